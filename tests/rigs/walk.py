"""The walk of a faulted sample in docs/architecture.md, against a traced run: gdb stops at each function of the table, in the
thread of the run with the fault, and the order in which a step calls them is that of the table.

The program is built once more, as it is delivered but with the lines of its functions: gdb finds those that the compiler
has put into their callers, too.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/architecture.md"
SECTION = "## A faulted sample, station by station"
# The truth is asked for once a second: at sample 200, in the middle of the spike.
SCENARIO = """schema = 1
title = "a spike over the first second"
[procedure.calibration]
duration = "24 min"
[[faults]]
id = "spike"
kind = "spike"
trigger = { at = "0.995 s" }
duration = "3 samples"
channels = "gyro x"
amplitude = "1000 deg/h"
"""


def table():
    """Rows of the table: file and function."""
    section = PAGE.read_text().split(SECTION, 1)[1].split("\n## ", 1)[0]
    return re.findall(r"^\| `([^`]+\.rs)` \| `(\w+)` \|", section, re.M)


def body(file, function):
    """First and last line of a function's body."""
    lines = (ROOT / file).read_text().splitlines()
    starts = [n for n, line in enumerate(lines) if re.search(rf"\bfn {function}\b", line)]
    if not starts:
        raise SystemExit(f"{PAGE.name}: {file} has no function {function}")
    begin = starts[0]
    indent = re.match(r"\s*", lines[begin])[0]
    end = next(n for n in range(begin + 1, len(lines)) if lines[n] == indent + "}")
    return begin + 2, end + 1


def built():
    """The program with the lines of its functions."""
    target = ROOT / ".rigs/walk"
    words = ["cargo", "build", "--quiet", "--release", "--package", "octant"]
    words += ["--config", 'profile.release.debug="line-tables-only"']
    words += ["--config", 'profile.release.package.octant.strip="none"']
    environment = dict(os.environ, CARGO_TARGET_DIR=str(target), CARGO_INCREMENTAL="0")
    subprocess.run(words, cwd=ROOT, env=environment, check=True)
    return target / "release/octant"


def traced(program, stations):
    """Functions in the order in which they were first called in each step of the run with the fault."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "spike.toml").write_text(SCENARIO)
        (folder / "stations.json").write_text(json.dumps(stations))
        environment = dict(os.environ, OCTANT_STATIONS=str(folder / "stations.json"), OCTANT_WALK=str(folder / "walk.json"))
        words = ["gdb", "-nx", "-batch", "-x", str(ROOT / "tests/rigs/walk_in_gdb.py"), "--args", str(program)]
        words += ["run", str(folder / "spike.toml"), "--out", str(folder / "out")]
        done = subprocess.run(words, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if not (folder / "walk.json").exists():
            raise SystemExit(f"gdb told no walk:\n{done.stdout[-4000:]}")
        return json.loads((folder / "walk.json").read_text())


def main():
    rows = table()
    stations = [[file, function, *body(file, function)] for file, function in rows]
    found = traced(built(), stations)
    names = [f"{file} {function}" for file, function in rows]
    wrong = [f"never called: {name}" for name in names if name not in found]
    expected = [name for name in names if name in found]
    wrong += [f"called as {place + 1}: {a}, the table has {b}" for place, (a, b) in enumerate(zip(found, expected)) if a != b]
    for place, name in enumerate(found):
        print(f"{place + 1:3} {name}")
    if wrong or len(rows) < 15:
        print("\n".join(wrong) or f"{PAGE.name} has a table of {len(rows)} rows")
        return 1
    print(f"{len(found)} functions are called in the order of {PAGE.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
