"""A run that Python steps, with parts that Python makes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ._folders import PathLike, Run
from ._octant import Epoch, Output, RawBench, Truth
from ._scenario import Scenario, overrides, settings

#: Record of a sample in a block: counts of 2**-36 rad, 2**-30 m/s and 2**-27 rad. ``aiding_kind`` is
#: 0 velocity (north, east, down, m/s), 1 position (latitude, longitude, rad; height, m), 255 none.
SAMPLE = np.dtype(
    [
        ("sequence", "<u8"),
        ("time_ns", "<u8"),
        ("delta_theta", "<i4", 3),
        ("delta_velocity", "<i4", 3),
        ("gimbal", "<i4", 2),
        ("status", "<u2"),
        ("aiding_kind", "u1"),
        ("aiding", "<f8", 3),
    ]
)

#: Record of an answer in a block. ``mode`` is 0 aligning, 1 calibrating, 2 refused, 3 navigating,
#: 4 done; ``command`` has counts of 2**-27 rad (azimuth, roll).
OUTPUT = np.dtype(
    [
        ("sequence", "<u8"),
        ("time_ns", "<u8"),
        ("mode", "u1"),
        ("stop", "<u2"),
        ("moving", "u1"),
        ("command", "<i4", 2),
        ("latitude_rad", "<f8"),
        ("longitude_rad", "<f8"),
        ("height_m", "<f8"),
        ("velocity_mps", "<f8", 3),
        ("q_nb", "<f8", 4),
        ("health", "<u4"),
        ("nis", "<f8"),
        ("parameters_revision", "<u4"),
    ]
)

#: Record of an estimate in a block: the place of its answer, parameters and sigma in SI.
ESTIMATE = np.dtype([("place", "<u8"), ("parameters", "<f8", 30), ("sigma", "<f8", 30)])

#: Values of one count.
DELTA_THETA_RAD, DELTA_VELOCITY_MPS, GIMBAL_RAD = 2.0**-36, 2.0**-30, 2.0**-27


class Bench:
    """A run of a scenario's method that is stepped from Python.

    Source, faults, unit under test, recorder and score are those of ``octant run``; three of them can be
    Python callables:

    - ``unit(epoch, output)`` fills in the :class:`Output` of each :class:`Epoch`. If a fault restarts
      the unit, ``unit.restart(offset)`` is called. For blocks it has ``unit.block(samples)`` too.
    - ``fault(epoch, number)`` alters the epoch, or returns another one, a list of them, or ``[]`` to lose it.
      Its receipt is in the summary, under the name of the callable.
    - ``source(command_rad)`` returns the next :class:`Epoch`, or None at its end. If it has
      ``truth()``, the run is scored against the :class:`Truth` that it returns.

    Parameters
    ----------
    scenario : path or Scenario
        The scenario. A run by the clock can't be stepped.
    out : path, optional
        Folder of the run; by default a new one in ``runs``.
    unit, source : callable, optional
        In place of the scenario's.
    faults : sequence of callables
        After the scenario's faults, in order.
    force, seed, set, **keys
        As for :func:`octant.run`.

    Examples
    --------
    >>> with octant.Bench("quick.toml", unit=core) as bench:
    ...     while bench.step():
    ...         pass
    >>> bench.result.verdict
    """

    def __init__(
        self,
        scenario: PathLike | Scenario,
        *,
        out: PathLike | None = None,
        unit: Callable[[Epoch, Output], None] | None = None,
        faults: Sequence[Callable[[Epoch, int], Any]] = (),
        source: Callable[[tuple[float, float]], Epoch | None] | None = None,
        force: bool = False,
        seed: int | None = None,
        set: Mapping[str, Any] | None = None,
        **keys: Any,
    ) -> None:
        asked = {
            **settings(scenario),
            "out": None if out is None else Path(out),
            "force": force,
            "seed": seed,
            "set": overrides(set, keys),
        }
        self._unit = unit
        self._raw = RawBench(asked, source, unit, list(faults))
        self._result: Run | None = None

    def step(self) -> bool:
        """Take one step of the source; return False if the run is over."""
        return self._raw.step()

    def run(self, steps: int | None = None) -> int:
        """Take steps to the end, or a number of them; return how many there were."""
        return self._raw.steps(2**63 if steps is None else steps)

    def steps(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Take steps; return samples and answers as arrays of :data:`SAMPLE` and :data:`OUTPUT`.

        Samples are those of the source, before faults. There are fewer where the run ends.
        """
        samples, outputs = self._raw.records(number)
        return np.frombuffer(samples, SAMPLE), np.frombuffer(outputs, OUTPUT)

    def run_blocks(self, size: int = 4096) -> int:
        """Run to the end in blocks; return the number of steps.

        The unit gets many samples at once: ``unit.block(samples)`` returns its answers, an array of
        :data:`OUTPUT`, or a pair of answers and an array of :data:`ESTIMATE`. For that its commands have
        to be known before: ``unit.commands(number)`` returns the set points of the next answers, an
        array of counts (number, 2); without that method it keeps its last one. The stream hash is
        that of the run step by step.

        Raises
        ------
        ValueError
            If the unit has no ``block``, or source or faults can't go ahead.
        octant.BenchError
            From :meth:`finish`, if the answers had other commands than those that were announced.
        """
        block = getattr(self._unit, "block", None)
        if block is None:
            raise ValueError("the unit has no method block(samples): run() steps it")
        commands = getattr(self._unit, "commands", None)
        done = 0
        while True:
            if commands is None:
                raw = self._raw.ahead_holding(size)
            else:
                raw = self._raw.ahead(np.ascontiguousarray(commands(size), "<i4").tobytes())
            samples = np.frombuffer(raw, SAMPLE)
            if not len(samples):
                # The source has ended, which a step finds; or a fault delivers none or several.
                if not self.step():
                    return done
                done += 1
                continue
            made = block(samples)
            outputs, estimates = made if isinstance(made, tuple) else (made, np.empty(0, ESTIMATE))
            taken = self._raw.play(_bytes(outputs, OUTPUT), _bytes(estimates, ESTIMATE))
            done += taken
            if taken < len(samples):
                return done

    @property
    def epoch(self) -> Epoch:
        """Last sample of the source."""
        return self._raw.epoch

    @property
    def output(self) -> Output:
        """Last answer of the unit."""
        return self._raw.output

    @property
    def truth(self) -> Truth | None:
        """Truth at the last sample, where the source knows it."""
        return self._raw.truth

    @property
    def number(self) -> int:
        """Number of steps so far."""
        return self._raw.number

    @property
    def total(self) -> int | None:
        """Number of samples of the scenario, where it is known."""
        return self._raw.total

    def finish(self) -> Run:
        """End the run, score it, and write its folder of evidence.

        A run that isn't over counts as interrupted: its folder keeps the name ``OUT.partial``.
        """
        if self._result is None:
            self._result = Run(self._raw.finish())
        return self._result

    @property
    def result(self) -> Run:
        """The run; ends it if that wasn't done."""
        return self.finish()

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None or not issubclass(kind, Exception):
            self.finish()


def _bytes(records: np.ndarray, kind: np.dtype) -> bytes:
    array = np.asarray(records)
    if array.dtype != kind:
        expected = "OUTPUT" if kind is OUTPUT else "ESTIMATE"
        raise ValueError(f"found records of {array.dtype}, expected octant.{expected}")
    return np.ascontiguousarray(array).tobytes()


def outputs_for(samples: np.ndarray) -> np.ndarray:
    """Answers to a block, to be filled in: numbers and stamps are there, NIS is NaN, attitude the identity."""
    outputs = np.zeros(len(samples), OUTPUT)
    outputs["sequence"], outputs["time_ns"] = samples["sequence"], samples["time_ns"]
    outputs["q_nb"][:, 0] = 1.0
    outputs["nis"] = np.nan
    return outputs
