"""Runs that Python steps."""

import subprocess
import time

import numpy as np
import pytest

import octant

NAVIGATE = """
schema = 1
title = "at rest"
[site]
latitude = "30 deg"
[procedure.navigation]
duration = "60 s"
"""


@pytest.fixture
def scenario():
    return octant.Scenario.from_toml(NAVIGATE)


class Held:
    """A unit that stays where it was put. It navigates from the first sample on."""

    def __init__(self):
        self.seen = []

    def __call__(self, epoch, output):
        self.seen.append(epoch.sequence)
        output.mode = "navigating"
        output.latitude_rad = np.radians(30.0)

    def block(self, samples):
        self.seen.extend(samples["sequence"])
        outputs = octant.outputs_for(samples)
        outputs["mode"] = 3
        outputs["latitude_rad"] = np.radians(30.0)
        return outputs


class Turning(Held):
    """A unit whose set point is a function of the number of the sample, and known before."""

    def at(self, sequence):
        return (sequence // 500) % 5 * 20_000_000

    def __call__(self, epoch, output):
        super().__call__(epoch, output)
        output.command_rad = (self.at(epoch.sequence) * octant.GIMBAL_RAD, 0.0)

    def commands(self, number):
        sequences = len(self.seen) + 1 + np.arange(number)
        return np.stack([self.at(sequences), np.zeros(number, int)], axis=1)

    def block(self, samples):
        outputs = super().block(samples)
        outputs["command"][:, 0] = self.at(samples["sequence"].astype(int))
        return outputs


def test_its_own_core_step_by_step_has_the_bits_of_a_run(lockstep, tmp_path):
    with octant.Bench(lockstep, out=tmp_path / "bench") as bench:
        while bench.step():
            pass
    run = octant.run(lockstep, out=tmp_path / "run", progress=False)
    assert bench.result.stream_hash == run.stream_hash
    assert bench.result.verdict == run.verdict
    assert bench.result.summary == run.summary


def test_steps_of_its_own_core_are_arrays(lockstep, tmp_path):
    with octant.Bench(lockstep, out=tmp_path / "bench") as bench:
        samples, outputs = bench.steps(1000)
        assert samples["sequence"].tolist() == list(range(1, 1001))
        assert (outputs["sequence"] == samples["sequence"]).all()
        assert np.abs(np.linalg.norm(outputs["q_nb"], axis=1) - 1).max() < 1e-9
        assert bench.number == 1000 and bench.epoch.sequence == 1000
        bench.run()


@pytest.mark.parametrize("unit", [Held, Turning])
def test_blocks_have_the_bits_of_steps(unit, scenario, tmp_path):
    with octant.Bench(scenario, unit=unit(), out=tmp_path / "steps") as steps:
        steps.run()
    for size in (7, 1024):
        with octant.Bench(scenario, unit=unit(), out=tmp_path / f"blocks-{size}") as blocks:
            blocks.run_blocks(size)
        assert blocks.result.stream_hash == steps.result.stream_hash
        assert blocks.result.summary["navigation"] == steps.result.summary["navigation"]


def test_commands_that_were_not_announced_are_found(scenario, tmp_path):
    class Liar(Turning):
        def commands(self, number):
            return np.zeros((number, 2), int)

    with octant.Bench(scenario, unit=Liar(), out=tmp_path / "a") as bench:
        bench.run_blocks(4096)
    assert bench.result.verdict == "error"
    assert "announced" in str(bench.result.reasons)


def test_a_unit_is_scored_against_the_truth(scenario, tmp_path):
    with octant.Bench(scenario, unit=Held(), out=tmp_path / "a") as bench:
        assert bench.run() == 12_000
    run = bench.result
    assert run.summary["method"].startswith("Held")
    assert run.summary["navigation"]["latitude_error_arcmin"]["max"] == pytest.approx(0.0, abs=1e-6)
    verified = subprocess.run([octant.program(), "verify", run.path], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stderr


def test_an_exception_of_the_unit_is_raised(scenario, tmp_path):
    def unit(epoch, output):
        if epoch.sequence == 5:
            raise ZeroDivisionError("at five")

    bench = octant.Bench(scenario, unit=unit, out=tmp_path / "a")
    with pytest.raises(ZeroDivisionError, match="at five"):
        bench.run()
    run = bench.finish()
    assert run.verdict == "error" and "at five" in str(run.reasons)


def test_an_answer_that_breaks_the_rules_fails_the_run(scenario, tmp_path):
    def unit(epoch, output):
        output.latitude_rad = float("nan")

    with octant.Bench(scenario, unit=unit, out=tmp_path / "a") as bench:
        assert not bench.step()
    assert bench.result.verdict == "fail"


def test_a_fault_alters_loses_and_doubles(scenario, tmp_path):
    def spike(epoch, number):
        if number == 10:
            x, y, z = epoch.delta_theta
            epoch.delta_theta = (x + 1_000_000, y, z)
        if number == 20:
            return []
        if number == 30:
            return [epoch, epoch]

    unit = Held()
    with octant.Bench(scenario, unit=unit, faults=[spike], out=tmp_path / "a") as bench:
        bench.run()
    assert 20 not in unit.seen and unit.seen.count(30) == 2
    (receipt,) = bench.result.faults
    assert receipt["id"] == "spike" and receipt["samples_altered"] == 3
    assert (receipt["first_sample"], receipt["last_sample"]) == (10, 30)


def test_a_source_is_a_callable_with_a_truth(scenario, tmp_path):
    class Rest:
        def __init__(self):
            self.number = 0

        def __call__(self, command_rad):
            if self.number == 4000:
                return None
            self.number += 1
            return octant.Epoch(self.number, self.number * 5_000_000, (0, 0, 0), (0, 0, -52_600_000))

        def truth(self):
            return octant.Truth(self.number * 5_000_000, np.radians(30.0), 0.0)

    with octant.Bench(scenario, unit=Held(), source=Rest(), out=tmp_path / "a") as bench:
        bench.run()
    errors = bench.result.errors
    # The first sample, then one a second.
    assert len(errors) == 21 and np.abs(errors["latitude"]).max() < 1e-9


def test_a_part_that_uses_the_bench_is_refused(scenario, tmp_path):
    def unit(epoch, output):
        bench.step()

    bench = octant.Bench(scenario, unit=unit, out=tmp_path / "a")
    with pytest.raises(ValueError, match="in a step"):
        bench.step()
    bench.finish()


def test_speed_is_told(scenario, tmp_path, capsys):
    def empty(epoch, output):
        pass

    scenario.procedure.navigation.duration = "600 s"
    figures = []
    with octant.Bench(scenario, unit=empty, out=tmp_path / "a") as bench:
        begin = time.perf_counter()
        done = bench.run()
        figures.append(("by the step", done / (time.perf_counter() - begin)))
    scenario.procedure.navigation.duration = "7200 s"
    with octant.Bench(scenario, unit=Held(), out=tmp_path / "b") as bench:
        begin = time.perf_counter()
        done = bench.run_blocks(8192)
        figures.append(("in blocks", done / (time.perf_counter() - begin)))
    with capsys.disabled():
        for name, rate in figures:
            print(f"\na unit in Python {name}: {rate:,.0f} samples/s")
