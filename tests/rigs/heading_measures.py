#!/usr/bin/env python3
"""Computes the measures of heading tests with numpy from recordings, and compares them with the summary of each run.

The four shipped tests run at 0, 45, 70 and -33 deg latitude and at headings on both sides of north. Nothing of the harness but
its exports takes part in the computation.

Usage: python tests/rigs/heading_measures.py OCTANT FOLDER     (FOLDER is filled with the runs)

Needs the packages of tests/rigs/requirements-export.txt. Exit status: 0 as expected, 1 with the measure that is another.
"""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
MODES_WITH_HEADING = (1, 2, 3)
# Latitude and heading of each run, deg.
PLACES = [(0, 40), (45, -0.001), (70, 0.002), (-33, 179.999)]


def run(octant, folder, test, latitude, heading, rate_hz, more):
    """Runs a shipped test, and returns its summary and the folder of its tables."""
    out = folder / f"{test}{latitude}"
    sets = [f'site.latitude="{latitude} deg"', f'motion.heading="{heading} deg"', f'record.rate="{rate_hz} Hz"', *more]
    arguments = [part for key in sets for part in ("--set", key)]
    scenario = ROOT / f"fixtures/scenarios/heading/{test}.toml"
    done = subprocess.run([octant, "run", scenario, *arguments, "--out", out], capture_output=True, text=True)
    # A verdict is no error here.
    assert done.returncode in (0, 1, 3), done.stderr
    subprocess.run([octant, "export", out, "--to", "csv", "--out", out / "csv"], check=True, capture_output=True)
    return json.loads((out / "summary.json").read_text()), out / "csv"


def headings(q):
    """Heading of a body from its attitude q_nb (w, x, y, z): the direction of its x axis in the horizon, deg."""
    w, x, y, z = q.T
    north, east = 1 - 2 * (y * y + z * z), 2 * (x * y + w * z)
    return np.degrees(np.arctan2(east, north))


def wrapped(angle):
    return (angle + 180.0) % 360.0 - 180.0


def read(tables):
    """Times, errors of the heading (NaN without one) and true headings of each run-up, since it was switched on."""
    with open(tables / "navigation.csv") as file:
        rows = list(csv.DictReader(file))

    def column(name):
        return np.array([float(row[name]) if row[name] else np.nan for row in rows])

    def quaternion(prefix):
        return np.stack([column(f"{prefix}_{part}") for part in "wxyz"], axis=1)

    time, mode = column("time_s"), column("mode")
    truth = headings(quaternion("true_q_nb"))
    error = wrapped(headings(quaternion("q_nb")) - truth)
    error[~np.isin(mode, MODES_WITH_HEADING)] = np.nan
    with open(tables / "events.csv") as file:
        units = [json.loads(row["detail"]) | {"t": float(row["time_s"])} for row in csv.DictReader(file) if row["kind"] == "unit"]
    starts = [0.0] + [one["t"] for one in units if one["action"] == "power-on"]
    ends = [one["t"] for one in units if one["action"] == "power-off"] + [np.inf]
    parts = [(start, (time > start) & (time <= end)) for start, end in zip(starts, ends)]
    return [(time[part] - start, error[part], truth[part]) for start, part in parts]


def at(time, values, due):
    index = np.argmin(np.abs(time - due))
    assert abs(time[index] - due) <= 0.5, f"no reading at {due} s"
    return values[index]


def settled_s(time, error, until):
    """Settling time by the definition: three readings every 30 min, within 0.7 deg."""
    due = np.arange(1800.0, until + 1, 1800.0)
    values = np.array([at(time, error, one) for one in due])
    for last in range(2, len(due)):
        three = values[last - 2 : last + 1]
        if np.all(np.isfinite(three)) and np.ptp(three) <= 0.7:
            return due[last]
    raise AssertionError("it doesn't settle")


