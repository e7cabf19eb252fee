"""Test harness for inertial navigation systems.

:func:`open` reads a folder of evidence, :func:`run` makes one::

    import octant

    run = octant.run("quick.toml")     # or octant.open("runs/quick")
    run.verdict                        # "pass"
    run.errors["longitude"]            # NumPy array, arcmin
    run.errors.to_pandas()             # or to_polars(), to_arrow()
    octant.plot.position(run)

:class:`Bench` steps a run, with a unit under test, faults or a source that are Python callables;
:class:`Scenario` is a scenario as an object; :func:`campaign` and :func:`observe` are the program's
commands. Tables are :class:`Table`: columns with units, which pyarrow, polars and pandas take without a
copy. Their units are those of the reports (arcmin, deg/h, ppm, arcsec, ug, m/s); time is simulated time
in s. Numbers that cross to a callable are SI and radians.
"""

from typing import Any

from ._bench import (
    DELTA_THETA_RAD,
    DELTA_VELOCITY_MPS,
    ESTIMATE,
    GIMBAL_RAD,
    OUTPUT,
    SAMPLE,
    Bench,
    outputs_for,
)
from ._folders import Campaign, History, Method, Night, Run, open
from ._octant import (
    PARAMETERS,
    BenchError,
    Epoch,
    InputError,
    OctantError,
    Output,
    Table,
    Truth,
    __version__,
)
from ._run import campaign, observe, program, run
from ._scenario import Scenario, Section

__all__ = [
    "DELTA_THETA_RAD",
    "DELTA_VELOCITY_MPS",
    "ESTIMATE",
    "GIMBAL_RAD",
    "OUTPUT",
    "PARAMETERS",
    "SAMPLE",
    "Bench",
    "BenchError",
    "Campaign",
    "Epoch",
    "History",
    "InputError",
    "Method",
    "Night",
    "OctantError",
    "Output",
    "Run",
    "Scenario",
    "Section",
    "Table",
    "Truth",
    "__version__",
    "campaign",
    "observe",
    "open",
    "outputs_for",
    "plot",
    "program",
    "run",
]


def __getattr__(name: str) -> Any:
    # matplotlib is loaded when it is needed alone.
    if name == "plot":
        from importlib import import_module

        return import_module(".plot", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
