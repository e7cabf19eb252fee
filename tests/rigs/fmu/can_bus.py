#!/usr/bin/env python3
"""The Calibrator on a CAN bus, imported by FMPy: a bus and a harness in Python around the FMU.

Usage: can_bus.py FMU RECORDING PARAMETERS.csv [--fd] [--bus] [--steps N]

The harness sends the samples of the recording as frames of the wire protocol, put together by the
published client, and compares every output and all parameters that come back with the recording, bit
for bit. Without --bus both ends are connected directly and nothing takes time. With --bus frames take
as long as their bits do, the lowest identifier wins, the loser is told so and has to come again, one
frame in a hundred is destroyed, and every frame is confirmed: all that the bus does it was asked for
by the FMU's own Configuration operations.
"""

import argparse
import collections
import ctypes
import pathlib
import shutil
import struct
import sys
import time
import xml.etree.ElementTree as xml
import zipfile

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

import recording
import variables

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "fixtures/wire/clients"))
import octant_client as wire  # noqa: E402

MIME = 'application/org.fmi-standard.fmi-ls-bus.can; version="1.0.0"'
FORMAT_ERROR, CAN, CAN_FD, CONFIRM, LOST, ERROR, CONFIGURATION, STATUS = (
    0x01, 0x10, 0x11, 0x20, 0x30, 0x31, 0x40, 0x41)
PERIOD_S = 0.005


def operation(code, arguments):
    return struct.pack("<II", code, 8 + len(arguments)) + arguments


def operations(data):
    at = 0
    while at < len(data):
        code, length = struct.unpack_from("<II", data, at)
        yield code, data[at + 8:at + length]
        at += length
    assert at == len(data), "operations end where the data do"


def transmit(frame, fd):
    identifier, data = frame
    head = struct.pack("<IBBBH", identifier, 0, 1, 0, len(data)) if fd else \
        struct.pack("<IBBH", identifier, 0, 0, len(data))
    return operation(CAN_FD if fd else CAN, head + data)


def frame_of(code, arguments):
    """Identifier and data of a transmit operation."""
    if code == CAN_FD:
        identifier, ide, brs, _, length = struct.unpack_from("<IBBBH", arguments)
        data = arguments[9:]
        assert (ide, brs, length) == (0, 1, len(data)), arguments
    else:
        identifier, ide, rtr, length = struct.unpack_from("<IBBH", arguments)
        data = arguments[8:]
        assert (ide, rtr, length) == (0, 0, len(data)), arguments
    return identifier, data


def bus_variables(path, description):
    """The variables of the bus, found as an importer finds them: by terminal and manifest."""
    with zipfile.ZipFile(path) as archive:
        manifest = xml.fromstring(
            archive.read("extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml"))
        terminals = xml.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        # FMPy leaves out what a binary variable is, and which clock it has.
        declared = xml.fromstring(archive.read("modelDescription.xml")).find("ModelVariables")
    space = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert manifest.get(space + "fmi-ls-name") == "org.fmi-standard.fmi-ls-bus"
    assert manifest.get(space + "fmi-ls-version") == "1.0.0"
    assert manifest.get("isBusSimulationFMU") == "false"
    [terminal] = [t for t in terminals.find("Terminals")
                  if t.get("terminalKind") == "org.fmi-ls-bus.network-terminal"]
    assert terminal.get("matchingRule") == "org.fmi-ls-bus.transceiver"
    [configuration] = terminal.findall("Terminal")
    assert configuration.get("terminalKind") == "org.fmi-ls-bus.network-terminal.configuration"
    by_name = {variable.name: variable for variable in description.modelVariables}
    members = {member.get("memberName"): by_name[member.get("variableName")]
               for part in (terminal, configuration)
               for member in part.findall("TerminalMemberVariable")}
    assert sorted(members) == ["BusNotifications", "Rx_Clock", "Rx_Data", "Tx_Clock", "Tx_Data"]
    references = {name: variable.valueReference for name, variable in members.items()}
    for way in ("Rx", "Tx"):
        [binary] = declared.findall(f"Binary[@valueReference='{references[way + '_Data']}']")
        assert binary.get("mimeType") == MIME
        assert int(binary.get("clocks")) == references[way + "_Clock"]
    return references


