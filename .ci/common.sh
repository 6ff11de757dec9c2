# shellcheck shell=bash disable=SC2086
# Shared by ./quickstart, ./check and .ci/run: packages, configuring, logs. Sourced, with the working folder at the root.

step() { printf '==> %s\n' "$*"; }
die() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; exit 1; }

# packages_to TASK...: what the tasks need, one a line: Debian packages, or COMMAND=PACKAGE where any provider of the command
# will do. The list is .ci/packages.
packages_to() {
  local task
  for task in "$@"; do
    grep -q "^$task:" .ci/packages || die ".ci/packages has no line '$task:'"
    sed -n "s/^$task: *//p" .ci/packages | tr -s ' ' '\n'
  done
}

# missing_packages NEED...: prints the packages to install, one a line.
missing_packages() {
  local need
  for need in "$@"; do
    if [[ $need == *=* ]]; then
      command -v "${need%%=*}" >/dev/null || echo "${need#*=}"
    elif command -v dpkg-query >/dev/null; then
      [ "$(dpkg-query -W -f='${db:Status-Status}' "$need" 2>/dev/null)" = installed ] || echo "$need"
    fi
  done
}

# as_root COMMAND...: runs it as root, directly or through sudo.
as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# install_packages_to TASK...: installs what is missing for these tasks, and only that.
install_packages_to() {
  local needs missing
  needs=$(packages_to "$@")
  mapfile -t missing < <(missing_packages $needs)
  [ ${#missing[@]} = 0 ] && return
  local advice="these Debian packages are missing: ${missing[*]}; install them with: apt-get install ${missing[*]}"
  command -v apt-get >/dev/null || die "$advice"
  [ "$(id -u)" = 0 ] || command -v sudo >/dev/null || die "$advice (as root)"
  step "installing ${missing[*]}"
  run_logged build/packages.log as_root apt-get update -q
  run_logged build/packages.log as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y \
    --no-install-recommends "${missing[@]}"
}

# run_logged LOG COMMAND...: quiet while it works, the end of its output when it fails.
run_logged() {
  local log=$1
  shift
  mkdir -p "$(dirname "$log")"
  if ! "$@" </dev/null >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    die "failed: $* (all of it is in $log)"
  fi
}

# Puts nvcc on the path where CUDA lies in its usual place.
find_nvcc() {
  command -v nvcc >/dev/null || { [ -x /usr/local/cuda/bin/nvcc ] && PATH=$PATH:/usr/local/cuda/bin; }
  nvcc --version >/dev/null 2>&1
}

# The preset for this machine: `cuda` where there are both a compiler and a GPU for it.
best_preset() {
  if find_nvcc && nvidia-smi -L 2>/dev/null | grep -q '^GPU'; then echo cuda; else echo cpu; fi
}

# configure PRESET FOLDER OPTION...: a folder that another generator or another source tree made is begun anew.
configure() {
  local preset=$1 folder=$2 cache=$2/CMakeCache.txt fresh=()
  shift 2
  find_nvcc || true
  if command -v ccache >/dev/null; then  # what one folder has compiled, no other compiles again
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
  fi
  if [ -f "$cache" ] && { ! grep -q '^CMAKE_GENERATOR:INTERNAL=Ninja$' "$cache" ||
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$cache"; }; then
    fresh=(--fresh)
  fi
  run_logged "$folder/configure.log" cmake "${fresh[@]}" --preset "$preset" -B "$folder" "$@"
}
