#!/usr/bin/env bash
# Installs the packages, builds, converts a scan, flies a camera path through it and leaves pictures and a report.
set -euo pipefail
# shellcheck source=.ci/packages.sh
. "$(dirname "${BASH_SOURCE[0]}")/.ci/packages.sh"

usage() {
  cat <<'TEXT'
usage: ./demo.sh [-o OUT] [--build-only] [SCAN...]
  SCAN           LAS, LAZ, COPC, PLY, PCD or text files, or folders of them; all of them become one cloud.
                 Without one, a built-in scan of a town, 10 million points
  -o OUT         where the pictures, the report and the converted scan go (./strata-demo)
  --build-only   install the packages and build, run nothing
TEXT
}

out=strata-demo
build_only=false
scans=()
while [ $# -gt 0 ]; do
  case $1 in
    -o)
      if [ -z "${2:-}" ]; then printf 'error: -o needs a folder\n' >&2 && exit 2; fi
      out=$2
      shift
      ;;
    --build-only) build_only=true ;;
    -h | --help) usage && exit 0 ;;
    --) shift && scans+=("$@") && break ;;
    -*) printf 'error: unknown argument %s (see ./demo.sh --help)\n' "$1" >&2 && exit 2 ;;
    *) scans+=("$1") ;;
  esac
  shift
done
for scan in ${scans[@]+"${scans[@]}"}; do
  [[ $scan == synthetic:* ]] || [ -e "$scan" ] || die "$scan: no such file or folder"
done

bin=$strata_root/build/release/bin
build_programs() {
  install_packages
  build_release strata-convert strata-info strata-export strata-bench strata-view
}
if $build_only; then
  build_programs
  say "the programs are in $bin"
  exit 0
fi

# The store's name: the scan's without its ending.
if [ ${#scans[@]} -eq 0 ]; then
  scans=("synthetic:city?points=10e6")
  name=city
elif [[ ${scans[0]} == synthetic:* ]]; then
  name=${scans[0]#synthetic:}
  name=${name%%\?*}
else
  name=$(basename -- "$(realpath -- "${scans[0]}")")
  [ -d "${scans[0]}" ] || name=${name%.*}
  name=${name%.copc}
fi
[ -n "$name" ] || name=scan

mkdir -p -- "$out" 2>/dev/null || die "$out: cannot be made"
out=$(cd -- "$out" && pwd)
store=$out/$name.strata
made=$out/.made-by-demo   # names of the stores that an earlier run made here; only those are replaced
force=()
if [ -e "$store" ]; then
  grep -qxF -- "$name.strata" "$made" 2>/dev/null ||
    die "$store: exists and was not made by demo.sh (choose another folder with -o)"
  force=(--force)
fi

build_programs
grep -qxF -- "$name.strata" "$made" 2>/dev/null || printf '%s\n' "$name.strata" >>"$made"

rm -f -- "$out"/{overview,close,detail}.png "$out/report.html"
[ -d "$store.building" ] && force=(--force)  # what an interrupted run left
say "converting ${scans[*]}"
"$bin/strata-convert" "${scans[@]}" -o "$store" ${force[@]+"${force[@]}"}
say "taking three pictures and flying an orbit around it"
"$bin/strata-bench" --make-path orbit "$store" >"$out/path.json"
"$bin/strata-bench" "$store" --stills --path "$out/path.json" -o "$out" --screenshot-every 60 --point-size 2 --edl

say "done:"
for file in overview.png close.png detail.png report.html; do
  [ -s "$out/$file" ] || die "$out/$file: was not made"
  printf '  %s\n' "$out/$file"
done
say "to fly through it yourself:"
printf '  %q %q\n' "$bin/strata-view" "$store"
