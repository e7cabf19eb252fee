"""Holds what the virtual machine told against the runs in process, and what candump saw against the
CAN database.

Usage: judge.py WORK STATUS-OF-THE-RUN-OVER-THE-UART
"""

import base64
import gzip
import io
import json
import math
import re
import sys
from pathlib import Path

import cantools
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

work, uart_status = Path(sys.argv[1]), int(sys.argv[2])
failed = []


def check(name, is_so, what=""):
    print(f"{'ok  ' if is_so else 'FAIL'} {name} {what}")
    if not is_so:
        failed.append(name)


def hash_of(name):
    return json.loads((work / f"{name}.json").read_text())["stream_hash"]


def said_of(name: str) -> str:
    """The last line of a name."""
    return next((line for line in reversed(said) if line.startswith(f"{name} ")), f"nothing of {name}")


def figure(line: str, name: str) -> float:
    """Value of a key in a line, or not a number."""
    match = re.search(rf'"{name}":([-\d.e]+)', line)
    return float(match[1]) if match else math.nan


said = [
    line.strip()[4:]
    for line in (work / "console").read_text(errors="replace").splitlines()
    if line.startswith("RIG ")
]
expected = {name: hash_of(name) for name in ("lockstep", "short")}
scenario_of = {"vcan-fd": "lockstep"}
seen = set()
for line in said:
    if line.startswith("run "):
        _, name, status, found, start, end = line.split()
        seen.add(name)
        check(
            f"{name}: status {status}",
            status == "0" and found == expected[scenario_of.get(name, "short")],
            f"{found[:16]}, {float(end) - float(start):.0f} s",
        )
    elif line.startswith("failed"):
        check(line, False)
for name in ("vcan-classic", "vcan-fd", "sja1000", "candump", "slcan"):
    check(f"{name} was run", name in seen)

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

# The instrument on the bus: what was recorded of it, and what the frames say that candump saw.
told = next((line for line in said if line.startswith("instrument ")), "no word")
samples = {}
sample, parts = {}, 0
for line in lines:
    match = re.fullmatch(r"\(\S+\) vcan1 ([0-9A-F]+)#([0-9A-F]*)", line)
    frame = int(match[1], 16) if match else 0
    name = known[frame].name if frame in known else ""
    if not name.startswith("HarnessSample_") or len(match[2]) != 2 * known[frame].length:
        continue
    if name == "HarnessSample_0":
        sample, parts = {}, 0
    parts += 1
    sample |= known[frame].decode(bytes.fromhex(match[2]), scaling=False)
    # candump loses frames where the host is busy.
    if name == "HarnessSample_6" and parts == 7:
        samples[sample["sequence"]] = [
            sample[f"{what}_{axis}"] for what in ("delta_theta", "delta_velocity") for axis in "xyz"
        ] + [sample["azimuth"], sample["roll"]]
recording = base64.b64decode("".join(line[10:] for line in said if line.startswith("recording ")))
check("the instrument's run left a recording", len(recording) > 0, told)
if not recording:
    # The console has what the run and canplayer said.
    console = (work / "console").read_text(errors="replace").splitlines()
    after = max((at for at, line in enumerate(console) if line.startswith("RIG run ")), default=0)
    print("\n".join(line for line in console[after:] if not line.startswith("RIG ")))
    sys.exit(1)
reader = make_reader(io.BytesIO(recording), decoder_factories=[DecoderFactory()])
recorded = [decoded for *_, decoded in reader.iter_decoded_messages(topics=["/imu"])]
# The run numbers samples from the first that arrived, whatever was lost before it: they are found by what they hold, in
# their order. Each has the noise of its own.
played = [samples[number] for number in sorted(samples)]
equal, at = 0, 0
for one in recorded:
    held = [*one.delta_theta, *one.delta_velocity, one.gimbal_azimuth, one.gimbal_roll]
    if held in played[at:]:
        equal, at = equal + 1, played.index(held, at) + 1
check("an instrument on the kernel's CAN", told.startswith("instrument 0 "), told)
check("its arrivals are stamped by the kernel", figure(told, "arrivals_by_kernel") > 100, told)
# A host that is busy starves the machine, and its controllers overrun: however many samples that costs, each has to be
# counted, and one that has arrived has to be equal. Where most are lost, nothing is shown.
missing = re.search(r'"missing":(\d+)', told)
missing = int(missing[1]) if missing else 0
check(
    "it has the samples of the frames, or counts them as missing",
    equal == len(recorded) == 200 - missing and missing <= 100,
    f"{equal} of {len(recorded)} equal, {missing} missing",
)

told = said_of("unkept")
check("a clock that nobody keeps is refused", not told.startswith("unkept 0") and "found a clock that went" in told, told)
told = [line for line in said if line.startswith("stamped ")]
# Where what keeps the clock was starved, the clock was behind by more than the scenario says, up to so many milliseconds.
# As far behind as the line's delay, its stamps show nothing.
behind_ms = {line: float(match[1]) for line in told if (match := re.match(r"stamped 0 behind:(\d+) ", line))}
kept = [line for line, behind in behind_ms.items() if behind < 20.0 and '"early":0' in line]
if kept:
    check("a unit with stamps by /dev/ptp0", '"origin":"stamps(tai,/dev/ptp0)"' in kept[-1], kept[-1])
    # The clock is kept within milliseconds, and the scenario says so. A host that is busy makes the bound and the line's
    # delay larger, and never smaller.
    within_ms = figure(kept[-1], "within_us") * 1e-3
    check("the bound of its times", 10.0 < within_ms < 40.0, kept[-1])
    check("the line's delay is what the unit waits", 20.0 - max(within_ms, behind_ms[kept[-1]]) <= figure(kept[-1], "least_ms") < 60.0, kept[-1])
else:
    # A clock that nobody kept for long, or a unit that came too late, has to end the run or leave it without a bound; one
    # that is behind by no more than the line's delay shows in nothing.
    noticed = [behind_ms.get(line, 20.0) >= 20.0 or '"within_us":null' in line for line in told]
    check("a clock that was kept badly is noticed, and nothing is shown", bool(told) and all(noticed), " ".join(told))
told = said_of("otherwise")
check("the same stamps as UTC are refused", not told.startswith("otherwise 0") and "the stamps have another scale" in told, told)

sys.exit(1 if failed else 0)
