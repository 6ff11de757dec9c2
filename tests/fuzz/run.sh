#!/usr/bin/env bash
# run.sh PROGRAM CORPUS [SEEDS...]: 20,000 inputs or a minute, whichever ends first; POINTSKIN_FUZZ_SECONDS sets a time instead.
set -euo pipefail
limits=(-runs=20000 -max_total_time=60)
if [ -n "${POINTSKIN_FUZZ_SECONDS:-}" ]; then limits=(-max_total_time="$POINTSKIN_FUZZ_SECONDS"); fi
program=$1
shift
cd "$1"/..  # inputs that fail are left beside the corpus
exec "$program" "${limits[@]}" -timeout=20 -rss_limit_mb=4096 -max_len=8192 "$@"
