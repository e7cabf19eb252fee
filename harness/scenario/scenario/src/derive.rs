//! Defaults that depend on other keys, and keys that have no effect beside others.

use super::error::{Place, Problem};
use super::keys::{
    Default, EndpointFmuKeys, Keys, LinkKeys, SCENARIO, Section, SourceFmuKeys, SourceLiveKeys,
    by_case, key, keys_of,
};
use super::quantity::{self, UnitDimension};
use super::recorded::NO_TIME;
use crate::choices::DESCRIBED;
use octant_instruments::grades::GradeSheet;
use octant_toml_tree::{Node, Table, Value, join, parse_default};

/// Adds the defaults that depend on other keys to a document that isn't checked yet: values of a wrong
/// kind are left for the check.
pub(crate) fn derive(document: &mut Table) {
    if text(document, key!(motion.kind)) == Some("dockside") {
        let own = keys_of!(motion.ship: roll, pitch, yaw, surge, sway, heave, spectrum)
            .iter()
            .any(|path| document.at(path).is_some());
        set(document, key!(motion.ship.preset), if own { "calm" } else { "default" });
    }
    instrument(document);
    if document.at(key!(procedure.calibration)).is_some() {
        calibration(document);
    }
    let dockside = text(document, key!(motion.kind)) == Some("dockside");
    let [still, moving] = by_case::DRIFT_SIGMAS;
    set(document, key!(screening.drift), &format!("{:?}", if dockside { moving } else { still }));
    if text(document, key!(source.uri)).is_some_and(|uri| uri.starts_with("fmu:")) {
        defaults(document, key!(source.fmu), SourceFmuKeys::SECTION);
        if text(document, key!(source.fmu.process)) == Some("own") {
            set(document, key!(source.fmu.time_limit), by_case::TIME_LIMIT);
        }
    }
    if text(document, key!(endpoint.uri)).is_some_and(|uri| uri.starts_with("fmu:")) {
        defaults(document, key!(endpoint.fmu), EndpointFmuKeys::SECTION);
        if text(document, key!(endpoint.fmu.process)) == Some("own") {
            set(document, key!(endpoint.fmu.time_limit), by_case::TIME_LIMIT);
        }
    }
    if is_live(document) {
        defaults(document, key!(endpoint.link), LinkKeys::SECTION);
    }
    if text(document, key!(source.uri)).is_some_and(octant_link::Uri::is_one) {
        let bus = text(document, key!(source.uri))
            .is_some_and(|uri| uri.starts_with("can:") || uri.starts_with("slcan:"));
        set(document, key!(source.live.protocol), if bus { "dbc" } else { "octant" });
        defaults(document, key!(source.live), SourceLiveKeys::SECTION);
    }
    if document.at(key!(source.reference)).is_some() {
        reference(document);
    }
    if document.at(key!(turntable.drive)).is_some() {
        set(document, key!(turntable.drive.guard), by_case::GUARD[usize::from(!cfg!(unix))]);
    }
    for [table, split, rate_of] in [
        [key!(source.text), key!(source.text.split), key!(source.text.rate)],
        [key!(source.mcap), key!(source.mcap.split), key!(source.mcap.rate)],
    ] {
        if document.at(table).is_some() {
            let rate = text(document, key!(imu.rate)).or(default_of(key!(imu.rate)));
            let Some(rate) = rate.map(str::to_owned) else { continue };
            let split = match document.at(split).map(|node| &node.value) {
                Some(Value::Integer(split)) if *split > 1 => *split as f64,
                _ => 1.0,
            };
            let rate = match quantity::parse(&rate) {
                Ok(quantity) if split > 1.0 => UnitDimension::FREQUENCY.write(quantity.si / split),
                _ => rate,
            };
            set(document, rate_of, &rate);
        }
    }
}

/// Layout of a text file that a reference shares with the samples, unless it gives its own.
const LAYOUT: [&str; 4] = keys_of!(source.reference: delimiter, skip_lines, header, comment);
/// The layout and the stamps of a reference, and those of the samples' text files.
const SHARED: [[&str; 2]; 6] = [
    [key!(source.reference.delimiter), key!(source.text.delimiter)],
    [key!(source.reference.skip_lines), key!(source.text.skip_lines)],
    [key!(source.reference.header), key!(source.text.header)],
    [key!(source.reference.comment), key!(source.text.comment)],
    [key!(source.reference.time_column), key!(source.text.time_column)],
    [key!(source.reference.time_unit), key!(source.text.time_unit)],
];

