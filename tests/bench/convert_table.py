#!/usr/bin/env python3
"""Prints the tables of docs/benchmarks.md from what tests/bench/convert.sh measured.
usage: convert_table.py RESULTS PCL_SIZE MEMORY SIZE..."""
import json
import os
import statistics
import sys

STAGES = ["survey", "distribute", "build", "merge", "write"]
EXTRA_MICROS = 0.38  # what a conversion of LAZ may take beside LASzip's own time


def runs_of(results, size, ending):
    path = os.path.join(results, f"{size}.{ending}")
    return [json.loads(line) for line in open(path)] if os.path.exists(path) else []


def median(runs, value):
    return statistics.median(value(run) for run in runs)


def total_row(size, ending, runs):
    points = runs[0]["points"]
    wall = median(runs, lambda r: r["seconds"])
    cpu = median(runs, lambda r: r["cpu_seconds"])
    plain = points * 26
    return (f"| {size} | {ending.upper()} | {wall:.1f} s | {points / wall / 1e6:.1f} M | {cpu / points * 1e6:.2f} µs "
            f"| {max(r['peak_rss_bytes'] for r in runs) / 2**30:.2f} GiB "
            f"| {max(r['temp_peak_bytes'] for r in runs) / 1e9:.2f} GB "
            f"({max(r['temp_peak_bytes'] for r in runs) / plain:.2f}) "
            f"| {runs[0]['output_bytes'] / points:.2f} | {len(runs)} |")


def stage_row(size, ending, runs):
    cells = []
    for stage in STAGES:
        wall = median(runs, lambda r: r["stages"].get(stage, 0.0))
        cpu = median(runs, lambda r: r["stage_cpu_seconds"].get(stage, 0.0))
        cells.append(f"{wall:.2f} / {cpu:.2f}")
    return f"| {size} | {ending.upper()} | " + " | ".join(cells) + " |"


def decode_row(size, decode, runs):
    micros = decode["cpu_us_per_point"]
    ours = median(runs, lambda r: r["cpu_seconds"] / r["points"] * 1e6)
    return (f"| {size} | {micros:.2f} µs | {micros + EXTRA_MICROS:.2f} µs | {ours:.2f} µs "
            f"| {'kept' if ours <= micros + EXTRA_MICROS else 'missed'} |")


def main():
    results, pcl_size, memory, sizes = sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[4:]
    rows = [(size, ending, runs) for size in sizes for ending in ("las", "laz")
            if (runs := runs_of(results, size, ending))]
    print(f"`--memory {memory}`; temporary disk also as a share of the input's plain records.\n")
    print("| points | input | wall | points/s | CPU a point | peak RSS | temporary disk | store bytes a point | runs |")
    print("|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        print(total_row(*row))
    left_out = os.path.join(results, "left_out")
    if os.path.exists(left_out):
        print(open(left_out).read(), end="")
    print("\nWall and CPU seconds of each stage:\n")
    print("| points | input | " + " | ".join(STAGES) + " |\n|---|---|" + "---|" * len(STAGES))
    for row in rows:
        print(stage_row(*row))
    decoded = [(size, path) for size in sizes if os.path.exists(path := os.path.join(results, f"{size}.decode"))]
    if decoded:
        print("\nLAZ against LASzip's own decoding of the same file on one core:\n")
        print(f"| points | LASzip CPU a point | + {EXTRA_MICROS} µs | Strata CPU a point | target |\n|---|---|---|---|---|")
        for size, path in decoded:
            print(decode_row(size, json.load(open(path)), runs_of(results, size, "laz")))
    pcl = os.path.join(results, "pcl")
    if os.path.exists(pcl):
        p = json.load(open(pcl))
        points = next((r[0]["points"] for r in (runs_of(results, pcl_size, e) for e in ("las", "laz")) if r), None)
        each = f"{points / p['seconds'] / 1e6:.1f} M | {p['cpu_seconds'] / points * 1e6:.2f} µs" if points else "- | -"
        size = f"{p['bytes'] / points:.1f}" if points else "-"
        print("\n| PCL's pcl_outofcore_process | wall | points/s | CPU a point | peak RSS | store bytes a point | files |")
        print("|---|---|---|---|---|---|---|")
        print(f"| {pcl_size}, `-depth 5 -gen_lod`, coordinates and colour only | {p['seconds']:.1f} s | {each} "
              f"| {p['peak_rss_bytes'] / 2**30:.2f} GiB | {size} | {p['files']} |")
    else:
        print("\npcl_outofcore_process: not measured (" + open(os.path.join(results, "pcl_why")).read().strip() + ").")


main()
