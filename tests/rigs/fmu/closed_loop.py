#!/usr/bin/env python3
"""Runs octant.ssp in a master of others and compares the calibrator's outputs with those of the
program, bit for bit, in every step: all of them, or those that are connectors where the master
sees no others.

Usage: closed_loop.py libcosim|ecos|fmpy octant.ssp COLUMNS.npz [--steps N]
"""

import argparse
import shutil
import sys
import time

import numpy as np
from fmpy import extract, read_model_description

import variables

STEP_S = 0.005


def libcosim(path, wanted, steps, known):
    """libcosim, through its C interface."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_ssp_file(ssp_path=path)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    index = execution.slave_index_from_instance_name("calibrator")
    read = {"Real": observer.last_real_values, "Integer": observer.last_integer_values,
            "Boolean": observer.last_boolean_values}
    for row in range(steps):
        if not execution.step():
            sys.exit(f"libcosim stopped in step {row}")
        for group in wanted:
            group.values[row] = read[group.kind](index, group.references)


def ecos(path, wanted, steps, known):
    """Ecos."""
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("warn")
    with EcosSimulation(step_size=STEP_S, ssp_path=path) as simulation:
        if not simulation.init(parameter_set="lockstep"):
            sys.exit(f"Ecos: {EcosLib.get_last_error()}")
        read = {"Real": simulation.get_real, "Integer": simulation.get_integer,
                "Boolean": simulation.get_bool}
        every = [(group, at, read[group.kind], f"calibrator::{name}")
                 for group in wanted for at, name in enumerate(group.names)]
        # Name by name is slow: estimates are got where they are compared.
        always = [one for one in every if not variables.is_estimate(one[3].split("::")[1])]
        for row in range(steps):
            simulation.step()
            for group, at, function, name in every if row and known[row - 1] else always:
                group.values[row, at] = function(name)
        simulation.terminate()


def fmpy(path, wanted, steps, known):
    """FMPy's own reader of system structures."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import ParameterSet, read_ssd

    # It reads parameter bindings, and takes one set for all components, with their names in front.
    every = ParameterSet(name="lockstep")
    for component in read_ssd(path).system.elements:
        for binding in component.parameterBindings:
            for parameter in [p for values in binding.parameterValues for p in values.parameters]:
                parameter.name = f"{component.name}.{parameter.name}"
                # Texts of Booleans are all true to it.
                if parameter.type == "Boolean":
                    parameter.value = float(parameter.value == "true")
                every.parameters.append(parameter)
    result = simulate_ssp(path, stop_time=(steps - 0.5) * STEP_S, step_size=STEP_S,
                          parameter_set=every)
    for group in wanted:
        for at, name in enumerate(group.names):
            group.values[:, at] = result[f"calibrator.{name}"][:steps]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool", choices=["libcosim", "ecos", "fmpy"])
    parser.add_argument("ssp")
    parser.add_argument("columns")
    parser.add_argument("--steps", type=int)
    arguments = parser.parse_args()

    columns = np.load(arguments.columns)
    expected = {name[4:]: columns[name] for name in columns.files if name.startswith("out ")}
    known = columns["parameter rows"]
    if arguments.tool == "fmpy":
        # It sees connectors alone, and not all outputs are connectors.
        hidden = ("parameters.", "sigma.", "answer.")
        expected = {name: column for name, column in expected.items()
                    if not name.startswith(hidden) or name == "parameters.revision"}
    steps = (arguments.steps or len(known)) + 1

    folder = extract(arguments.ssp)
    description = read_model_description(f"{folder}/resources/calibrator_fmi2.fmu")
    shutil.rmtree(folder)
    # After the first step there is the first sample; after step n the answer to sample n - 1.
    blank = {name: np.zeros((steps, *column.shape[1:]), column.dtype)
             for name, column in expected.items()}
    wanted = variables.grouped(description, blank)
    began = time.perf_counter()
    globals()[arguments.tool](arguments.ssp, wanted, steps, known)
    took = time.perf_counter() - began

    for group in wanted:
        group.values = group.values[1:]
    failed = variables.compare(variables.grouped(description, expected), wanted,
                               np.arange(steps - 1), known)
    outputs = sum(group.width for group in wanted)
    print(f"  {steps} steps, {outputs} outputs each: "
          + ("DIFFERENT" if failed else "equal bit for bit")
          + f", {took / steps * 1e6:.1f} us a step")
    return failed


if __name__ == "__main__":
    sys.exit(main())
