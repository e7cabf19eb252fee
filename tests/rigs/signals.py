"""Signals to a campaign and a night, at moments that a seed gives. See tests/rigs/signals."""

import collections
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from children import popen

OCTANT, SIGNALS, SEED = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
# A command that takes longer hangs.
HANGS_S = 300
TABLES = ["cases.parquet", "checks.parquet", "drift.parquet"]
SCENARIO = """schema = 1
title = "short"
seed = 1
[imu]
rate = "100 Hz"
[procedure.calibration]
positions = "eight"
duration = "HOURS h"
[procedure.navigation]
duration = "HOURS h"
[[requirements]]
id = "NAV-1"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "100 nmi"
"""
CAMPAIGN = """schema = 1
title = "disturbed"
replicates = 10
[[scenarios]]
id = "short"
file = "short.toml"
"""
SUITE = """schema = 1
[[cases]]
scenario = "short.toml"
expect = "pass"
[[cases]]
scenario = "again.toml"
expect = "pass"
"""
KINDS = ["INT", "TERM", "HUP", "STOP", "KILL"]
TARGETS = ["parent", "group", "child"]
failed = []


def expect(is_so, what):
    if not is_so:
        failed.append(what)
        print(f"FAIL {what}", flush=True)


def stat(pid):
    """State and parent of a process that lives."""
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return None
    return None if words[0] in "ZX" else (words[0], int(words[1]))


def children(parent):
    pids = (int(name) for name in os.listdir("/proc") if name.isdigit())
    return [pid for pid in pids if (stat(pid) or ("", 0))[1] == parent]


def send(kind, send_to):
    number = getattr(signal, f"SIG{kind}")
    try:
        send_to(number)
    except ProcessLookupError:
        # It has ended by itself.
        pass


class Command:
    """A command with its words, started until it ends by itself."""

    def __init__(self, folder, words):
        self.folder, self.words = folder, words
        self.seen = set()
        self.start()

    def start(self):
        self.process = popen(
            [OCTANT, *self.words],
            cwd=self.folder,
            start_new_session=True,
            stdout=open(self.folder / "out", "w"),
            stderr=open(self.folder / "err", "w"),
        )

    def said(self):
        return (self.folder / "out").read_text() + (self.folder / "err").read_text()

    def disturb(self, rng, kind, target):
        """Sends one signal; whether anybody was there to get it."""
        until = time.monotonic() + rng.choice([rng.uniform(0, 0.05), rng.uniform(0, 0.6)])
        mine = []
        while time.monotonic() < until:
            mine = children(self.process.pid)
            self.seen.update(mine)
            time.sleep(0.005)
        if self.process.poll() is not None:
            return False
        mine = children(self.process.pid)
        self.seen.update(mine)
        pid = self.process.pid
        if target == "child" and not mine:
            return False
        one = rng.choice(mine) if target == "child" else None
        to = {
            "parent": lambda number: os.kill(pid, number),
            "group": lambda number: os.killpg(pid, number),
            "child": lambda number: os.kill(one, number),
        }[target]
        send(kind, to)
        if kind == "STOP":
            time.sleep(rng.uniform(0.05, 0.4))
            send("CONT", to)
        return True

    def wait(self):
        """Its exit status, with nothing left behind."""
        try:
            status = self.process.wait(HANGS_S)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            status = self.process.wait()
            expect(False, f"{self.words[0]}: it hung")
        until = time.monotonic() + HANGS_S
        while any(stat(pid) for pid in self.seen) and time.monotonic() < until:
            time.sleep(0.005)
        expect(not any(stat(pid) for pid in self.seen), f"{self.words[0]}: a process is left behind")
        self.seen.clear()
        return status


def crashed(folder):
    """Results that only a signal explains, and cases with two of them, of every campaign in a folder."""
    found = []
    for plan in sorted(folder.rglob("plan.json")):
        said = subprocess.run([OCTANT, "campaign", "status", plan.parent, "--json"], capture_output=True, text=True)
        if not said.stdout:
            found.append(said.stderr)
            continue
        state = json.loads(said.stdout)
        signs = ("crashed", "signal: ", "took more than", "took too long")
        found += state["differing"] + [bad for bad in state["bad"] if any(words in bad["reason"] for words in signs)]
    return found


def left(folder):
    """Files and folders that aren't whole."""
    ends = (".new", ".partial", ".replaced", ".again")
    return [path for path in folder.rglob("*") if path.name.endswith(ends)]


def tables(folder):
    return [(folder / name).read_bytes() for name in TABLES]