class Node:
    """The FMU: events, ticks, and time."""

    def __init__(self, path, parameters, settings):
        self.description = read_model_description(path)
        self.at = bus_variables(path, self.description)
        self.folder = extract(path)
        co_simulation = self.description.coSimulation
        assert co_simulation.hasEventMode and co_simulation.canHandleVariableCommunicationStepSize
        self.fmu = FMU3Slave(guid=self.description.guid, unzipDirectory=self.folder,
                             instanceName="node", modelIdentifier=co_simulation.modelIdentifier)
        self.fmu.instantiate(eventModeUsed=True)
        for group in variables.grouped(self.description, parameters | settings):
            name = {"Bool": "Boolean"}.get(group.kind, group.kind)
            pointer = group.row(0)
            if group.kind == "Bool":
                pointer = ctypes.cast(pointer, ctypes.POINTER(ctypes.c_bool))
            getattr(self.fmu, "fmi3Set" + name)(
                self.fmu.component, group.reference_array, len(group.references), pointer,
                group.width)
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()
        self.time_s = 0.0
        self.next_s = None
        self.clock = (ctypes.c_uint32 * 1)(self.at["Tx_Clock"])
        self.interval, self.qualifier = (ctypes.c_double * 1)(), (ctypes.c_int * 1)()
        self.update()

    def update(self):
        while self.fmu.updateDiscreteStates()[0]:
            pass
        self.fmu.getIntervalDecimal(self.clock, self.interval, self.qualifier)
        if self.qualifier[0] == 0:
            self.next_s = None
        elif self.qualifier[0] == 2:
            self.next_s = self.time_s + self.interval[0]

    def receive(self, data):
        self.fmu.setClock([self.at["Rx_Clock"]], [True])
        self.fmu.setBinary([self.at["Rx_Data"]], [data])
        self.update()

    def sent(self):
        """What it sends now, at ticks that it has announced."""
        data = b""
        while self.next_s is not None and self.next_s <= self.time_s:
            self.fmu.setClock([self.at["Tx_Clock"]], [True])
            data += self.fmu.getBinary([self.at["Tx_Data"]])[0]
            self.update()
        return data

    def step_to(self, time_s):
        if time_s > self.time_s:
            self.fmu.enterStepMode()
            self.fmu.doStep(self.time_s, time_s - self.time_s)
            self.fmu.enterEventMode()
            self.time_s += time_s - self.time_s
            self.update()

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


class Wires:
    """Both ends connected directly."""

    def __init__(self, node, fd):
        self.node, self.fd = node, fd
        self.frames = 0

    def carry(self, frames):
        """The frames of the harness there, and those of the node back."""
        self.frames += len(frames)
        if frames:
            self.node.receive(b"".join(transmit(frame, self.fd) for frame in frames))
        back = []
        for code, arguments in operations(self.node.sent()):
            assert code != FORMAT_ERROR, arguments
            if code in (CAN, CAN_FD):
                back.append(frame_of(code, arguments))
        self.frames += len(back)
        return back

    def report(self):
        return f"{self.frames} frames"


