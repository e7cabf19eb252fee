"""Which instructions of a program are executed in runs and reports: breakpoints that are hit once.

A copy of the program has a breakpoint in place of each instruction that takes a constant. Whoever hits one
is noted, gets the instruction back, and goes on; so do its threads and the programs that it starts.
"""

import ctypes
import os
import signal
import struct
import subprocess

import elf
import shown

libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.restype = ctypes.c_long
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
TRACEME, PEEKUSER, POKEUSER, CONT, SETOPTIONS, GETEVENTMSG = 0, 3, 6, 7, 0x4200, 0x4201
# Threads, forks, programs that begin; all ends with the tracer.
OPTIONS = 0x2 | 0x4 | 0x8 | 0x10 | 0x100000
RIP = 16 * 8
ALL = 0x40000000  # __WALL
BREAKPOINT = b"\xcc"


def ptrace(request, thread, address=0, data=0):
    ctypes.set_errno(0)
    result = libc.ptrace(request, thread, address, data)
    if result == -1 and ctypes.get_errno():
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result


def base_of(thread, program):
    with open(f"/proc/{thread}/maps") as maps:
        for line in maps:
            if line.rstrip().endswith(str(program)):
                return int(line.split("-")[0], 16)
    return None


class Tracer:
    """A copy of the program with breakpoints, and what was hit of it."""

    def __init__(self, program, sites, folder):
        self.program = folder / "octant-reach"
        subprocess.run(["objcopy", "--strip-debug", program, self.program], check=True)
        data = self.program.read_bytes()
        text_address, text_offset, _ = elf.sections(data)[".text"]
        self.before = {site: data[site - text_address + text_offset:][:1] for site in sites}
        with open(self.program, "r+b") as file:
            for site in sites:
                file.seek(site - text_address + text_offset)
                file.write(BREAKPOINT)
        self.hits = set()
        self.bases = {}

    def stopped(self, thread):
        """Handles a trap; whether it was one of ours."""
        rip = ptrace(PEEKUSER, thread, RIP) & (2**64 - 1)
        if thread not in self.bases:
            self.bases[thread] = base_of(thread, self.program)
        base = self.bases[thread]
        site = None if base is None else rip - 1 - base
        if site not in self.before:
            return False
        self.hits.add(site)
        with open(f"/proc/{thread}/mem", "r+b", buffering=0) as memory:
            memory.seek(rip - 1)
            # Another thread may have got it back already.
            memory.write(self.before[site])
        ptrace(POKEUSER, thread, RIP, rip - 1)
        return True

    def run(self, words, folder):
        """Runs the copy with these words, and everything that it starts; its exit status."""
        first = os.fork()
        if first == 0:
            os.chdir(folder)
            with open("said.txt", "ab") as said:
                os.dup2(said.fileno(), 1)
                os.dup2(said.fileno(), 2)
            ptrace(TRACEME, 0)
            os.execv(self.program, ["octant", *words])
        options_set, status_of_first = False, None
        self.bases = {}
        while True:
            try:
                thread, status = os.waitpid(-1, ALL)
            except ChildProcessError:
                return status_of_first
            if os.WIFEXITED(status) or os.WIFSIGNALED(status):
                self.bases.pop(thread, None)
                if thread == first:
                    status_of_first = os.waitstatus_to_exitcode(status)
                continue
            deliver, event = os.WSTOPSIG(status), status >> 16
            if thread == first and not options_set:
                ptrace(SETOPTIONS, thread, 0, OPTIONS)
                options_set, deliver = True, 0
            elif event:
                # A new program has other addresses.
                self.bases.pop(thread, None)
                deliver = 0
            elif deliver == signal.SIGTRAP and self.stopped(thread):
                deliver = 0
            elif deliver == signal.SIGSTOP:
                # A thread or process that has just begun.
                deliver = 0
            try:
                ptrace(CONT, thread, 0, deliver)
            except ProcessLookupError:
                continue


def executed(program, constants, root, folder):
    """The instructions that the runs and reports execute, with the groups of commands that do."""
    sites = {site for constant in constants for site in constant["sites"]}
    tracer = Tracer(program, sites, folder)
    place = folder / "runs"
    place.mkdir(exist_ok=True)
    found = {}
    for group, commands in enumerate(shown.groups(root)):
        for line, words, expected in commands:
            before = len(found)
            tracer.hits = set()
            status = tracer.run(words, place)
            for site in tracer.hits:
                found.setdefault(site, set()).add(group)
            print(f"  {len(found) - before:5} more of {len(sites)} instructions by octant {line}: {status}", flush=True)
            if status not in expected:
                said = (place / "said.txt").read_text(errors="replace")[-1500:]
                raise SystemExit(f"octant {line} ended with {status}, not {expected}:\n{said}")
    return found
