#!/usr/bin/env bash
# Simulates 1,000 frames, makes and measures the surface of every one, and says whether all is as it should be: no particle
# lost, energy bounded, every mesh watertight, memory flat. Too long for the test suite; ends with 1 if something is not.
#
#   examples/fluid/thousand_frames.sh [SCENE] [PARTICLES] [PROGRAM] [more options of `pointskin fluid`]
#   default: drop 8192 build/bin/pointskin; about ten minutes on two cores, 1.5 GB of temporary files
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
scene=${1:-drop}
particles=${2:-8192}
program=${3:-build/bin/pointskin}
shift $(($# < 3 ? $# : 3))

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" fluid --simulate "$scene" --particles "$particles" --frames 1000 --cube-size 1 -o "$folder/mesh_{}.ply" \
  --report "$folder/report.json" "$@"
python3 - "$folder/report.json" <<'PYTHON'
import json
import sys

frames = json.load(open(sys.argv[1], encoding="utf-8"))["frames"]
energy = [f["kinetic_energy"] + f["potential_energy"] for f in frames]
stirred = json.load(open(sys.argv[1], encoding="utf-8"))["scene"]["name"] == "stir"
most_energy = 2.5 if stirred else 1.2
peak = [f["host_peak_bytes"] / 1e6 for f in frames]
found = {
    "frames": len(frames) == 1000,
    "particles kept": len({f["particles"] for f in frames}) == 1,
    "meshes watertight": all(f["mesh"]["watertight"] for f in frames),
    "energy bounded": max(energy) < most_energy * energy[0],
    "density error": max(f["mean_density_error"] for f in frames) < 0.06,
    "memory flat from frame 250 on": peak[-1] < 1.1 * peak[249] + 1,
}
print(f"energy: {energy[0]:.0f} J at first, at most {max(energy):.0f} J, {energy[-1]:.0f} J at last")
print(f"mean compression: at most {max(f['mean_density_error'] for f in frames):.3f}")
print(f"components: {min(f['mesh']['components'] for f in frames)} to {max(f['mesh']['components'] for f in frames)}")
print("host peak after 100, 250, 500, 1000 frames: " + ", ".join(f"{peak[i]:.1f} MB" for i in (99, 249, 499, 999)))
for name, holds in found.items():
    print(f"{name}: {'yes' if holds else 'NO'}")
sys.exit(0 if all(found.values()) else 1)
PYTHON
