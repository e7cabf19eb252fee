"""Holds what the virtual machine told against the runs in process, and what candump saw against the
CAN database.

Usage: judge.py WORK STATUS-OF-THE-RUN-OVER-THE-UART
"""

import base64
import gzip
import json
import re
import sys
from pathlib import Path

import cantools

work, uart_status = Path(sys.argv[1]), int(sys.argv[2])
failed = []


def check(name, is_so, what=""):
    print(f"{'ok  ' if is_so else 'FAIL'} {name} {what}")
    if not is_so:
        failed.append(name)


def hash_of(name):
    return json.loads((work / f"{name}.json").read_text())["stream_hash"]


said = [
    line.strip()[4:]
    for line in (work / "console").read_text(errors="replace").splitlines()
    if line.startswith("RIG ")
]
expected = {name: hash_of(name) for name in ("lockstep", "short")}
scenario_of = {"vcan-fd": "lockstep"}
seen, instruments = set(), {}
for line in said:
    if line.startswith("run "):
        _, name, status, found, start, end = line.split()
        seen.add(name)
        samples = 120_000 if scenario_of.get(name) else 10_000
        seconds = float(end) - float(start)
        check(
            f"{name}: status {status}",
            status == "0" and found == expected[scenario_of.get(name, "short")],
            f"{found[:16]}, {samples / seconds:.0f} samples/s",
        )
    elif line.startswith("instrument "):
        _, name, status, found, *readings = line.split(maxsplit=4)
        readings = "".join(readings)
        count = {key: int(value) for key, value in re.findall(r'"(\w+)":(\d+)', readings)}
        instruments[name] = found
        check(
            f"instrument on {name}: status {status}, {count.get('samples')} samples",
            status == "0" and count.get("samples") == 1000 and count.get("missing") == 0,
            readings,
        )
    elif line.startswith("failed"):
        check(line, False)
for name in ("vcan-classic", "vcan-fd", "sja1000", "candump", "slcan"):
    check(f"{name} was run", name in seen)

# That slcan gives samples to the last bit is shown by a test with an adapter that is played.
check(
    "the kernel's CAN and slcan give the same samples",
    sorted(instruments) == ["SocketCAN", "slcan"] and len(set(instruments.values())) == 1,
    instruments,
)

baud = next((line for line in said if line.startswith("baud ")), "")
check("a rate that the driver doesn't keep is refused", "9600" in baud and not baud.startswith("baud 0"), baud)

check(
    f"16550, harness outside: status {uart_status}",
    uart_status == 0 and hash_of("uart") == expected["short"],
)
check("the machine came to its end", "done" in said and "told over" in said)

# The first frames of the run that candump watched, by the database and not by our code.
dump = "".join(line[5:] for line in said if line.startswith("dump "))
lines = gzip.decompress(base64.b64decode(dump)).decode().splitlines()
database = cantools.database.load_file("fixtures/can/octant.dbc", strict=True)
known = {message.frame_id: message for message in database.messages}
decoded, foreign = 0, 0
for line in lines:
    match = re.fullmatch(r"\(\S+\) vcan1 ([0-9A-F]+)#([0-9A-F]*|R\d*)", line)
    frame, data = int(match[1], 16), match[2]
    if data.startswith("R") or frame not in known:
        foreign += 1
        continue
    bytes_of = bytes.fromhex(data)
    if len(bytes_of) != known[frame].length:
        foreign += 1
        continue
    fields = known[frame].decode(bytes_of, decode_choices=False)
    decoded += bool(fields)
check("cantools reads what candump saw", decoded > 10_000, f"{decoded} frames")
check("frames of others were among them", foreign >= 4, f"{foreign} frames")

sys.exit(1 if failed else 0)
