//! Units: SI values of a scenario's quantities.

use super::numbers::Found;
use octant_sample::parameters::ParameterGroup;
use octant_scenario::quantity;

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    for known in super::numbers::known("units") {
        let name = known.name;
        let value = match name.strip_prefix("unit of ") {
            Some(group) => of_group(group).ok_or_else(|| format!("find the group {group}"))?,
            None => quantity::parse(&name).map_err(|why| format!("parse {name}: {why:?}"))?.si,
        };
        all.insert(name, value);
    }
    Ok(all)
}

fn of_group(name: &str) -> Option<f64> {
    let plain = |group: &ParameterGroup| group.name().replace('_', " ") == name.replace('-', " ");
    ParameterGroup::ALL
        .into_iter()
        .find(plain)
        .map(|group| std::hint::black_box(group).si_per_unit())
}
