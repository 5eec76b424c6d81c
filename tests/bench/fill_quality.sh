#!/usr/bin/env bash
# Measures hole filling as docs/effects.md reports it: converts red_rocks and a synthetic city, thins them to a quarter and
# a sixteenth, and compares the ways of filling with the picture of the whole scan.
# usage: tests/bench/fill_quality.sh RED_ROCKS.laz FOLDER [CITY_POINTS]
#   FOLDER gets SCAN/fill.tsv and pictures, SCAN.steady.tsv (flicker) and SCAN.times.md (milliseconds).
set -euo pipefail
red_rocks=$1
folder=$2
city="synthetic:city?points=${3:-16e6}&seed=1"
here=$(cd "$(dirname "$0")" && pwd)
bin=${STRATA_BIN:-$here/../../build/release/bin}
mkdir -p "$folder"
for scan in red_rocks city; do
  input=$red_rocks
  [ $scan = red_rocks ] || input=$city
  store=$folder/$scan.strata
  [ -e "$store" ] || "$bin/strata-convert" "$input" -o "$store" --normals --json >/dev/null
  views=$here/${scan}_fill_views.json
  "$bin/fill_quality" times "$store" "$views" 1 0.25 0.0625 >"$folder/$scan.times.md"
  "$bin/fill_quality" pictures "$folder/$scan" "$store" "$views"
  "$bin/fill_quality" steadiness "$store" "$views" >"$folder/$scan.steady.tsv"
done
