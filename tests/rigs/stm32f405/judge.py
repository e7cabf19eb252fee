"""Judges the runs of tests/rigs/firmware.

Usage: judge.py FOLDER
"""

import json
import sys
from pathlib import Path

FOLDER = Path(sys.argv[1])
# Of what a run is told by, these are about the line and the host, and differ.
# What a run without faults alone has is in one of them; a follower of samples is compared by its verdict elsewhere.
ELSEWHERE = {"faults", "pacing", "inputs", "false_alarms"}
wrong = []


def expect(is_so, what):
    if not is_so:
        wrong.append(what)


def read(name):
    summary = json.loads((FOLDER / f"{name}.json").read_text())
    link = json.loads((FOLDER / name / "manifest.json").read_text())["link"]
    return summary, link


program, link = read("program")
expect(link["firmware"] == "echo 1", f"the program's firmware is {link['firmware']}")
for name in ("program-bad", "firmware", "firmware-bad"):
    summary, link = read(name)
    is_bad = name.endswith("-bad")
    expect(("STM32F405" in link["firmware"]) == name.startswith("firmware"), f"{name}: {link['firmware']}")
    expect(summary["stream_hash"] == program["stream_hash"], f"{name}: another stream")
    for key in program.keys() - ELSEWHERE:
        expect(summary[key] == program[key], f"{name}: {key} is {summary[key]}, of the program {program[key]}")
    for fault in summary["faults"]:
        expect(fault["fired"], f"{name}: {fault['id']} did nothing")
    expect((link["repeated"] > 0) == is_bad, f"{name}: asked {link['repeated']} times again")
    expect((link["damaged"] > 0) == is_bad, f"{name}: {link['damaged']} damaged frames")
    [wire] = summary["inputs"]
    came = link["received"] + link["damaged"] + link["unreadable"]
    expect(wire["read"] == came, f"{name}: {wire['read']} messages in the account, {came} came")
    expect((wire["used"] < wire["read"]) == is_bad, f"{name}: {wire['used']} messages used")
    print(f"{name}: {link['received']} messages, {link['repeated']} times asked again, {link['damaged']} damaged,"
          f" stream {summary['stream_hash'][:16]}")

expect(program["verdict"] == "inconclusive" and program["reasons"][0].startswith("calibration: planned"),
       f"an echo shows nothing: {program['reasons']}")
for finding in program.get("findings", []):
    expect(finding["verdict"] != "fail", f"an answer that may not be: {finding}")
clock, link = read("clock")
pacing = clock["pacing"]
device_clock = pacing["device_clock"]
expect(pacing["frames"] == 40, f"by the clock: {pacing['frames']} samples")
expect(device_clock is not None and device_clock["exchanges"] > 0, f"by the clock: no time of the device: {pacing}")
print(f"by the clock: answers within {pacing['answer_us']['p50'] / 1e3:.1f} ms (p50), {pacing['late_answers']} late, {pacing['not_sent']} not sent,"
      f" {device_clock and device_clock['exchanges']} exchanges of the time")
for line in wrong:
    print(line)
sys.exit(1 if wrong else 0)
