#!/usr/bin/env python3
"""Runs one command of tests/run and ends with it: nothing that the command started outlives it.

    step.py LOG COMMAND...          output of the command goes to the file LOG
    step.py --live LOG COMMAND...   and to the terminal, while the command runs
    step.py --whole COMMAND...      output and input are those of step.py: tests/run itself

The exit status is that of the command. A process that is left running when the command has ended is named, ended,
and makes a status of 1: a test or a rig has lost it. A signal to step.py ends the command and all that it started.
There is no pipe between the command and the log, so no process can hold this up by holding the output open.

On Linux every descendant is found, also a daemon: step.py is their subreaper. Elsewhere only the command's process
group is ended.
"""

import ctypes
import os
import select
import signal
import subprocess
import sys
import time

# What a process that the command has left behind may take to end by itself, on a host that does something else: the
# guard of a turntable ends when it sees that its harness has gone. Afterwards it is an error.
GRACE_S = 20.0
# From a request to end to the end by force.
ENDING_S = 5.0
# Compilers' caches that a build starts for the builds after it.
LEFT_ALONE = {"sccache"}
# The process whose end ends every step, in the environment of those.
WHOLE = "OCTANT_TESTS_RUN"
PR_SET_CHILD_SUBREAPER = 36
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)


def become_subreaper():
    """Makes orphans among the descendants children of this process."""
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def descendants():
    """Processes below this one that live: number, name."""
    children, names = {}, {}
    for entry in os.listdir("/proc") if sys.platform == "linux" else []:
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", encoding="utf-8", errors="replace") as file:
                # The name is in parentheses and may have anything in it.
                name, _, rest = file.read().partition("(")[2].rpartition(")")
        except OSError:
            continue
        state, parent = rest.split()[:2]
        children.setdefault(int(parent), []).append(int(entry))
        if state not in "ZX":
            names[int(entry)] = name
    found, open_ends = [], [os.getpid()]
    while open_ends:
        below = children.get(open_ends.pop(), [])
        open_ends += below
        found += [(process, names[process]) for process in below if process in names]
    return found


def command_line(process):
    """The command line of a process, in one printable line."""
    try:
        with open(f"/proc/{process}/cmdline", "rb") as file:
            words = file.read().decode("utf-8", "replace").split("\0")
    except OSError:
        return ""
    line = "".join(c if c.isprintable() else "?" for c in " ".join(words).strip())
    return line if len(line) <= 300 else line[:300] + " …"


def send(process, number):
    """Sends a signal to a process that may have gone."""
    try:
        os.kill(process, number)
    except (ProcessLookupError, PermissionError):
        pass


def begin_group():
    """Begins a process group, in which reading or setting the terminal fails and does not stop a process.

    It is no session: where Linux schedules sessions (sched_autogroup_enabled), each has an equal share of the processors,
    however nice its processes are, and however many of them wait.
    """
    os.setpgrp()
    signal.signal(signal.SIGTTIN, signal.SIG_IGN)
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)


class Terminal:
    """Copies what is added to the log to the terminal."""

    def __init__(self, log):
        self.file = open(log, "rb") if log else None

    def copy(self):
        while self.file and (piece := self.file.read(1 << 16)):
            try:
                sys.stdout.buffer.write(piece)
                sys.stdout.buffer.flush()
            except OSError:
                # A terminal that was closed loses what is shown; the log has it.
                self.file = None


