#!/usr/bin/env bash
# Measures the figures of docs/benchmarks.md. The tables of a section go between the marks of its own page,
# docs/benchmarks/SECTION.md, and its main figures between those of docs/benchmarks.md, which has `machine` and `targets`
# whole. On two idle cores the default sizes take about 20 minutes and 12 GB of disk.
# usage: tests/bench/all.sh [-b BUILD] [-d FOLDER] [-o DOCS] [-q] [SECTION...]
#   BUILD    the folder with bin/ and tests/ (default: build/release)
#   FOLDER   scratch; what an earlier call left in it is used again (default: a new one under TMPDIR)
#   DOCS     the folder with benchmarks.md and benchmarks/ (default: docs)
#   -q       quick: everything a hundredth, only to see that it works
#   SECTION  machine conversion store selection loading streaming rasterizers progressive kanzok schuetz guenther
#            flights real filling largest larger targets; default: all but larger and largest
# Sizes, from the environment:
#   CONVERT="10M 50M"           points of the conversions
#   LARGER="200M 500M:1G"       the same of section larger, POINTS[:--memory]
#   CITY=50e6 ROOM=20e6         points of the stores that are flown through
#   LARGEST=500e6               points of the largest city
#   RASTER=10 PROGRESSIVE=10    million points to draw
#   SCALE=0.02                  share of the papers' numbers of points; KANZOK_SCALE=SCALE
#   REPEAT=3                    flights of each path
#   VIEWS=30                    views indoors
#   FLOWN=3e6                   points of the room that is flown through
#   FILLED=16e6                 points of the city whose holes are filled
#   RED_ROCKS=FILE.laz          the real scan; default: ../shared/data/laz/large/red_rocks_4.0M.laz
# Disk: larger takes 48 bytes a point of one scan at a time; figures that earlier calls measured into the same FOLDER stay
# in its tables, so it may be run scan by scan. largest takes 21 bytes a point: 1e9 points fit 25 GB, 2e9 fit 45 GB.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$root/build/release folder='' docs=$root/docs quick=0
while getopts b:d:o:q option; do
  case $option in
    b) build=$(realpath "$OPTARG") ;;
    d) folder=$OPTARG ;;
    o) docs=$OPTARG ;;
    q) quick=1 ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
