#!/usr/bin/env python3
"""Prints the tables of docs/benchmarks/conversion.md from what tests/bench/convert.sh measured: RESULTS/SIZE:MEMORY.ENDING, one
line of JSON a run; SIZE.decode, what LASzip alone took; pcl_SIZE, PCL's converter.
usage: convert_table.py RESULTS"""
import json
import os
import re
import statistics
import sys

STAGES = ["survey", "distribute", "build", "merge", "write"]
EXTRA_MICROS = 0.38  # what a conversion of LAZ may take beside LASzip's own time
UNITS = {"": 1, "k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9}


def count_of(size):
    return float(size.rstrip("kKMG")) * UNITS[size.lstrip("0123456789.")]


class Scan:
    """One input under one memory cap; the figures are medians over its runs."""

    def __init__(self, results, name):
        self.size, self.memory, self.ending = re.fullmatch(r"([^:]+):([^.]+)\.(la[sz])", name).groups()
        self.runs = [json.loads(line) for line in open(os.path.join(results, name))]
        self.points = self.runs[0]["points"]
        self.wall = self.median(lambda r: r["seconds"])
        self.cpu = self.median(lambda r: r["cpu_seconds"])
        self.temporary = max(r["temp_peak_bytes"] for r in self.runs)

    def median(self, value):
        return statistics.median(value(run) for run in self.runs)

    def stage(self, name):
        return self.median(lambda r: r["stages"].get(name, 0.0)), self.median(lambda r: r["stage_cpu_seconds"].get(name, 0.0))

    def start(self):
        return f"| {self.size} | {self.ending.upper()} | {self.memory} |"

    def name(self):
        return f"{self.size} with {self.memory}"

    def merging(self):
        return 100 * self.stage("merge")[0] / self.wall

    def row(self):
        return (f"{self.start()} {self.wall:.1f} s | {self.points / self.wall / 1e6:.1f} M "
                f"| {self.cpu / self.points * 1e6:.2f} µs | {max(r['peak_rss_bytes'] for r in self.runs) / 2**30:.2f} GiB "
                f"| {self.temporary / 1e9:.2f} GB ({self.temporary / (26 * self.points):.2f}) "
                f"| {self.runs[0]['output_bytes'] / self.points:.2f} | {len(self.runs)} |")

    def stages(self):
        return self.start() + "".join(f" {wall:.2f} / {cpu:.2f} |" for wall, cpu in map(self.stage, STAGES))


def header(*cells):
    print("| " + " | ".join(cells) + " |\n" + "|---" * len(cells) + "|")


def totals(scans, left_out):
    print("Temporary disk also as a share of the input's plain records.\n")
    header("points", "input", "`--memory`", "wall", "points/s", "CPU a point", "peak RSS", "temporary disk", "store bytes a point",
           "runs")
    for scan in scans:
        print(scan.row())
    for line in left_out:
        print(line)
    print("\nWall and CPU seconds of each stage:\n")
    header("points", "input", "`--memory`", *STAGES)
    for scan in scans:
        print(scan.stages())


def growth(scans):
    """Of the LAS files, smallest against largest: what grows, and what the largest moves."""
    las = [scan for scan in scans if scan.ending == "las"]
    if not las:
        return
    few, many = las[0], las[-1]
    if many.points > few.points:
        print(f"\n{many.points / few.points:.3g} times the points take {many.wall / few.wall:.3g} times as long (LAS, {few.name()} and "
              f"{many.name()}); merging takes {few.merging():.0f} % of the one and {many.merging():.0f} % of the other.")
    distribute, build = many.stage("distribute")[0], many.stage("build")[0]
    if distribute > 0 and build > 0:
        moved = many.runs[0]["input_bytes"] + many.temporary, many.temporary + many.runs[0]["output_bytes"]
        print(f"\nLAS, {many.name()}: distribute moves {moved[0] / distribute / 1e9:.2g} GB/s of input and temporary file, build "
              f"{moved[1] / build / 1e9:.2g} GB/s of temporary file and store: it computes, "
              f"{1e9 * many.stage('build')[1] / many.points:.0f} ns of CPU a point.")


def decoding(results, scans):
    laz = [(scan, path) for scan in scans if scan.ending == "laz"
           if os.path.exists(path := os.path.join(results, f"{scan.size}.decode"))]
    if not laz:
        return
    print("\nLAZ against LASzip's own decoding of the same file on one core:\n")
    header("points", "LASzip CPU a point", f"+ {EXTRA_MICROS} µs", "Strata CPU a point", "target")
    for scan, path in laz:
        alone = json.load(open(path))["cpu_us_per_point"]
        ours = scan.median(lambda r: r["cpu_seconds"] / r["points"] * 1e6)
        print(f"| {scan.size} | {alone:.2f} µs | {alone + EXTRA_MICROS:.2f} µs | {ours:.2f} µs "
              f"| {'kept' if ours <= alone + EXTRA_MICROS else 'missed'} |")


def pcl(results, names):
    for name in names:
        size = name.removeprefix("pcl_")
        p, points = json.load(open(os.path.join(results, name))), count_of(size)
        print()
        header("PCL's pcl_outofcore_process", "wall", "points/s", "CPU a point", "peak RSS", "store bytes a point", "files")
        print(f"| {size}, `-depth 5 -gen_lod`, coordinates and colour only | {p['seconds']:.1f} s "
              f"| {points / p['seconds'] / 1e6:.1f} M | {p['cpu_seconds'] / points * 1e6:.2f} µs "
              f"| {p['peak_rss_bytes'] / 2**30:.2f} GiB | {p['bytes'] / points:.1f} | {p['files']} |")


def main(results):
    names = sorted(os.listdir(results))
    scans = [Scan(results, name) for name in names if re.fullmatch(r"[^:]+:[^.]+\.la[sz]", name)]
    scans.sort(key=lambda scan: (scan.points, scan.memory, scan.ending))
    left_out = []
    for name in names:
        if name.endswith(".why"):
            size, memory, ending = re.split(r"[:.]", name)[:3]
            left_out.append(f"| {size} | {ending.upper()} | {memory} | " + open(os.path.join(results, name)).read().strip() + " |")
    if not scans and not left_out:
        sys.exit(f"error: {results}: holds no measured conversion")
    totals(scans, left_out)
    growth(scans)
    decoding(results, scans)
    pcl(results, [name for name in names if name.startswith("pcl_") and name != "pcl_why"])
    if os.path.exists(why := os.path.join(results, "pcl_why")):
        print("\npcl_outofcore_process: not measured (" + open(why).read().strip() + ").")


main(*sys.argv[1:])
