#!/usr/bin/env bash
# tests/bench/gpu.sh [BUILD] [--small]: prints the tables of Schütz 2022 and Günther 2013 for this machine's GPU.
# BUILD is a release build (default: build/release): its bin/gpu_bench is run, with its lib/, where there is one, before
# the system's libraries, so that a build may be taken to a machine that has none of them.
# Needs about 40 GiB of memory and 20 GiB on the GPU; --small needs neither, nor a GPU.
set -euo pipefail
build=build/release
small=()
for argument in "$@"; do
  case "$argument" in
    --small) small=(--small) ;;
    -*) echo "usage: gpu.sh [BUILD] [--small]" >&2; exit 2 ;;
    *) build=$argument ;;
  esac
done
if [ ! -x "$build/bin/gpu_bench" ]; then
  echo "error: $build/bin/gpu_bench: not there (build the target gpu_bench)" >&2
  exit 1
fi
if [ -d "$build/lib" ]; then
  export LD_LIBRARY_PATH="$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
fi
exec "$build/bin/gpu_bench" "${small[@]}"
