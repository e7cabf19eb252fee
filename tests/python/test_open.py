"""Folders of evidence as tables."""

import json
import time

import numpy as np
import pytest

import octant


def test_errors_are_the_scored_ones(quick):
    errors = quick.errors
    navigating = np.isin(errors["mode"].astype(str), ["navigating", "done"])
    scores = quick.summary["navigation"]
    for name in ("latitude", "longitude"):
        expected = scores[f"{name}_error_arcmin"]
        assert np.abs(errors[name][navigating]).max() == pytest.approx(expected["max"], rel=1e-12)
        assert errors[name][navigating][-1] == pytest.approx(expected["final"], rel=1e-12)


def test_parameters_and_sigma_end_as_in_the_summary(quick):
    for name, score in quick.summary["calibration"]["parameters"].items():
        assert quick.parameters[name][-1] == pytest.approx(score["estimate"], rel=1e-12)
        assert quick.sigma[name][-1] == pytest.approx(score["sigma"], rel=1e-12)
        assert quick.parameters.units[name] == score["unit"]


def test_the_covariance_has_the_sigmas_on_its_diagonal(quick):
    covariance = quick.covariance
    for row, name in enumerate(covariance["parameter"]):
        sigma = quick.summary["calibration"]["parameters"][name]["sigma"]
        assert np.sqrt(covariance[name][row]) == pytest.approx(sigma, rel=1e-9)


def test_numpy_arrays_share_the_memory_of_the_table(quick):
    column = quick.errors["latitude"]
    again = quick.errors["latitude"]
    assert column.__array_interface__["data"][0] == again.__array_interface__["data"][0]
    assert not column.flags.writeable


def test_arrow_polars_and_pandas_take_a_table(quick):
    pyarrow, polars = pytest.importorskip("pyarrow"), pytest.importorskip("polars")
    table = pyarrow.table(quick.errors)
    assert table.schema.field("latitude").metadata[b"unit"] == b"arcmin"
    latitude = table.column("latitude").chunk(0)
    address = latitude.buffers()[1].address
    assert address == quick.errors["latitude"].__array_interface__["data"][0], "a copy was made"
    frame = polars.DataFrame(quick.errors)
    assert frame["latitude"].to_numpy()[-1] == quick.errors["latitude"][-1]
    assert quick.errors.to_pandas()["latitude"].iloc[-1] == quick.errors["latitude"][-1]


def test_rows_are_on_the_grid_of_the_recording(quick):
    assert np.all(np.diff(quick.truth["time"]) > 0)
    assert len(quick.navigation) >= len(quick.errors) > 28 * 3600 - 2


def test_the_baseline_has_tables_too(quick):
    assert quick.baseline.errors["longitude"].std() > quick.errors["longitude"].std()


def test_a_column_that_is_not_there_names_the_nearest(quick):
    with pytest.raises(KeyError, match="latitude"):
        quick.errors["latitud"]


def test_a_folder_that_holds_nothing_is_refused(tmp_path):
    with pytest.raises(octant.InputError, match="no evidence"):
        octant.open(tmp_path)
    with pytest.raises(octant.InputError, match="no folder"):
        octant.open(tmp_path / "nowhere")


def test_damage_is_an_error_with_the_file(quick, tmp_path):
    whole = (quick.path / "recording.mcap").read_bytes()
    (tmp_path / "recording.mcap").write_bytes(whole[:1000] + b"\0" * 100 + whole[1100:])
    with pytest.raises(octant.InputError, match="recording.mcap"):
        octant.open(tmp_path).errors


def test_a_torn_recording_is_read_up_to_the_tear(quick, tmp_path):
    whole = (quick.path / "recording.mcap").read_bytes()
    (tmp_path / "recording.mcap").write_bytes(whole[: len(whole) // 2])
    run = octant.open(tmp_path)
    assert run.truncated
    assert 0 < len(run.truth) < len(quick.truth)


def test_events_are_json(quick):
    events = [json.loads(event) for event in quick.events["event"]]
    modes = [event["detail"]["to"] for event in events if event["kind"] == "mode"]
    assert modes[-2:] == ["navigating", "done"] or modes[-1] == "navigating"


def test_opening_is_timed(quick, capsys):
    begin = time.perf_counter()
    run = octant.open(quick.path)
    assert len(run.errors) and len(run.sigma)
    with capsys.disabled():
        print(f"\nopening quick, errors with sigma: {time.perf_counter() - begin:.3f} s")
