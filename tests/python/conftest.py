"""Runs and scenarios that the tests share."""

import os
from pathlib import Path

import pytest

import octant

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "fixtures" / "scenarios"

@pytest.fixture(scope="session")
def quick(tmp_path_factory):
    """A run of quick.toml; OCTANT_RUN names one that is there."""
    there = os.environ.get("OCTANT_RUN")
    if there:
        return octant.open(there)
    return octant.run(SCENARIOS / "quick.toml", out=tmp_path_factory.mktemp("runs") / "quick", progress=False)


@pytest.fixture
def lockstep():
    """Ten minutes at 200 Hz, every sample recorded."""
    return SCENARIOS / "lockstep.toml"
