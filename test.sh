#!/usr/bin/env bash
# Installs the packages, builds, and runs every test that needs no GPU and is not labelled slow.
set -euo pipefail
# shellcheck source=.ci/packages.sh
. "$(dirname "${BASH_SOURCE[0]}")/.ci/packages.sh"

usage() {
  cat <<'TEXT'
usage: ./test.sh [--build-only] [-- CTEST_ARGUMENTS...]
  --build-only   install the packages and build, run nothing
  --             the rest goes to ctest, for example: ./test.sh -- -R NodeKey
TEXT
}

build_only=false
while [ $# -gt 0 ]; do
  case $1 in
    --build-only) build_only=true ;;
    -h | --help) usage && exit 0 ;;
    --) shift && break ;;
    *) printf 'error: unknown argument %s (see ./test.sh --help)\n' "$1" >&2 && exit 2 ;;
  esac
  shift
done

# Without the set of real scans beside the project, those of a Debian package are tested.
if [ ! -e "$strata_root/../shared/data/MANIFEST.tsv" ] && ! $build_only; then strata_packages+=(libcgal-demo); fi
install_packages
build_release all
if $build_only; then
  say "the programs are in $strata_root/build/release/bin"
  exit 0
fi

say "running the tests"
cd "$strata_root"
ctest --preset release -LE 'slow|gpu' -j2 "$@" || die "some tests failed"
