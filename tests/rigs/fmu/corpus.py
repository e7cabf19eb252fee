#!/usr/bin/env python3
"""What two checkers say of FMUs of others, as rows of a table.

Usage: corpus.py OCTANT FMPY FOLDER...

FOLDER holds FMUs in folders; in an environment of Python, those of its packages.
"""

import collections
import json
import pathlib
import subprocess
import sys

octant, fmpy, *folders = sys.argv[1:]
print("| FMU | errors of `octant fmu check`, by rule | warnings | FMPy's validator |")
print("|---|---|---|---|")
for fmu in sorted(path for folder in folders for path in pathlib.Path(folder).rglob("*.fmu")):
    checked = subprocess.run([octant, "fmu", "check", fmu, "--json"], capture_output=True, text=True)
    file = json.loads(checked.stdout)["files"][0]
    if "unreadable" in file:
        errors, warnings = f"unreadable: {file['unreadable']}", 0
    else:
        count = collections.Counter(one["rule"] for one in file["findings"] if one["severity"] == "error")
        errors = ", ".join(f"`{rule}`" for rule in sorted(count)) or "none"
        warnings = sum(one["severity"] == "warning" for one in file["findings"])
    # It ends with 0 whatever it finds: what it says is read.
    said = subprocess.run([fmpy, "validate", fmu], capture_output=True, text=True).stdout
    first = said.strip().splitlines()[0]
    others = "no problem" if first == "No problems found." else first.replace(" were found:", "")
    print(f"| {fmu.parent.name}/{fmu.name} | {errors} | {warnings} | {others} |", flush=True)
