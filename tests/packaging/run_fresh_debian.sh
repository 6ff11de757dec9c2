#!/usr/bin/env bash
# Makes the packages of the CPU and installs them into a bare Debian; run_fresh_debian.sh FOLDER, in the project's root.
set -euo pipefail
if [ "${POINTSKIN_TEST_PACKAGES:-0}" != 1 ]; then
  echo "skipped: it takes minutes; ask for it by POINTSKIN_TEST_PACKAGES=1"
  exit 77
fi
POINTSKIN_PACKAGE_CUDA=0 ./package deb wheel
# Debian's own check of packages. There is no address of a maintainer yet.
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog dist/*.deb
fi
exec tests/packaging/fresh_debian.sh dist "$1"
