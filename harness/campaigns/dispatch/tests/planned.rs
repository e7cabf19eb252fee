//! A campaign of short cases.

use octant_campaign::plan::Plan;
use std::path::Path;

const SCENARIO: &str = "schema = 1
title = \"short\"
[procedure.calibration]
duration = \"20 s\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]
[procedure.navigation]
duration = \"5 s\"
";

/// Plan of a campaign with so many cases, whose files are in a folder.
pub(crate) fn planned(folder: &Path, title: &str, cases: usize) -> Plan {
    let at = |name: &str| folder.join(name);
    std::fs::write(at("short.toml"), SCENARIO).unwrap();
    let campaign = format!(
        "schema = 1\ntitle = \"{title}\"\nreplicates = {cases}\n[[scenarios]]\nid = \"short\"\nfile = \"short.toml\"\n"
    );
    std::fs::write(at("campaign.toml"), campaign).unwrap();
    Plan::of(&at("campaign.toml")).unwrap()
}
