#!/usr/bin/env bash
# Measures hole filling as docs/hole_filling.md reports it: converts red_rocks and a synthetic city, thins them to a quarter and
# a sixteenth, and compares the ways of filling with the picture of the whole scan. Prints the tables; about three minutes
# on two idle cores with 16 million points.
# usage: tests/bench/fill_quality.sh RED_ROCKS.laz FOLDER [CITY_POINTS]
#   RED_ROCKS.laz  '' leaves the scan out     FOLDER  gets stores and pictures; what is in it is used again
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
  [ -n "$input" ] || continue
  store=$folder/$scan.strata
  [ -e "$store/store.json" ] || "$bin/strata-convert" "$input" -o "$store" --normals --json >/dev/null 2>&1
  views=$here/${scan}_fill_views.json
  printf '%s, thinned and filled, against all of its points (`pictures`):\n\n' $scan
  "$bin/fill_quality" pictures "$folder/$scan" "$store" "$views"
  printf '%s, mean difference of successive frames (`steadiness`):\n\n' $scan
  "$bin/fill_quality" steadiness "$store" "$views"
  printf '%s, milliseconds of each step as in Farias 2014, Table 5.2 (`times`):\n\n' $scan
  "$bin/fill_quality" times "$store" "$views" 1 0.25 0.0625
  echo
done
