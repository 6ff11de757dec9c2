#!/usr/bin/env bash
# Draws the pictures of the README: three frames of a dam break, simulated, surfaced and rendered by pointskin.
#
#   examples/fluid/pictures.sh [PROGRAM]      default: build/bin/pointskin; a minute on two cores
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
program=${1:-build/bin/pointskin}
frames=(12 33 60)

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" fluid --simulate dam-break --particles 20000 --frames 61 --cube-size 0.75 --mesh-smoothing-iters 10 \
  -o "$folder/mesh_{}.ply"
for i in "${!frames[@]}"; do
  "$program" render "$folder/mesh_${frames[$i]}.ply" -o "docs/pictures/fluid_$((i + 1)).png" --size 480x320 \
    --azimuth 25 --elevation 18
done
ls -l docs/pictures/fluid_*.png
