#!/usr/bin/env bash
# Prints the processor time, user and system together, that building takes: tests/bench/build_time.sh [CMAKE_ARGUMENTS...]
# It builds the programs, and then the tests, in a folder of its own that it removes, without ccache.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
programs=(strata-convert strata-info strata-export strata-bench strata-view)

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --preset release -B "$folder" -DCMAKE_CXX_COMPILER_LAUNCHER= "$@" --log-level=WARNING >/dev/null

TIMEFORMAT='%U %S'
row() {
  local name=$1
  shift
  if ! { time cmake --build "$folder" --target "$@" >"$folder/log" 2>&1; } 2>"$folder/time"; then
    tail -n 20 "$folder/log" >&2
    exit 1
  fi
  awk -v name="$name" '{ printf "| %s | %.0f |\n", name, $1 + $2 }' "$folder/time"
}
echo '| what is built | processor time (s) |'
echo '|---|---|'
row 'the programs that demo.sh builds' "${programs[@]}"
row 'the tests and benchmarks after them' all
