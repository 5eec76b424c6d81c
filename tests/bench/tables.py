#!/usr/bin/env python3
"""Makes the tables of docs/benchmarks.md and docs/benchmarks/ from what the programs print, for tests/bench/all.sh.
usage: tables.py put PAGE SECTION FILE | headline SECTION FILE | machine FOLDER ROOT | benchmark COUNTER... <JSON | planes NAME INFO.json...
       flights NAME REPORT_FOLDER... | store TITLE REPORT_FOLDER | conversion JSON FOLDER |
       stamp ROOT | targets FOLDER"""
import json
import os
import re
import subprocess
import sys
import textwrap


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def header(*cells):
    row(*cells)
    print("|" + "---|" * len(cells))


def short(value):
    for limit, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if abs(value) >= limit:
            return f"{value / limit:.3g}{unit}"
    return f"{value:.3g}"


def digits(value):
    """Three digits, or all before the point."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def wrapped(text):
    """Prose of at most 120 columns; tables, code and short lines as they are."""
    lines, code = [], False
    for line in text.splitlines():
        code ^= line.startswith("```")
        long = len(line) > 120 and not code and not line.startswith("|")
        lines += textwrap.wrap(line, 120, break_long_words=False, break_on_hyphens=False) if long else [line]
    return "\n".join(lines)


def put(page, section, file):
    """Replaces the lines between the section's two marks."""
    begin, end = f"<!-- {section}: tests/bench/all.sh {section} -->", f"<!-- end of {section} -->"
    text = open(page).read()
    if text.count(begin) != 1 or text.count(end) != 1:
        sys.exit(f"error: {page}: found no marks of section {section} (expected {begin} and {end})")
    before, rest = text.split(begin)
    after = rest.split(end)[1]
    body = wrapped(open(file).read().strip())
    with open(page + ".part", "w") as out:
        out.write(f"{before}{begin}\n{body}\n{end}{after}")
    os.replace(page + ".part", page)