class Step:
    def __init__(self, command, log, live):
        self.signalled = None
        self.status = None
        # A signal ends the wait for the next event.
        self.woken, waking = os.pipe()
        for end in (self.woken, waking):
            os.set_blocking(end, False)
        signal.set_wakeup_fd(waking, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        for number in SIGNALS:
            signal.signal(number, self.on_signal)
        self.events = select.poll()
        self.events.register(self.woken, select.POLLIN)
        self.whole_is_gone = False
        self.watch_whole(log)
        become_subreaper()
        out = open(log, "ab", buffering=0) if log else None
        self.terminal = Terminal(log if live else None)
        self.live = live
        self.log = out
        # A process group of its own, but for the whole, whose group has the terminal.
        self.child = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL if log else None,
            stdout=out,
            stderr=out,
            preexec_fn=begin_group if log else None,
        )
        self.group = self.child.pid if log else None

    def watch_whole(self, log):
        """Notices the end of tests/run itself, also by SIGKILL."""
        if not log:
            os.environ[WHOLE] = str(os.getpid())
        elif (whole := os.environ.get(WHOLE)) and hasattr(os, "pidfd_open"):
            try:
                self.events.register(os.pidfd_open(int(whole)), select.POLLIN)
            except ProcessLookupError:
                sys.exit(128 + signal.SIGTERM)

    def on_signal(self, number, _):
        self.signalled = self.signalled or number

    def wait(self, limit_s):
        """Waits for the next event; takes in processes that have ended."""
        for fd, _ in self.events.poll(limit_s * 1000.0):
            if fd == self.woken:
                try:
                    os.read(self.woken, 1 << 12)
                except BlockingIOError:
                    pass
            else:
                self.whole_is_gone = True
                self.events.unregister(fd)
        self.reap()
        self.terminal.copy()

    def reap(self):
        """Takes in every child that has ended, its own and those that were left to it."""
        while True:
            try:
                process, status = os.waitpid(-1, os.WNOHANG)
            except ChildProcessError:
                return
            if process == 0:
                return
            if process == self.child.pid:
                self.status = os.waitstatus_to_exitcode(status)
                self.child.returncode = self.status

    def run(self):
        """Waits for the command; returns its exit status, or that of the signal that ended it."""
        while self.status is None and not self.signalled and not self.whole_is_gone:
            self.wait(0.2 if self.live else 5.0)
        if self.status is None:
            self.end_all()
            return 128 + (self.signalled or signal.SIGTERM)
        status = self.status if self.status >= 0 else 128 - self.status
        left = self.left()
        until = time.monotonic() + GRACE_S
        while left and time.monotonic() < until and not self.signalled:
            self.wait(0.1)
            left = self.left()
        for process, name in left:
            self.say(f"left running: {process} {command_line(process) or name}")
        self.end_all()
        # A skip would hide it.
        return 1 if left and status in (0, 77) else status

    def left(self):
        return [(process, name) for process, name in descendants() if name not in LEFT_ALONE]

    def end_all(self):
        """Ends everything below: by request, then by force."""
        begun = time.monotonic()
        asked = set()
        if self.group and sys.platform != "linux":
            send(-self.group, signal.SIGTERM)
        while living := self.left():
            waited_s = time.monotonic() - begun
            if waited_s > 3.0 * ENDING_S:
                self.say("can't be ended: " + ", ".join(f"{process} {name}" for process, name in living))
                break
            for process, _ in living:
                if waited_s > ENDING_S:
                    send(process, signal.SIGKILL)
                elif process not in asked:
                    send(process, signal.SIGTERM)
                    # A stopped process hears no request.
                    send(process, signal.SIGCONT)
                    asked.add(process)
            self.wait(0.05)
        if self.group and sys.platform != "linux":
            send(-self.group, signal.SIGKILL)
        self.terminal.copy()

    def say(self, line):
        if self.log:
            self.log.write(f"{line}\n".encode())
            self.terminal.copy()
        else:
            print(line, flush=True)


def main(arguments):
    mode = arguments.pop(0) if arguments[:1] in (["--live"], ["--whole"]) else None
    log = None if mode == "--whole" or not arguments else arguments.pop(0)
    if not arguments:
        sys.exit(__doc__)
    if log:
        open(log, "wb").close()
    step = Step(arguments, log, mode == "--live")
    status = step.run()
    if mode == "--whole" and step.signalled:
        # As the terminal's shell expects it.
        signal.signal(step.signalled, signal.SIG_DFL)
        os.kill(os.getpid(), step.signalled)
    sys.exit(status)


if __name__ == "__main__":
    main(sys.argv[1:])
