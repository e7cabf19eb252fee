"""Figures of a run: one call each, with matplotlib.

Every function takes a :class:`octant.Run` (or its ``baseline``), draws on the axes that it is given, or
on new ones, and returns the figure::

    octant.plot.position(run)
    octant.plot.parameters(run, group="g_dependent").savefig("g.svg")
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from ._folders import Method, Run
from ._octant import PARAMETERS, Table

__all__ = [
    "allan",
    "attitude",
    "correlation",
    "gimbals",
    "ground_track",
    "nis",
    "parameters",
    "position",
    "report",
    "velocity",
]

#: Groups of the sensors' error parameters, by the beginning of their names.
GROUPS = {
    "gyro_bias": "gyro_bias_",
    "gyro_scale": "gyro_scale_",
    "gyro_misalignment": "gyro_misalignment_",
    "g_dependent": "g_",
    "accel_bias": "accel_bias_",
    "accel_scale": "accel_scale_",
    "accel_misalignment": "accel_misalignment_",
}
#: Phases that are scored.
NAVIGATION = ("navigating", "done")
#: 95 % bounds of chi-squared with three degrees of freedom.
NIS_BOUNDS = (0.2158, 9.3484)
EARTH_RADIUS_M = 6_371_000.0


def _axes(axes: Any, rows: int, **options: Any) -> tuple[Any, list[Any]]:
    """Use the given axes, or make a figure with rows of axes."""
    if axes is not None:
        found = list(np.atleast_1d(np.asarray(axes, dtype=object)).ravel())
        if len(found) != rows:
            raise ValueError(f"found {len(found)} axes, expected {rows}")
        return found[0].figure, found
    import matplotlib.pyplot as plt

    figure, made = plt.subplots(
        rows, 1, sharex=options.pop("sharex", True), squeeze=False, figsize=(8, 2 + 1.8 * rows),
        layout="constrained", **options,
    )
    return figure, list(made[:, 0])


def _hours(table: Table) -> np.ndarray:
    return table["time"] / 3600


def _in(table: Table, modes: tuple[str, ...] | None) -> np.ndarray:
    """Rows in these modes."""
    if modes is None:
        return np.ones(len(table), bool)
    return np.isin(table["mode"].astype(str), modes)


def _lines(run: Method, axes: Any, names: list[tuple[str, str]], phase: str | None) -> Any:
    """Draw errors over time, one below the other."""
    table = run.errors
    rows = _in(table, NAVIGATION if phase == "navigation" else None)
    figure, axes = _axes(axes, len(names))
    for axis, (name, label) in zip(axes, names):
        axis.plot(_hours(table)[rows], table[name][rows], linewidth=0.9)
        axis.axhline(0, color="0.6", linewidth=0.6)
        axis.set_ylabel(f"{label}, {table.units[name]}")
        _mark_faults(run, axis)
    axes[-1].set_xlabel("time, h")
    return figure


def _mark_faults(run: Method, axis: Any) -> None:
    """Mark onsets of faults with lines."""
    events = run.events
    for time, text in zip(events["time"], events["event"]):
        event = json.loads(text)
        if event["kind"] == "fault" and event["detail"]["begins"]:
            axis.axvline(time / 3600, color="tab:red", linewidth=0.8, linestyle=":")


def position(run: Method, axes: Any = None, *, phase: str | None = "navigation") -> Any:
    """Latitude and longitude error (arcmin) over time.

    Parameters
    ----------
    run : Run or Method
        The run.
    axes : two matplotlib axes, optional
        Where to draw; by default a new figure.
    phase : "navigation" or None
        Navigation alone, which is scored, or the whole run.

    Returns
    -------
    matplotlib.figure.Figure
    """
    return _lines(run, axes, [("latitude", "latitude error"), ("longitude", "longitude error")], phase)


def velocity(run: Method, axes: Any = None, *, phase: str | None = "navigation") -> Any:
    """Velocity errors north and east (m/s) over time; arguments as for :func:`position`."""
    return _lines(run, axes, [("velocity_north", "north"), ("velocity_east", "east")], phase)


def attitude(run: Method, axes: Any = None, *, phase: str | None = "navigation") -> Any:
    """Attitude errors phi about north, east and down (arcmin) over time, on three axes.

    ``c_nb(computed) = (I - [phi x]) c_nb(true)``; arguments as for :func:`position`.
    """
    names = [("phi_north", "phi north"), ("phi_east", "phi east"), ("phi_down", "phi down")]
    return _lines(run, axes, names, phase)


def parameters(run: Run, axes: Any = None, *, group: str = "g_dependent", sigmas: float = 1.0) -> Any:
    """Errors of a group of parameters over time, with their sigma around zero.

    Where the true values aren't known, the estimates are drawn with sigma around them.

    Parameters
    ----------
    run : Run
        The run. Of a baseline, which has no summary of its own, estimates are drawn.
    axes : matplotlib axes, optional
        One for each parameter of the group.
    group : str
        A key of ``octant.plot.GROUPS``.
    sigmas : float
        Half width of the band in sigma.
    """
    if group not in GROUPS:
        raise ValueError(f"group {group!r}, expected one of {', '.join(GROUPS)}")
    names = [name for name in PARAMETERS if name.startswith(GROUPS[group])]
    table, sigma = run.parameters, run.sigma
    scores = run.summary.get("calibration") if isinstance(run, Run) else None
    figure, axes = _axes(axes, len(names))
    for axis, name in zip(axes, names):
        score = (scores or {"parameters": {}})["parameters"].get(name) or {}
        true = score.get("true")
        values = table[name] - (0.0 if true is None else true)
        hours, band = _hours(table), sigmas * sigma[name]
        middle = np.zeros_like(values) if true is not None else values
        axis.fill_between(hours, middle - band, middle + band, alpha=0.25, linewidth=0)
        axis.plot(hours, values, linewidth=0.9)
        axis.set_ylabel(f"{name}\n{table.units[name]}", fontsize=8)
    what = "error" if scores else "estimate"
    axes[0].set_title(f"{group.replace('_', ' ')}: {what}, band of {sigmas:g} sigma", fontsize=10)
    axes[-1].set_xlabel("time, h")
    return figure


def _expected_nis(run: Method) -> str:
    """Mean NIS that is expected of a run: 3, or a range where its filter considers states."""
    calibration = (getattr(run, "summary", None) or {}).get("calibration") or {}
    expected = calibration.get("nis_expected")
    return f"{expected[0]:.2f} to {expected[1]:.2f}" if expected else "3"


def nis(run: Method, axes: Any = None) -> Any:
    """Normalized innovation squared of the measurements, with the bounds that hold 95 % of them."""
    table = run.innovations
    figure, (axis,) = _axes(axes, 1)
    rejected = table["rejected"].astype(bool)
    hours = _hours(table)
    axis.plot(hours[~rejected], table["nis"][~rejected], ".", markersize=2, label="used")
    axis.plot(hours[rejected], table["nis"][rejected], "x", markersize=4, label="rejected")
    for bound in NIS_BOUNDS:
        axis.axhline(bound, color="0.4", linewidth=0.7, linestyle="--")
    mean = float(np.mean(table["nis"][~rejected])) if (~rejected).any() else float("nan")
    axis.set_title(f"NIS: mean {mean:.3f}, expected {_expected_nis(run)}", fontsize=10)
    axis.set_yscale("log")
    axis.set_xlabel("time, h")
    axis.legend(loc="upper right", fontsize=8)
    return figure


def gimbals(run: Method, axes: Any = None, *, phase: str | None = None) -> Any:
    """Commanded gimbal angles (deg) over time.

    Parameters
    ----------
    run, axes
        As for :func:`position`.
    phase : "calibration", "navigation" or None
        Part of the run.
    """
    table = run.navigation
    modes = {"calibration": ("aligning", "calibrating"), "navigation": NAVIGATION}.get(phase or "")
    rows = _in(table, modes)
    figure, axes = _axes(axes, 2)
    for axis, name in zip(axes, ("azimuth", "roll")):
        axis.step(_hours(table)[rows], table[f"command_{name}"][rows], where="post", linewidth=0.9)
        axis.set_ylabel(f"{name}, deg")
    axes[-1].set_xlabel("time, h")
    return figure


def ground_track(run: Method, axes: Any = None) -> Any:
    """Estimated and true position in the horizontal plane (m), about the true start of the navigation."""
    errors, truth = run.errors, run.truth
    rows = _in(errors, NAVIGATION)
    if not rows.any():
        raise ValueError("the run has no navigation with truth")
    figure, (axis,) = _axes(axes, 1)
    start = errors["time"][rows][0]
    true = truth["time"] >= start
    latitude, longitude = np.radians(truth["latitude"][true]), np.radians(truth["longitude"][true])
    north = (latitude - latitude[0]) * EARTH_RADIUS_M
    east = (longitude - longitude[0]) * EARTH_RADIUS_M * np.cos(latitude[0])
    axis.plot(east, north, linewidth=1.4, label="truth")
    found = np.isin(truth["time"][true], errors["time"][rows])
    here = np.isin(errors["time"][rows], truth["time"][true])
    axis.plot(
        east[found] + errors["east"][rows][here],
        north[found] + errors["north"][rows][here],
        linewidth=0.9,
        label="navigation",
    )
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel("east, m")
    axis.set_ylabel("north, m")
    axis.legend(fontsize=8)
    return figure


def correlation(run: Method, axes: Any = None) -> Any:
    """Correlations of the parameters at the end of the calibration."""
    table = run.covariance
    names = list(PARAMETERS)
    matrix = np.array([table[name] for name in names]).T
    deviation = np.sqrt(np.diag(matrix))
    with np.errstate(invalid="ignore", divide="ignore"):
        matrix = matrix / np.outer(deviation, deviation)
    figure, (axis,) = _axes(axes, 1)
    if axes is None:
        figure.set_size_inches(8, 7)
    image = axis.imshow(matrix, vmin=-1, vmax=1, cmap="RdBu_r")
    axis.set_xticks(range(len(names)), names, rotation=90, fontsize=6)
    axis.set_yticks(range(len(names)), names, fontsize=6)
    figure.colorbar(image, ax=axis, label="correlation")
    return figure


def _allan_deviation(rate: np.ndarray, period_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Overlapping Allan deviation of a rate at averaging times of powers of two periods."""
    angle = np.concatenate([[0.0], np.cumsum(rate)]) * period_s
    lengths = 2 ** np.arange(int(np.log2(max(len(rate) // 4, 1))) + 1)
    deviations = []
    for n in lengths:
        difference = angle[2 * n :] - 2 * angle[n:-n] + angle[: -2 * n]
        deviations.append(np.sqrt(np.mean(difference**2) / 2) / (n * period_s))
    return lengths * period_s, np.array(deviations)


def _of_samples(run: Method, start_h: float, end_h: float | None) -> Any:
    """Allan deviations of the recorded samples: sensor, axis, averaging times, deviations."""
    table = run.samples
    time = table["time"]
    chosen = (time >= start_h * 3600) & (time <= (np.inf if end_h is None else end_h * 3600))
    if chosen.sum() < 16:
        raise ValueError(f"found {chosen.sum()} samples between {start_h} h and {end_h} h, expected 16 or more")
    if np.any(np.diff(table["sequence"][chosen]) != 1):
        raise ValueError('the recording has not every sample: expected a run with record.samples = "full"')
    period_s = float(np.median(np.diff(time[chosen])))
    for sensor, (name, scale) in enumerate([("delta_theta", np.degrees(1) * 3600), ("delta_velocity", 1e6 / 9.80665)]):
        for direction in "xyz":
            rate = table[f"{name}_{direction}"][chosen] / period_s * scale
            yield sensor, direction, *_allan_deviation(rate - rate.mean(), period_s)


def allan(run: Method, axes: Any = None, *, start_h: float | None = None, end_h: float | None = None) -> Any:
    """Allan deviation of the gyros (deg/h) and accelerometers (ug), over the averaging time.

    Of the whole run, the deviation in its summary is drawn, with its intervals of 95 %: of all
    stretches in which the gimbals were at rest. Of a part of the run, and of a run without it, that of
    the recorded samples. They have to be complete then: a run with ``record.samples = "full"``. The mean
    of the part (Earth rate, gravity, bias) doesn't matter; a turn of the gimbals does, so choose a dwell.

    Parameters
    ----------
    run, axes
        As for :func:`position`.
    start_h, end_h : float
        Part of the run, h.
    """
    stored = run.summary.get("allan_deviation") if isinstance(run, Run) and start_h is None and end_h is None else None
    found = None if stored else list(_of_samples(run, start_h or 0.0, end_h))
    figure, axes = _axes(axes, 2)
    if stored:
        for axis, sensor in zip(axes, ("gyro", "accelerometer")):
            for direction in "xyz":
                rows = np.array(stored[sensor][direction]["series"], dtype=float).reshape(-1, 5)
                (line,) = axis.loglog(rows[:, 0], rows[:, 1], marker=".", label=direction)
                axis.fill_between(rows[:, 0], rows[:, 2], rows[:, 3], color=line.get_color(), alpha=0.15, linewidth=0)
    else:
        for sensor, direction, times, deviations in found:
            axes[sensor].loglog(times, deviations, marker=".", label=direction)
    for axis, label in zip(axes, ("gyro, deg/h", "accelerometer, ug")):
        axis.set_ylabel(label)
        axis.grid(True, which="both", linewidth=0.3)
    axes[0].legend(fontsize=8)
    axes[-1].set_xlabel("averaging time, s")
    return figure


def report(run: Run) -> dict[str, Any]:
    """All figures that the run has data for, by name."""
    figures = {}
    if len(run.errors) and _in(run.errors, NAVIGATION).any():
        figures["position"] = position(run)
        figures["velocity"] = velocity(run)
        figures["attitude"] = attitude(run)
        figures["ground_track"] = ground_track(run)
    if len(run.parameters):
        for group in GROUPS:
            figures[f"parameters.{group}"] = parameters(run, group=group)
    if len(run.innovations):
        figures["nis"] = nis(run)
    if (run.path / "calibration.octcal").is_file():
        figures["correlation"] = correlation(run)
    if len(run.navigation):
        figures["gimbals"] = gimbals(run)
    if run.summary.get("allan_deviation"):
        figures["allan"] = allan(run)
    return figures
