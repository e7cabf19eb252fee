//! The resolved scenario, with every default and every drawn value.

use super::derive::without_effect;
use super::document::{Entry, Node, Table, Value, write_value};
use super::error::Place;
use super::keys::{Kind, SCENARIO, Section};
use super::model::{Alignment, MOTIONS, Motion, Scenario};
use super::quantity::Dimension;
use super::resolve::Draws;
use octant_sample::parameters::Group;
use std::fmt::Write as _;
use std::path::Path;

impl Scenario {
    /// Writes the scenario as TOML with every default and every drawn value. Parsed again, with the
    /// same seed, it gives the same run.
    #[must_use]
    pub fn to_resolved_toml(&self, seed: u64, draws: &Draws) -> String {
        let mut document = self.document.clone();
        for (path, _) in without_effect(&document) {
            document.remove_at(&path);
        }
        document.set("seed", node(Value::Integer(i64::try_from(seed).unwrap_or(i64::MAX))));
        let parameters = draws.parameters.to_array();
        for group in Group::ALL {
            let values = quantities(dimension_of(group), &parameters[group.range()]);
            let constant = table(vec![("constant", values)]);
            document.set_at(&format!("imu.{}", group.name()), node(constant));
        }
        if let Motion::Dockside(_) = &self.motion {
            document.remove_at("motion.ship.spectrum");
            document.set_at("motion.ship.preset", node(Value::Text("calm".to_owned())));
            for (index, name) in MOTIONS.into_iter().enumerate() {
                let amplitude = if index < 3 { Dimension::ANGLE } else { Dimension::LENGTH };
                let component = |sinusoid: &octant_plant::config::Sinusoid| {
                    node(table(vec![
                        ("amplitude", text(amplitude.write(sinusoid.amplitude))),
                        ("period", text(Dimension::TIME.write(sinusoid.period_s))),
                        ("phase", text(Dimension::ANGLE.write(sinusoid.phase_rad))),
                    ]))
                };
                let components = draws.motion[index].iter().map(component);
                let components = Value::Array(components.collect());
                document.set_at(&format!("motion.ship.{name}"), node(components));
            }
        }
        if let Alignment::Given { .. } = self.alignment {
            let attitude = quantities(Dimension::SMALL_ANGLE, &draws.attitude_error_rad);
            let velocity = quantities(Dimension::VELOCITY, &draws.velocity_error_mps);
            document.set_at("procedure.alignment.attitude_error", node(attitude));
            document.set_at("procedure.alignment.velocity_error", node(velocity));
        }
        self.write_files(&mut document);
        let mut out = String::from(
            "# Resolved by Octant: every default and every value drawn from the seed.\n",
        );
        write_table(&document, SCENARIO, "", &mut out);
        out
    }

    /// Makes relative file names absolute, because the resolved scenario is in another folder.
    fn write_files(&self, document: &mut Table) {
        let folder = std::path::absolute(&self.folder).unwrap_or_else(|_| self.folder.clone());
        let absolute = |file: &str| {
            if file.starts_with("${") || Path::new(file).is_absolute() {
                file.to_owned()
            } else {
                folder.join(file).display().to_string()
            }
        };
        for path in [
            "source.uri",
            "endpoint.uri",
            "source.text.gyro.file",
            "source.text.accelerometer.file",
            "turntable.drive.dialect",
            "source.live.database",
            "source.live.mapping",
        ] {
            let Some(Node { value: Value::Text(written), .. }) = document.at(path) else {
                continue;
            };
            let resolved = match (path, written.split_once(':')) {
                ("source.uri" | "endpoint.uri", None) => continue,
                ("turntable.drive.dialect", _)
                    if written == octant_turntable::Dialect::BUILT_IN =>
                {
                    continue;
                }
                // A port, which is no file.
                ("source.uri", Some(_)) if octant_link::Uri::is_one(written) => continue,
                ("endpoint.uri", Some((scheme, _))) if scheme != "fmu" => continue,
                ("source.uri" | "endpoint.uri", Some((scheme, file))) => {
                    format!("{scheme}:{}", absolute(file))
                }
                _ => absolute(written),
            };
            document.set_at(path, node(Value::Text(resolved)));
        }
    }
}

/// Dimension in which a group is written.
fn dimension_of(group: Group) -> Dimension {
    match group {
        Group::GyroBias => Dimension::GYRO_BIAS,
        Group::GyroScale | Group::AccelScale => Dimension::RATIO,
        Group::GyroMisalignment | Group::AccelMisalignment => Dimension::SMALL_ANGLE,
        Group::GDependent => Dimension::G_DEPENDENT,
        Group::AccelBias => Dimension::ACCEL_BIAS,
    }
}

fn node(value: Value) -> Node {
    Node { value, place: Place::Default }
}

fn text(text: String) -> Value {
    Value::Text(text)
}

fn quantities(dimension: Dimension, values: &[f64]) -> Value {
    Value::Array(values.iter().map(|value| node(text(dimension.write(*value)))).collect())
}

fn table(entries: Vec<(&str, Value)>) -> Value {
    let entry = |(key, value): (&str, Value)| Entry {
        key: key.to_owned(),
        place: Place::Default,
        node: node(value),
    };
    Value::Table(Table { entries: entries.into_iter().map(entry).collect() })
}

/// Writes a table in the order of its keys: values first, then tables with their headers.
fn write_table(table: &Table, section: &Section, path: &str, out: &mut String) {
    let mut later = Vec::new();
    for key in section.keys {
        let Some(node) = table.get(key.name) else { continue };
        let kind = match &key.kind {
            Kind::Either(kinds) => kinds.iter().find(|kind| kind.section().is_some()),
            kind => Some(kind),
        };
        match (kind, &node.value) {
            (Some(Kind::Table(inner)), Value::Table(table)) if !inner.one_of => {
                later.push((key.name, *inner, vec![table], false));
            }
            (Some(Kind::Tables(inner, ..)), Value::Array(entries)) if path.is_empty() => {
                let tables = entries.iter().filter_map(|entry| match &entry.value {
                    Value::Table(table) => Some(table),
                    _ => None,
                });
                later.push((key.name, *inner, tables.collect(), true));
            }
            (Some(Kind::VariantTables(variants, _)), Value::Array(entries)) => {
                for entry in entries {
                    if let Value::Table(table) = &entry.value
                        && let Some(inner) = variants.section(table)
                    {
                        later.push((key.name, inner, vec![table], true));
                    }
                }
            }
            _ => {
                _ = write!(out, "{} = ", key.name);
                write_value(&node.value, out);
                out.push('\n');
            }
        }
    }
    for (name, section, tables, array) in later {
        let path = super::document::join(path, name);
        for table in tables {
            _ = if array { write!(out, "\n[[{path}]]\n") } else { write!(out, "\n[{path}]\n") };
            write_table(table, section, &path, out);
        }
    }
}
