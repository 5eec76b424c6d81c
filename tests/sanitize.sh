#!/usr/bin/env bash
# Runs the tests under sanitizers: tests/sanitize.sh [asan|tsan]... [-- CTEST_ARGUMENTS...], both without arguments.
#
#   asan   AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer over the fast tests of every kind but gl and
#          golden: Mesa's software drivers are slow under it, and what they leak is not ours.
#   tsan   ThreadSanitizer over the tests that start the streaming threads, or call what those share. Debian's TBB is
#          not built with it, so the parallel loops of the converter and the rasterizers would give false alarms: they
#          are left out.
set -euo pipefail
# shellcheck source=.ci/packages.sh
. "$(dirname "${BASH_SOURCE[0]}")/../.ci/packages.sh"
cd "$strata_root"

threaded_tests=(lod_streamer_stress_test lod_streamer_test lod_load_queue_test lod_node_cache_test lod_fade_test)
presets=()
while [ $# -gt 0 ]; do
  case $1 in
    asan | tsan) presets+=("$1") ;;
    --) shift && break ;;
    -h | --help) sed -n '2,/^set/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" && exit 0 ;;
    *) printf 'error: unknown argument %s (expected asan, tsan or --)\n' "$1" >&2 && exit 2 ;;
  esac
  shift
done
[ ${#presets[@]} -gt 0 ] || presets=(asan tsan)

strata_packages+=("${strata_check_packages[@]}")
install_packages
for preset in "${presets[@]}"; do
  say "$preset: building"
  cmake --preset "$preset" --log-level=WARNING
  if [ "$preset" = tsan ]; then
    cmake --build build/tsan -j "$(build_jobs)" --target "${threaded_tests[@]}"
    export TSAN_OPTIONS="suppressions=$strata_root/tests/support/tsan.supp ${TSAN_OPTIONS:-}"
    for name in "${threaded_tests[@]}"; do "build/tsan/tests/$name" --gtest_brief=1 || die "tsan: $name found something"; done
  else
    cmake --build build/asan -j "$(build_jobs)"
    ctest --preset asan -j2 --timeout 1800 -L 'unit|property|stress|system' -LE 'slow|gpu' "$@" ||
      die "asan: some tests failed"
  fi
  say "$preset: nothing found"
done
