#!/usr/bin/env python3
"""Steps a calibrator FMU with FMPy over recorded samples and compares every output bit for bit.

Usage: fmpy_steps.py FMU COLUMNS.npz PARAMETERS.csv [--from K] [--to K] [--restore FILE] [--save FILE]

COLUMNS.npz is of columns.py. A save at the end of one process and a restore at the beginning of
another carry the state as bytes. With --event-mode an FMI 3.0 FMU gets its inputs in event mode.
"""

import argparse
import pathlib
import shutil
import sys
import time

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

import variables

STEP_S = 0.005


class Fmi2:
    """FMI 2.0."""

    def __init__(self, description, folder, event_mode):
        self.fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="calibrator",
                             modelIdentifier=description.coSimulation.modelIdentifier)
        self.fmu.instantiate()

    def begin(self, parameters):
        self.fmu.setupExperiment(startTime=0.0)
        self.set(parameters, 0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, groups, row):
        for group in groups:
            function = getattr(self.fmu, "fmi2Set" + group.kind)
            function(self.fmu.component, group.reference_array, len(group.references),
                     group.row(row))

    def get(self, groups, row):
        for group in groups:
            function = getattr(self.fmu, "fmi2Get" + group.kind)
            function(self.fmu.component, group.reference_array, len(group.references),
                     group.row(row))

    def step(self, groups, row, now):
        self.set(groups, row)
        self.fmu.doStep(now, STEP_S)

    def state(self):
        return self.fmu.serializeFMUstate(self.fmu.getFMUstate())

    def restore(self, data):
        self.fmu.setFMUstate(self.fmu.deSerializeFMUstate(data))


class Fmi3:
    """FMI 3.0, with or without event mode."""

    def __init__(self, description, folder, event_mode):
        self.fmu = FMU3Slave(guid=description.guid, unzipDirectory=folder, instanceName="calibrator",
                             modelIdentifier=description.coSimulation.modelIdentifier)
        self.event_mode = event_mode
        self.fmu.instantiate(eventModeUsed=event_mode)

    def begin(self, parameters):
        self.set(parameters, 0)
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()
        if self.event_mode:
            self.discrete()

    def discrete(self):
        while self.fmu.updateDiscreteStates()[0]:
            pass
        self.fmu.enterStepMode()

    def call(self, what, groups, row):
        for group in groups:
            name = {"Bool": "Boolean"}.get(group.kind, group.kind)
            function = getattr(self.fmu, f"fmi3{what}{name}")
            pointer = group.row(row)
            if group.kind == "Bool":
                # A C bool is a byte.
                from ctypes import POINTER, c_bool, cast
                pointer = cast(pointer, POINTER(c_bool))
            function(self.fmu.component, group.reference_array, len(group.references), pointer,
                     group.width)

    def set(self, groups, row):
        self.call("Set", groups, row)

    def get(self, groups, row):
        self.call("Get", groups, row)

    def step(self, groups, row, now):
        if self.event_mode:
            self.fmu.enterEventMode()
        self.set(groups, row)
        if self.event_mode:
            self.discrete()
        self.fmu.doStep(now, STEP_S)

    def state(self):
        return self.fmu.serializeFMUState(self.fmu.getFMUState())

    def restore(self, data):
        self.fmu.setFMUState(self.fmu.deserializeFMUState(data))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu")
    parser.add_argument("columns")
    parser.add_argument("parameters")
    parser.add_argument("--from", dest="first", type=int, default=0)
    parser.add_argument("--to", type=int)
    parser.add_argument("--restore")
    parser.add_argument("--save")
    parser.add_argument("--event-mode", action="store_true")
    arguments = parser.parse_args()

    columns = np.load(arguments.columns)
    pick = lambda prefix: {name[len(prefix):]: columns[name] for name in columns.files
                           if name.startswith(prefix)}
    inputs, expected, known = pick("in "), pick("out "), columns["parameter rows"]
    last = arguments.to or len(known)

    description = read_model_description(arguments.fmu)
    folder = extract(arguments.fmu)
    try:
        kind = Fmi2 if description.fmiVersion == "2.0" else Fmi3
        instance = kind(description, folder, arguments.event_mode)
        start = variables.parameters(arguments.parameters)
        start["imu.external_stamps"] = np.array([[1.0]])
        instance.begin(variables.grouped(description, start))
        if arguments.restore:
            instance.restore(pathlib.Path(arguments.restore).read_bytes())
        set_groups = variables.grouped(description, inputs)
        get_groups = variables.grouped(
            description, {name: np.zeros_like(column) for name, column in expected.items()})
        began = time.perf_counter()
        for row in range(arguments.first, last):
            instance.step(set_groups, row, row * STEP_S)
            instance.get(get_groups, row)
        took = time.perf_counter() - began
        if arguments.save:
            state = instance.state()
            pathlib.Path(arguments.save).write_bytes(state)
            print(f"  state of {len(state)} bytes after {last} samples")
    finally:
        shutil.rmtree(folder, ignore_errors=True)

    failed = variables.compare(variables.grouped(description, expected), get_groups,
                               np.arange(arguments.first, last), known)
    steps = last - arguments.first
    outputs = sum(group.width for group in get_groups)
    print(f"  {steps} steps, {outputs} outputs each: "
          + ("DIFFERENT" if failed else "equal bit for bit")
          + f", {took / steps * 1e6:.1f} us a step")
    return failed


if __name__ == "__main__":
    sys.exit(main())