# The main figures of each section: patterns, each of which fills the braces of its text. The first match of a pattern
# counts, or the last where the text begins with "last ".
HEADLINES = {
    "conversion": [(r"^\| (\S+) \| LAS \| \S+ \| \S+ s \| (\S+ M) \| (\S+ µs) \| (\S+ GiB) \|",
                    "last {0} points of LAS: {1} points/s, {2} of CPU a point, {3} of memory"),
                   (r"^\| (\S+) \| LAZ \| \S+ \| \S+ s \| (\S+ M) \|", "last as LAZ: {1} points/s")],
    "larger": [(r"^\| (\S+) \| LAS \| (\S+) \| (\S+ s) \| (\S+ M) \| \S+ µs \| (\S+ GiB) \|",
                "last {0} points of LAS with `--memory {1}`: {2}, {3} points/s, {4} of memory")],
    "store": [(r"^\| bytes a point, stored / plain \| (.+?) \|", "A {0}:"),
              (r"^\| \*\*all\*\* \| \*\*(\S+)\*\*", "{0} bytes a point")],
    "selection": [(r"^\| passWithOcclusion/20/20 \| \S+ ms \| (\S+ ms) \| (\d+) \|",
                   "An LOD pass that selects {1} nodes: {0} of CPU with the occlusion test"),
                  (r"^\| passWithout/20/20 \| \S+ ms \| (\S+ ms) \|", "{0} without")],
    "loading": [(r"^`(\S+)`:", "A point of `{0}` made ready for drawing:"),
                (r"^\| all for drawing, 10 bits \|.*?\| (\S+) \| \S+ \| \S+ \|$", "{0} ns with 10 bits"),
                (r"^\| all for drawing, 20 bits \|.*?\| (\S+) \| \S+ \| \S+ \|$", "{0} ns with 20 bits"),
                (r"^\| finding occluders \|.*?\| (\S+) \| \S+ \| \S+ \|$", "{0} ns for its occluders")],
    "streaming": [(r"^(\S+ %) of the nodes loaded", "Indoors the occlusion test leaves {0} of the nodes to load"),
                  (r"p99 over the slow disk / instant: (\S+)",
                   "the 99th percentile of frame times over a disk of 200 ms a read is {0} times that over an instant one")],
    "rasterizers": [(r"^\| cpu/far/1 \|.*\| (\S+) \|$", "Points a second: {0} million by `cpu` on one core"),
                    (r"^\| cpu/far/2 \|.*\| (\S+) \|$", "{0} million on two"),
                    (r"^\| onGl/compute32 \|.*\| (\S+) \|$", "{0} million by `compute32` on llvmpipe"),
                    (r"^\| onGl/points \|.*\| (\S+) \|$", "{0} million by `points`")],
    "progressive": [(r"^Against drawing everything \(Table 4\.4\), (\S+ M) points", "A frame of {0} points:"),
                    (r"^\| everything, compute32 \| (\S+) \|", "{0} ms by `compute32`"),
                    (r"^\| progressive, (\S+ M) a frame \| (\S+) \|", "last {1} ms with {0} points a frame")],
    "kanzok": [(r"^Outdoors: a city, (\S+ [MGk]) points", "Overview of a city of {0} points:"),
               (r"^\| 65536, with \| (\d+) \| (\S+ [MGk]) \| (\d+) \|", "{0} nodes, {1} points, {2} frames a second"),
               (r"^\| \*65536, with\* \| (\d+) \| (\S+ [MGk]) \| (\d+) \|",
                "in the paper {0} nodes, {1} points, {2} frames a second")],
    "schuetz": [(r"^\| manor \| (\S+ [MGk]) \| \S+ \| \S+ \| (\S+) \|(?:.*)\| (\S+) \|$",
                 "{0} points without LOD: {1} ms by `cpu`, {2} times as fast as `GL_POINTS`")],
    "guenther": [(r"^\| 170 \| \S+ \| \S+ \| \S+ \| \S+ \| \S+ \| \S+ \| (\S+) \|",
                  "170 planes one behind the other: `compute_lock` is {0} times as fast as `GL_POINTS`")],
    "flights": [(r"^\| orbit \| (\S+ ms) \| \S+ ms \| (\S+ ms) \|", "Frame times, median and 99th percentile: orbit {0}, {1}"),
                (r"^\| flythrough \| (\S+ ms) \| \S+ ms \| (\S+ ms) \|", "flythrough {0}, {1}")],
    "real": [(r"^\| orbit, cold \| (\S+ ms) \| \S+ ms \| (\S+ ms) \|",
              "Frame times, median and 99th percentile: orbit {0}, {1}"),
             (r"^\| flythrough, cold \| (\S+ ms) \| \S+ ms \| (\S+ ms) \|", "flythrough {0}, {1}")],
    "filling": [(r"^\| nothing \|(?: \S+ %, \S+ %, \S+ dB, \S+ \|)? \S+ %, \S+ %, (\S+ dB), \S+ \|$",
                 "A sixteenth of a scan against all of it: {0} unfilled"),
                (r"^\| window 7 \|(?: \S+ %, \S+ %, \S+ dB, \S+ \|)? \S+ %, \S+ %, (\S+ dB), \S+ \|$",
                 "{0} by windows of 7 pixels"),
                (r"^\| with normals of the neighbourhood \(jump-flood\) \|(?: \S+ %, \S+ %, \S+ dB, \S+ \|)? \S+ %, \S+ %, "
                 r"(\S+ dB), \S+ \|$", "{0} by `jump-flood`")],
    "largest": [(r"^The largest city: (\S+ [MGk]) points", "{0} points:"),
                (r"^Converted in (\S+ s) \((\S+ M) points/s", "converted in {0}, {1} points/s"),
                (r"^\| orbit, cold \| (\S+ ms) \| \S+ ms \| (\S+ ms) \|",
                 "median and 99th percentile of the frame times of an orbit {0}, {1}")],
}


def headline(section, file):
    """The section's main figures in one line."""
    measured, parts = open(file).read(), []
    for pattern, text in HEADLINES[section]:
        found = list(re.finditer(pattern, measured, re.M))
        if found:
            parts.append(text.removeprefix("last ").format(*found[-1 if text.startswith("last ") else 0].groups()))
    print("; ".join(parts).replace(":; ", ": ") + "." if parts else "Not measured.")


def stamp(root):
    """What was measured, when, and how busy the machine was with other things."""
    commit = subprocess.run(["git", "-C", root, "describe", "--always"], capture_output=True, text=True).stdout
    changed = subprocess.run(["git", "-C", root, "status", "--porcelain", "-uno", "--", ".", ":!docs"], capture_output=True, text=True)
    commit = commit.strip() + ("-dirty" if changed.stdout else "")  # the page that is being written does not count
    when = subprocess.run(["date", "-u", "+%Y-%m-%d"], capture_output=True, text=True).stdout
    print(f"Source: {commit or 'unknown'}, {when.strip()}; load {os.getloadavg()[0]:.1f} when it began.")


