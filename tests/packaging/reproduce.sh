#!/usr/bin/env bash
# Makes all packages two times, from copies of the sources in two folders and with no compiler cache, and expects the same bytes.
#
#   reproduce.sh FOLDER      in the project's root; FOLDER is made anew and keeps what differs
#
# The folders' names have different lengths, the second build runs on one processor less, in another time zone and locale, and
# with another mask for new files: what depends on any of these differs.
set -euo pipefail
folder=$1
rm -rf "$folder"
mkdir -p "$folder"
folder=$(readlink -f "$folder")
readonly one=$folder/a two=$folder/a-longer-name/of/the-sources
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || echo 0)}
export SOURCE_DATE_EPOCH POINTSKIN_PACKAGE_CUDA=${POINTSKIN_PACKAGE_CUDA:-0} CCACHE_DISABLE=1

# The present commit alone, as a repository: the source archive is made of it.
for copy in "$one" "$two"; do
  git clone -q --no-hardlinks . "$copy"
done
(cd "$one" && ./package)
jobs=$(($(nproc) > 1 ? $(nproc) - 1 : 1))
(umask 027 && cd "$two" && TZ=Asia/Kolkata LC_ALL=C CMAKE_BUILD_PARALLEL_LEVEL=$jobs ./package)

exec tests/packaging/compare_packages.py "$one/dist" "$two/dist"
