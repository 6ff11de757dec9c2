#!/usr/bin/env bash
# Installs what ./package made into a Debian 12 that has no compiler and nothing of ours: the .deb files by apt, the wheel by
# pip in a new environment without a network. Needs root, debootstrap and a Debian mirror.
#
#   fresh_debian.sh DIST FOLDER      FOLDER keeps the bare system for the next time
set -euo pipefail
dist=$(readlink -f "$1") folder=$(mkdir -p "$2" && readlink -f "$2")
readonly bare=$folder/bare.tar root=$folder/root
skip() { echo "skipped: $*"; exit 77; }
[ "$(id -u)" = 0 ] || skip "needs root"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
ls "$dist"/pointskin_*.deb "$dist"/pointskin-*.whl >/dev/null 2>&1 || skip "no packages in $dist; make them with ./package"

clean() { umount -q "$root/proc" 2>/dev/null || true; rm -rf "$root"; }
trap clean EXIT
clean
if [ ! -s "$bare" ]; then
  mirror=$(grep -rhoE '(URIs: *|^deb +)[a-z]+://[^ ]+' /etc/apt/sources.list /etc/apt/sources.list.d 2>/dev/null |
    sed -E 's/^(URIs: *|deb +)//' | grep -E '/debian/?$' | head -1 || true)
  debootstrap --variant=minbase --include=python3-numpy,python3-venv bookworm "$root" "${mirror:-http://deb.debian.org/debian}" \
    >"$folder/debootstrap.log" 2>&1 || { tail -5 "$folder/debootstrap.log"; skip "debootstrap found no mirror"; }
  # The same mirror and the same way to it as here.
  rm -rf "$root/etc/apt/sources.list" "$root/etc/apt/sources.list.d"
  for file in sources.list sources.list.d apt.conf.d trusted.gpg.d; do
    [ ! -e "/etc/apt/$file" ] || cp -a "/etc/apt/$file" "$root/etc/apt/"
  done
  mkdir -p "$root/etc/ssl/certs" && cp -a /etc/ssl/certs/. "$root/etc/ssl/certs/"
  tar -cf "$bare" -C "$root" .
else
  mkdir -p "$root" && tar -xf "$bare" -C "$root"
fi
cp -L /etc/resolv.conf /etc/hosts "$root/etc/" 2>/dev/null || true
mkdir "$root/packages" "$root/packages/mpi" && cp "$dist"/*.deb "$dist"/*.whl "$root/packages"
mv "$root"/packages/pointskin-{openmpi,mpich}_*.deb "$root/packages/mpi"  # each brings an MPI along
mount -t proc proc "$root/proc"
mapfile -t way < <(env | grep -iE '^[a-z_]*proxy=' || true)
inside() { chroot "$root" env -i "${way[@]}" PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
without_network() { unshare -n chroot "$root" env -i PATH=/usr/bin:/bin HOME=/root LC_ALL=C.UTF-8 "$@"; }

cat >"$root/ball.py" <<'END'
import sys
import numpy as np
import pointskin as ps
i = np.arange(20000)
z = 1 - (2 * i + 1) / 20000
r = np.sqrt(1 - z * z)
p = np.stack([r * np.cos(2.399963 * i), r * np.sin(2.399963 * i), z], axis=1).astype(np.float32)
ps.Cloud(p, p).save("/ball.ply")
mesh = ps.reconstruct(p, p, depth=7)
assert mesh.is_watertight
mesh.save(sys.argv[1])
print(mesh, open("/proc/self/maps").read().count("libGL"))
END

echo "== the wheel, in an environment of its own, without a network"
! inside sh -c 'command -v gcc cc c++ make'
inside python3 -m venv --system-site-packages /venv
without_network sh -c '/venv/bin/pip install --no-index -q /packages/pointskin-*.whl'
without_network /venv/bin/python /ball.py /by_wheel.ply
without_network /venv/bin/pointskin check /by_wheel.ply
without_network /venv/bin/python -m pointskin --version

echo "== the Debian packages"
inside apt-get update -q >/dev/null
inside sh -c 'apt-get install -q -y --no-install-recommends /packages/*.deb' >"$folder/apt.log" 2>&1 ||
  { tail -20 "$folder/apt.log"; exit 1; }
! inside sh -c 'command -v gcc cc c++ make'
inside python3 /ball.py /by_deb.ply
inside pointskin reconstruct /ball.ply -o /by_program.ply --depth 7 -q
inside cmp /by_wheel.ply /by_deb.ply
inside cmp /by_deb.ply /by_program.ply
inside sh -c 'ldd /usr/bin/pointskin /usr/lib/*/libpointskin.so.0' | { ! grep -E 'libGL|libcuda|not found'; }
inside test -s /usr/share/man/man1/pointskin-reconstruct.1 -o -s /usr/share/man/man1/pointskin-reconstruct.1.gz

echo "== the module for Open MPI"
! inside sh -c 'command -v mpirun'
inside sh -c 'apt-get install -q -y --no-install-recommends /packages/mpi/pointskin-openmpi_*.deb openmpi-bin' >"$folder/apt.log" 2>&1 ||
  { tail -20 "$folder/apt.log"; exit 1; }
inside mpirun --allow-run-as-root --oversubscribe -n 2 pointskin reconstruct /ball.ply -o /by_ranks.ply --depth 7 -q
inside cmp /by_deb.ply /by_ranks.ply
inside apt-get remove -q -y pointskin libpointskin0 >/dev/null
echo "== all of it is the same mesh"
