#!/usr/bin/env python3
"""Changes a tunable parameter of the plant in the middle of a simulation by FMPy, and compares with the fault that adds the
same bias: other code in the plant, and the same bits, because the bias is a whole number of counts a sample.

Usage: tunable.py FOLDER

FOLDER has plant_fmi2.fmu and plant_fmi3.fmu.
"""

import pathlib
import shutil
import sys

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

STEP_S = 0.005
STEPS, MIDDLE = 2000, 1000
# Numbers of a fault that an FMI 3.0 plant has.
ROOM = 14
# 4096 counts of 2^-36 rad in a sample.
BIAS = 4096 / 2**36 / STEP_S
GYRO, FAULT = "imu.parameters.gyro_bias", "fault[1]"


class Plant:
    """One plant between its initialization and its end."""

    def __init__(self, path, starts, event_mode=False):
        self.description = read_model_description(path)
        self.folder = extract(path)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.is_fmi2 = self.description.fmiVersion == "2.0"
        self.event_mode = event_mode
        kind = FMU2Slave if self.is_fmi2 else FMU3Slave
        self.fmu = kind(guid=self.description.guid, unzipDirectory=self.folder, instanceName="plant",
                        modelIdentifier=self.description.coSimulation.modelIdentifier)
        if self.is_fmi2:
            self.fmu.instantiate()
            self.fmu.setupExperiment(startTime=0.0)
        else:
            self.fmu.instantiate(eventModeUsed=event_mode)
        for name, value in starts.items():
            self.start(name, value)
        if self.is_fmi2:
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()
        self.leave_event()

    def leave_event(self):
        if self.event_mode:
            while self.fmu.updateDiscreteStates()[0]:
                pass
            self.fmu.enterStepMode()

    def start(self, name, value):
        if name.endswith("kind"):
            if self.is_fmi2:
                self.fmu.setInteger([self.references[name]], [value])
            else:
                self.fmu.setInt64([self.references[name]], [value])
        else:
            self.set(name, value)

    def set(self, name, values):
        values = [values] if np.isscalar(values) else list(values)
        if self.is_fmi2:
            names = [name] if name in self.references else [f"{name}[{i + 1}]" for i in range(len(values))]
            self.fmu.setReal([self.references[one] for one in names], values)
        else:
            self.fmu.setFloat64([self.references[name]], values)

    def tune(self, name, values):
        if self.event_mode:
            self.fmu.enterEventMode()
        self.set(name, values)
        self.leave_event()

    def gyro(self):
        if self.is_fmi2:
            return self.fmu.getReal([self.references[f"gyro.delta_theta[{i}]"] for i in (1, 2, 3)])
        return self.fmu.getFloat64([self.references["gyro.delta_theta"]], nValues=3)

    def step(self, n):
        self.fmu.doStep(n * STEP_S, STEP_S)
        return self.gyro()

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def run(path, starts, event_mode, change):
    plant = Plant(path, starts, event_mode)
    rows = np.empty((STEPS, 3))
    for n in range(STEPS):
        if n == MIDDLE:
            change(plant)
        rows[n] = plant.step(n)
    plant.end()
    return rows.view(np.int64)


def kind_of_fault(description):
    """The item of bias-step, which has no name in FMI 2.0."""
    [variable] = [v for v in description.modelVariables if v.name == "fault[1].kind"]
    return next(int(item.value) for item in variable.declaredType.items if item.name == "bias-step")


def main(folder):
    folder = pathlib.Path(folder)
    item = kind_of_fault(read_model_description(folder / "plant_fmi3.fmu"))
    failed = []

    def expect(good, what):
        print(("ok   " if good else "FAIL ") + what)
        if not good:
            failed.append(what)

    # Channel y, the bias, and its dimension (that of gyros).
    numbers = [2.0, BIAS, 0.0]
    results = []
    for name, event_mode in [("fmi2", False), ("fmi3", False), ("fmi3", True)]:
        path = folder / f"plant_{name}.fmu"
        told = f"plant_{name}" + (" in event mode" if event_mode else "")
        names = [v.name for v in read_model_description(path).modelVariables]
        # FMI 3.0 sets the whole of an array.
        room = ROOM if f"{FAULT}.values" in names else len(numbers)
        fault = {f"{FAULT}.kind": item, f"{FAULT}.start": MIDDLE * STEP_S,
                 f"{FAULT}.values": numbers + [0.0] * (room - len(numbers))}
        plain = run(path, {}, event_mode, lambda plant: None)
        same = run(path, {}, event_mode, lambda plant: plant.tune(GYRO, [0.0, 0.0, 0.0]))
        expect((plain == same).all(), f"{told}: the value that it has changes no bit")
        tuned = run(path, {}, event_mode, lambda plant: plant.tune(GYRO, [0.0, BIAS, 0.0]))
        expected = run(path, fault, event_mode, lambda plant: None)
        expect((tuned == expected).all(), f"{told}: a bias from the middle on, bit for bit the fault")
        differ = (tuned != plain).any(axis=1)
        expect(not differ[:MIDDLE].any() and differ[MIDDLE:].all(), f"{told}: from the middle on, and on no step before")
        results.append(tuned)
    expect(all((results[0] == other).all() for other in results[1:]), "both standards: the same bits")

    # What a user of simulate_fmu does: a column of the inputs.
    column = f"{GYRO}[2]"
    signals = np.array([(0.0, 0.0), (MIDDLE * STEP_S, BIAS)], dtype=[("time", float), (column, float)])
    result = simulate_fmu(folder / "plant_fmi2.fmu", input=signals, stop_time=STEPS * STEP_S, step_size=STEP_S,
                          output_interval=STEP_S, output=["gyro.delta_theta[2]"])
    got = np.ascontiguousarray(result["gyro.delta_theta[2]"][1:]).view(np.int64)
    expect(len(got) == STEPS and (got == results[0][:, 1]).all(), "simulate_fmu, plant_fmi2: a column of the inputs")

    # A value that isn't finite: discarded, and nothing has changed.
    def no_number(plant):
        try:
            plant.set("imu.angle_random_walk", float("nan"))
        except Exception as error:  # FMPy raises for every status above warning.
            expect("fmi2SetReal" in str(error), "a NaN is refused")

    path = folder / "plant_fmi2.fmu"
    plain = run(path, {}, False, lambda plant: None)
    expect((run(path, {}, False, no_number) == plain).all(), "after a refused value the simulation goes on as without it")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