class Bus:
    """A bus with arbitration, errors and time: the loser's frame is thrown away, and it is told."""

    def __init__(self, node, fd):
        self.node, self.fd = node, fd
        self.rates, self.lost_behaviour, self.state = {}, None, None
        self.counts = collections.Counter()
        self.waiting = None

    def bits_s(self, frame):
        bits = 8 * len(frame[1])
        if not self.fd:
            return (bits + 47 + (33 + bits) // 4) / self.rates[1]
        crc = 27 if len(frame[1]) <= 16 else 32
        return 34 / self.rates[1] + (5 + bits + (21 + bits) // 4 - 4 + crc) / self.rates[2]

    def take(self):
        for code, arguments in operations(self.node.sent()):
            if code == CONFIGURATION and arguments[0] in (1, 2):
                [self.rates[arguments[0]]] = struct.unpack("<I", arguments[1:])
            elif code == CONFIGURATION:
                self.lost_behaviour = arguments[1]
            elif code == STATUS:
                self.state = arguments[0]
            else:
                assert code in (CAN, CAN_FD) and self.waiting is None, (code, arguments)
                self.waiting = frame_of(code, arguments)

    def carry(self, frames):
        frames, back, node = collections.deque(frames), [], self.node
        self.take()
        while True:
            if self.waiting is None and not frames:
                if node.next_s is None or node.next_s > node.time_s + 1e-3:
                    return back
                # It comes again after it has lost, or was destroyed.
                node.step_to(node.next_s)
                self.take()
                continue
            ours = frames[0] if frames else None
            theirs = self.waiting
            is_theirs = theirs is not None and (ours is None or theirs[0] < ours[0])
            winner = theirs if is_theirs else ours
            loser = theirs if ours is not None and not is_theirs else None
            self.counts["frames"] += 1
            answer = b""
            if loser is not None:
                # DISCARD_AND_NOTIFY
                assert self.lost_behaviour == 2
                self.counts["lost"] += 1
                self.waiting = None
                answer = operation(LOST, struct.pack("<I", loser[0]))
            node.step_to(node.time_s + self.bits_s(winner))
            if self.counts["frames"] % 100 == 0:
                self.counts["destroyed"] += 1
                answer += operation(ERROR, struct.pack("<IBBB", winner[0], 1, 1 + (not is_theirs),
                                                       is_theirs))
                if is_theirs:
                    self.waiting = None
            elif is_theirs:
                back.append(theirs)
                self.waiting = None
                answer += operation(CONFIRM, struct.pack("<I", theirs[0]))
            else:
                answer += transmit(frames.popleft(), self.fd)
            node.receive(answer)
            self.take()

    def report(self):
        assert self.state == 1 and self.lost_behaviour == 2 and min(self.counts.values()) > 0
        return ", ".join(f"{count} {what}" for what, count in self.counts.items())


class Harness:
    """Lock-step: a request, and its answer."""

    def __init__(self, bus, fd):
        self.bus, self.form = bus, "fd" if fd else "classic"
        self.reassembler = wire.Reassembler(["device"], self.form)
        self.step = 0

    def ask(self, *messages):
        frames = [frame for message in messages
                  for frame in wire.segments(message, "harness", self.form)]
        back = (self.reassembler.receive(*frame, self.form) for frame in self.bus.carry(frames))
        return [message for message in back if message and message["kind"] not in
                ("status", "heartbeat")]

    def hello(self):
        hello = wire.hello(0, 0x0C7A, 0, 5_000_000) | {"silence_ms": 2000}
        said = self.ask(hello)
        # The one of power on has session 0.
        assert [message["session"] for message in said if message["kind"] == "hello"][-1] == 0x0C7A
        assert not any(message["kind"] == "bye" for message in said), said

    def sample(self, imu, aiding):
        self.step = (self.step + 1) & 0x7FFF
        sample = {"kind": "sample", "step": self.step, "aided": aiding is not None,
                  "status": int(imu["status"]), "sequence": int(imu["sequence"]),
                  "device_time_ns": int(imu["device_time_ns"]),
                  "azimuth": int(imu["azimuth"]), "roll": int(imu["roll"])}
        for name in ("delta_theta", "delta_velocity"):
            sample |= {f"{name}_{axis}": int(count) for axis, count in zip("xyz", imu[name])}
        if aiding is None:
            return self.ask(sample)
        value = [float(number) for number in aiding["value"]]
        return self.ask({"kind": "aiding", "step": self.step, "reference": int(aiding["kind"]),
                         "device_time_ns": int(aiding["device_time_ns"]),
                         "north_or_latitude": value[0], "east_or_longitude": value[1],
                         "down_or_height": value[2]}, sample)


def expected_output(row):
    """A row of the recording under the names of the wire."""
    names = {"latitude": "latitude", "longitude": "longitude", "height": "height", "nis": "nis",
             "sequence": "sequence", "device_time_ns": "device_time_ns", "health": "health",
             "azimuth_command": "azimuth", "roll_command": "roll", "stop": "stop", "mode": "mode",
             "moving": "moving", "parameters_revision": "revision"}
    fields = {name: row[field].item() for name, field in names.items()}
    fields |= dict(zip(("velocity_north", "velocity_east", "velocity_down"), row["velocity"].tolist()))
    return fields | dict(zip(("attitude_w", "attitude_x", "attitude_y", "attitude_z"),
                             row["q_nb"].tolist()))


def bits(value):
    return struct.pack("<d", value) if isinstance(value, float) else value


def compare(expected, found):
    """Names of the fields that differ."""
    return [name for name, value in expected.items() if bits(value) != bits(found[name])]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu")
    parser.add_argument("recording")
    parser.add_argument("parameters")
    parser.add_argument("--fd", action="store_true")
    parser.add_argument("--bus", action="store_true")
    parser.add_argument("--steps", type=int)
    arguments = parser.parse_args()

    messages = recording.read(arguments.recording)
    imu, outputs = messages["/imu"], messages["/output"]
    aiding = {int(row["device_time_ns"]): row for row in messages["/aiding"]}
    estimates = {int(row["sequence"]): row for row in messages["/parameters"]}
    steps = min(arguments.steps or len(imu), len(imu))

    settings = {"can.fd": np.array([[arguments.fd]])}
    if arguments.bus:
        settings |= {"can.bus_notifications": np.array([[True]]),
                     "can.arbitration_lost": np.array([[2]])}
    node = Node(arguments.fmu, variables.parameters(arguments.parameters), settings)
    bus = (Bus if arguments.bus else Wires)(node, arguments.fd)
    harness = Harness(bus, arguments.fd)
    harness.hello()
    failed, estimated = [], 0
    began = time.perf_counter()
    for k in range(steps):
        node.step_to(k * PERIOD_S)
        back = harness.sample(imu[k], aiding.get(int(imu[k]["device_time_ns"])))
        output = back[0]
        wrong = compare(expected_output(outputs[k]), output)
        parts = back[1:]
        row = estimates.get(int(imu[k]["sequence"]))
        if output["parameters_follow"] and row is not None:
            estimated += 1
            values = [part[f"value_{i}"] for part in parts for i in range(5)]
            sigma = [part[f"sigma_{i}"] for part in parts for i in range(5)]
            if np.array(values).tobytes() != row["values"].tobytes():
                wrong.append("parameters")
            if np.array(sigma).tobytes() != row["sigma"].tobytes():
                wrong.append("sigma")
        if [part["kind"] for part in parts] != ["parameters"] * (6 * output["parameters_follow"]):
            wrong.append("which messages came")
        if wrong and len(failed) < 5:
            print(f"  sample {k}: {', '.join(wrong)}")
        if wrong:
            failed.append(k)
    took = time.perf_counter() - began
    counts = harness.reassembler.counts
    unclean = {name: count for name, count in counts.items()
               if count and name not in ("frames", "foreign", "messages")}
    print(f"  {steps} samples, {estimated} times all parameters, {bus.report()}: "
          + ("DIFFERENT" if failed or unclean else "equal bit for bit")
          + f", {took / steps * 1e6:.0f} us a sample, {node.time_s:.3f} s {unclean or ''}")
    node.close()
    return bool(failed or unclean or estimated == 0)


if __name__ == "__main__":
    sys.exit(main())