class Rounds:
    """Signals, and the same command after each that ended it."""

    def __init__(self, rng):
        self.rng, self.count, self.kinds = rng, 0, collections.Counter()
        self.order = []
        # Ends by a case that was ended three times.
        self.met = 0

    def run(self, folder, words):
        """One piece of work; the exit status with which it ended by itself."""
        command = Command(folder, words)
        in_a_row = 0
        while True:
            # Every kind with every target before any comes again.
            if not self.order:
                self.order = [(kind, target) for kind in KINDS for target in TARGETS]
                self.rng.shuffle(self.order)
            sent = None
            # Work that is never left alone doesn't end.
            if self.count < SIGNALS and in_a_row < 5:
                kind, target = self.order.pop()
                if command.disturb(self.rng, kind, target):
                    self.count += 1
                    in_a_row += 1
                    self.kinds[f"{kind} {target}"] += 1
                    sent = kind, target
                else:
                    self.order.insert(0, (kind, target))
            if self.count < SIGNALS and in_a_row < 5 and command.process.poll() is None:
                if sent is None or sent[0] == "STOP" or sent[1] == "child":
                    # It goes on, and gets the next one.
                    continue
            status = command.wait()
            by_signal = [-getattr(signal, f"SIG{kind}") for kind in ("INT", "TERM", "HUP", "KILL")]
            # One case that was met each time that it ran: the bench failed, and says so.
            met = status == 4 and "was ended from outside 3 times" in command.said()
            self.met += met
            broken_off = status == 3 or status in by_signal or met
            if not broken_off:
                return status, command.said()
            expect(in_a_row > 0, f"{words[0]}: status {status} without a signal: {command.said()}")
            expect(not crashed(folder), f"{words[0]}: {sent}: {crashed(folder)}")
            if failed:
                return status, command.said()
            command.start()


def campaign(folder, rng):
    plan = ["campaign", "plan", "signals.toml", "--out"]
    run = ["campaign", "run", "torn", "--jobs", "2"]
    for name in ("whole", "torn"):
        subprocess.run([OCTANT, *plan, name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([OCTANT, "campaign", "run", "whole"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([OCTANT, "campaign", "merge", "whole"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    rounds = Rounds(rng)
    times = 0
    while rounds.count < SIGNALS and not failed:
        times += 1
        shutil.rmtree(folder / "torn/results", ignore_errors=True)
        shutil.rmtree(folder / "torn/parts", ignore_errors=True)
        status, said = rounds.run(folder, run)
        expect(status == 0, f"campaign: status {status}: {said}")
        if failed:
            break
        subprocess.run([OCTANT, "campaign", "merge", "torn"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        expect(tables(folder / "torn") == tables(folder / "whole"), "campaign: other bytes than undisturbed")
        expect(not crashed(folder / "torn"), f"campaign: {crashed(folder / 'torn')}")
        expect(not left(folder), f"campaign: left over: {left(folder)}")
    return rounds, times


def nightly(folder, rng):
    run = ["nightly", "signals.toml", "--suite", "suite.toml", "--history", "h", "--json", "--jobs", "2"]
    first = subprocess.run([OCTANT, *run, "--first"], cwd=folder, capture_output=True, text=True)
    expect(first.returncode == 0, f"nightly: status {first.returncode}: {first.stdout}{first.stderr}")
    if failed:
        return Rounds(rng), 0
    nights = folder / "h/nights"
    whole = tables(nights / json.loads(first.stdout)["night"] / "signals")
    rounds = Rounds(rng)
    times = 0
    while rounds.count < SIGNALS and not failed:
        times += 1
        status, said = rounds.run(folder, run)
        expect(status == 0, f"nightly: status {status}: {said}")
        if failed:
            break
        night = json.loads((folder / "out").read_text())
        expect(night["reasons"][0] == "no regression found", f"nightly: {night['reasons']}")
        expect(tables(nights / night["night"] / "signals") == whole, "nightly: other bytes than undisturbed")
        expect(not left(folder / "h"), f"nightly: left over: {left(folder / 'h')}")
    return rounds, times


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "signals.toml").write_text(CAMPAIGN)
        (folder / "suite.toml").write_text(SUITE)
        for name, hours in (("short", 1), ("again", 1.5)):
            (folder / f"{name}.toml").write_text(SCENARIO.replace("HOURS", str(hours)))
        for number, work in enumerate((campaign, nightly)):
            began = time.monotonic()
            rounds, times = work(folder, random.Random(SEED + number))
            took = time.monotonic() - began
            print(
                f"{'FAIL' if failed else 'ok  '} {work.__name__}: {rounds.count} signals, "
                f"{len(rounds.kinds)} kinds of signal and target, came to its end {times} times, {took:.0f} s",
                flush=True,
            )
            if failed:
                break
    print(f"seed {SEED}: {len(failed)} things not as they have to be")
    sys.exit(1 if failed else 0)


main()