sections=("$@")
[ ${#sections[@]} -gt 0 ] ||
  sections=(machine conversion store selection loading streaming rasterizers progressive kanzok schuetz guenther flights
    real filling targets)
if [ $quick = 1 ]; then
  : "${FILLED:=200e3}" "${CONVERT:=100k}" "${LARGER:=200k 300k:512M}" "${CITY:=300e3}" "${ROOM:=200e3}" "${LARGEST:=1e6}" "${RASTER:=1}" "${SCALE:=0.0005}" "${REPEAT:=1}" "${VIEWS:=3}" "${FLOWN:=100e3}" "${NODES:=20000}"
fi
: "${FILLED:=16e6}" "${CONVERT:=10M 50M}" "${LARGER:=200M 500M:1G}" "${CITY:=50e6}" "${ROOM:=20e6}" "${LARGEST:=500e6}" "${RASTER:=10}" "${PROGRESSIVE:=10}" "${SCALE:=0.02}" "${REPEAT:=3}" "${VIEWS:=30}" "${FLOWN:=3e6}" "${NODES:=2000000}"
: "${KANZOK_SCALE:=$SCALE}" "${RED_ROCKS:=$root/../shared/data/laz/large/red_rocks_4.0M.laz}"
export PATH=$build/bin:$build/tests:$PATH
if [ -z "$folder" ]; then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
mkdir -p "$folder/sections"
folder=$(realpath "$folder")

note() { printf '%s %s\n' "$(date +%T)" "$*" >&2; }
table() { python3 "$root/tests/bench/tables.py" "$@"; }
# quietly COMMAND...: what it says is shown only where it fails
quietly() { "$@" 2>"$folder/messages" || { tail -n 3 "$folder/messages" >&2; return 1; }; }
# made_store NAME INPUT OPTIONS...: FOLDER/NAME.strata, made where it is not there
made_store() {
  [ -e "$folder/$1.strata/store.json" ] || quietly strata-convert "$2" -o "$folder/$1.strata" --json "${@:3}" >/dev/null
}
path_of() { strata-bench --make-path "$2" "$folder/$1.strata" >"$folder/$1_$2.json"; }
# first_seconds FROM TO SECONDS: the path FROM, cut off after so long
first_seconds() {
  python3 -c 'import json, sys
path = json.load(open(sys.argv[1]))
whole = path["keys"][-1]["t"] - path["keys"][0]["t"]
for key in path["keys"]: key["t"] *= min(1.0, float(sys.argv[3]) / whole)
json.dump(path, open(sys.argv[2], "w"))' "$1" "$2" "$3"
}
# fly STORE PATH OUT OPTIONS...
fly() { quietly strata-bench "$folder/$1.strata" --path "$2" -o "$folder/$3" --backend cpu --json "${@:4}" >/dev/null; }

machine() { table machine "$folder" "$root"; }
conversion() { # shellcheck disable=SC2086
  "$root/tests/bench/convert.sh" -b "$build" -d "$folder/scans" $CONVERT
}
larger() { # shellcheck disable=SC2086
  "$root/tests/bench/convert.sh" -b "$build" -d "$folder/scans" -r 1 -n -s "$folder/larger" $LARGER
}
store() {
  made_store store_city "synthetic:city?points=10e6&seed=1"
  strata-export "$folder/store_city.strata" -o "$folder/store_city.las" --format 2 --force >/dev/null
  made_store las_city "$folder/store_city.las"
  rm -rf "$folder/store_city.las" "$folder/store_city.strata"
  local infos=("city of 10 M points, LAS format 2" "$folder/las_city.strata")
  if [ -e "$RED_ROCKS" ]; then
    made_store red_rocks "$RED_ROCKS"
    infos+=(red_rocks "$folder/red_rocks.strata")
  fi
  for ((i = 1; i < ${#infos[@]}; i += 2)); do strata-info "${infos[i]}" --json >"$folder/info_$i.json"; infos[i]=$folder/info_$i.json; done
  table planes "${infos[@]}"
}
selection() { quietly selection_bench --benchmark_format=json | table benchmark nodes hidden occluders Mpoints tested; }
loading() {
  local stores=(las_city red_rocks room)
  [ -e "$folder/las_city.strata" ] || stores[0]=loading_city
  made_store "${stores[0]}" "synthetic:city?points=10e6&seed=1"
  [ ! -e "$RED_ROCKS" ] || made_store red_rocks "$RED_ROCKS"
  made_store room "synthetic:room?points=$ROOM&seed=1" --node-points 16384
  for name in "${stores[@]}"; do
    [ -e "$folder/$name.strata" ] || continue
    printf '\n`%s`:\n\n' "${name#l*_}"
    quietly decode_bench "$folder/$name.strata" --benchmark_format=json | table benchmark ns/point MB/s bytes/point
  done
}
streaming() {
  made_store room "synthetic:room?points=$ROOM&seed=1" --node-points 16384
  made_store flown "synthetic:room?points=$FLOWN&seed=1" --node-points 16384
  path_of flown flythrough
  first_seconds "$folder/flown_flythrough.json" "$folder/flown.json" 4
  # shellcheck disable=SC2016
  printf 'Indoors, with and without the occlusion test (`indoors`):\n\n'
  streaming_bench indoors "$folder/room.strata" "$VIEWS"
  for what in slow ahead planes; do
    # shellcheck disable=SC2016
    case $what in
      slow) printf '\nThe same pictures while a streamer works behind over either disk, then one flight over disks that are instant, slow and broken (`slow`):\n\n' ;;
      ahead) printf '\nWith and without looking ahead (`ahead`):\n\n' ;;
      planes) printf '\nPlanes by need and all at once, each frame whole before the next (`planes`):\n\n' ;;
    esac
    streaming_bench $what "$folder/flown.strata" "$folder/flown.json"
  done
  # shellcheck disable=SC2016
  printf '\nThe loaders against plain reading, page cache warm (`loaders`):\n\n'
  streaming_bench loaders "$folder/room.strata"
  # shellcheck disable=SC2016
  printf '\nReading alone, every node of the room once in a random order (`read_bench`):\n\n'
  read_bench "$folder/room.strata"
  # shellcheck disable=SC2016
  printf '\nOpening a store (`open`):\n\n'
  streaming_bench open "$NODES"
}
rasterizers() {
  STRATA_BENCH_POINTS=$RASTER quietly rasterizer_bench --benchmark_format=json --benchmark_min_time=0.3 |
    table benchmark Mpoints/s
}
progressive() {
  local bench=(--points "$PROGRESSIVE") flight=(--frames 60 --points 0.5,0.25) small=()
  if [ $quick = 1 ]; then
    small=(--small) bench=(--small) flight=(--frames 6 --size 320x180 --points 0.02)
  fi
  pool_bench "${small[@]}"
  printf '\n'
  progressive_bench "${bench[@]}"
  made_store city "synthetic:city?points=$CITY&seed=1"
  path_of city flythrough
  printf '\nAlong the flythrough of the city (%s points), streamed:\n\n' "$CITY"
  progressive_flight "$folder/city.strata" "$folder/city_flythrough.json" "${flight[@]}"
  [ -e "$RED_ROCKS" ] || return 0
  made_store red_rocks "$RED_ROCKS"
  path_of red_rocks flythrough
  printf '\nAlong the flythrough of red_rocks:\n\n'
  progressive_flight "$folder/red_rocks.strata" "$folder/red_rocks_flythrough.json" "${flight[@]}"
}
suite() { quietly paper_suites --suite "$1" --suite-scale "$2"; }
kanzok() { suite kanzok "$KANZOK_SCALE"; }
schuetz() { suite schuetz "$SCALE"; }
guenther() { suite guenther "$SCALE"; }
flights() {
  made_store city "synthetic:city?points=$CITY&seed=1"
  local runs=()
  for kind in orbit flythrough street dive; do
    path_of city $kind
    fly city "$folder/city_$kind.json" "flight_$kind" --repeat "$REPEAT"
    runs+=("$kind" "$folder/flight_$kind")
  done
  fly city "$folder/city_flythrough.json" flight_cold --repeat "$REPEAT" --cold
  fly city "$folder/city_flythrough.json" flight_again --repeat "$REPEAT"
  table flights "${runs[@]}" "flythrough, cold" "$folder/flight_cold" "flythrough, again" "$folder/flight_again"
  # shellcheck disable=SC2016
  printf '\nThe same build twice, `strata-bench compare`:\n\n```\n'
  strata-bench compare "$folder/flight_flythrough" "$folder/flight_again" --fail-above 5% || true
  # shellcheck disable=SC2016
  printf '```\n'
}
# described NAME STORE: four flights, stills and report of one store
described() {
  local runs=()
  for kind in orbit flythrough; do
    path_of "$2" $kind
    fly "$2" "$folder/$2_$kind.json" "$2_$kind" --repeat "$REPEAT" --cold --stills --screenshot-every 60
    runs+=("$kind, cold" "$folder/$2_$kind")
  done
  table store "$1" "$folder/$2_orbit"
  table flights "${runs[@]}"
}
real() {
  if [ ! -e "$RED_ROCKS" ]; then
    echo "Not measured: $RED_ROCKS is not there."
    return
  fi
  made_store red_rocks "$RED_ROCKS"
  described "Red Rocks, a canyon from the air" red_rocks
}
largest() {
  if [ ! -e "$folder/largest.strata/store.json" ]; then
    quietly strata-convert "synthetic:city?points=$LARGEST&seed=1" -o "$folder/largest.strata" --resume --json |
      tail -n 1 >"$folder/largest.json"
  fi
  [ ! -s "$folder/largest.json" ] || table conversion "$folder/largest.json" "$folder"
  described "The largest city" largest
}
filling() {
  [ -e "$RED_ROCKS" ] || echo "Not measured: $RED_ROCKS is not there."
  STRATA_BIN=$build/bin "$root/tests/bench/fill_quality.sh" "$([ ! -e "$RED_ROCKS" ] || echo "$RED_ROCKS")" "$folder/filled" "$FILLED"
}
targets() { table targets "$folder/sections"; }

# Several sections: each in a run of its own, so that one that fails leaves its pages as they were and the others go on.
if [ ${#sections[@]} -gt 1 ]; then
  failed=()
  quickly=()
  [ $quick = 0 ] || quickly=(-q)
  for section in "${sections[@]}"; do
    "$0" -b "$build" -d "$folder" -o "$docs" "${quickly[@]}" "$section" || failed+=("$section")
  done
  [ ${#failed[@]} = 0 ] || { echo "error: not measured: ${failed[*]}" >&2; exit 1; }
  exit 0
fi
section=${sections[0]}
note "$section"
start=$SECONDS
stamp=$(table stamp "$root")
"$section" >"$folder/sections/$section.part"
case $section in
  machine | targets)
    mv "$folder/sections/$section.part" "$folder/sections/$section.md"
    table put "$docs/benchmarks.md" "$section" "$folder/sections/$section.md"
    ;;
  *)
    printf '\n%s\n' "$stamp" >>"$folder/sections/$section.part"
    mv "$folder/sections/$section.part" "$folder/sections/$section.md"
    table headline "$section" "$folder/sections/$section.md" >"$folder/sections/$section.headline"
    table put "$docs/benchmarks/$section.md" "$section" "$folder/sections/$section.md"
    table put "$docs/benchmarks.md" "$section" "$folder/sections/$section.headline"
    ;;
esac
note "$section took $((SECONDS - start)) s"
