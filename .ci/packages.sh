#!/usr/bin/env bash
# Installs what Strata is built, run and tested with on Debian 12 or newer and Ubuntu 24.04 or newer, and builds it.
# demo.sh and test.sh source it; run by itself it only installs. Needs root or sudo, and only where a package is missing.

unset CDPATH
strata_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

strata_packages=(
  ca-certificates cmake ninja-build g++ make pkg-config
  libegl-dev libgl-dev libegl1 libegl-mesa0 libgl1-mesa-dri
  libglfw3-dev libimgui-dev
  libglm-dev libeigen3-dev
  libtbb-dev libhwy-dev
  liblz4-dev libxxhash-dev
  libpcl-dev
  libcli11-dev nlohmann-json3-dev libspdlog-dev libpng-dev
  libgtest-dev libbenchmark-dev xdotool xvfb xauth
)
# What .ci/checks.sh and the sanitizers need besides; neither demo.sh nor test.sh installs them.
# shellcheck disable=SC2034  # for those who source this file
strata_check_packages=(clang clang-format clang-tidy git)
# Taken where the release has them: Mesa 25.1 dropped OSMesa.
strata_optional_packages=(libosmesa6-dev)
# The reference library of LAS and LAZ. Releases without it take these three, and nothing else, from Debian 13.
strata_laszip_packages=(liblaszip8 liblaszip-api8 liblaszip-dev)
strata_laszip_version=3.5
strata_laszip_suite=trixie

say() { printf 'strata: %s\n' "$*"; }
die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    die "packages are missing and can be installed only as root or with sudo (this user is neither root nor has sudo)"
  fi
}

# Keeps apt's own chatter for the case that something fails.
apt_install() {
  local log
  log=$(mktemp)
  if ! as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" >"$log" 2>&1 </dev/null; then
    tail -n 20 "$log" >&2
    rm -f "$log"
    die "apt-get could not install: $*"
  fi
  rm -f "$log"
}

apt_update() {
  say "reading the package lists"
  as_root apt-get update -q >/dev/null </dev/null || die "apt-get update failed"
}

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

missing_packages() {
  local package
  for package in "$@"; do
    is_installed "$package" || printf '%s\n' "$package"
  done
}

is_laszip_new_enough() { [ -n "$1" ] && dpkg --compare-versions "$1" ge "$strata_laszip_version"; }

has_laszip() {
  is_installed liblaszip-dev && is_laszip_new_enough "$(dpkg-query -W -f='${Version}' liblaszip-dev)"
}

candidate_version() {
  LC_ALL=C apt-cache policy "$1" 2>/dev/null | sed -n 's/^  Candidate: //p' | grep -v '(none)' || true
}

# The mirror that this machine's own apt sources name for Debian; empty where they name none.
debian_mirror() {
  local codename
  # shellcheck source=/dev/null
  codename=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
  # shellcheck disable=SC2016  # apt fills these in
  apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
    awk -v codename="$codename" '$1 == "Debian" && $2 == codename && $3 == "main" { print $4; exit }'
}

# A configuration of apt of its own in a temporary folder: no source and no list of it outlives the download.
install_laszip_from_debian13() (
  mirror=${STRATA_DEBIAN_MIRROR:-$(debian_mirror)}
  [ -n "$mirror" ] || die "LASzip $strata_laszip_version is not in this release and its apt sources name no Debian mirror" \
    "(set STRATA_DEBIAN_MIRROR to the address of one, or install liblaszip-dev >= $strata_laszip_version by hand)"
  say "taking LASzip from Debian's suite $strata_laszip_suite: ${strata_laszip_packages[*]}"
  apt_install debian-archive-keyring

  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  chmod 755 "$folder"
  mkdir -p "$folder/sources" "$folder/lists/partial" "$folder/cache" "$folder/packages"
  if [ "$(id -u)" = 0 ]; then chown _apt "$folder/lists/partial" "$folder/packages" 2>/dev/null || true; fi
  cat >"$folder/sources/debian.sources" <<SOURCES
Types: deb
URIs: $mirror
Suites: $strata_laszip_suite
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
SOURCES
  isolated=(-q -o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$folder/sources"
    -o "Dir::State::Lists=$folder/lists" -o "Dir::Cache=$folder/cache" -o APT::Get::AllowUnauthenticated=false)
  cd "$folder/packages"
  if ! apt-get "${isolated[@]}" update >"$folder/log" 2>&1 ||
    ! apt-get "${isolated[@]}" download "${strata_laszip_packages[@]/%//$strata_laszip_suite}" >>"$folder/log" 2>&1; then
    tail -n 5 "$folder/log" >&2
    die "LASzip could not be fetched from $mirror"
  fi
  apt_install "$folder"/packages/*.deb
)

install_packages() {
  command -v apt-get >/dev/null || die "this set-up needs apt (Debian 12 or newer, Ubuntu 24.04 or newer)"
  local missing wanted=() package
  mapfile -t missing < <(missing_packages "${strata_packages[@]}")
  if [ ${#missing[@]} -eq 0 ] && has_laszip; then
    say "all packages are installed"
    return
  fi

  as_root true
  apt_update
  for package in "${strata_optional_packages[@]}"; do
    if ! is_installed "$package" && [ -n "$(candidate_version "$package")" ]; then wanted+=("$package"); fi
  done
  if ! has_laszip && is_laszip_new_enough "$(candidate_version liblaszip-dev)"; then wanted+=(liblaszip-dev); fi
  wanted+=("${missing[@]}")
  if [ ${#wanted[@]} -gt 0 ]; then
    say "installing ${#wanted[@]} packages: ${wanted[*]}"
    apt_install "${wanted[@]}"
  fi
  has_laszip || install_laszip_from_debian13
}

# As many compilers at a time as there are cores, but 1.5 GB for each: PCL's headers need it.
build_jobs() {
  local cores memory_kb jobs
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)
  jobs=$((memory_kb / 1500000))
  ((jobs < cores)) || jobs=$cores
  ((jobs > 0)) || jobs=1
  printf '%s' "$jobs"
}

# Builds the targets named. The programs end up in build/release/bin.
build_release() {
  local jobs
  jobs=$(build_jobs)
  say "configuring build/release"
  # shellcheck disable=SC2086  # STRATA_CONFIGURE holds further arguments, as .ci/run sets them
  (cd "$strata_root" && cmake --preset release --log-level=WARNING ${STRATA_CONFIGURE:-}) || die "configuring failed"
  say "building with $jobs jobs"
  cmake --build "$strata_root/build/release" -j "$jobs" --target "$@" || die "building failed"
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  set -euo pipefail
  install_packages
fi
