#!/usr/bin/env bash
# tests/bench/gpu.sh [BUILD] [--small]: prints the tables of Schütz 2022 and Günther 2013, with the papers' numbers of
# points, and those of Rumpler 2019, with 50 million, for this machine's GPU. BUILD is a release build (default:
# build/release): its bin/paper_suites and bin/progressive_bench are run, with its lib/, where there is one, before the
# system's libraries, so that a build may be taken to a machine that has none of them. Needs about 40 GiB of memory and
# 20 GiB on the GPU; --small (a thousandth) needs neither, nor a GPU.
set -euo pipefail
build=build/release
scale=1
progressive=(--points 50)
for argument in "$@"; do
  case "$argument" in
    --small) scale=0.001 progressive=(--small) ;;
    -*) echo "usage: gpu.sh [BUILD] [--small]" >&2; exit 2 ;;
    *) build=$argument ;;
  esac
done
for program in paper_suites progressive_bench; do
  if [ ! -x "$build/bin/$program" ]; then
    echo "error: $build/bin/$program: not there (build the target $program)" >&2
    exit 1
  fi
done
if [ -d "$build/lib" ]; then
  export LD_LIBRARY_PATH="$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
fi
for suite in schuetz guenther; do "$build/bin/paper_suites" --suite $suite --suite-scale $scale; done
"$build/bin/progressive_bench" "${progressive[@]}"
