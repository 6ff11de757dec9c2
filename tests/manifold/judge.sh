#!/usr/bin/env bash
# judge.sh PROGRAM GENERATOR SOURCE DEPTH [GENERATOR OPTION...]
#
# Reconstructs SOURCE (a shape of pointskin_generate, or a file) at DEPTH; the mesh must please both `pointskin check`
# and the Manifold library. Exit 77: skipped, because a scan, node or the npm package is missing; with
# POINTSKIN_REQUIRE_MANIFOLD=1 a missing judge is a failure.
set -euo pipefail

program=$1 generator=$2 source=$3 depth=$4
shift 4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

if ! command -v node >/dev/null || ! node "$here/check.mjs" --installed 2>/dev/null; then
  echo "node or the npm package manifold-3d is missing; run: npm ci --prefix tests/manifold"
  [ "${POINTSKIN_REQUIRE_MANIFOLD:-0}" = 1 ] && exit 1
  exit 77
fi
if [[ $source == --self-test ]]; then
  exec node "$here/check.mjs" --self-test
fi
if [[ $source == */* && ! -f $source ]]; then
  echo "$source is not there"
  exit 77
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cloud=$source
if [[ $source != */* ]]; then
  cloud=$folder/cloud.ply
  "$generator" "$source" -o "$cloud" "$@"
fi
"$program" reconstruct "$cloud" -o "$folder/mesh.ply" --depth "$depth" -q
failed=0
"$program" check "$folder/mesh.ply" || { echo "pointskin check: exit code $?"; failed=1; }
node "$here/check.mjs" "$folder/mesh.ply" || { echo "Manifold does not accept the mesh"; failed=1; }
exit $failed
