#!/usr/bin/env bash
# Times conversions as docs/benchmarks.md reports them: a synthetic city as LAS and LAZ, every stage, three runs each.
# usage: tests/bench/convert.sh [POINTS] [FOLDER]
set -euo pipefail
points=${1:-50e6}
folder=${2:-$(mktemp -d)}
bin=$(cd "$(dirname "$0")/../.." && pwd)/build/release/bin
mkdir -p "$folder"
if [ ! -e "$folder/city.las" ]; then
  "$bin/strata-convert" "synthetic:city?points=$points" -o "$folder/made.strata" --force --json >/dev/null
  "$bin/strata-export" "$folder/made.strata" -o "$folder/city.las" --force >/dev/null
  "$bin/strata-export" "$folder/made.strata" -o "$folder/city.laz" --force >/dev/null
fi
for input in city.las city.laz; do
  for run in 1 2 3; do
    printf '%s run %s: ' "$input" "$run"
    "$bin/strata-convert" "$folder/$input" -o "$folder/timed.strata" --force --json | tail -n 1
  done
done
