//! The resolved scenario, with every default and every drawn value.

use super::arguments::override_set;
use super::derive::without_effect;
use super::error::{Place, Problem};
use super::keys::{Kind, SCENARIO, Section, key, keys_of};
use super::model::{AlignmentSpec, MOTIONS, MotionSpec, RequirementSpec, Scenario};
use super::quantity::UnitDimension;
use super::resolve::DrawnValues;
use super::trajectory::OF_RUN;
use octant_sample::further::FurtherGroup;
use octant_sample::parameters::ParameterGroup;
use octant_toml_tree::{Entry, Node, Table, Value, join, write_value};
use std::fmt::Write as _;
use std::path::Path;

impl Scenario {
    /// Writes the scenario as TOML with every default and every drawn value. Parsed again, with the
    /// same seed, it gives the same run.
    #[must_use]
    pub fn to_resolved_toml(&self, seed: u64, draws: &DrawnValues) -> String {
        let mut document = self.document.clone();
        for (path, _) in without_effect(&document) {
            document.remove_at(path);
        }
        document.set(key!(seed), node(Value::Integer(i64::try_from(seed).unwrap_or(i64::MAX))));
        let parameters = draws.parameters.to_array();
        for group in ParameterGroup::ALL {
            let values = quantities(dimension_of(group), &parameters[group.range()]);
            let constant = table(vec![("constant", values)]);
            document.set_at(&join(key!(imu), group.name()), node(constant));
        }
        self.write_drawn(&mut document, draws);
        if let MotionSpec::Dockside(_) = &self.motion {
            document.remove_at(key!(motion.ship.spectrum));
            document.set_at(key!(motion.ship.preset), node(Value::Text("calm".to_owned())));
            for (index, name) in MOTIONS.into_iter().enumerate() {
                let amplitude =
                    if index < 3 { UnitDimension::ANGLE } else { UnitDimension::LENGTH };
                let component = |sinusoid: &octant_plant::config::Sinusoid| {
                    node(table(vec![
                        ("amplitude", text(amplitude.write(sinusoid.amplitude))),
                        ("period", text(UnitDimension::TIME.write(sinusoid.period_s))),
                        ("phase", text(UnitDimension::ANGLE.write(sinusoid.phase_rad))),
                    ]))
                };
                let components = draws.motion[index].iter().map(component);
                let components = Value::Array(components.collect());
                document.set_at(&join(key!(motion.ship), name), node(components));
            }
        }
        if let AlignmentSpec::Given { .. } = self.alignment {
            let attitude = quantities(UnitDimension::SMALL_ANGLE, &draws.attitude_error_rad);
            let velocity = quantities(UnitDimension::VELOCITY, &draws.velocity_error_mps);
            document.set_at(key!(procedure.alignment.attitude_error), node(attitude));
            document.set_at(key!(procedure.alignment.velocity_error), node(velocity));
        }
        self.write_files(&mut document);
        let mut out = String::from(
            "# Resolved by Octant: every default and every value drawn from the seed.\n",
        );
        write_table(&document, SCENARIO, "", &mut out);
        out
    }

    /// Adds requirements, as a campaign does to its scenarios: they are judged, and written with the scenario.
    pub fn require(&mut self, more: Vec<RequirementSpec>) {
        let written = more.iter().map(|requirement| {
            let RequirementSpec { check, text: sentence, limit_text: _, clause } = requirement;
            let mut entries = vec![
                ("id", text(check.id.clone())),
                ("text", text(sentence.clone())),
                ("measure", text(check.measure.clone())),
                ("comparison", text(check.comparison.sign().to_owned())),
                ("limit", Value::Number(check.limit)),
            ];
            if check.secant_latitude {
                entries.push(("secant_latitude", Value::Boolean(true)));
            }
            entries.extend(clause.iter().map(|clause| ("clause", text(clause.clone()))));
            node(table(entries))
        });
        let key = key!(requirements);
        let mut all = match self.document.get(key).map(|node| &node.value) {
            Some(Value::Array(all)) => all.clone(),
            _ => Vec::new(),
        };
        all.extend(written);
        if !all.is_empty() {
            self.document.set(key, node(Value::Array(all)));
        }
        self.requirements.extend(more);
    }

    /// Writes the scenario as TOML with every default and with changes, `KEY=VALUE` as of `--set`. What is
    /// drawn stays to be drawn. `about` are the lines of the comment at its top.
    ///
    /// # Errors
    /// If a change is of no key. Values are checked when the text is read.
    pub fn to_toml_with(&self, changes: &[String], about: &[String]) -> Result<String, Problem> {
        let mut document = self.document.clone();
        for change in changes {
            override_set(&mut document, change)?;
        }
        for (path, _) in without_effect(&document) {
            document.remove_at(path);
        }
        self.write_files(&mut document);
        let mut out: String = about.iter().map(|line| format!("# {line}\n")).collect();
        write_table(&document, SCENARIO, "", &mut out);
        Ok(out)
    }

