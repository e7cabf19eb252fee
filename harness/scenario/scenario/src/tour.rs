//! The tour: a scenario with every key and its meaning, made from the table of keys.
//!
//! Keys that are omitted by default, or that contradict another one, are comments in it.

use super::complete::expected;
use super::keys::{Bounds, Default, Key, Kind, SCENARIO, Section, cases_in_words, key};
use super::ports;
use super::quantity::{self, UnitDimension};
use octant_faults::{connection::kinds as connection, kinds};
use octant_toml_tree::{join, parse_default, write_value};

/// Settings of the tour beside the defaults: path and TOML value.
const SET: &[(&str, &str)] = &[
    (key!(schema), "1"),
    (key!(title), "a tour of every key"),
    (key!(procedure.calibration.positions), "eight"),
    (key!(procedure.navigation.duration), "24 h"),
    (key!(baseline.positions), "six"),
    (key!(baseline.g_states), "false"),
    (key!(requirements.id), "NAV-1"),
    (key!(requirements.text), "The longitude error stays below 20 arcmin over 24 hours."),
    (key!(requirements.measure), "navigation.longitude_error_arcmin.max"),
    (key!(requirements.limit), "20 arcmin"),
    (key!(requirements.clause), "example: no document behind it"),
];

/// Tables that are omitted by default but present in the tour.
const OPENED: &[&str] =
    &[key!(procedure.calibration), key!(procedure.navigation), key!(baseline), key!(requirements)];

