"""Runs and scenarios from Python."""

import os
import signal
import subprocess
import threading
import time

import pytest

import octant
from conftest import SCENARIOS


def hash_of_the_program(scenario, folder):
    command = [octant.program(), "run", scenario, "--out", folder]
    subprocess.run(command, check=True, capture_output=True)
    return octant.open(folder).stream_hash


def test_it_has_the_same_bits_as_the_program(lockstep, tmp_path):
    run = octant.run(lockstep, out=tmp_path / "python", progress=False)
    assert run.stream_hash == hash_of_the_program(lockstep, tmp_path / "program")
    assert (run.path / "manifest.json").is_file() and run.report.is_file()
    verified = subprocess.run([octant.program(), "verify", run.path], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stderr


def test_keywords_change_keys(lockstep, tmp_path):
    run = octant.run(lockstep, out=tmp_path / "a", progress=False, imu__angle_random_walk="0 deg/sqrt(h)")
    assert 'angle_random_walk = "0 deg/sqrt(h)"' in run.scenario
    other = octant.run(lockstep, out=tmp_path / "b", progress=False)
    assert run.stream_hash != other.stream_hash


def test_bad_input_is_refused_with_the_nearest_key(lockstep, tmp_path):
    with pytest.raises(octant.InputError, match="seed"):
        octant.run(lockstep, out=tmp_path / "a", sed=1)
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_there_is_not_overwritten(lockstep, tmp_path):
    octant.run(lockstep, out=tmp_path / "a", progress=False)
    with pytest.raises(octant.InputError, match="a"):
        octant.run(lockstep, out=tmp_path / "a", progress=False)
    octant.run(lockstep, out=tmp_path / "a", progress=False, force=True)


def test_progress_is_told_and_other_threads_go_on(tmp_path):
    told, ticks = [], []
    over = threading.Event()

    def tick():
        while not over.wait(0.01):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        octant.run(SCENARIOS / "quick.toml", out=tmp_path / "a", progress=lambda *at: told.append(at))
    finally:
        over.set()
        thread.join()
    done = [at for at, _ in told]
    assert done == sorted(done) and done[-1] > 0
    assert len(ticks) > 5


def test_an_exception_of_the_progress_ends_the_run(tmp_path):
    def stop(done, total):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        octant.run(SCENARIOS / "quick.toml", out=tmp_path / "a", progress=stop)
    assert not (tmp_path / "a").exists()
    assert (tmp_path / "a.partial" / "recording.mcap").is_file()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_ends_the_run_in_order(tmp_path):
    def interrupt(done, total):
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        octant.run(SCENARIOS / "quick.toml", out=tmp_path / "a", progress=interrupt)
    assert (tmp_path / "a.partial" / "summary.json").is_file()


def test_observability_is_predicted():
    (first, *_) = octant.observe(SCENARIOS / "quick.toml")
    assert first["rank"] == 12 and first["rank_with_vertical"] == 13
