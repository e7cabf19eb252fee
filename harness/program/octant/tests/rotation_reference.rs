//! References of the drift by g_zz, which depend on the rotation in navigation.

use crate::common::program::{ended, json, octant_in};

const SCENARIO: &str = "schema = 1\ntitle = \"rotation\"\n[imu]\nrate = \"20 Hz\"\n[procedure.calibration]\n\
    duration = \"10 min\"\n[procedure.navigation]\nduration = \"20 min\"\n";

#[test]
fn the_drift_by_g_zz_is_told_where_the_rotation_leaves_g_zz_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), SCENARIO).unwrap();
    for (rotation, told) in [("sixteen", true), ("tetrahedral", false)] {
        let set = format!("procedure.navigation.rotation=\"{rotation}\"");
        ended(octant_in(folder.path(), &["run", "s.toml", "--out", rotation, "--set", &set]), 0);
        let reference = &json(&folder.path().join(rotation).join("summary.json"))["reference"];
        for of in ["true_g_zz", "residual_g_zz"] {
            assert_eq!(reference[of].is_object(), told, "{rotation}: {of} {}", reference[of]);
        }
        assert!(
            reference["random_walk"].is_object(),
            "{rotation}: the noise is that of any rotation"
        );
    }
}
