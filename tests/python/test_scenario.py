"""Scenarios as objects, and their types."""

import copy
import pickle
import subprocess
import sys

import pytest

import octant
from conftest import SCENARIOS


def test_a_scenario_makes_a_round_trip(lockstep, tmp_path):
    scenario = octant.Scenario.load(lockstep)
    again = octant.Scenario.from_toml(scenario.to_toml())
    assert dict(again) == dict(scenario)
    scenario.save(tmp_path / "copy.toml")
    run = octant.run(scenario, out=tmp_path / "a", progress=False)
    copy = octant.run(tmp_path / "copy.toml", out=tmp_path / "b", progress=False)
    assert run.stream_hash == copy.stream_hash


@pytest.mark.parametrize("name", sorted(path.name for path in SCENARIOS.glob("*.toml")))
def test_shipped_scenarios_make_a_round_trip(name):
    scenario = octant.Scenario.load(SCENARIOS / name)
    assert octant.Scenario.from_toml(scenario.to_toml()) == scenario


def test_a_table_comes_to_be_with_its_first_key():
    scenario = octant.Scenario()
    first, second = scenario.imu, scenario.imu
    assert first == {} and scenario.to_toml() == "schema = 1\n"
    first.rate = "100 Hz"
    second.angle_random_walk = "0 deg/sqrt(h)"
    scenario["procedure.navigation.duration"] = "1 h"
    scenario.procedure.calibration = {"positions": "eight", "duration": "4 h"}
    assert scenario.check().imu == {"rate": "100 Hz", "angle_random_walk": "0 deg/sqrt(h)"}
    other = scenario.copy()
    del other.imu.rate
    assert "rate" not in other.imu and scenario.imu.rate == "100 Hz"


def test_copies_and_pickles_are_scenarios_of_their_own(lockstep):
    scenario = octant.Scenario.load(lockstep)
    for other in (copy.copy(scenario), copy.deepcopy(scenario), pickle.loads(pickle.dumps(scenario))):
        assert type(other) is octant.Scenario and other == scenario
        other.imu.rate = "123 Hz"
        assert scenario.to_toml() == octant.Scenario.load(lockstep).to_toml()
        other.imu.rate = "200 Hz"
        other.check()
    assert copy.deepcopy(scenario.procedure) == scenario.procedure


def test_a_key_that_no_scenario_has_is_refused_where_it_is_set(lockstep):
    scenario = octant.Scenario.load(lockstep)
    before = scenario.to_toml()
    with pytest.raises(octant.InputError, match="imu.angle_random_wlk: did you mean imu.angle_random_walk"):
        scenario["imu.angle_random_wlk"] = "0 deg/sqrt(h)"
    with pytest.raises(octant.InputError, match="did you mean seed"):
        scenario.sed = 1
    with pytest.raises(octant.InputError, match="title is 'x', a table is needed"):
        scenario.title = "x"
        scenario["title.rate"] = 1
    with pytest.raises(octant.InputError, match="imu.rate takes a value"):
        scenario["imu.rate.unit"] = "Hz"
    with pytest.raises(octant.InputError, match="imu.rate takes a value"):
        scenario.describe("imu.rate.unit")
    with pytest.raises(AttributeError, match="did you mean imu"):
        scenario.imuu
    with pytest.raises(AttributeError, match="by default it is '200 Hz'"):
        octant.Scenario().imu.rate
    scenario.title = octant.Scenario.from_toml(before).title
    assert scenario.to_toml() == before


def test_a_value_is_checked_by_name(lockstep):
    scenario = octant.Scenario.load(lockstep)
    scenario.imu.angle_random_walk = "3 km"
    with pytest.raises(octant.InputError, match="angle_random_walk"):
        scenario.check()


def test_keys_are_described_and_completed():
    scenario = octant.Scenario()
    assert scenario.describe("imu.rate").startswith("imu.rate: Samples per second")
    assert scenario.describe("imu.rate").endswith('Default: "200 Hz".')
    assert scenario.imu.describe("rate") == scenario.describe("imu.rate")
    assert {"imu", "procedure", "copy"} <= set(dir(scenario)) and "rate" in dir(scenario.imu)


def test_no_key_hides_a_method():
    def names(node, path):
        for name, inner in node.get("properties", {}).items():
            yield path, name
            yield from names(inner, f"{path}{name}.")

    hidden = {path + name for path, name in names(octant.Scenario.schema(), "") if hasattr(octant.Section, name)}
    assert not hidden
    assert {name for path, name in names(octant.Scenario.schema(), "") if not path and hasattr(octant.Scenario, name)} == {"schema"}


def test_the_types_are_those_of_the_program():
    schema = subprocess.run([octant.program(), "schema"], check=True, capture_output=True).stdout
    written = subprocess.run([SCENARIOS.parents[1] / "tests/scenario-types", "--check"], input=schema, capture_output=True)
    assert written.returncode == 0, written.stderr


USE = """\
import octant

scenario = octant.Scenario.load("a.toml")
scenario.procedure.calibration.duration = "12 h"
scenario.imu.accel_bias = {"normal": "1 ug"}
scenario.imu.accel_bias.normal = "3 ug"
scenario.procedure.calibration.positions = "seven"
scenario.imu.rat = "12"
scenario.seed = "four"
text: int = scenario.imu.rate
"""


def test_a_type_checker_knows_every_key(tmp_path):
    (tmp_path / "use.py").write_text(USE)
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--follow-imports", "silent", "use.py"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True).stdout
    assert [line.split(":")[1] for line in said.splitlines()] == ["7", "8", "9", "10"], said
