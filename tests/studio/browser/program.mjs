// The program under test: started on a free port, with folders of its own, and ended whatever the test does.
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, mkdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

export const program = process.env.POINTSKIN_PROGRAM ?? 'build/bin/pointskin';
export const generator = process.env.POINTSKIN_GENERATE ?? 'build/bin/pointskin_generate';

/** Runs a command of the program to its end. @returns {status, stdout, stderr} */
export function runProgram(...args) {
  return spawnSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 26 });
}

/** A folder that is removed when the process ends. */
export function temporaryFolder() {
  const folder = mkdtempSync(join(tmpdir(), 'pointskin-studio-'));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** `pointskin studio` with the given arguments. Its state (journals) lies in `folder/state`. */
export class Program {
  /** @param {{args?: string[], folder?: string}} options */
  static async start({ args = [], folder = temporaryFolder() } = {}) {
    mkdirSync(join(folder, 'state'), { recursive: true });
    const child = spawn(program, ['studio', '--no-browser', '--root', folder, ...args],
      { env: { ...process.env, XDG_STATE_HOME: join(folder, 'state') }, stdio: ['ignore', 'pipe', 'pipe'] });
    const self = new Program(child, folder);
    self.url = await self.#firstLine();
    return self;
  }

  constructor(child, folder) {
    this.child = child;
    this.folder = folder;
    this.errors = '';
    child.stderr.on('data', data => { this.errors += data; });
    this.ended = new Promise(resolve => child.on('exit', (code, signal) => resolve({ code, signal })));
    process.on('exit', () => child.kill('SIGKILL'));
  }

  get origin() { return new URL(this.url).origin; }
  get token() { return new URL(this.url).hash.slice(1); }

  async kill(signal = 'SIGTERM') {
    this.child.kill(signal);
    return this.ended;
  }

  /** Highest memory so far in bytes. */
  async peakMemory() {
    const { readFileSync } = await import('node:fs');
    const status = readFileSync(`/proc/${this.child.pid}/status`, 'utf8');
    return 1024 * Number(/VmHWM:\s+(\d+)/.exec(status)[1]);
  }

  #firstLine() {
    return new Promise((resolve, reject) => {
      createInterface({ input: this.child.stdout }).once('line', resolve);
      this.ended.then(({ code }) => reject(new Error(`studio ended with ${code}: ${this.errors}`)));
    });
  }
}