def machine(folder, root):
    cpu = re.search(r"model name\s*: (.*)", open("/proc/cpuinfo").read())
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    system = re.search(r'PRETTY_NAME="(.*)"', open("/etc/os-release").read())
    disk = os.statvfs(folder)
    print(f"**Machine**: {len(os.sched_getaffinity(0))} cores of {cpu.group(1) if cpu else 'an unknown processor'}, "
          f"{memory:.0f} GiB, {disk.f_bavail * disk.f_frsize / 1e9:.0f} GB of disk free, "
          f"{system.group(1) if system else 'Linux'}. ", end="")
    stamp(root)


def benchmark(*counters):
    text = sys.stdin.read()
    text = re.sub(r'([^\s,{\[])\n(\s*")', r"\1,\n\2", text)  # the library leaves commas out beside errors
    runs = json.loads(re.sub(r",(\s*[}\]])", r"\1", text))["benchmarks"]
    header("benchmark", "wall", "CPU", *counters)
    for run in runs:
        name = run["name"].removesuffix("/real_time")
        if run.get("error_occurred"):
            row(name, run.get("error_message", "failed"), *[""] * (1 + len(counters)))
            continue
        unit = run["time_unit"].replace("us", "µs")
        row(name, f"{digits(run['real_time'])} {unit}", f"{digits(run['cpu_time'])} {unit}",
            *[digits(run[c]) if c in run else "-" for c in counters])


def planes(*named):
    infos = [(named[i], json.load(open(named[i + 1]))) for i in range(0, len(named), 2)]
    names = []
    for _, info in infos:
        names += [plane["name"] for plane in info["planes"] if plane["name"] not in names]
    header("bytes a point, stored / plain", *[name for name, _ in infos])
    for name in names:
        if not any(p["name"] == name and p["bytes"] > 0 for _, info in infos for p in info["planes"]):
            continue  # nothing varies there
        cells = []
        for _, info in infos:
            plane = next((p for p in info["planes"] if p["name"] == name), None)
            cells.append(f"{plane['bytes'] / info['points']:.3f} / {plane['raw_bytes'] / info['points']:.3f}" if plane else "-")
        row(name, *cells)
    row("**all**", *[f"**{info['bytes'] / info['points']:.2f}**" for _, info in infos])


def flights(*named):
    header("path", "p50", "p95", "p99", "max", "points a frame", "LOD pass", "to 80 / 95 / 100 % of detail", "hitches",
           "widest spacing p95", "points drawn / read for a pixel", "read", "peak memory", "noise of p50")
    first = None
    for name, folder in zip(named[::2], named[1::2]):
        report = json.load(open(os.path.join(folder, "report.json")))
        first = first or report
        m = report["measures"]
        reached = report["jumps"][0]["reached_ms"]
        detail = " / ".join("-" if reached[k] is None else f"{reached[k]:.0f}" for k in ("80", "95", "100"))
        noise = report["noise"].get("frame_ms p50")
        row(name, *[f"{m['frame_ms'][k]:.1f} ms" for k in ("p50", "p95", "p99", "max")], short(m["points_drawn_mean"]),
            f"{m['lod_ms']:.2f} ms", detail + " ms", m["hitches"], f"{m['widest_spacing_px']['p95']:.2f} px",
            f"{m['points_per_pixel_won']:.1f} / {m['points_read_per_pixel']:.2f}", f"{m['bytes_read'] / 1e6:.0f} MB",
            f"{m['peak_rss_bytes'] / 2**20:.0f} MiB", "-" if noise is None else f"{100 * noise:.0f} %")
    options = first["options"]
    print(f"\n{first['store']['points']} points, {options['size']}, {m['frames']} frames, {options['points a pixel']} points "
          f"a pixel, budget {options['point budget']}, {first['measures']['backend']} on {first['measures']['device']}, "
          f"medians of {options['repetitions']} flights. Page cache of the first: {options['page cache']}.")


def store(title, folder):
    report = json.load(open(os.path.join(folder, "report.json")))
    s = report["store"]
    print(f"{title}: {s['points']} points, {s['nodes']} nodes on {s['levels']} levels, {s['extent']}, points.bin "
          f"{s['points.bin']}, from {s['sources']}; store {s['hash']}.\n")


