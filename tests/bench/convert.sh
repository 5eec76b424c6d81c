#!/usr/bin/env bash
# Makes the conversion tables of docs/benchmarks/conversion.md: a synthetic city as LAS 1.2 format 2 (26 bytes a point) and LAZ,
# converted with default options. Prints Markdown; what it is doing goes to stderr. Inputs are made where FOLDER has
# none, one at a time, and those that were made are deleted as soon as they are measured.
# usage: tests/bench/convert.sh [-d FOLDER] [-b BUILD] [-r RUNS] [-s RESULTS] [-n] [-k] [POINTS[:MEMORY]...]
#   FOLDER  inputs (city_50M.las ...) and scratch; needs 48 bytes a point of the largest size (default: a new one under
#           TMPDIR)                BUILD  folder with bin/ and tests/ (default: build/release)
#   RUNS    medians over so many (default: 3 below 200 million points, else 1)
#   RESULTS keeps what is measured; the tables hold what earlier calls left there too (default: nothing is kept)
#   -n      without PCL's converter      -k  keep inputs that were made
#   POINTS[:MEMORY]  and --memory, 2G where it is not said; default: 10M 50M 200M 500M
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$root/build/release folder='' runs='' kept='' pcl=1 keep=0
while getopts d:b:r:s:nk option; do
  case $option in
    d) folder=$OPTARG ;;
    b) build=$OPTARG ;;
    r) runs=$OPTARG ;;
    s) kept=$OPTARG ;;
    n) pcl=0 ;;
    k) keep=1 ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
sizes=("$@")
[ ${#sizes[@]} -gt 0 ] || sizes=(10M 50M 200M 500M)
export PATH=$build/bin:$build/tests:$PATH
for program in strata-convert make_scan laszip_decode python3; do
  command -v "$program" >/dev/null || { echo "error: $program is not there (build all targets, or say -b)" >&2; exit 1; }
done
made_folder=0
if [ -z "$folder" ]; then folder=$(mktemp -d) made_folder=1; fi
mkdir -p "$folder"
results=${kept:-$(mktemp -d)}
mkdir -p "$results"
# shellcheck disable=SC2317  # called by the trap
clean_up() {
  [ -n "$kept" ] || rm -rf "$results"
  rm -rf "$folder/timed.strata" "$folder/timed.strata.building" "$folder/making".* "$folder/outofcore"
  [ "$made_folder" = 0 ] || rm -rf "$folder"
}
trap clean_up EXIT

note() { printf '%s %s\n' "$(date +%T)" "$*" >&2; }
points_of() { awk -v t="$1" 'BEGIN { n = t + 0; if (t ~ /[kK]$/) n *= 1e3; if (t ~ /M$/) n *= 1e6; if (t ~ /G$/) n *= 1e9; printf "%d", n }'; }
free_bytes() { df --output=avail -B1 "$folder" | tail -n 1; }

# make_input SIZE ENDING: FOLDER/city_SIZE.ENDING, under another name until it is whole.
make_input() {
  note "making city_$1.$2"
  make_scan "synthetic:city?points=$(points_of "$1")&seed=1" "$folder/making.$2"
  mv "$folder/making.$2" "$folder/city_$1.$2"
}

# convert_once INPUT MEMORY: prints one line of JSON
convert_once() {
  rm -rf "$folder/timed.strata"
  cat "$1" >/dev/null # warm where it fits
  strata-convert "$1" -o "$folder/timed.strata" --memory "$2" --force --json 2>"$results/messages" | tail -n 1 ||
    { cat "$results/messages" >&2; return 1; }
  rm -rf "$folder/timed.strata"
}

for each in "${sizes[@]}"; do
  size=${each%%:*} memory=2G
  case $each in *:*) memory=${each#*:} ;; esac
  points=$(points_of "$size")
  for ending in las laz; do
    input=$folder/city_$size.$ending
    made=0
    if [ ! -e "$input" ]; then
      [ $ending = las ] && need=$((points * 48)) || need=$((points * 35))
      if [ "$(free_bytes)" -lt "$need" ]; then
        note "$size $ending left out: $(free_bytes) bytes free, $need needed"
        echo "left out: the disk has not enough room" >"$results/$size:$memory.$ending.why"
        continue
      fi
      make_input "$size" "$ending"
      made=1
    fi
    times=${runs:-$([ "$points" -ge 200000000 ] && echo 1 || echo 3)}
    rm -f "$results/measuring"
    for run in $(seq "$times"); do
      note "city_$size.$ending, --memory $memory, run $run of $times"
      convert_once "$input" "$memory" >>"$results/measuring"
    done
    mv "$results/measuring" "$results/$size:$memory.$ending"
    rm -f "$results/$size:$memory.$ending.why"
    if [ "$ending" = laz ]; then
      note "LASzip alone on city_$size.laz"
      laszip_decode "$input" >"$results/$size.decode"
    fi
    if [ $made = 1 ] && [ $keep = 0 ]; then rm -f "$input"; fi
  done
done

# PCL's own converter on 10 million points, or on as many as the first size has.
pcl_size=10M
case " ${sizes[*]} " in *" 10M "*) ;; *) pcl_size=${sizes[0]%%:*} ;; esac
if [ $pcl = 0 ]; then
  note "without PCL's converter"
elif command -v pcl_outofcore_process >/dev/null; then
  note "pcl_outofcore_process on $pcl_size"
  make_input "$pcl_size" pcd
  rm -rf "$folder/outofcore"
  python3 "$root/tests/bench/time_command.py" "$folder/outofcore" \
    pcl_outofcore_process -depth 5 -gen_lod -overwrite "$folder/city_$pcl_size.pcd" "$folder/outofcore" \
    >"$results/pcl_$pcl_size" 2>/dev/null || { rm -f "$results/pcl_$pcl_size"; echo "it failed" >"$results/pcl_why"; }
  rm -rf "$folder/outofcore" "$folder/city_$pcl_size.pcd"
else
  echo "package pcl-tools is not installed" >"$results/pcl_why"
fi

python3 "$root/tests/bench/convert_table.py" "$results"