/// Adds the layout and the stamps of a recorded reference: those of the samples' text files.
fn reference(document: &mut Table) {
    let position = text(document, key!(source.reference.kind)) == Some("position");
    set(document, key!(source.reference.unit), if position { "deg" } else { "m/s" });
    let as_text = text(document, key!(source.uri)).is_some_and(|uri| uri.starts_with("text:"));
    for [path, of_text] in SHARED {
        let given = document.at(of_text).map(|node| node.value.clone());
        let value = match given.filter(|_| as_text) {
            Some(value) => value,
            None if path == key!(source.reference.time_unit) && !as_text => {
                parse_default("ns").value
            }
            None => match default_of(of_text) {
                Some(value) => parse_default(value).value,
                None => continue,
            },
        };
        if document.at(path).is_none() && reachable(document, path) {
            document.set_at(path, Node { value, place: Place::Default });
        }
    }
}

/// Default of a key as TOML, where it has one that depends on no other key.
fn default_of(path: &str) -> Option<&'static str> {
    match SCENARIO.at(path)?.default {
        Default::Value(value) => Some(value),
        _ => None,
    }
}

/// Adds the values of the instrument that the scenario names, and the σ of its errors as those from which
/// the filter starts. Other keys keep the defaults of Table 1.
fn instrument(document: &mut Table) {
    let Some(sheet) = text(document, key!(imu.model)).and_then(GradeSheet::of) else { return };
    for (key, value, _) in sheet.imu {
        set(document, &join(key!(imu), key), value);
    }
    if document.at(key!(procedure.calibration)).is_some() {
        for (key, value) in sheet.prior {
            set(document, &join(key!(procedure.calibration.prior), key), value);
        }
    }
}

/// True if the core is at the other end of a wire.
fn is_live(document: &Table) -> bool {
    text(document, key!(endpoint.uri)).is_some_and(octant_link::Uri::is_one)
}

/// Adds the defaults of the keys of a table that depend on no other key.
fn defaults(document: &mut Table, path: &str, keys: &Section) {
    for key in keys.keys {
        if let Default::Value(value) = key.default {
            set(document, &join(path, key.name), value);
        }
    }
}

fn calibration(document: &mut Table) {
    if document.at(key!(procedure.calibration.stops)).is_none() {
        set(document, key!(procedure.calibration.positions), "eight");
    }
    let dockside = text(document, key!(motion.kind)) == Some("dockside");
    let reference = match text(document, key!(source.reference.kind)) {
        Some("velocity") => "velocity",
        Some("position") => "dock-position",
        _ => by_case::REFERENCES[usize::from(dockside)],
    };
    set(document, key!(procedure.calibration.aiding.reference), reference);
    let position =
        text(document, key!(procedure.calibration.aiding.reference)) == Some("dock-position");
    let coloured = text(document, key!(procedure.calibration.aiding.sway)) == Some("coloured");
    let [sigma, noise] = match position {
        true => by_case::OF_POSITION[usize::from(coloured)],
        false => by_case::OF_VELOCITY,
    };
    set(document, key!(procedure.calibration.aiding.sigma), sigma);
    set(document, key!(procedure.calibration.aiding.noise), noise);

    let drawn = |path: &str| {
        let text = text(document, path)?;
        let quantity = quantity::parse(text).ok()?;
        (quantity.is(UnitDimension::G_DEPENDENT) && quantity.si > 0.0)
            .then(|| (quantity.si, text.to_owned()))
    };
    let prior = match (drawn(key!(imu.g_dependent.normal)), drawn(key!(imu.g_dependent.uniform))) {
        (Some((_, text)), _) => text,
        // Standard deviation of a uniform distribution of this half width.
        (None, Some((half_width, _))) => {
            UnitDimension::G_DEPENDENT.write(half_width / libm::sqrt(3.0))
        }
        (None, None) => by_case::G_DEPENDENT.to_owned(),
    };
    set(document, key!(procedure.calibration.prior.g_dependent), &prior);
    let simulated = text(document, key!(source.uri)).is_none_or(|uri| uri == "plant");
    let still = text(document, key!(motion.kind)).is_none_or(|kind| kind == "static");
    let [exact, surveyed] = by_case::POSITION;
    let position = if simulated && still { exact } else { surveyed };
    set(document, key!(procedure.calibration.prior.position), position);
}

fn text<'a>(document: &'a Table, path: &str) -> Option<&'a str> {
    match &document.at(path)?.value {
        Value::Text(text) => Some(text),
        _ => None,
    }
}