def point(time, error, after):
    """Settle point error and rms of the ten readings about their mean."""
    ten = np.array([at(time, error, after + 1200.0 * number) for number in range(1, 11)])
    return ten.mean(), np.sqrt(np.mean((ten - ten.mean()) ** 2))


def worst(values):
    return max(values, key=abs)


def compare(what, found, expected, within=1e-6):
    assert found is not None, f"{what}: the summary has none, numpy {expected}"
    assert abs(found - expected) <= within, f"{what}: the summary has {found}, numpy {expected}"


def check(octant, folder, test, latitude, heading, more=()):
    rate = 10 if test == "dynamic" else 1
    summary, tables = run(octant, folder, test, latitude, heading, rate, more)
    score, run_ups = summary["heading"], read(tables)
    assert len(run_ups) == len(score["run_ups"])
    begins, ends = {"settle": (18000, 0), "settle-in-motion": (21620, 21620)}.get(test, (18000, 18000 + 1520))
    settled = [settled_s(time, error, begins) for time, error, _ in run_ups]
    points = [point(time, error, after) for (time, error, _), after in zip(run_ups, settled)]
    where = score["in_motion"] if test == "settle-in-motion" else score
    name = f"{test} at {latitude} deg"
    compare(f"{name}: settling time", where["settling_time_min"], max(settled) / 60, 0)
    compare(f"{name}: settle point error", where["settle_point_error_deg"], worst([one[0] for one in points]))
    compare(f"{name}: rms", where["readings_rms_deg"], max(one[1] for one in points))
    if len(points) > 1:
        compare(f"{name}: repeatability", where["repeatability_deg"], np.ptp([one[0] for one in points]))
    if test != "settle-in-motion":
        first = run_ups[0]
        true_heading = at(first[0], first[2], settled[0])
        compare(f"{name}: settle point heading", wrapped(score["settle_point_heading_deg"] - true_heading), points[0][0])
        assert 0 <= score["settle_point_heading_deg"] < 360
    time, error, _ = run_ups[0]
    if test == "settle-in-motion":
        after = [point(time, error, ends) for time, error, _ in run_ups]
        compare(f"{name}: after the motion", score["after_motion"]["settle_point_error_deg"], worst([one[0] for one in after]))
    if test == "scorsby":
        compare(f"{name}: error", score["scorsby_error_deg"], at(time, error, ends) - points[0][0])
    if test == "dynamic":
        moving = error[(time >= begins - 0.01) & (time <= ends + 0.01)] - points[0][0]
        compare(f"{name}: amplitude", score["dynamic_amplitude_deg"], np.abs(moving).max())
        largest = np.argmax(np.abs(np.fft.rfft(moving)) * np.where(np.arange(len(moving) // 2 + 1) == 0, 0.5, 1.0))
        frequency = largest * 10.0 / len(moving) if np.abs(moving).max() > 0.5 else 0.0
        compare(f"{name}: frequency", score["dynamic_frequency_hz"], frequency)
    limits = [one for one in summary["requirements"] if "at_equator" in one]
    for one in limits:
        compare(f"{name}: limit of {one['id']}", one["limit"], one["at_equator"] / np.cos(np.radians(latitude)))
    return 3 + len(limits)


def main():
    octant, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    count = 0
    for test in ("settle", "settle-in-motion", "scorsby", "dynamic"):
        for latitude, heading in PLACES:
            count += check(octant, folder, test, latitude, heading)
    # A gyro whose axis is off by 2.5 deg has an error above 0.5 deg, whose frequency counts.
    zeros = ", ".join(['"0 deg"'] * 4)
    misaligned = f'imu.gyro_misalignment={{ constant = [{zeros}, "2.5 deg", "0 deg"] }}'
    (folder / "misaligned").mkdir()
    count += check(octant, folder / "misaligned", "dynamic", 45, 0, [misaligned])
    print(f"heading tests: {count} measures and limits of 17 runs are those of numpy {np.__version__}")


if __name__ == "__main__":
    main()
