#!/usr/bin/env python3
"""Runs a command and prints what it took as JSON; the bytes and files are those it left in FOLDER.
usage: time_command.py FOLDER COMMAND..."""
import json
import os
import resource
import subprocess
import sys
import time

folder, command = sys.argv[1], sys.argv[2:]
begin = time.monotonic()
code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
wall = time.monotonic() - begin
usage = resource.getrusage(resource.RUSAGE_CHILDREN)
files = [os.path.join(path, name) for path, _, names in os.walk(folder) for name in names]
print(json.dumps({"seconds": wall, "cpu_seconds": usage.ru_utime + usage.ru_stime,
                  "peak_rss_bytes": usage.ru_maxrss * 1024, "files": len(files),
                  "bytes": sum(map(os.path.getsize, files))}))
sys.exit(code)
