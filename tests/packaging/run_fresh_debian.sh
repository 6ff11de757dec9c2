#!/usr/bin/env bash
# Makes the packages of the CPU and installs them into a bare Debian; run_fresh_debian.sh FOLDER, in the project's root.
set -euo pipefail
if [ "${POINTSKIN_TEST_PACKAGES:-0}" != 1 ]; then
  echo "skipped: it takes minutes; ask for it by POINTSKIN_TEST_PACKAGES=1"
  exit 77
fi
POINTSKIN_PACKAGE_CUDA=0 ./package deb wheel
exec tests/packaging/fresh_debian.sh dist "$1"
