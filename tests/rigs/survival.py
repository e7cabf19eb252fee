"""A bench on which everything goes wrong. See tests/rigs/survival.

Usage: survival.py OCTANT SECONDS SEED
"""

import json
import os
import pty
import random
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
import tty
from pathlib import Path

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader

from children import popen

OCTANT, SECONDS, SEED = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
# Only what hangs takes as long, on a busy host too.
LONG_S = 300
SCENARIO = """schema = 1
title = "survival"
[procedure.alignment]
method = "given"
[procedure.navigation]
duration = "DURATION"
[realtime]
overruns = 1000000
late_answers = 1000000
silence = "1 s"
[endpoint.link]
hello = "3 s"
answer = "2 s"
[record]
samples = "full"
"""


class Line:
    """A line of two pseudo terminals, with us in the middle."""

    def __init__(self, folder):
        self.ends = []
        self.paths = []
        for name in ("harness", "device"):
            near, far = pty.openpty()
            tty.setraw(far)
            # What a reader that is gone doesn't take is lost, and holds nobody up.
            os.set_blocking(near, False)
            path = folder / name
            path.symlink_to(os.ttyname(far))
            self.ends.append((near, far))
            self.paths.append(path)
        self.cut = False
        self.slow = False
        self.duplicate = False
        self.delay_s = 0.0
        self.garbage = None
        self.over = False
        self.thread = threading.Thread(target=self.carry, daemon=True)
        self.thread.start()

    def carry(self):
        nears = [near for near, _ in self.ends]
        while not self.over:
            ready, _, _ = select.select(nears, [], [], 0.02)
            garbage = self.garbage
            if garbage is not None:
                for near in nears:
                    self.write(near, garbage.randbytes(200))
            for near in ready:
                try:
                    data = os.read(near, 64 if self.slow else 4096)
                except OSError:
                    continue
                if self.cut:
                    continue
                if self.slow:
                    time.sleep(0.02)
                if self.delay_s:
                    time.sleep(self.delay_s)
                other = nears[1 - nears.index(near)]
                self.write(other, data)
                if self.duplicate and near == nears[1]:
                    self.write(other, data)

    @staticmethod
    def write(near, data):
        _, writable, _ = select.select([], [near], [], 0.05)
        if writable:
            try:
                os.write(near, data)
            except OSError:
                pass

    def close(self):
        self.over = True
        self.thread.join()
        for path, (near, far) in zip(self.paths, self.ends):
            os.close(near)
            os.close(far)
            path.unlink(missing_ok=True)


def device(folder, scenario, line):
    return popen(
        [OCTANT, "serve", scenario, "--endpoint", f"serial:{line.paths[1]}", "--silence", "1"],
        stdout=subprocess.DEVNULL,
        stderr=open(folder / "serve.log", "a"),
    )


def harness(folder, scenario, line, more=(), out=None):
    out = out or folder / "run"
    return popen(
        [OCTANT, "run", scenario, "--endpoint", f"serial:{line.paths[0]}", "--out", out, "--force", *more],
        stdout=open(folder / "run.out", "w"),
        stderr=open(folder / "run.log", "w"),
    )


def recorded(path):
    """Seconds of samples in a recording, however it ended, and its events."""
    last, events = 0, []
    if not path.exists():
        return 0.0, ["there is no recording"]
    try:
        with open(path, "rb") as file:
            for _, channel, message in NonSeekingReader(file).iter_messages(log_time_order=False):
                if "sample" in channel.topic or "output" in channel.topic:
                    last = max(last, message.log_time)
                elif "event" in channel.topic:
                    events.append(json.loads(message.data))
    # The reader says in any of these ways that the file ends within a record.
    except (McapError, EOFError, ValueError, struct.error) as error:
        if not last:
            return 0.0, [f"{type(error).__name__}: {error}"]
    return last * 1e-9, events


def share():
    """How much of a processor is left to one who computes."""
    wall, cpu = time.monotonic(), time.thread_time()
    while time.thread_time() < cpu + 0.02:
        pass
    return min(1.0, 0.02 / (time.monotonic() - wall))


def wait(process, seconds):
    """The status; None where it isn't there in seconds, of which a busy host gives only a share."""
    given = 0.0
    while given < seconds:
        began = time.monotonic()
        try:
            return process.wait(1)
        except subprocess.TimeoutExpired:
            given += (time.monotonic() - began) * share()
    process.kill()
    process.wait()
    return None


