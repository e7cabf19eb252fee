#!/usr/bin/env python3
"""Reads CAN frames of the conformance vectors with cantools and the CAN database, and writes them back.

Usage: python tests/rigs/wire_cantools.py

Every frame of fixtures/wire/messages.json, classic and FD, is decoded by fixtures/can/octant.dbc. The
signals have to be the fields of the message, to the last bit, in physical units; encoded again they have to
be the bytes of the frame. Exit status: 0 as expected, 1 not as expected.
"""

import json
import pathlib
import struct
import sys

import cantools

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARAMETERS_PER_SEGMENT = 5
LSB = {"delta_theta": 2.0**-36, "delta_velocity": 2.0**-30}
GIMBAL_LSB = 2.0**-27
GIMBAL = ("azimuth", "roll", "azimuth_command", "roll_command")

failures = []


def check(holds, what):
    if not holds:
        failures.append(what)


def bits(value):
    return struct.pack(">d", value).hex()


def expected_signals(vector, names):
    """Signals of a whole message by name, as physical values; f64 as their bits."""
    signals = {}
    for name, value in vector["fields"].items():
        if name == "configuration":
            words = struct.unpack("<4Q", bytes.fromhex(value))
            signals |= {f"{name}_{i}": word for i, word in enumerate(words)}
        elif name in ("name", "firmware", "text"):
            room = 40 if name == "text" else 24
            words = struct.unpack(f"<{room // 8}Q", value.encode().ljust(room, b"\0"))
            signals |= {f"{name}_{i}": word for i, word in enumerate(words)}
        elif name.startswith(("value_", "sigma_")) and vector["kind"] == "parameters":
            index = PARAMETERS_PER_SEGMENT * vector["fields"]["segment"] + int(name[-1])
            prefix = "sigma_" if name.startswith("sigma_") else ""
            signals[prefix + names[index]] = value
        elif name.startswith(tuple(LSB)):
            signals[name] = value * LSB[name[:-2]]
        elif name in GIMBAL:
            signals[name] = value * GIMBAL_LSB
        else:
            # u64 are text; a flag is a bit.
            number = isinstance(value, str) and len(value) != 16
            signals[name] = int(value) if number or isinstance(value, bool) else value
    return signals


def main():
    database = cantools.database.load_file(ROOT / "fixtures/can/octant.dbc", strict=True)
    vectors = json.loads((ROOT / "fixtures/wire/messages.json").read_text())["vectors"]
    names = [name for name in next(v for v in vectors if v["kind"] == "restart")["fields"]
             if name not in ("step", "offset")]
    seen = set()
    for vector in vectors:
        for form in ("classic", "fd"):
            found = {}
            for text in vector[form]:
                identifier, _, data = text.partition("#")
                data = bytes.fromhex(data.removeprefix("#1"))
                message = database.get_message_by_frame_id(int(identifier, 16))
                place = f"{vector['name']}, {message.name}"
                seen.add(message.name)
                check(message.is_fd == (form == "fd"), f"{place}: is_fd is {message.is_fd}")
                check(message.length == len(data), f"{place}: {message.length} bytes")
                check(message.senders[0].lower() == vector["sender"], f"{place}: from {message.senders}")
                signals = message.decode(data, decode_choices=False)
                check(message.encode(signals, strict=False) == data, f"{place}: encoded again it differs")
                for signal in message.signals:
                    value = signals[signal.name]
                    found[signal.name] = bits(value) if signal.is_float else value
            found.pop("crc32")
            expected = expected_signals(vector, names)
            for name in expected.keys() | found.keys():
                # One expected as the text of a u64 may have sixteen digits too.
                want, have = expected.get(name), found.get(name)
                same = want == have or (isinstance(have, int) and str(have) == want)
                check(same, f"{vector['name']}, {form}: {name} is {have}, expected is {want}")
    missing = {message.name for message in database.messages} - seen
    check(not missing, f"no vector has {sorted(missing)}")
    for failure in failures[:20]:
        print(failure, file=sys.stderr)
    print(f"cantools {cantools.__version__}: {len(seen)} frames of the database in {len(vectors)} "
          f"messages, {len(failures)} checks failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
