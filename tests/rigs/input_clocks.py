#!/usr/bin/env python3
"""Rate, its uncertainty and the gaps of recordings: what octant says is what numpy finds.

The counts of the rows are those with which the rows were made. numpy fits the stamps on them by least squares
(numpy.polyfit with the covariance of the residuals).

Usage: python tests/rigs/input_clocks.py OCTANT FOLDER     (FOLDER is filled with the runs)
"""

import json
import pathlib
import subprocess
import sys

import numpy as np

octant, folder = sys.argv[1], pathlib.Path(sys.argv[2])

SCENARIO = """schema = 1
[site]
latitude = "30.5 deg"
longitude = "114 deg"
[imu]
rate = "{rate} Hz"
[procedure.alignment]
method = "given"
[procedure.navigation]
duration = "{duration} s"
rotation = "none"
[source]
uri = "text:{name}.csv"
[source.text]
header = true
delimiter = "comma"
time_column = "t"
time_unit = "s"
[source.text.gyro]
x = "gx"
y = "gy"
z = "gz"
[source.text.accelerometer]
x = "ax"
y = "ay"
z = "az"
"""


def recording(name, rate, seconds, ppm, jitter_s, digits, gaps):
    """Writes a recording of a unit at rest; returns counts and stamps of its rows."""
    rng = np.random.default_rng(len(name))
    counts = np.arange(int(rate * seconds))
    for begin, lost in gaps:
        counts = counts[(counts < begin) | (counts >= begin + lost)]
    stamps = 10 + counts / rate / (1 + ppm * 1e-6) + rng.normal(0, jitter_s, len(counts))
    stamps = np.round(stamps, digits)
    earth, latitude = 7.292115e-5, np.deg2rad(30.5)
    row = f"{earth * np.cos(latitude):.12e},0,{-earth * np.sin(latitude):.12e},0,0,-9.79324"
    lines = [f"{stamp:.{digits}f},{row}" for stamp in stamps]
    (folder / f"{name}.csv").write_text("t,gx,gy,gz,ax,ay,az\n" + "\n".join(lines) + "\n")
    # Longer than the recording: all of it is read.
    scenario = SCENARIO.format(rate=rate, duration=int(seconds) + 2, name=name)
    (folder / f"{name}.toml").write_text(scenario)
    return counts, stamps


def account(name):
    command = [octant, "run", folder / f"{name}.toml", "--out", folder / name]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode in (0, 3), ended.stderr
    return json.loads((folder / name / "summary.json").read_text())["inputs"][0]


RECORDINGS = [
    # name, rate, seconds, ppm, jitter, digits of the stamps, gaps by first row and number of rows
    ("jitter", 100, 120, 0, 5e-4, 9, []),
    ("gaps", 50, 240, -320, 1e-3, 6, [(700, 1), (3000, 25), (9000, 150)]),
    ("digits", 60, 150, 137, 0, 3, [(4000, 60)]),
]
for name, rate, seconds, ppm, jitter_s, digits, gaps in RECORDINGS:
    counts, stamps = recording(name, rate, seconds, ppm, jitter_s, digits, gaps)
    found = account(name)
    (slope, _), covariance = np.polyfit(counts, stamps - stamps[0], 1, cov=True)
    numpy_ppm = (1 / slope / rate - 1) * 1e6
    numpy_sigma_ppm = np.sqrt(covariance[0, 0]) / slope * 1e6
    steps = np.diff(counts)
    clock, missing = found["clock"], sum(entry["count"] for entry in found.get("missing", []))
    assert found["read"] == len(counts), (name, found["read"], len(counts))
    assert missing == int(np.sum(steps - 1)), (name, missing)
    words = "".join(entry["kind"] for entry in found.get("missing", []))
    number = int(np.sum(steps > 1))
    assert number == 0 or f" in {number} gap" in words, (name, words)
    assert abs(clock["rate_ppm"] - numpy_ppm) < 1e-3 * numpy_sigma_ppm + 1e-6, (name, clock, numpy_ppm)
    assert abs(clock["rate_sigma_ppm"] / numpy_sigma_ppm - 1) < 1e-3, (name, clock, numpy_sigma_ppm)
    assert abs(numpy_ppm - ppm) < 5 * numpy_sigma_ppm, (name, numpy_ppm)
    scatter_s = np.std(stamps - np.polyval(np.polyfit(counts, stamps, 1), counts))
    assert abs(clock["scatter_s"] / scatter_s - 1) < 1e-3, (name, clock, scatter_s)
    print(f"{name}: {numpy_ppm:+.3f} ± {numpy_sigma_ppm:.2g} ppm, {number} gaps of {missing} rows, as octant says")
print(f"clocks and gaps of {len(RECORDINGS)} recordings are those that numpy finds")
