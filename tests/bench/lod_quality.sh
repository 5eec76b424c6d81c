#!/usr/bin/env bash
# Measures what level of detail costs in picture quality, as docs/benchmarks/lod_quality.md reports it: converts
# red_rocks and a synthetic city with each way of colouring, and compares pictures of few points with the picture of all
# points.
# usage: tests/bench/lod_quality.sh RED_ROCKS.laz FOLDER [CITY_POINTS]
#   The plots FOLDER/*/*.svg and tables FOLDER/*/*.tsv are the figures of docs/benchmarks/lod_quality.md; pictures lie beside them.
set -euo pipefail
red_rocks=$1
folder=$2
city="synthetic:city?points=${3:-20e6}&seed=1"
here=$(cd "$(dirname "$0")" && pwd)
bin=${STRATA_BIN:-$here/../../build/release/bin}
mkdir -p "$folder"

convert() {  # INPUT STORE OPTIONS...
  [ -e "$2" ] || "$bin/strata-convert" "$1" -o "$2" "${@:3}" --json >/dev/null
}
for scan in red_rocks city; do
  input=$red_rocks
  [ $scan = red_rocks ] || input=$city
  stores=()
  for colour in first average; do
    store=$folder/${scan}_ntree_$colour.strata
    convert "$input" "$store" --lod-colour $colour
    stores+=("ntree_$colour=$store")
  done
  reference=$folder/${scan}_ntree_first.strata
  "$bin/lod_quality" compare "$folder/$scan" "$reference" "$here/${scan}_views.json" "${stores[@]}"
  "$bin/lod_quality" growth "$folder/$scan" "$reference" "$here/${scan}_views.json"
done
"$bin/lod_quality" coverage "$folder/coverage" red_rocks "$folder/red_rocks_ntree_first.strata" "$here/red_rocks_views.json" \
  city "$folder/city_ntree_first.strata" "$here/city_views.json"
