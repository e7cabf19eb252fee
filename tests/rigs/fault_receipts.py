#!/usr/bin/env python3
"""Compares recordings with numpy: of runs with the example of each fault's page, and of the run without it.

The receipt of a fault has to be what the comparison finds: first and last sample, count, largest change. Nothing of the
harness but its recordings takes part in it.

Usage: python tests/rigs/fault_receipts.py OCTANT FOLDER     (FOLDER is filled with the runs)

Needs the packages of tests/rigs/requirements-export.txt. Exit status: 0 as expected, 1 with the fault whose receipt is
another.
"""

import json
import re
import struct
import subprocess
import sys
from pathlib import Path

import numpy
from mcap.reader import make_reader

SCENARIO = """schema = 1
title = "receipts"
seed = 3
imu.rate = "100 Hz"
[procedure.calibration]
duration = "120 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "90 deg" }, \
{ azimuth = "90 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "0 deg" }]
[record]
samples = "full"
"""
PERIOD_NS = 10_000_000
# sequence, stamp, three and three counts, two encoder angles, status
SAMPLE = struct.Struct("<QQ3i3i2iH")
COUNTS = slice(2, 8)
PLACES = {
    "inside": "Acts inside the simulated instrument",
    "in place": "Acts on samples and aiding on their way",
    "delivery": "Acts on the delivery",
}


def recorded(folder):
    """Samples and aiding that reached the core, by step, and set points."""
    samples, aiding, commands = {}, {}, {}
    with open(folder / "recording.mcap", "rb") as file:
        for _, channel, message in make_reader(file).iter_messages(topics=["/imu", "/aiding", "/output"]):
            step = message.log_time // PERIOD_NS
            if channel.topic == "/imu":
                samples.setdefault(step, []).append(SAMPLE.unpack_from(message.data, 4))
            elif channel.topic == "/aiding":
                aiding.setdefault(step, []).append(bytes(message.data))
            else:
                # After sequence, stamp, ten numbers of the solution and NIS.
                commands[step] = struct.unpack_from("<2i", message.data, 4 + 2 * 8 + 11 * 8)
    return samples, aiding, commands


def altered(place, with_fault, twin, steps):
    """Numbers of the altered steps, and the largest change of the counts over them."""
    (samples, aiding, _), (other, other_aiding, _) = with_fault, twin
    found = [k for k in range(1, steps + 1) if samples.get(k) != other[k] or aiding.get(k) != other_aiding.get(k)]
    if place == "delivery":
        return found, None
    here = numpy.array([samples[k][0] for k in range(1, steps + 1)], dtype=numpy.int64)
    there = numpy.array([other[k][0] for k in range(1, steps + 1)], dtype=numpy.int64)
    change = here - there
    if place == "inside":
        rest = numpy.any(numpy.delete(change, range(2, 8), axis=1) != 0, axis=1)
        for k in set(aiding) | set(other_aiding):
            if k <= steps:
                rest[k - 1] |= aiding.get(k) != other_aiding.get(k)
        sums = numpy.cumsum(change[:, COUNTS], axis=0)
        found, since = [], 0
        low = high = numpy.zeros(6, dtype=numpy.int64)
        while since < steps:
            # The ranges of the sums from the last altered sample on.
            low_s = numpy.minimum(numpy.minimum.accumulate(sums[since:], axis=0), low)
            high_s = numpy.maximum(numpy.maximum.accumulate(sums[since:], axis=0), high)
            leaves = numpy.any(high_s - low_s > 1, axis=1) | rest[since:]
            if not leaves.any():
                break
            since += int(numpy.argmax(leaves)) + 1
            found.append(since)
            low = high = sums[since - 1]
    largest = numpy.abs(change[numpy.array(found, dtype=int) - 1, COUNTS]).max(axis=0) if found else None
    return found, largest


def main():
    octant, work = sys.argv[1], Path(sys.argv[2])
    pages = Path(__file__).resolve().parents[2] / "docs" / "faults"

    def run(name, text):
        (work / f"{name}.toml").write_text(text)
        arguments = [octant, "run", f"{name}.toml", "--out", name, "--no-twin"]
        ended = subprocess.run(arguments, cwd=work, capture_output=True, text=True)
        assert (work / name / "summary.json").exists(), f"{name}: {ended.stderr}"
        return json.loads((work / name / "summary.json").read_text())

    run("none", SCENARIO)
    twin = recorded(work / "none")
    counts = dict.fromkeys(PLACES, 0)
    other_way = []
    for page in sorted(pages.glob("*.md")):
        text = page.read_text()
        place = next((place for place, says in PLACES.items() if says in text), None)
        if place is None:
            continue
        name = page.stem
        example = re.search(r"```toml\n(.*?)```", text, re.DOTALL).group(1)
        summary = run(name, SCENARIO + example)
        with_fault = recorded(work / name)
        steps = max(with_fault[0])
        if any(with_fault[2][k] != twin[2].get(k) for k in with_fault[2]):
            other_way.append(name)
            continue
        found, largest = altered(place, with_fault, twin, steps)
        receipt = summary["faults"][0]
        wanted = (len(found), found[0] if found else None, found[-1] if found else None)
        told = tuple(receipt[key] for key in ("samples_altered", "first_sample", "last_sample"))
        assert told == wanted, f"{name}: the receipt says {told}, numpy finds {wanted}"
        if largest is not None:
            change = receipt["largest_change"]
            change = change["delta_theta"] + change["delta_velocity"]
            assert change == largest.tolist(), f"{name}: the receipt says {change}, numpy finds {largest}"
        if found:
            assert summary["altered_streams"]["first_sample"] <= found[0], f"{name}: altered_streams"
        counts[place] += 1
        print(f"{name}: {wanted[0]} samples from {wanted[1]} to {wanted[2]}")
    print(f"receipts as numpy finds them: {counts}; the core went another way: {', '.join(other_way) or 'nowhere'}")
    assert counts["inside"] >= 14 and counts["in place"] >= 30 and counts["delivery"] >= 4, counts


main()