    /// Writes the errors beside the parameters that were drawn as given ones.
    fn write_drawn(&self, document: &mut Table, draws: &DrawnValues) {
        let errors = self.true_further(draws);
        for (group, _) in FurtherGroup::ALL.iter().zip(&self.further).filter(|(_, of)| of.is_some())
        {
            let values = errors[group.range()].iter().map(|error| error.unwrap_or(0.0));
            let values: Vec<f64> = values.collect();
            let mut set = |key: &str, value| document.set_at(key, node(value));
            let extension = |dimension| quantities(dimension, &values);
            let one = |dimension: UnitDimension, index: usize| text(dimension.write(values[index]));
            match group {
                FurtherGroup::AccelLever => {
                    let paths = keys_of!(imu.extensions.lever_arm: x, y, z);
                    for (path, arm) in paths.into_iter().zip(values.chunks(3)) {
                        set(path, quantities(UnitDimension::LENGTH, arm));
                    }
                }
                FurtherGroup::GyroAsymmetry => {
                    set(key!(imu.extensions.gyro_asymmetry), extension(UnitDimension::RATIO));
                }
                FurtherGroup::AccelAsymmetry => {
                    set(key!(imu.extensions.accel_asymmetry), extension(UnitDimension::RATIO));
                }
                FurtherGroup::AccelQuadratic => {
                    let values = extension(UnitDimension::ACCEL_QUADRATIC);
                    set(key!(imu.extensions.accel_quadratic), values);
                }
                FurtherGroup::GyroBiasTemperature => {
                    let values = extension(UnitDimension::GYRO_BIAS_PER_K);
                    set(key!(imu.extensions.temperature.gyro_bias), values);
                }
                FurtherGroup::GyroScaleTemperature => {
                    let values = extension(UnitDimension::SCALE_PER_K);
                    set(key!(imu.extensions.temperature.gyro_scale), values);
                }
                FurtherGroup::AccelBiasTemperature => {
                    let values = extension(UnitDimension::ACCEL_BIAS_PER_K);
                    set(key!(imu.extensions.temperature.accel_bias), values);
                }
                FurtherGroup::AccelScaleTemperature => {
                    let values = extension(UnitDimension::SCALE_PER_K);
                    set(key!(imu.extensions.temperature.accel_scale), values);
                }
                FurtherGroup::Deflection => {
                    set(key!(site.deflection_north), one(UnitDimension::SMALL_ANGLE, 0));
                    set(key!(site.deflection_east), one(UnitDimension::SMALL_ANGLE, 1));
                }
                FurtherGroup::GravityAnomaly => {
                    set(key!(site.gravity_anomaly), one(UnitDimension::ACCEL_BIAS, 0));
                }
                FurtherGroup::GimbalMounting => {
                    // The truth of z has the azimuth encoder's zero in it, which is a key of its own.
                    let mut values = values.clone();
                    values[2] += self.turntable.errors.encoder_zero_rad[0];
                    set(key!(turntable.mounting), quantities(UnitDimension::SMALL_ANGLE, &values));
                }
                FurtherGroup::GimbalNonOrthogonality => {
                    set(key!(turntable.non_orthogonality), one(UnitDimension::SMALL_ANGLE, 0));
                }
                FurtherGroup::EncoderEccentricity => {
                    let given = self.turntable.errors.eccentricity_rad;
                    let drawn = &draws.further[group.range()];
                    let paths = keys_of!(turntable: eccentricity_azimuth, eccentricity_roll);
                    for (axis, path) in paths.into_iter().enumerate() {
                        // A drawn curve hides the truth: that of the coefficients is the sum.
                        let values = [0, 1].map(|i| given[axis][i] + drawn[2 * axis + i]);
                        let values = quantities(UnitDimension::SMALL_ANGLE, &values);
                        set(path, values);
                    }
                }
                FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov => {}
            }
        }
        document.remove_at(key!(imu.extensions.drawn));
        document.remove_at(key!(site.drawn));
        document.remove_at(key!(turntable.drawn));
    }

    /// Makes relative file names absolute, because the resolved scenario is in another folder.
    fn write_files(&self, document: &mut Table) {
        let folder = std::path::absolute(&self.folder).unwrap_or_else(|_| self.folder.clone());
        let absolute = |file: &str| {
            let stays = file.starts_with("${") || file == OF_RUN;
            if stays || Path::new(file).is_absolute() {
                file.to_owned()
            } else {
                folder.join(file).display().to_string()
            }
        };
        super::files::replace(document, |file| Some(absolute(file)));
    }
}

/// Dimension in which a group is written.
fn dimension_of(group: ParameterGroup) -> UnitDimension {
    match group {
        ParameterGroup::GyroBias => UnitDimension::GYRO_BIAS,
        ParameterGroup::GyroScale | ParameterGroup::AccelScale => UnitDimension::RATIO,
        ParameterGroup::GyroMisalignment | ParameterGroup::AccelMisalignment => {
            UnitDimension::SMALL_ANGLE
        }
        ParameterGroup::GDependent => UnitDimension::G_DEPENDENT,
        ParameterGroup::AccelBias => UnitDimension::ACCEL_BIAS,
    }
}

fn node(value: Value) -> Node {
    Node { value, place: Place::Default }
}

fn text(text: String) -> Value {
    Value::Text(text)
}

fn quantities(dimension: UnitDimension, values: &[f64]) -> Value {
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
        let path = join(path, name);
        for table in tables {
            _ = if array { write!(out, "\n[[{path}]]\n") } else { write!(out, "\n[{path}]\n") };
            write_table(table, section, &path, out);
        }
    }
}
