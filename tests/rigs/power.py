#!/usr/bin/env python3
"""Cuts and lowers the power of a device by an instrument of PyVISA-sim, and compares the runs with those in process.

Usage: python tests/rigs/power.py OCTANT

The instrument is tests/rigs/power.yaml. PyVISA-sim has neither a socket nor relays nor a load: this program listens, keeps
two relays by the instrument's property, and is the load, a resistor of 48 ohm and the device behind channel 2 or relay 1.

Exit status: 0 as expected, 1 with what isn't.
"""

import json
import re
import signal
import socketserver
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import pyvisa

from children import popen

OHM = 48.0
SHORT = """schema = 1
title = "short"
[procedure.calibration]
duration = "8 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }]
[procedure.navigation]
duration = "2 s"
"""
CUT = '[[faults]]\nid = "f"\nkind = "brown-out"\ntrigger = { at = "4 s" }\nduration = "500 ms"\n'
RESTART = '[[faults]]\nid = "f"\nkind = "restart"\ntrigger = { at = "4 s" }\n'
DIP = '[[faults]]\nid = "f"\nkind = "voltage-dip"\nvoltage = "%s"\ntrigger = { at = "4 s" }\n'
SUPPLY = 'channel = 2\nvoltage = "24 V"\ncurrent_limit = "2 A"\n'


class Bench:
    """The instrument, what it feeds, and a folder."""

    def __init__(self, octant, folder):
        self.octant, self.folder = octant, folder
        self.link = folder / "device"
        self.child, self.starts, self.lock = None, 0, threading.Lock()
        manager = pyvisa.ResourceManager(f"{Path(__file__).with_suffix('.yaml')}@sim")
        self.visa = manager.open_resource(
            "TCPIP::localhost::5025::SOCKET", read_termination="\n", write_termination="\n", timeout=20
        )
        bench = self

        class Handler(socketserver.StreamRequestHandler):
            def handle(self):
                for line in self.rfile:
                    reply = bench.take(line.decode().strip())
                    if reply is not None:
                        self.wfile.write(reply.encode() + b"\n")

        class Server(socketserver.ThreadingTCPServer):
            daemon_threads, allow_reuse_address = True, True

        self.server = Server(("127.0.0.1", 0), Handler)
        self.port = f"tcp:127.0.0.1:{self.server.server_address[1]}"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def ask(self, line):
        """What PyVISA-sim replies to a line; None: nothing."""
        self.visa.write(line)
        try:
            return self.visa.read()
        except pyvisa.VisaIOError:
            return None

    def take(self, line):
        with self.lock:
            if not line:
                return None
            relay = re.fullmatch(r"ROUT:(CLOS|OPEN) \(@1\)", line)
            if relay:
                line = f"RELAY 1 {int(relay[1] == 'CLOS')}"
            if line in ("MEAS:VOLT?", "MEAS:CURR?"):
                volts = float(self.ask("VOLT?")) if self.ask("OUTP?") == "ON" else 0.0
                volts = min(volts, OHM * float(self.ask("CURR?")))
                return f"{volts if 'VOLT' in line else volts / OHM:+.6E}"
            reply = self.ask(line)
            if "?" not in line:
                self.feed()
            return reply

    def feed(self):
        """Starts or kills the device, as its power is."""
        selected = self.ask("INST:NSEL?")
        self.ask("INST:NSEL 2")
        powered = self.ask("OUTP?") == "ON" and float(self.ask("VOLT?")) >= 18
        self.ask(f"INST:NSEL {selected}")
        powered = powered or self.ask("ROUT:CLOS? (@1)") == "1"
        if powered and self.child is None:
            command = [self.octant, "serve", "--endpoint", f"pty:{self.link}", self.folder / "s.toml"]
            self.child = popen(command, stderr=subprocess.DEVNULL)
            self.starts += 1
        elif not powered and self.child is not None:
            self.child.kill()
            self.child.wait()
            self.child = None
            # The name of a terminal goes with its adapter.
            self.link.unlink(missing_ok=True)

    def is_on(self):
        with self.lock:
            return self.child is not None

    def scenario(self, faults, power, calibration="8 s"):
        link = '[endpoint.link]\nhello = "60 s"\nanswer = "20 s"\n'
        text = SHORT.replace('8 s', calibration) + f'{faults}[endpoint]\nuri = "serial:{self.link}"\n{link}[power]\nport = "{self.port}"\n'
        (self.folder / "s.toml").write_text(text + 'rest = "10 ms"\nreply = "20 s"\n' + power)
        self.starts = 0

    def command(self, out, *more):
        return [self.octant, "run", "--no-twin", "--force", "--out", self.folder / out, *more]

    def run(self, out, file, statuses=(0, 1, 3)):
        done = subprocess.run(self.command(out, self.folder / file), capture_output=True, text=True)
        assert done.returncode in statuses, f"status {done.returncode}: {done.stderr}"
        return done.stderr

    def summary(self, out):
        return json.loads((self.folder / out / "summary.json").read_text())

    def inside(self, faults):
        """The stream hash of the run in process."""
        (self.folder / "p.toml").write_text(SHORT + faults)
        self.run("inside", "p.toml")
        return self.summary("inside")["stream_hash"]

    def power(self):
        return json.loads((self.folder / "out" / "manifest.json").read_text())["bench"]["power"]

    def by_hand(self, *more, status=0):
        done = subprocess.run([self.octant, "power", self.port, *more], capture_output=True, text=True)
        assert done.returncode == status, f"{more}: status {done.returncode}: {done.stderr}"
        return done.stdout + done.stderr


