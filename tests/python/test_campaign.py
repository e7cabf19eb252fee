"""Campaigns and nights from Python."""

import numpy as np
import pytest

import octant

CASE = """
schema = 1
title = "short"
[imu]
rate = "10 Hz"
[procedure.navigation]
duration = "10 min"
rotation = "none"
[[requirements]]
id = "NAV-1"
text = "The position stays within 1 nmi."
measure = "navigation.radial_error_nmi.max"
limit = "1 nmi"
"""

CAMPAIGN = """
schema = 1
title = "latitudes"
seed = 1
replicates = 3
[[scenarios]]
id = "static"
file = "case.toml"
[[factors]]
name = "latitude"
key = "site.latitude"
values = ["0 deg", "45 deg"]
"""


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "case.toml").write_text(CASE)
    (folder / "campaign.toml").write_text(CAMPAIGN)
    told = []
    made = octant.campaign(folder / "campaign.toml", folder / "out", jobs=2, progress=lambda *at: told.append(at))
    assert told[-1] == (6, 6)
    return made


def test_cases_are_a_table_with_units(campaign):
    cases = campaign.cases
    assert len(cases) == 6 == len(campaign.plan["cases"])
    assert set(cases["verdict"]) == {"pass"}
    assert cases.units["navigation.radial_error_nmi.max"] == "nmi"
    assert (cases["navigation.radial_error_nmi.max"] > 0).all()


def test_checks_and_drift_belong_to_the_cases(campaign):
    assert set(campaign.checks["case"]) == set(campaign.cases["case"])
    assert campaign.drift.units == {
        "hours": "h", "latitude_error_arcmin": "arcmin", "longitude_error_arcmin": "arcmin",
    }
    for case in campaign.cases["case"]:
        hours = campaign.drift["hours"][campaign.drift["case"] == case]
        assert np.all(np.diff(hours) > 0)


def test_statistics_are_those_of_the_report(campaign):
    assert campaign.statistics["schema"] >= 1


def test_the_same_call_goes_on_where_it_was(campaign):
    again = octant.campaign("nowhere.toml", campaign.path, progress=False)
    assert again.cases["stream_hash"].tolist() == campaign.cases["stream_hash"].tolist()


def test_a_folder_of_a_campaign_is_opened_as_one(campaign):
    assert isinstance(octant.open(campaign.path), octant.Campaign)


def test_a_campaign_that_is_refused_says_why(tmp_path):
    (tmp_path / "campaign.toml").write_text(CAMPAIGN.replace("replicates", "replicate"))
    with pytest.raises(octant.InputError, match="replicates"):
        octant.campaign(tmp_path / "campaign.toml", tmp_path / "out")


def test_a_night_is_opened_by_its_file(tmp_path):
    (tmp_path / "night.json").write_text('{"schema": 1, "id": "2026-03-02"}')
    (tmp_path / "nightly.json").write_text('{"schema": 1, "verdict": "pass"}')
    night = octant.open(tmp_path)
    assert isinstance(night, octant.Night) and night.verdict == "pass"
    assert night.night["id"] == "2026-03-02" and night.campaigns == {}
