#!/usr/bin/env bash
# How close a reconstruction comes to a known surface, clean and noisy, beside another program where one is given.
#
#   bench/accuracy.sh [--bin build/bin] [--shape gyroid] [--points 500000] [--depth 8] [--noise 0.003]
#                     [--normal-noise 0.1] [--options '--screening 4'] [--keep FOLDER]
#                     [--peer 'PoissonRecon --in {in} --out {out} --depth {depth}']
#
# Prints a Markdown table; distances are in world units (the shapes have a radius of about 1).
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
bin=$root/build/bin shape=gyroid points=500000 depth=8 noise=0.003 normal_noise=0.1 options='' keep='' peer=''
while [ $# -gt 0 ]; do
  case $1 in
    --bin | --shape | --points | --depth | --noise | --normal-noise | --options | --keep | --peer)
      [ $# -gt 1 ] || { echo "accuracy.sh: $1 needs a value" >&2; exit 2; }
      name=${1#--}
      printf -v "${name//-/_}" '%s' "$2"
      shift 2
      ;;
    *)
      sed -n '2,/^set/{s/^# \{0,1\}//;/^set/d;p}' "${BASH_SOURCE[0]}" >&2
      exit 2
      ;;
  esac
done

folder=$keep
if [ -z "$folder" ]; then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
mkdir -p "$folder"

# row WHO CASE MESH SECONDS
row() {
  local word rms mean max triangles
  read -r -a words < <("$bin/pointskin_accuracy" "$3" --shape "$shape")
  for ((word = 0; word < ${#words[@]}; word += 2)); do
    case ${words[word]} in
      triangles) triangles=${words[word + 1]} ;;
      rms) rms=${words[word + 1]} ;;
      mean) mean=${words[word + 1]} ;;
      max) max=${words[word + 1]} ;;
    esac
  done
  printf '| %s | %s | %s | %s | %s | %s | %.2f |\n' "$1" "$2" "$rms" "$mean" "$max" "$triangles" "$4"
}

# timed COMMAND...: runs it quietly and leaves its wall clock in $seconds.
timed() {
  local begin=${EPOCHREALTIME/,/.}
  "$@" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; echo "accuracy.sh: failed: $*" >&2; exit 1; }
  seconds=$(awk -v begin="$begin" -v end="${EPOCHREALTIME/,/.}" 'BEGIN {print end - begin}')
}

echo "$shape, $points points, depth $depth"
echo
echo '| program | samples | rms | mean | max | triangles | seconds |'
echo '|---|---|---|---|---|---|---|'
for case in clean noisy; do
  cloud=$folder/$case.ply
  extra=()
  [ "$case" = noisy ] && extra=(--noise "$noise" --normal-noise "$normal_noise")
  "$bin/pointskin_generate" "$shape" -o "$cloud" --points "$points" --seed 1 "${extra[@]}"
  # shellcheck disable=SC2086  # the options are words
  timed "$bin/pointskin" reconstruct "$cloud" -o "$folder/$case-pointskin.ply" --depth "$depth" $options
  row pointskin "$case" "$folder/$case-pointskin.ply" "$seconds"
  if [ -n "$peer" ]; then
    mesh=$folder/$case-peer.ply
    command=${peer//\{in\}/$cloud}
    command=${command//\{out\}/$mesh}
    read -r -a words <<<"${command//\{depth\}/$depth}"
    timed "${words[@]}"
    row "$(basename "${words[0]}")" "$case" "$mesh" "$seconds"
  fi
done