def wait_for(what, holds):
    until = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < until, f"{what} did not come"
        time.sleep(0.01)


def same(bench, name, faults, power, inside, starts):
    bench.scenario(faults, power)
    bench.run("out", "s.toml")
    found, expected = bench.summary("out")["stream_hash"], bench.inside(inside)
    assert found == expected, f"{name}: {found} and {expected}"
    assert bench.starts == starts, f"{name}: started {bench.starts} times, expected {starts}"
    assert not bench.is_on(), f"{name}: left on"
    assert bench.power()["end"]["on"] is False
    print(f"ok   {name}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(Path(sys.argv[1]), Path(folder))
        same(bench, "a power cut by a supply has the bits of a brown-out in process", CUT, SUPPLY, CUT, 2)
        assert bench.power()["identity"] == "PyVISA-sim,supply,1,0.7"
        volts = [one["after"]["voltage_v"] for one in bench.power()["switchings"]]
        assert volts == [0, 24, 0, 24, 0], volts
        same(bench, "and by a relay", CUT, "relay = 1\n", CUT, 2)
        same(bench, "a dip that the device rides through has those of no fault", DIP % "20 V", SUPPLY, "", 1)
        same(bench, "a dip that it doesn't, those of a restart", DIP % "9 V", SUPPLY, RESTART, 2)

        bench.scenario("", SUPPLY.replace("24 V", "40 V"))
        said = bench.run("out", "s.toml", [4])
        assert "`VOLT 40` with -113" in said, said
        print("ok   a voltage beyond the supply's range is told in its words")

        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            bench.scenario("", SUPPLY, "10 h")
            command = bench.command("out", bench.folder / "s.toml")
            harness = popen(command, stderr=subprocess.DEVNULL)
            wait_for("the device", bench.is_on)
            time.sleep(1)
            harness.send_signal(number)
            harness.wait(60)
            # After SIGKILL nobody is left to switch it off.
            assert bench.is_on() == (number == signal.SIGKILL), number.name
        print("ok   interrupted runs leave it off, and a killed one as it was")

        said = bench.by_hand("--channel", "2", "off")
        assert said.startswith("PyVISA-sim,supply,1,0.7\noff, set to 24 V and at most 2 A"), said
        assert not bench.is_on()
        bench.by_hand("--channel", "2", "set", "--voltage", "28 V", "--current-limit", "300 mA")
        said = bench.by_hand("--channel", "2", "on")
        # 0.3 A through 48 ohm.
        assert "measured 14.400 V, 0.3000 A" in said, said
        said = bench.by_hand("--channel", "3", "status", status=4)
        assert "`INST:NSEL 3` with -113" in said, said
        bench.by_hand("--channel", "2", "off")
        print("ok   by hand")


try:
    main()
except AssertionError as error:
    print(f"FAIL {error}", file=sys.stderr)
    sys.exit(1)