class Case:
    """One thing that goes wrong in a run of some seconds."""

    duration_s = 4
    realtime = True
    # Exit statuses that are right. A process that was killed has none of these.
    statuses = (0, 3, 4)

    def during(self, bench):
        """Does it, after a while of the run."""

    # The recording ends early.
    fills_disk = False
    # A fault that the run has.
    fault = None

    def scenario(self):
        return SCENARIO.replace("DURATION", f"{self.duration_s} s")

    def faulted_scenario(self):
        if not self.fault:
            return self.scenario()
        fault = f'[[faults]]\nid = "f"\nkind = "{self.fault}"\ntrigger = {{ at = "1.5 s" }}\n'
        return self.scenario().replace("[realtime]", '[realtime]\npace = "clock"') + fault

    def after(self, bench, status):
        """What has to be so beside the usual."""


class Nothing(Case):
    statuses = (0, 3)


class KillDevice(Case):
    statuses = (4,)

    def during(self, bench):
        bench.device.kill()

    def after(self, bench, status):
        bench.expect("no answer" in bench.said or "gone" in bench.said, "the error names it")


class KillHarness(Case):
    statuses = (-signal.SIGKILL,)

    def during(self, bench):
        bench.harness.kill()


class Interrupt(Case):
    statuses = (3,)

    def during(self, bench):
        bench.harness.send_signal(signal.SIGINT)


class Cut(Case):
    statuses = (4,)

    def during(self, bench):
        bench.line.cut = True


class CutForAMoment(Case):
    """Less than the silence that ends a run: samples are lost, and told."""

    statuses = (3, 4)

    def during(self, bench):
        bench.line.cut = True
        time.sleep(0.3)
        bench.line.cut = False


class CutForAMomentInLockStep(Case):
    realtime = False
    duration_s = 20
    statuses = (0,)

    def during(self, bench):
        bench.line.cut = True
        time.sleep(0.5)
        bench.line.cut = False


class Garbage(Case):
    statuses = (0, 3, 4)

    def during(self, bench):
        bench.line.garbage = random.Random(bench.random.random())
        time.sleep(1.0)
        bench.line.garbage = None


class GarbageInLockStep(Garbage):
    realtime = False
    duration_s = 20
    statuses = (0,)


class Twice(Case):
    def during(self, bench):
        bench.line.duplicate = True


class Late(Case):
    """Answers come too late for their period, and the run is told to bear that."""

    def during(self, bench):
        bench.line.delay_s = 0.02
        time.sleep(0.5)
        bench.line.delay_s = 0.0

    def after(self, bench, status):
        summary = bench.out / "summary.json"
        if summary.exists():
            late = json.loads(summary.read_text())["pacing"]["late_answers"]
            bench.expect(late > 10, f"{late} late answers were told, more are expected")


class SlowReader(Case):
    def during(self, bench):
        bench.line.slow = True


class Unplugged(Case):
    """The port itself goes away."""

    statuses = (4,)

    def during(self, bench):
        bench.unplug()


class FullDisk(Case):
    statuses = (4,)
    duration_s = 15
    fills_disk = True

    def after(self, bench, status):
        bench.expect("o space left" in bench.said or "File too large" in bench.said, "the error names it")


class HostFault(Case):
    """What the harness does to its own host."""

    statuses = (0, 3)

    def after(self, bench, status):
        summary = bench.recording.parent / "summary.json"
        if not summary.exists():
            bench.expect(False, "there is a summary")
            return
        summary = json.loads(summary.read_text())
        # A run that broke off for another reason may not have come that far.
        if status != 4 or self.fills_disk:
            bench.expect(summary["faults"][0]["fired"], "the fault fired")


class Starved(HostFault):
    fault = "host-cpu-starved"
    # The device is starved too.
    statuses = (0, 3, 4)


class Stalled(HostFault):
    fault = "host-recorder-stalled"


class DiskFilled(HostFault, FullDisk):
    fault = "host-disk-full"
    statuses = (4,)
    duration_s = 4

    def after(self, bench, status):
        FullDisk.after(self, bench, status)
        HostFault.after(self, bench, status)


CASES = [
    Nothing, KillDevice, KillHarness, Interrupt, Cut, CutForAMoment, CutForAMomentInLockStep, Garbage,
    GarbageInLockStep, Twice, Late, SlowReader, Unplugged, FullDisk, Starved, Stalled,
    DiskFilled,
]


