#!/usr/bin/env bash
# Replays the kept inputs of every fuzz target, tests/fuzz/corpus/TARGET, and their prefixes under AddressSanitizer and
# UndefinedBehaviorSanitizer: any finding ends the script with an error.
set -euo pipefail
# shellcheck source=.ci/packages.sh
. "$(dirname "${BASH_SOURCE[0]}")/../../.ci/packages.sh"
cd "$strata_root"

cmake --preset asan --log-level=WARNING >/dev/null || die "configuring failed"
cmake --build build/asan -j "$(build_jobs)" --target fuzz_replays >/dev/null || die "building the fuzz targets failed"
for folder in tests/fuzz/corpus/*/; do
  target=$(basename "$folder")
  log=$(mktemp)
  if ! UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 "build/asan/fuzz/${target}_replay" "$folder" >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    rm -f "$log"
    die "fuzz: ${target} fails on a kept input"
  fi
  say "fuzz: $target, $(tail -n 1 "$log")"
  rm -f "$log"
done
