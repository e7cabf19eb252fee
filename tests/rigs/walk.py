"""The walk of a faulted sample in docs/architecture.md, against a traced run: gdb writes down each function of the table that
the run with the fault reaches, and a step reaches them in the order of the table.

The program is built once more, as it is delivered but with the lines of its functions: gdb finds those that the compiler
has put into their callers, too. One that has no code of its own left is no station: the table names what it calls.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/architecture.md"
SECTION = "## A faulted sample, station by station"
# The truth is asked for once a second: in the middle of the spike.
SAMPLES = 3
SCENARIO = f"""schema = 1
title = "a spike over the first second"
[procedure.calibration]
duration = "24 min"
[[faults]]
id = "spike"
kind = "spike"
trigger = {{ at = "0.995 s" }}
duration = "{SAMPLES} samples"
channels = "gyro x"
amplitude = "1000 deg/h"
"""
# The functions with which the table comes to the step, to the epoch, and to the fault.
STEP, EPOCH, FAULT = "step", "begin", "on_epoch"


def table():
    """Rows of the table: file and function."""
    section = PAGE.read_text().split(SECTION, 1)[1].split("\n#", 1)[0]
    return re.findall(r"^\| `([^`]+\.rs)` \| `(\w+)` \|", section, re.M)


def body(file, function):
    """Lines of a function's body with code in them."""
    lines = (ROOT / file).read_text().splitlines()
    starts = [n for n, line in enumerate(lines) if re.search(rf"\bfn {function}\b", line)]
    if not starts:
        raise SystemExit(f"{PAGE.name}: {file} has no function {function}")
    indent = re.match(r"\s*", lines[starts[0]])[0]
    end = next(n for n in range(starts[0] + 1, len(lines)) if lines[n] == indent + "}")
    is_code = lambda line: line.strip() and not line.strip().startswith("//") and line.strip("{}(),; ")
    return [n + 1 for n in range(starts[0] + 1, end) if is_code(lines[n])]


def built():
    """The program with the lines of its functions."""
    target = ROOT / ".rigs/walk"
    words = ["cargo", "build", "--quiet", "--release", "--package", "octant"]
    words += ["--config", 'profile.release.debug="line-tables-only"']
    words += ["--config", 'profile.release.package.octant.strip="none"']
    environment = dict(os.environ, CARGO_TARGET_DIR=str(target), CARGO_INCREMENTAL="0")
    subprocess.run(words, cwd=ROOT, env=environment, check=True)
    return target / "release/octant"


def traced(program, rows):
    """Rows as they are reached, by thread; the run ends with the fault."""
    commands = ["set pagination off", "set confirm off", "set breakpoint pending off", "set dprintf-style gdb"]
    for number, (file, function) in enumerate(rows):
        # A step is long, and the compiler has no code for its first lines.
        lines = body(file, function) if function == STEP else body(file, function)[:8]
        commands += [f'dprintf {file}:{line},"walk %d {number}\\n",$_thread' for line in lines]
    fault = next(file for file, function in rows if function == FAULT)
    commands += [f"break {fault}:{body(fault, FAULT)[0]}", f"ignore $bpnum {SAMPLES - 1}"]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "spike.toml").write_text(SCENARIO)
        commands += [f"run run {folder / 'spike.toml'} --out {folder / 'out'} >/dev/null 2>&1", "kill"]
        (folder / "walk.gdb").write_text("\n".join(commands) + "\n")
        words = ["gdb", "-nx", "-batch", "-x", str(folder / "walk.gdb"), str(program)]
        done = subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    calls = [(int(thread), int(row)) for thread, row in re.findall(r"^walk (\d+) (\d+)$", done.stdout, re.M)]
    if not calls:
        raise SystemExit(f"gdb told no walk:\n{done.stdout[-4000:]}")
    return calls


def order(calls, rows):
    """Rows in the order in which they are first reached: those before the step, then those of the step with most of them."""
    number = {function: place for place, (_, function) in enumerate(rows)}
    epoch = number[EPOCH]
    thread = next((of for of, row in calls if row == number[FAULT]), None)
    before = list(dict.fromkeys(row for _, row in calls if row < epoch))
    steps = [[]]
    for of, row in calls:
        if of != thread or row < epoch:
            continue
        if row == epoch and steps[-1][-1:] != [epoch]:
            steps.append([])
        steps[-1].append(row)
    return before + max((list(dict.fromkeys(step)) for step in steps), key=len)


def main():
    rows = table()
    found = order(traced(built(), rows), rows)
    for place, row in enumerate(found):
        print(f"{place + 1:3} {' '.join(rows[row])}")
    missing = [row for row in range(len(rows)) if row not in found]
    wrong = [f"never reached: {' '.join(rows[row])}" for row in missing]
    expected = [row for row in range(len(rows)) if row in found]
    wrong += [f"the table has {rows[b][1]} where the run reaches {rows[a][1]}" for a, b in zip(found, expected) if a != b]
    if wrong or len(rows) < 15:
        print("\n".join(wrong) or f"{PAGE.name} has a table of {len(rows)} rows")
        return 1
    print(f"{len(found)} functions are reached in the order of {PAGE.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
