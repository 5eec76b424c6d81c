#!/usr/bin/env python3
"""Prints the lines that were run in each wing: coverage_table.py BUILD_FOLDER, after programs built with --coverage ran."""
import json
import os
import subprocess
import sys

FOLDERS = ("core", "io", "lod", "render", "converter", "viewer")


def wing(path):
    parts = path.split("/")
    return "/".join(parts[:2]) if len(parts) > 2 else parts[0]


def main():
    build = os.path.abspath(sys.argv[1])
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    data = [
        os.path.join(folder, name)
        for folder, _, names in os.walk(build)
        for name in names
        if name.endswith(".gcno") and f"{os.sep}tests{os.sep}" not in folder[len(build) :] + os.sep
    ]
    if not data:
        sys.exit("error: no .gcno files: the programs were not built with --coverage")
    lines = {}  # source -> line -> was run
    for first in range(0, len(data), 50):
        command = ["gcov", "--json-format", "--stdout", *data[first : first + 50]]
        output = subprocess.run(command, cwd=build, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
        for report in output.splitlines():
            if not report.startswith("{"):
                continue
            parsed = json.loads(report)
            for source in parsed["files"]:
                path = os.path.normpath(os.path.join(parsed["current_working_directory"], source["file"]))
                path = os.path.relpath(path, root)
                if not path.startswith(tuple(folder + "/" for folder in FOLDERS)):
                    continue
                seen = lines.setdefault(path, {})
                for line in source["lines"]:
                    number = line["line_number"]
                    seen[number] = seen.get(number, False) or line["count"] > 0
    wings = {}
    for path, seen in lines.items():
        counts = wings.setdefault(wing(path), [0, 0])
        counts[0] += sum(seen.values())
        counts[1] += len(seen)
    wings["all"] = [sum(counts[i] for counts in wings.values()) for i in (0, 1)]
    print("| wing | lines run | lines | share |\n|---|---|---|---|")
    for name, (run, total) in sorted(wings.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"| {name} | {run} | {total} | {100 * run / max(total, 1):.1f} % |")


if __name__ == "__main__":
    main()