/// Examples for keys for which the example of the dimension isn't useful.
const EXAMPLES: &[(&str, &str)] = &[
    (key!(motion.ship.roll), r#"[{ amplitude = "3 deg", period = "8 s", phase = "0 deg" }]"#),
    (key!(motion.ship.pitch), r#"[{ amplitude = "1.5 deg", period = "6 s", phase = "0 deg" }]"#),
    (key!(motion.ship.yaw), r#"[{ amplitude = "1 deg", period = "10 s", phase = "0 deg" }]"#),
    (key!(motion.ship.surge), r#"[{ amplitude = "0.2 m", period = "6 s", phase = "0 deg" }]"#),
    (key!(motion.ship.sway), r#"[{ amplitude = "0.2 m", period = "7 s", phase = "0 deg" }]"#),
    (key!(motion.ship.heave), r#"[{ amplitude = "0.2 m", period = "8 s", phase = "0 deg" }]"#),
    (key!(motion.ship.spectrum.peak_period), r#""8 s""#),
    (key!(turntable.drive.port), r#""tcp:192.168.1.20:8000""#),
    (key!(turntable.drive.azimuth), r#"["-185 deg", "365 deg"]"#),
    (key!(turntable.drive.roll), r#"["-185 deg", "365 deg"]"#),
    (key!(turntable.drive.guard), r#""1 s""#),
    (key!(power.port), r#""tcp:192.168.1.30""#),
    (key!(power.relay), "1"),
    (key!(procedure.calibration.name), r#""eight with other tilts""#),
    (key!(baseline.name), r#""level and on edge""#),
    (key!(imu.extensions.temperature.plateau), r#""15 K""#),
    (key!(imu.extensions.vibration.frequency), r#""35 Hz""#),
    (
        key!(procedure.calibration.stops),
        r#"[{ azimuth = "0 deg", roll = "0 deg", weight = 1.0 }, { azimuth = "0 deg", roll = "45 deg", weight = 2.0 }]"#,
    ),
    (
        key!(baseline.stops),
        r#"[{ azimuth = "0 deg", roll = "0 deg", weight = 1.0 }, { azimuth = "0 deg", roll = "90 deg", weight = 1.0 }]"#,
    ),
    (key!(source.mcap.accelerometer.topic), r#""/accel""#),
    (key!(source.text.gyro.file), r#""gyroscope.txt""#),
    (key!(source.text.gyro.y), "3"),
    (key!(source.text.gyro.z), "4"),
    (key!(source.text.accelerometer.file), r#""accelerometer.txt""#),
    (key!(source.text.accelerometer.x), "5"),
    (key!(source.text.accelerometer.y), "6"),
    (key!(source.text.accelerometer.z), "7"),
    (key!(source.text.temperature_column), "10"),
    (key!(source.text.gimbal.azimuth), "8"),
    (key!(source.text.gimbal.roll), "9"),
    (key!(source.live.protocol), r#""vectornav""#),
    (key!(source.live.gyro_count), r#""0.000390625 arcsec""#),
    (key!(source.live.accel_count), r#""1.5e-6 m/s""#),
    (key!(source.live.stamps_within), r#""50 us""#),
    (key!(source.live.host_clock), r#""/dev/ptp0""#),
    (key!(source.live.host_within), r#""1 us""#),
    (key!(source.live.tai_offset), "37"),
    (key!(source.live.pps), r#""/dev/pps0""#),
    (key!(source.log.protocol), r#""vectornav""#),
    (key!(source.log.description), r#""unit.toml""#),
    (key!(source.live.description), r#""unit.toml""#),
    (key!(source.log.gyro_count), r#""0.000390625 arcsec""#),
    (key!(source.log.accel_count), r#""1.5e-6 m/s""#),
    (key!(source.live.database), r#""unit.dbc""#),
    (key!(source.live.mapping), r#""unit.toml""#),
    (key!(source.mcap.topic), r#""/imu""#),
    (key!(source.mcap.time_field), r#""header.stamp.sec""#),
    (key!(source.mcap.nanoseconds_field), r#""header.stamp.nanosec""#),
    (key!(source.mcap.temperature_field), r#""temperature""#),
    (key!(source.mcap.gyro.x), r#""angular_velocity.x""#),
    (key!(source.mcap.gyro.y), r#""angular_velocity.y""#),
    (key!(source.mcap.gyro.z), r#""angular_velocity.z""#),
    (key!(source.mcap.accelerometer.x), r#""linear_acceleration.x""#),
    (key!(source.mcap.accelerometer.y), r#""linear_acceleration.y""#),
    (key!(source.mcap.accelerometer.z), r#""linear_acceleration.z""#),
    (key!(source.fmu.time_limit), r#""10 s""#),
    (key!(source.fmu.step), r#""5 ms""#),
    (key!(source.fmu.tolerance), "1e-6"),
    (key!(source.fmu.map.gyro.rate), r#"["imu.wx", "imu.wy", "-imu.wz"]"#),
    (key!(source.fmu.map.gyro.delta_theta), r#""imu.delta_theta""#),
    (
        key!(source.fmu.map.accelerometer.specific_force),
        r#"[{ variable = "imu.fx", unit = "g" }, { variable = "imu.fy", unit = "g" }, { variable = "imu.fz", unit = "g" }]"#,
    ),
    (key!(source.fmu.map.gimbal.roll), r#"{ constant = "0 deg" }"#),
    (key!(endpoint.link.hello), r#""10 s""#),
    (key!(endpoint.fmu.time_limit), r#""10 s""#),
    (key!(endpoint.fmu.tolerance), "1e-6"),
    (key!(endpoint.fmu.parameters), r#"{ "filter.gain" = 0.5 }"#),
    (key!(endpoint.fmu.modes.calibrating), r#"[1, "turning"]"#),
];

/// Kind of fault in the tour.
const SHOWN_FAULT: &str = "spike";

/// Examples for keys of the fault in the tour.
const FAULT_EXAMPLES: &[(&str, &str)] = &[
    ("id", r#""spike-1""#),
    ("channels", r#""gyro x""#),
    ("amplitude", r#""1000 deg/h""#),
    ("trigger", r#"{ at = "5050 s" }"#),
    ("duration", r#""100 samples""#),
    ("repeat", r#"{ times = 3, every = "10 s" }"#),
];

/// Example for the key at a path, as TOML.
fn example_at(path: &str, kind: &Kind) -> String {
    let own = match path.split_once('.') {
        Some((table, key)) if table == key!(faults) => {
            FAULT_EXAMPLES.iter().find(|(name, _)| *name == key)
        }
        _ => EXAMPLES.iter().find(|(name, _)| *name == path),
    };
    own.map_or_else(|| example(kind), |(_, text)| (*text).to_owned())
}

/// Keys with a default that have no effect beside the tour's settings.
const CLOSED: &[&str] =
    &[key!(procedure.alignment.duration), key!(procedure.calibration.least_squares)];

/// Makes the tour as TOML. It can be run: 4 hours of calibration, 24 hours of navigation, two methods.
#[must_use]
pub fn tour() -> String {
    let mut out = String::from(
        "# A tour of every key of a scenario: what it takes, its default and its meaning.\n\
         #\n\
         # Lines that start with \"#:\" are keys that this scenario leaves out: take the mark away to use\n\
         # one. All others have their defaults, but for title, positions, navigation, baseline and\n\
         # requirements. It runs: the instrument of Table 1 of the paper, static, four hours of\n\
         # calibration in eight positions, 24 hours of navigation, and again with six positions.\n\n",
    );
    table(SCENARIO, "", true, &mut out);
    out
}

/// Writes the keys of a table: values first, then tables under their headers.
fn table(section: &Section, path: &str, open: bool, out: &mut String) {
    let possible = || section.keys.iter().filter(|key| !matches!(key.kind, Kind::Refused(_)));
    for key in possible().filter(|key| headed(key, path).is_none()) {
        comment(key, out);
        let path = join(path, key.name);
        let set = SET.iter().find(|(name, _)| *name == path).map(|(_, text)| *text);
        let default = match key.default {
            Default::Value(text) => Some(text),
            _ => None,
        };
        let open = open && !CLOSED.contains(&path.as_str());
        let mark = if open && set.or(default).is_some() { "" } else { "#: " };
        let value = set.or(default).map_or_else(|| example_at(&path, &key.kind), written);
        *out += &format!("{mark}{} = {value}\n", key.name);
    }
    for key in possible() {
        let Some((inner, array)) = headed(key, path) else { continue };
        let path = join(path, key.name);
        let optional = !matches!(key.default, Default::Section | Default::Value(_));
        let open = open
            && (!optional || OPENED.contains(&path.as_str()))
            && !CLOSED.contains(&path.as_str());
        out.push('\n');
        comment(key, out);
        let mark = if open { "" } else { "#: " };
        *out += &if array { format!("{mark}[[{path}]]\n") } else { format!("{mark}[{path}]\n") };
        table(inner, &path, open, out);
    }
}

/// Keys of a table with its own header, and whether it is one of an array.
fn headed(key: &Key, path: &str) -> Option<(&'static Section, bool)> {
    match &key.kind {
        Kind::Table(section) if !section.one_of => Some((section, false)),
        Kind::Tables(section, ..) if path.is_empty() => Some((section, true)),
        // A fault has many forms: one of them shows the common keys.
        Kind::VariantTables(variants, _) => {
            let (_, section) = (variants.forms)().iter().find(|(name, _)| *name == SHOWN_FAULT)?;
            Some((section, true))
        }
        Kind::Either(kinds) => kinds.iter().find_map(Kind::section).map(|section| (section, false)),
        _ => None,
    }
}

/// Writes meaning, kind and default of a key as a comment.
fn comment(key: &Key, out: &mut String) {
    let mut text = key.doc.to_owned();
    match &key.kind {
        Kind::Table(section) if section.one_of => {
            let each = section.keys.iter().map(|key| {
                format!("{} = {} ({})", key.name, example(&key.kind), key.doc.trim_end_matches('.'))
            });
            text += &format!(" One of: {}.", each.collect::<Vec<_>>().join("; "));
        }
        Kind::Variants(variants) => {
            let each = (variants.forms)().iter().map(|(_, section)| {
                let key = &section.keys[0];
                let doc = key.doc.trim_end_matches('.');
                let more: Vec<String> = section.keys[1..]
                    .iter()
                    .map(|key| format!("{} = {}", key.name, example_in_form(key)))
                    .collect();
                let more = if more.is_empty() {
                    String::new()
                } else {
                    format!("; with it {}", more.join(", "))
                };
                format!("{} = {} ({doc}{more})", key.name, example_in_form(key))
            });
            text += &format!(" One of: {}.", each.collect::<Vec<_>>().join("; "));
        }
        Kind::Choice(choices) | Kind::Uri(choices) => {
            let each = choices.iter().map(|(name, doc)| {
                if doc.is_empty() { format!("{name:?}") } else { format!("{name:?} ({doc})") }
            });
            text += &format!(" {}.", each.collect::<Vec<_>>().join("; "));
        }
        Kind::Either(kinds) if !kinds.iter().any(|kind| matches!(kind, Kind::Table(_))) => {
            text += &format!(" Takes {}.", expected(&key.kind));
        }
        Kind::Either(kinds) => {
            let texts = kinds.iter().filter(|kind| !matches!(kind, Kind::Table(_)));
            let each = texts.map(|kind| format!("{} = {}", key.name, example(kind)));
            text += &format!(" Instead of the table: {}.", each.collect::<Vec<_>>().join(" or "));
        }
        Kind::Table(_) | Kind::Tables(..) | Kind::VariantTables(..) => {}
        kind => text += &format!(" Takes {}.", expected(kind)),
    }
    match key.default {
        Default::Value(default) if !matches!(key.kind, Kind::Either(_)) => {
            text += &format!(" Default {}.", written(default));
        }
        Default::Value(_) | Default::Section => {}
        Default::Derived(words) => text += &format!(" Default: {words}."),
        Default::ByCase(cases) => text += &format!(" Default: {}.", cases_in_words(cases)),
        Default::Absent(words) => text += &format!(" Left out: {words}."),
        Default::Required => text += " Always given.",
    }
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > 100 {
            *out += &line;
            out.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line += word;
    }
    *out += &line;
    out.push('\n');
}

/// Writes a default of the table as TOML.
fn written(default: &str) -> String {
    let mut out = String::new();
    write_value(&parse_default(default).value, &mut out);
    out
}

/// Example value of a kind, as TOML.
fn example(kind: &Kind) -> String {
    let repeat = |text: &str, count: usize| format!("[{}]", vec![text; count].join(", "));
    match kind {
        Kind::Text => "\"text\"".to_owned(),
        Kind::Choice(choices) | Kind::Uri(choices) => format!("{:?}", choices[0].0),
        Kind::Choices(choices) => format!("[{:?}]", choices[0]),
        Kind::Boolean => "true".to_owned(),
        Kind::Integer(from, _) => from.to_string(),
        Kind::Number(_) => "1.0".to_owned(),
        Kind::Numbers(count) => repeat("1.0", *count),
        Kind::Quantity(dimensions, _) => format!("{:?}", dimensions[0].example),
        Kind::Quantities(dimension, count) => repeat(&format!("{:?}", dimension.example), *count),
        Kind::Vector(dimensions) => repeat(&format!("{:?}", dimensions[0].example), 3),
        Kind::Times => "[\"5050 s\"]".to_owned(),
        Kind::Condition => format!("{:?}", super::condition::EXAMPLE),
        Kind::Channels => format!("{:?}", octant_faults::Channels::NAMES[0].0),
        Kind::Limit => "\"20 arcmin\"".to_owned(),
        Kind::Column => "2".to_owned(),
        Kind::Port(channel) => ports::example_port(channel),
        Kind::Settings => r#"{ "ship.mass" = 3.2e6 }"#.to_owned(),
        Kind::Values => "[1]".to_owned(),
        Kind::Names => "[]".to_owned(),
        Kind::Lists => "[[]]".to_owned(),
        Kind::Codes => "1".to_owned(),
        Kind::Table(section) | Kind::Tables(section, ..) => {
            let possible = |key: &&Key| !matches!(key.kind, Kind::Refused(_));
            let keys = section.keys.iter().filter(possible);
            let keys = keys.take(if section.one_of { 1 } else { usize::MAX });
            let each = keys.map(|key| match key.default {
                Default::Value(text) => format!("{} = {}", key.name, written(text)),
                _ => format!("{} = {}", key.name, example(&key.kind)),
            });
            let table = format!("{{ {} }}", each.collect::<Vec<_>>().join(", "));
            if matches!(kind, Kind::Tables(..)) { format!("[{table}]") } else { table }
        }
        Kind::Variants(variants) => {
            let (_, section) = &(variants.forms)()[0];
            format!("{{ {} }}", given(section).join(", "))
        }
        Kind::VariantTables(variants, _) => {
            let (_, section) = &(variants.forms)()[0];
            format!("[{{ {} }}]", given(section).join(", "))
        }
        Kind::Either(kinds) => example(&kinds[0]),
        Kind::Refused(reason) => format!("{reason:?}"),
    }
}

/// Examples for keys of triggers and repetitions.
const FORM_EXAMPLES: &[(&str, &str)] = &[
    ("at", r#""5050 s""#),
    ("sample", "1010001"),
    ("position", "4"),
    ("moving_to", "5"),
    ("mode", r#""navigating""#),
    ("every", r#""60 s""#),
    ("poisson", r#""6 min""#),
    ("after_fault", r#""spike-1""#),
    ("after", r#""2 s""#),
    ("from", r#""10 min""#),
    ("until", r#""1 h""#),
    ("times", "3"),
];

/// Example for a key of a form.
fn example_in_form(key: &Key) -> String {
    let own = FORM_EXAMPLES.iter().find(|(name, _)| *name == key.name);
    own.map_or_else(|| example(&key.kind), |(_, text)| (*text).to_owned())
}

/// Required keys of a table, and those with a default value, as TOML.
fn given(section: &Section) -> Vec<String> {
    let line = |key: &Key| match key.default {
        Default::Required => Some(format!("{} = {}", key.name, example_in_form(key))),
        Default::Value(text) => Some(format!("{} = {}", key.name, written(text))),
        Default::Derived(_) | Default::ByCase(_) | Default::Absent(_) | Default::Section => None,
    };
    section.keys.iter().filter_map(line).collect()
}

/// Example of a quantity within its bounds: that of the dimension if possible, else one between the
/// bounds.
fn quantity_within(dimension: UnitDimension, bounds: Bounds) -> String {
    let example = quantity::parse(dimension.example).is_ok_and(|q| bounds.contain(q.si));
    match bounds {
        Bounds::Within(from, to, _) if !example => dimension.write(0.5 * (from + to)),
        _ => dimension.example.to_owned(),
    }
}

/// Keys of a kind of fault, of samples or of connections.
fn section_of(kind: &str) -> Option<&'static Section> {
    super::keys::kind_section(kind).or_else(|| super::keys::connection_section(kind))
}

/// Descriptions of the parameters of a kind of fault, with their bounds.
#[must_use]
pub fn fault_parameters(kind: &str) -> Vec<(&'static str, String)> {
    let takes = |key: &'static Key| {
        let choices = match &key.kind {
            Kind::Choice(choices) => choices
                .iter()
                .filter(|(_, doc)| !doc.is_empty())
                .map(|(name, doc)| format!("{name:?}: {doc}"))
                .collect::<Vec<_>>(),
            _ => Vec::new(),
        };
        let more =
            if choices.is_empty() { String::new() } else { format!(" ({})", choices.join("; ")) };
        let bounds = match &key.kind {
            Kind::Quantity(_, bounds) => format!(", {}", bounds.words()),
            _ => String::new(),
        };
        (key.name, format!("{}{bounds}{more}", expected(&key.kind)))
    };
    let section = section_of(kind);
    section.map_or_else(Vec::new, |section| section.keys.iter().map(takes).collect())
}

/// Entry of a scenario with a fault of a kind, as TOML; `None` for an unknown kind.
#[must_use]
pub fn fault_example(kind: &str) -> Option<String> {
    let section = section_of(kind)?;
    let own = kinds::named(kind).map(|kind| &kind.example);
    let own = own.or_else(|| connection::named(kind).map(|kind| &kind.example))?;
    let mut out = String::from("[[faults]]\n");
    for key in section.keys {
        let value = match (own.value(key.name), key.default) {
            (Some(text), _) => text.to_owned(),
            (None, Default::Value(text)) => written(text),
            (None, Default::Required) => match key.name {
                "id" => format!("{:?}", format!("{kind}-1")),
                "trigger" => r#"{ at = "100 s" }"#.to_owned(),
                "connection" => r#""calibrator.gyro.delta_theta[1]""#.to_owned(),
                _ => match &key.kind {
                    Kind::Quantity(dimensions, bounds) => {
                        format!("{:?}", quantity_within(dimensions[0], *bounds))
                    }
                    kind => example(kind),
                },
            },
            (None, Default::Absent(_)) if key.name == "duration" => match key.kind {
                Kind::Refused(_) => continue,
                _ => r#""1 s""#.to_owned(),
            },
            (
                None,
                Default::Absent(_) | Default::Derived(_) | Default::ByCase(_) | Default::Section,
            ) => continue,
        };
        out += &format!("{} = {value}\n", key.name);
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::super::complete::complete;
    use super::super::error::Place;
    use super::*;

    /// Collects every path of the table of keys, with its key.
    fn paths(section: &'static Section, path: &str, all: &mut Vec<(String, &'static Key)>) {
        for key in section.keys.iter().filter(|key| !matches!(key.kind, Kind::Refused(_))) {
            let path = join(path, key.name);
            all.push((path.clone(), key));
            let inner = match &key.kind {
                Kind::Tables(section, ..) => Some(*section),
                kind => kind.section(),
            };
            if let Some(section) = inner {
                paths(section, &path, all);
            }
        }
    }

    #[test]
    fn the_shipped_tour_is_the_one_of_the_table() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/tour.toml");
        if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
            std::fs::write(file, tour()).unwrap();
        }
        let shipped = std::fs::read_to_string(file).unwrap();
        assert_eq!(shipped, tour(), "run this test with OCTANT_WRITE_FIXTURES=1 to write the tour");
    }

    #[test]
    fn the_tour_names_every_key_of_the_table() {
        let tour = tour();
        let mut all = Vec::new();
        paths(SCENARIO, "", &mut all);
        assert!(all.len() > 150, "{} keys", all.len());
        for (path, _) in all {
            let (parent, name) = path.rsplit_once('.').unwrap_or(("", &path));
            // The key is under the parent's header, or beside the parent if that is an inline table.
            let from = if parent.is_empty() {
                0
            } else if let Some(at) = tour.find(&format!("[{parent}]")) {
                at
            } else {
                let (grandparent, inline) = parent.rsplit_once('.').unwrap();
                let header = tour.find(&format!("[{grandparent}]")).unwrap();
                // The comment above the line describes the keys that the line doesn't use. Another
                // table may have a key of this name.
                let line = ["", "#: "]
                    .iter()
                    .filter_map(|mark| tour[header..].find(&format!("\n{mark}{inline} = ")))
                    .min()
                    .unwrap();
                let line = header + line;
                let above = tour[header..line].lines().rev();
                line - above.take_while(|l| l.starts_with("# ")).map(|l| l.len() + 1).sum::<usize>()
            };
            let block = &tour[from..];
            // The root's own values end at the first header as well.
            let skip = if parent.is_empty() { block.find("schema = ").unwrap() } else { 0 };
            let end = block[skip..].find("\n\n").map_or(block.len(), |at| skip + at);
            // Comments may be wrapped at any word.
            let block = block[..end].replace("\n# ", " ");
            let header = format!("[{path}]");
            let named = tour.contains(&header) || block.contains(&format!("{name} = "));
            assert!(named, "{path} is not in the tour");
        }
    }

    /// A figure in words would be another one than that of the code, some day.
    #[test]
    fn a_default_in_words_has_no_figure() {
        let mut all = Vec::new();
        paths(SCENARIO, "", &mut all);
        for (path, key) in all {
            if let Default::Derived(words) = key.default {
                assert!(!words.contains(|c: char| c.is_ascii_digit()), "{path}: {words}");
            }
        }
    }

    #[test]
    fn a_default_by_case_is_the_one_that_a_scenario_gets() {
        let at_dock = "motion = { kind = \"dockside\" }\n";
        let coloured = "[procedure.calibration.aiding]\nsway = \"coloured\"\n";
        let own = "source.uri = \"fmu:x.fmu\"\nsource.fmu.process = \"own\"\n";
        let aiding = "procedure.calibration.aiding";
        for (set, path, case) in [
            ("", "screening.drift", "static"),
            (at_dock, "screening.drift", "dockside"),
            ("", &*format!("{aiding}.reference"), "static"),
            (at_dock, &format!("{aiding}.reference"), "dockside"),
            ("", &format!("{aiding}.sigma"), "velocities"),
            (at_dock, &format!("{aiding}.sigma"), "dock-position"),
            (
                &format!("{at_dock}{coloured}"),
                &format!("{aiding}.sigma"),
                "with sway = \"coloured\"",
            ),
            ("", &format!("{aiding}.noise"), "velocities"),
            (at_dock, &format!("{aiding}.noise"), "dock-position"),
            (own, "source.fmu.time_limit", "in a process of its own"),
            ("", "procedure.calibration.prior.g_dependent", "elsewhere"),
            ("", "procedure.calibration.prior.position", "simulated at rest"),
            (at_dock, "procedure.calibration.prior.position", "elsewhere"),
            (own, "procedure.calibration.prior.position", "elsewhere"),
        ] {
            let text = format!("schema = 1\n{set}[procedure.calibration.least_squares]\n");
            let mut document = octant_toml_tree::parse(&text).unwrap();
            super::super::derive::derive(&mut document);
            let mut section = SCENARIO;
            let (parent, name) = path.rsplit_once('.').unwrap();
            for part in parent.split('.') {
                section = section.key(part).unwrap().kind.section().unwrap();
            }
            let Default::ByCase(cases) = section.key(name).unwrap().default else {
                panic!("{path} has no default by case")
            };
            let (_, value) = cases.iter().find(|(name, _)| *name == case).unwrap();
            let mut got = String::new();
            write_value(&document.at(path).unwrap().value, &mut got);
            let (shown, got) =
                (cases_in_words(&[(case, *value)]), got.trim_matches('"').to_owned());
            let got = got.strip_suffix(".0").unwrap_or(&got);
            assert_eq!(shown.replace('"', ""), format!("{case}: {got}").replace('"', ""), "{path}");
        }
    }

    /// Keys of faults and forms depend on the content of a table, so that the compiler can't look for these.
    #[test]
    fn every_example_of_a_form_is_of_a_key() {
        let fault = section_of(SHOWN_FAULT).unwrap();
        for (name, _) in FAULT_EXAMPLES {
            assert!(fault.key(name).is_some(), "{SHOWN_FAULT} has no {name}");
        }
        let forms = ["trigger", "repeat"].map(|name| {
            let kinds = match &fault.key(name).unwrap().kind {
                Kind::Either(kinds) => kinds,
                kind => std::slice::from_ref(kind),
            };
            let of_kind = |kind: &Kind| match kind {
                Kind::Variants(variants) => Some((variants.forms)()),
                _ => None,
            };
            kinds.iter().find_map(of_kind).unwrap()
        });
        for (name, _) in FORM_EXAMPLES {
            let mut sections = forms.iter().flat_map(|forms| forms.iter());
            assert!(sections.any(|(_, section)| section.key(name).is_some()), "no form has {name}");
        }
    }

    #[test]
    fn every_example_and_every_default_passes_the_check() {
        let mut all = Vec::new();
        paths(SCENARIO, "", &mut all);
        // A table's example consists of those of its keys.
        all.retain(|(_, key)| key.kind.section().is_none_or(|section| section.one_of));
        for (path, key) in all {
            let text = match key.default {
                Default::Value(text) => format!("x = {}", written(text)),
                _ => format!("x = {}", example_at(&path, &key.kind)),
            };
            let mut table =
                octant_toml_tree::parse(&text).unwrap_or_else(|e| panic!("{path}: {e:?}"));
            let mut problems = Vec::new();
            let node = table.get_mut("x").unwrap();
            super::super::complete::check(node, key, &key.kind, &path, &mut problems);
            assert!(problems.is_empty(), "{path}: {text}: {problems:?}");
        }
        let mut table = octant_toml_tree::parse("").unwrap();
        let mut problems = Vec::new();
        complete(&mut table, SCENARIO, "", &Place::Default, &mut problems);
        assert_eq!(problems.len(), 1, "the schema alone has to be given: {problems:?}");
    }
}
