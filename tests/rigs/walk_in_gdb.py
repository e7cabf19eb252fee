"""Run by gdb: stops at functions, and writes the order in which the thread of the fault first calls them, step by step.

The functions before the first step come as they are called; then those of the step in which every station was passed.
"""

import json
import os

import gdb

STATIONS = json.load(open(os.environ["OCTANT_STATIONS"]))
# The station that tells the thread of the fault, and the function with which a step begins.
FAULT, STEP = "on_epoch", "before"
# Steps after the first one with the fault: the truth is scored in one of them.
STEPS = 6
calls = []


class Stop(gdb.Breakpoint):
    def __init__(self, place, name):
        super().__init__(place)
        self.name = name

    def stop(self):
        calls.append((gdb.selected_thread().ptid, self.name))
        # Every stop costs far more than a step: the run isn't followed to its end.
        return self.name.endswith(" " + STEP) and self.is_enough()

    def is_enough(self):
        thread = next((of for of, name in calls if name.endswith(" " + FAULT)), None)
        if thread is None:
            return False
        first = next(place for place, (of, name) in enumerate(calls) if name.endswith(" " + FAULT))
        return sum(of == thread and name.endswith(" " + STEP) for of, name in calls[first:]) > STEPS


def first_line(file, begin, end):
    """The first line of a body that has code. gdb goes on to it by itself; each question costs it seconds."""
    found = gdb.decode_line(f"{file}:{begin}")[1] or ()
    lines = [place.line for place in found if begin <= place.line <= end]
    if not lines:
        raise gdb.GdbError(f"{file}:{begin}: no code")
    return min(lines)


gdb.execute("set pagination off")
gdb.execute("set breakpoint pending off")
gdb.execute("set print thread-events off")
for file, function, begin, end in STATIONS:
    Stop(f"{file}:{first_line(file, begin, end)}", f"{file} {function}")
gdb.execute("run", to_string=True)

thread = next((of for of, name in calls if name.endswith(" " + FAULT)), None)
whole, step, before = [], [], []
for of, name in calls:
    if of != thread:
        # The program's main thread begins, the run goes on in one of its own.
        if not whole and not step and name not in before:
            before.append(name)
        continue
    if name.endswith(" " + STEP):
        whole, step = max(whole, step, key=len), [name]
    elif step:
        step += [name] if name not in step else []
    elif name not in before:
        before.append(name)
whole = max(whole, step, key=len)
order = [name for name in before if name not in whole] + whole
json.dump(order, open(os.environ["OCTANT_WALK"], "w"))
gdb.execute("kill")
