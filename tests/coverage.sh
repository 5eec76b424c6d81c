#!/usr/bin/env bash
# Measures which lines the tests run: tests/coverage.sh [-- CTEST_ARGUMENTS...], for example -- -L unit. It builds with
# g++ --coverage in build/coverage, runs the fast tests that need no GPU, and prints a table with a row for each wing.
# A line of a header counts once, however many sources include it.
set -euo pipefail
# shellcheck source=.ci/packages.sh
. "$(dirname "${BASH_SOURCE[0]}")/../.ci/packages.sh"
cd "$strata_root"

usage() { echo 'usage: tests/coverage.sh [-- CTEST_ARGUMENTS...]'; }
case ${1:-} in
  "") ;;
  --) shift ;;
  -h | --help) usage && exit 0 ;;
  *) usage >&2 && exit 2 ;;
esac

install_packages
build=build/coverage
cmake --preset dev -B "$build" -DSTRATA_PRECOMPILE=OFF -DCMAKE_CXX_FLAGS="--coverage -O1" --log-level=WARNING >/dev/null ||
  die "configuring failed"
cmake --build "$build" -j "$(build_jobs)" || die "building failed"
find "$build" -name '*.gcda' -delete
ctest --test-dir "$build" -LE 'slow|gpu' -j2 --output-on-failure "$@" || say "some tests failed: their lines count too"
python3 tests/coverage_table.py "$build"