/// False if something other than a table is in the way.
fn reachable(document: &Table, path: &str) -> bool {
    let mut parents = path.match_indices('.').map(|(index, _)| &path[..index]);
    parents
        .all(|parent| document.at(parent).is_none_or(|node| matches!(node.value, Value::Table(_))))
}

/// Sets a default, unless there is a value or something other than a table is in the way.
fn set(document: &mut Table, path: &str, value: &str) {
    if reachable(document, path) && document.at(path).is_none() {
        document.set_at(path, parse_default(value));
    }
}

/// Keys without effect in a completed document, with the reason: refused if the scenario gives them,
/// and omitted from the resolved scenario.
pub(crate) fn without_effect(document: &Table) -> Vec<(&'static str, &'static str)> {
    let is = |path: &str, value: &str| text(document, path) == Some(value);
    let mut all = Vec::new();
    let mut add = |paths: &[&'static str], reason: &'static str| {
        all.extend(paths.iter().map(|path| (*path, reason)));
    };
    if is(key!(motion.kind), "static") {
        add(&[key!(motion.ship)], "without effect with motion.kind = \"static\"");
    }
    if !keys_of!(motion.ship: from, duration).iter().any(|path| document.at(path).is_some()) {
        add(&[key!(motion.ship.ramp)], "without effect without motion.ship.from or .duration");
    }
    let run_ups = document.at(key!(procedure.heading_test.run_ups)).map(|node| &node.value);
    if matches!(run_ups, None | Some(Value::Integer(1))) {
        add(&[key!(procedure.heading_test.off)], "without effect with run_ups = 1");
    }
    if is(key!(procedure.alignment.method), "coarse") {
        add(
            &keys_of!(procedure.alignment: tilt, azimuth, velocity, attitude_error, velocity_error),
            "without effect with method = \"coarse\"",
        );
    } else if is(key!(procedure.alignment.method), "inertial") {
        add(
            &keys_of!(procedure.alignment: tilt, azimuth, velocity, attitude_error, velocity_error),
            "without effect with method = \"inertial\"",
        );
    } else {
        add(&[key!(procedure.alignment.duration)], "without effect with method = \"given\"");
    }
    let estimator = |name: &str| {
        is(key!(procedure.calibration.estimator), name) || is(key!(baseline.estimator), name)
    };
    if !estimator("kalman") {
        add(
            &keys_of!(
                procedure.calibration: error_model, g_states, not_estimated,
                refuse_above_mean_nis, refuse_above_sigma, prior
            ),
            "without effect: no method of this scenario uses estimator = \"kalman\"",
        );
    }
    if !estimator("least-squares") {
        add(
            &[key!(procedure.calibration.least_squares)],
            "without effect: no method of this scenario uses estimator = \"least-squares\"",
        );
    } else if is(key!(procedure.calibration.least_squares.intervals), "commanded") {
        add(
            &keys_of!(procedure.calibration.least_squares: initial, window, threshold, shortest),
            "without effect with intervals = \"commanded\"",
        );
    }
    if document.at(key!(source.reference)).is_some() {
        add(
            &[key!(procedure.calibration.aiding.noise)],
            "without effect: source.reference is no simulation, to which noise is added",
        );
    }
    reference_without_effect(document, &mut add);
    let uri = text(document, key!(source.uri)).unwrap_or_default();
    if !uri.starts_with("text:") {
        add(&[key!(source.text)], "without effect: source.uri is not text:FILE");
    }
    if is(key!(source.text.time_column), NO_TIME) {
        add(&[key!(source.text.time_unit)], "without effect with time_column = \"none\"");
    }
    if !uri.starts_with("log:") {
        add(&[key!(source.log)], "without effect: source.uri is not log:FILE");
    }
    if !uri.starts_with("replay:") {
        add(&[key!(source.mcap)], "without effect: source.uri is not replay:FILE");
    }
    if !uri.starts_with("fmu:") {
        add(&[key!(source.fmu)], "without effect: source.uri is not fmu:FILE");
    }
    if !octant_link::Uri::is_one(uri) {
        add(&[key!(source.live)], "without effect: source.uri names no instrument on a port");
    }
    // The bench of a solution turns it between two run-ups; that of a file has done so.
    if !octant_link::Uri::is_one(uri) && !uri.starts_with("solution:") {
        add(
            &[key!(turntable.drive)],
            "a real table turns a real instrument, and source.uri names none on a port: the gimbals \
             of another source aren't those of the table",
        );
    }
    if is(key!(turntable.drive.driver), "another run") {
        add(
            &keys_of!(turntable.drive: units, dialect, home, tolerance, look, reply, guard, watchdog),
            "without effect: another run drives the table",
        );
    }
    if !is(key!(source.live.protocol), "dbc") {
        add(
            &keys_of!(source.live: database, mapping),
            "without effect: source.live.protocol is not \"dbc\"",
        );
    }
    if text(document, key!(source.live.pps)).is_none() {
        let reason = "without effect: source.live.pps names no pulses";
        add(&keys_of!(source.live: pps_edge, pps_silence), reason);
    }
    if text(document, key!(source.live.stamps)).is_none_or(|stamps| stamps == "own") {
        let reason = "without effect: source.live.stamps is \"own\"";
        add(&keys_of!(source.live: host_clock, host_within, tai_offset), reason);
        if text(document, key!(source.live.pps)).is_none() {
            add(&[key!(source.live.stamps_within)], reason);
        }
    }
    let is_utc = is(key!(source.live.stamps), "utc");
    if is_utc != text(document, key!(source.live.host_clock)).is_some() {
        let reason =
            "without effect: the stamps and the host's clock have scales that don't differ by it";
        add(&[key!(source.live.tai_offset)], reason);
    }
    for [protocol, description] in
        [keys_of!(source.live: protocol, description), keys_of!(source.log: protocol, description)]
    {
        if !is(protocol, DESCRIBED) {
            add(&[description], "without effect: the protocol is not \"described\"");
        }
    }
    if !text(document, key!(endpoint.uri)).is_some_and(|uri| uri.starts_with("fmu:")) {
        add(&[key!(endpoint.fmu)], "without effect: endpoint.uri is not fmu:FILE");
    }
    if !is_live(document) {
        add(&[key!(endpoint.link)], "without effect: endpoint.uri names no device");
    }
    for [process, time_limit] in
        [keys_of!(source.fmu: process, time_limit), keys_of!(endpoint.fmu: process, time_limit)]
    {
        if is(process, "shared") {
            add(
                &[time_limit],
                "without effect with process = \"shared\": nothing can end a call there",
            );
        }
    }
    all
}

/// Keys of a reference that another key of it, or the source, leaves without effect.
fn reference_without_effect(document: &Table, add: &mut impl FnMut(&[&'static str], &'static str)) {
    const VELOCITY: &[&str] = &keys_of!(source.reference: north, east, down, up);
    const POSITION: &[&str] = &keys_of!(source.reference: latitude, longitude, height);
    const TEXT: &[&str] = &keys_of!(source.reference: file, time_column);
    const MCAP: &[&str] = &keys_of!(source.reference: topic, time_field, nanoseconds_field);
    const UNITS: &[&str] = &keys_of!(source.reference: unit, time_unit);
    const TIME_UNIT: &[&str] = &[key!(source.reference.time_unit)];
    match text(document, key!(source.reference.kind)) {
        Some("velocity") => add(POSITION, "without effect with kind = \"velocity\""),
        Some("position") => add(VELOCITY, "without effect with kind = \"position\""),
        _ => {
            let reason = "without effect with kind = \"static\"";
            for keys in [VELOCITY, POSITION, TEXT, MCAP, &LAYOUT, UNITS] {
                add(keys, reason);
            }
            return;
        }
    }
    let uri = text(document, key!(source.uri)).unwrap_or_default();
    if !uri.starts_with("text:") {
        add(TEXT, "without effect: source.uri is not text:FILE");
        add(&LAYOUT, "without effect: source.uri is not text:FILE");
    } else if document.at(key!(source.reference.file)).is_none() {
        add(
            &LAYOUT,
            "without effect: the columns are in the gyros' file, which source.text describes",
        );
    }
    if !uri.starts_with("replay:") {
        add(MCAP, "without effect: source.uri is not replay:FILE");
    }
    if text(document, key!(source.reference.time_column)) == Some(NO_TIME) {
        add(TIME_UNIT, "without effect: the rows have no stamps");
    }
}

/// Problems of keys that are given and have no effect.
pub(crate) fn refuse_without_effect(document: &Table) -> Vec<Problem> {
    let given = |(path, reason): (&str, &str)| {
        let place = first_given(document.at(path)?)?.place.clone();
        Some(Problem { place, path: path.to_owned(), message: reason.to_owned() })
    };
    without_effect(document).into_iter().filter_map(given).collect()
}

/// First value of a tree that isn't a default.
fn first_given(node: &Node) -> Option<&Node> {
    if node.place != Place::Default {
        return Some(node);
    }
    match &node.value {
        Value::Table(table) => table.entries.iter().find_map(|entry| first_given(&entry.node)),
        _ => None,
    }
}
