"""Figures of a run."""

import numpy as np
import pytest

import octant
from octant import plot

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")


def test_every_figure_of_a_run_is_drawn(quick):
    figures = plot.report(quick)
    expected = {"position", "velocity", "attitude", "nis", "gimbals", "ground_track", "correlation", "allan"}
    assert expected <= set(figures)
    assert "parameters.g_dependent" in figures
    for name, figure in figures.items():
        drawn = [line for axis in figure.axes for line in axis.lines if len(line.get_xdata()) > 10]
        images = [image for axis in figure.axes for image in axis.images]
        assert drawn or images, f"{name} is empty"
        figure.canvas.draw()


def test_the_drawn_errors_are_those_of_the_table(quick):
    figure = plot.position(quick)
    line = figure.axes[1].lines[0]
    assert np.abs(line.get_ydata()).max() == np.abs(quick.summary["navigation"]["longitude_error_arcmin"]["max"])


def test_the_allan_deviation_of_white_noise_falls_with_the_root_of_time():
    rate = np.random.default_rng(1).normal(size=200_000)
    times, deviations = plot._allan_deviation(rate, 0.005)
    expected = 1.0 / np.sqrt(times / 0.005)
    assert np.allclose(deviations[:8], expected[:8], rtol=0.03)


def test_the_allan_deviation_of_a_run_is_its_random_walk(lockstep, tmp_path):
    run = octant.run(lockstep, out=tmp_path / "a", progress=False)
    end = run.navigation["time"][run.navigation["moving"].astype(bool)][0] / 3600
    figure = plot.allan(run, end_h=end)
    for line in figure.axes[0].lines:
        times, deviations = line.get_xdata(), line.get_ydata()
        at = np.argmin(np.abs(times - 1.28))
        # Table 1: 0.0007 deg/sqrt(h) is 0.042 deg/h at one second.
        assert deviations[at] * np.sqrt(times[at]) == pytest.approx(0.042, rel=0.25)


def test_the_stored_allan_deviation_is_drawn_without_every_sample(quick):
    stored = quick.summary["allan_deviation"]
    figure = plot.allan(quick)
    for axis, sensor in zip(figure.axes, ("gyro", "accelerometer")):
        for line, direction in zip(axis.lines, "xyz"):
            rows = np.array(stored[sensor][direction]["series"])
            assert len(rows) > 10
            assert np.array_equal(line.get_xdata(), rows[:, 0])
            assert np.array_equal(line.get_ydata(), rows[:, 1])
    # Table 1 at one second: 0.042 deg/h of each gyro, 50 ug of each accelerometer.
    walk = np.array(stored["gyro"]["x"]["series"])
    at = np.argmin(np.abs(walk[:, 0] - 1.28))
    assert walk[at, 1] * np.sqrt(walk[at, 0]) == pytest.approx(0.042, rel=0.02)


def test_a_part_of_a_run_wants_every_sample(quick):
    with pytest.raises(ValueError, match="every sample"):
        plot.allan(quick, end_h=0.1)