class Bench:
    def __init__(self, number, case, rng):
        self.case, self.random = case, rng
        self.name = f"{number} {type(case).__name__}"
        self.failed = []

    def expect(self, is_so, what):
        if not is_so:
            self.failed.append(what)

    def unplug(self):
        self.line.over = True
        self.line.thread.join()
        near, far = self.line.ends[0]
        os.close(near)
        os.close(far)
        self.line.ends[0] = pty.openpty()

    def run(self):
        case = self.case
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            scenario = folder / "scenario.toml"
            scenario.write_text(case.faulted_scenario())
            # The device's, and that of the next run.
            plain = folder / "plain.toml"
            plain.write_text(case.scenario())
            out = folder / "run"
            mounted = False
            if type(case) is FullDisk:
                small = folder / "small"
                small.mkdir()
                mounted = not subprocess.run(
                    ["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", small], stderr=subprocess.DEVNULL
                ).returncode
                if not mounted:
                    return "not done: mount needs root"
                out = small / "run"
            self.out = out
            self.line = Line(folder)
            self.device = device(folder, plain, self.line)
            more = ["--realtime"] if case.realtime else []
            self.harness = harness(folder, scenario, self.line, more, out)
            began = time.monotonic()
            partial = Path(f"{out}.partial") / "recording.mcap"
            while not partial.exists() and self.harness.poll() is None:
                if time.monotonic() - began > LONG_S:
                    self.harness.kill()
                time.sleep(0.01)
            recording_began = time.monotonic()
            time.sleep(self.random.uniform(0.2, 1.5) if case.realtime else 0.1)
            happened = time.monotonic() - recording_began
            case.during(self)
            status = wait(self.harness, 20)
            took = time.monotonic() - began
            self.said = (folder / "run.log").read_text() + (folder / "run.out").read_text()
            self.expect(status in case.statuses, f"status {status}, expected one of {case.statuses}")
            self.expect(status is not None, "it hung for 20 s")
            self.expect("panicked" not in self.said, "it panicked")
            if status == 4:
                self.expect("error: " in self.said or "octant: " in self.said or "reasons" in self.said, "an error in words")
            recording = out / "recording.mcap"
            if not recording.exists():
                recording = partial
            self.recording = recording
            if case.fills_disk:
                seconds, _ = recorded(recording)
                self.expect(seconds > 0.2, f"{seconds:.2f} s recorded before the disk was full")
            elif case.realtime:
                seconds, events = recorded(recording)
                least = min(happened, case.duration_s) - 1.0
                self.expect(seconds >= least, f"{seconds:.2f} s recorded, {least:.2f} s were over: {events[-1:]}")
            case.after(self, status)
            # Released: the same port, the same device, a run that is short and good.
            self.line.cut = self.line.slow = self.line.duplicate = False
            self.line.delay_s, self.line.garbage = 0.0, None
            if not isinstance(case, Unplugged):
                if self.device.poll() is not None:
                    self.device = device(folder, plain, self.line)
                status = wait(harness(folder, plain, self.line, out=folder / "again"), 30)
                said = (folder / "run.log").read_text()
                self.expect(status == 0, f"the next run on the port: status {status}: {said}")
            self.device.send_signal(signal.SIGINT)
            self.expect(wait(self.device, 5) in (0, 4), "the device ends on SIGINT")
            self.line.close()
            if mounted:
                subprocess.run(["umount", small], check=True)
            if self.failed:
                print(self.said, (folder / "serve.log").read_text(), sep="\n--\n")
            return f"{took:.1f} s"


def main():
    rng = random.Random(SEED)
    end = time.monotonic() + SECONDS
    number, failed, order = 0, 0, []
    # Each once before any comes again.
    while time.monotonic() < end or order:
        if not order:
            if time.monotonic() >= end:
                break
            order = rng.sample(CASES, len(CASES))
        number += 1
        bench = Bench(number, order.pop()(), rng)
        took = bench.run()
        print(f"{'FAIL' if bench.failed else 'ok  '} {bench.name}: {took} {'; '.join(bench.failed)}", flush=True)
        failed += bool(bench.failed)
        if time.monotonic() >= end and number >= len(CASES):
            break
    print(f"{number} times something went wrong, seed {SEED}: {failed} of them not as it has to be")
    sys.exit(1 if failed else 0)


main()