def conversion(file, folder):
    """`folder` is on the disk that held the store and the temporary files."""
    c = json.load(open(file))
    disk = os.statvfs(folder)
    each = (c["temp_peak_bytes"] + c["output_bytes"]) / c["points"]
    room = disk.f_bavail * disk.f_frsize + c["output_bytes"]
    print(f"Converted in {c['seconds']:.0f} s ({c['points_per_second'] / 1e6:.2f} M points/s, "
          f"{c['cpu_seconds'] / c['points'] * 1e6:.2f} µs of CPU a point), peak memory {c['peak_rss_bytes'] / 2**20:.0f} MiB, "
          f"temporary disk {c['temp_peak_bytes'] / 1e9:.2f} GB, store {c['output_bytes'] / 1e9:.2f} GB "
          f"({c['output_bytes'] / c['points']:.2f} bytes a point). A billion points take {each:.0f} GB of disk while they are "
          f"converted; the {room / 1e9:.0f} GB free here would have held {room / each / 1e9:.1f} billion.\n")


class Targets:
    """Out of the sections' own tables, so that the verdicts cannot differ from them."""

    def __init__(self, folder):
        self.folder = folder
        header("what", "measured", "must", "goal", "")

    def text(self, section):
        path = os.path.join(self.folder, section + ".md")
        return open(path).read() if os.path.exists(path) else ""

    def find(self, section, pattern, group=1, last=False):
        found = list(re.finditer(pattern, self.text(section), re.M))
        return float(found[-1 if last else 0].group(group)) if found else None

    def judge(self, what, value, must, goal, unit, higher=False):
        if value is None:
            return row(what, "not measured", f"{must:g}{unit}", f"{goal:g}{unit}", "")
        good = (lambda limit: value >= limit) if higher else (lambda limit: value <= limit)
        row(what, f"{digits(value)}{unit}", f"{must:g}{unit}", f"{goal:g}{unit}",
            "goal reached" if good(goal) else "**kept**" if good(must) else "**missed**")


def targets(folder):
    t = Targets(folder)
    las = r"^\| \S+ \| LAS \|(?: \d+[KMGT]? \|)? \S+ s \| (\S+) M \| (\S+) µs \| \S+ GiB \| \S+ GB \((\S+)\) \| (\S+) \|"
    t.judge("convert LAS, largest size", t.find("conversion", las, 1, True), 5, 9, " M points/s", True)
    t.judge("convert LAS, CPU a point", t.find("conversion", las, 2, True), 0.38, 0.38, " µs")
    t.judge("temporary disk against the plain input", t.find("conversion", las, 3, True), 1.0, 0.5, " x")
    t.judge("store of a city, all attributes", t.find("store", r"^\| \*\*all\*\* \| \*\*(\S+)\*\*"), 8, 6, " bytes a point")
    rate = r"^\| %s \| \S+ \S+ \| \S+ \S+ \| (\S+) \|"
    points = t.find("rasterizers", rate % "onGl/points")
    one, two, compute = (t.find("rasterizers", rate % name) for name in ("cpu/far/1", "cpu/far/2", "onGl/compute32"))
    t.judge("cpu, one core", one, 400, 400, " M points/s", True)
    t.judge("cpu, two cores, against GL_POINTS of llvmpipe", two / points if two and points else None, 60, 100, " x", True)
    t.judge("compute32 on llvmpipe against GL_POINTS", compute / points if compute and points else None, 6, 10, " x", True)
    t.judge("LOD pass of 1000 of 100,000 nodes, with occlusion, CPU",
            t.find("selection", r"^\| passWithOcclusion/20/20 \| \S+ ms \| (\S+) ms \|"), 3, 1, " ms")
    plain = t.find("streaming", r"^\| plain sequential reading \| (\S+) \|")
    loader = t.find("streaming", r"^\| 4 loaders \| (\S+) \|")
    t.judge("four loaders against plain reading, bytes", 100 * loader / plain if loader and plain else None, 80, 100, " %", True)
    t.judge("p99 with a disk of 200 ms a read against an instant one",
            t.find("streaming", r"^Medians of .* p99 over the slow disk / instant: (\S+)"), 1.2, 1.0, " x")
    t.judge("indoors, nodes loaded with the occlusion test", t.find("streaming", r"^(\S+) % of the nodes loaded"), 50, 25, " %")
    opened = re.search(r"^\| nodes \| opening ms.*?\n\|.*?\n\| \d+ \| (\S+) \| (\S+) \|", t.text("streaming"), re.M)
    t.judge("open a store of 2 M nodes, with the index for streaming",
            (float(opened.group(1)) + float(opened.group(2))) / 1e3 if opened else None, 1, 0.2, " s")


COMMANDS = {f.__name__: f for f in (put, headline, machine, benchmark, planes, flights, store, conversion, stamp, targets)}
if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
    sys.exit(__doc__)
COMMANDS[sys.argv[1]](*sys.argv[2:])
