//! Default values of a scenario.

use super::numbers::Found;
use octant_scenario::{MotionSpec, Scenario};
use std::path::Path;

const STATIC: &str = "schema = 1\n[procedure.navigation]\nduration = \"1 h\"\n";

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    let read = |text: &str| {
        Scenario::parse(text, "answers.toml", Path::new("."), &[]).map_err(|why| why.to_string())
    };
    for preset in ["default", "severe"] {
        let ship = format!("[motion]\nkind = \"dockside\"\nship = {{ preset = \"{preset}\" }}\n");
        let MotionSpec::Dockside(ship) = read(&(STATIC.to_owned() + &ship))?.motion else {
            return Err("read a ship: found a static base".to_owned());
        };
        for (i, of) in ship.components.iter().enumerate() {
            let one = of.first().ok_or_else(|| format!("find motion {i} of {preset}"))?;
            all.insert(format!("{preset} amplitude {i}"), one.amplitude);
            all.insert(format!("{preset} period {i}"), one.period_s);
        }
    }
    let scenario = read(STATIC)?;
    for (name, value) in [
        ("latitude", scenario.site.latitude_rad),
        ("longitude", scenario.site.longitude_rad),
        ("angle random walk", scenario.imu.angle_random_walk),
        ("velocity random walk", scenario.imu.velocity_random_walk),
        ("turntable rate", scenario.turntable.rate_radps),
        ("turntable acceleration", scenario.turntable.acceleration_radps2),
        ("encoder of the screens", scenario.screening.encoder_sigma_rad),
        ("gyro range", scenario.imu.extensions.gyro_range_radps),
    ] {
        all.insert(name.to_owned(), value);
    }
    Ok(all)
}
