"""Starts programs for the campaign, one at a time: requests and answers are lines of JSON on stdin and stdout.

It is a process of its own because the peak memory that the system tells of a program includes that of the process that
started it, up to the moment at which the program began; this one is small and stays so."""
import json
import os
import signal
import sys
import time


def run(request):
    out = os.open(request["stdout"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    err = os.open(request["stderr"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    begin = time.monotonic()
    pid = os.fork()
    if pid == 0:
        try:
            os.setpgid(0, 0)
            os.chdir(request["folder"])
            null = os.open("/dev/null", os.O_RDONLY)
            for source, target in ((null, 0), (out, 1), (err, 2)):
                os.dup2(source, target)
            os.closerange(3, 64)
            os.execv(request["arguments"][0], request["arguments"])
        finally:
            os._exit(127)
    os.close(out)
    os.close(err)
    late, pause = False, 0.001
    while True:
        done, status, usage = os.wait4(pid, os.WNOHANG)
        if done:
            break
        if time.monotonic() - begin > request["seconds"]:
            late = True
            os.kill(pid, signal.SIGKILL)
        time.sleep(pause)
        pause = min(0.02, pause * 1.3)
    return {"code": os.waitstatus_to_exitcode(status), "late": late, "peak": usage.ru_maxrss * 1024,
            "cpu": usage.ru_utime + usage.ru_stime, "wall": time.monotonic() - begin}


for line in sys.stdin:
    print(json.dumps(run(json.loads(line))), flush=True)
