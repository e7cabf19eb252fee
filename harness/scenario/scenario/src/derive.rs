//! Defaults that depend on other keys, and keys that have no effect beside others.

use super::document::{DocumentNode, DocumentTable, DocumentValue, parse_default};
use super::error::{Place, Problem};
use super::keys::{
    Default, EndpointFmuKeys, ImuKeys, Keys, LinkKeys, Section, SourceFmuKeys, SourceLiveKeys,
    TextKeys, by_case,
};
use super::quantity::{self, UnitDimension};
use super::recorded::NO_TIME;
use crate::choices::DESCRIBED;
use octant_instruments::grades::GradeSheet;

/// Adds the defaults that depend on other keys to a document that isn't checked yet: values of a wrong
/// kind are left for the check.
pub(crate) fn derive(document: &mut DocumentTable) {
    if text(document, "motion.kind") == Some("dockside") {
        let own = ["roll", "pitch", "yaw", "surge", "sway", "heave", "spectrum"]
            .iter()
            .any(|key| document.at(&format!("motion.ship.{key}")).is_some());
        set(document, "motion.ship.preset", if own { "calm" } else { "default" });
    }
    instrument(document);
    if document.at("procedure.calibration").is_some() {
        calibration(document);
    }
    let as_text = text(document, "source.uri").is_some_and(|uri| uri.starts_with("text:"));
    set(document, "screening.jumps", if as_text { "off" } else { "on" });
    let dockside = text(document, "motion.kind") == Some("dockside");
    let [still, moving] = by_case::DRIFT_SIGMAS;
    set(document, "screening.drift", &format!("{:?}", if dockside { moving } else { still }));
    for (name, keys) in [("source", SourceFmuKeys::SECTION), ("endpoint", EndpointFmuKeys::SECTION)]
    {
        if text(document, &format!("{name}.uri")).is_some_and(|uri| uri.starts_with("fmu:")) {
            fmu(document, &format!("{name}.fmu"), keys);
        }
    }
    if is_live(document) {
        for key in LinkKeys::SECTION.keys {
            if let Default::Value(value) = key.default {
                set(document, &format!("endpoint.link.{}", key.name), value);
            }
        }
    }
    if text(document, "source.uri").is_some_and(octant_link::Uri::is_one) {
        let bus = text(document, "source.uri")
            .is_some_and(|uri| uri.starts_with("can:") || uri.starts_with("slcan:"));
        set(document, "source.live.protocol", if bus { "dbc" } else { "octant" });
        for key in SourceLiveKeys::SECTION.keys {
            if let Default::Value(value) = key.default {
                set(document, &format!("source.live.{}", key.name), value);
            }
        }
    }
    if document.at("source.reference").is_some() {
        reference(document);
    }
    if document.at("turntable.drive").is_some() {
        set(document, "turntable.drive.guard", by_case::GUARD[usize::from(!cfg!(unix))]);
    }
    for table in ["source.text", "source.mcap"] {
        if document.at(table).is_some() {
            let rate = text(document, "imu.rate").or(default_of(ImuKeys::SECTION, "rate"));
            let Some(rate) = rate.map(str::to_owned) else { continue };
            let split = match document.at(&format!("{table}.split")).map(|node| &node.value) {
                Some(DocumentValue::Integer(split)) if *split > 1 => *split as f64,
                _ => 1.0,
            };
            let rate = match quantity::parse(&rate) {
                Ok(quantity) if split > 1.0 => UnitDimension::FREQUENCY.write(quantity.si / split),
                _ => rate,
            };
            set(document, &format!("{table}.rate"), &rate);
        }
    }
}

/// Layout of a text file that a reference shares with the samples, unless it gives its own.
const LAYOUT: [&str; 4] = ["delimiter", "skip_lines", "header", "comment"];

/// Adds the layout and the stamps of a recorded reference: those of the samples' text files.
fn reference(document: &mut DocumentTable) {
    let position = text(document, "source.reference.kind") == Some("position");
    set(document, "source.reference.unit", if position { "deg" } else { "m/s" });
    let as_text = text(document, "source.uri").is_some_and(|uri| uri.starts_with("text:"));
    for name in LAYOUT.into_iter().chain(["time_column", "time_unit"]) {
        let path = format!("source.reference.{name}");
        let of_text = document.at(&format!("source.text.{name}")).map(|node| node.value.clone());
        let value = match of_text.filter(|_| as_text) {
            Some(value) => value,
            None if name == "time_unit" && !as_text => parse_default("ns").value,
            None => match default_of(TextKeys::SECTION, name) {
                Some(value) => parse_default(value).value,
                None => continue,
            },
        };
        if document.at(&path).is_none() && reachable(document, &path) {
            document.set_at(&path, DocumentNode { value, place: Place::Default });
        }
    }
}

/// Default of a key as TOML, where it has one that depends on no other key.
fn default_of(section: &Section, name: &str) -> Option<&'static str> {
    match section.key(name)?.default {
        Default::Value(value) => Some(value),
        _ => None,
    }
}

/// Adds the values of the instrument that the scenario names, and the σ of its errors as those from which
/// the filter starts. Other keys keep the defaults of Table 1.
fn instrument(document: &mut DocumentTable) {
    let Some(sheet) = text(document, "imu.model").and_then(GradeSheet::of) else { return };
    for (key, value, _) in sheet.imu {
        set(document, &format!("imu.{key}"), value);
    }
    if document.at("procedure.calibration").is_some() {
        for (key, value) in sheet.prior {
            set(document, &format!("procedure.calibration.prior.{key}"), value);
        }
    }
}

/// True if the core is at the other end of a wire.
fn is_live(document: &DocumentTable) -> bool {
    text(document, "endpoint.uri").is_some_and(octant_link::Uri::is_one)
}

fn fmu(document: &mut DocumentTable, path: &str, keys: &Section) {
    for key in keys.keys {
        if let Default::Value(value) = key.default {
            set(document, &format!("{path}.{}", key.name), value);
        }
    }
    if text(document, &format!("{path}.process")) == Some("own") {
        set(document, &format!("{path}.time_limit"), by_case::TIME_LIMIT);
    }
}

fn calibration(document: &mut DocumentTable) {
    if document.at("procedure.calibration.stops").is_none() {
        set(document, "procedure.calibration.positions", "eight");
    }
    let dockside = text(document, "motion.kind") == Some("dockside");
    let reference = match text(document, "source.reference.kind") {
        Some("velocity") => "velocity",
        Some("position") => "dock-position",
        _ => by_case::REFERENCES[usize::from(dockside)],
    };
    set(document, "procedure.calibration.aiding.reference", reference);
    let position =
        text(document, "procedure.calibration.aiding.reference") == Some("dock-position");
    let coloured = text(document, "procedure.calibration.aiding.sway") == Some("coloured");
    let [sigma, noise] = match position {
        true => by_case::OF_POSITION[usize::from(coloured)],
        false => by_case::OF_VELOCITY,
    };
    set(document, "procedure.calibration.aiding.sigma", sigma);
    set(document, "procedure.calibration.aiding.noise", noise);

    let drawn = |key: &str| {
        let text = text(document, &format!("imu.g_dependent.{key}"))?;
        let quantity = quantity::parse(text).ok()?;
        (quantity.is(UnitDimension::G_DEPENDENT) && quantity.si > 0.0)
            .then(|| (quantity.si, text.to_owned()))
    };
    let prior = match (drawn("normal"), drawn("uniform")) {
        (Some((_, text)), _) => text,
        // Standard deviation of a uniform distribution of this half width.
        (None, Some((half_width, _))) => {
            UnitDimension::G_DEPENDENT.write(half_width / libm::sqrt(3.0))
        }
        (None, None) => by_case::G_DEPENDENT.to_owned(),
    };
    set(document, "procedure.calibration.prior.g_dependent", &prior);
    let simulated = text(document, "source.uri").is_none_or(|uri| uri == "plant");
    let still = text(document, "motion.kind").is_none_or(|kind| kind == "static");
    let [exact, surveyed] = by_case::POSITION;
    let position = if simulated && still { exact } else { surveyed };
    set(document, "procedure.calibration.prior.position", position);
}

fn text<'a>(document: &'a DocumentTable, path: &str) -> Option<&'a str> {
    match &document.at(path)?.value {
        DocumentValue::Text(text) => Some(text),
        _ => None,
    }
}

/// False if something other than a table is in the way.
fn reachable(document: &DocumentTable, path: &str) -> bool {
    let mut parents = path.match_indices('.').map(|(index, _)| &path[..index]);
    parents.all(|parent| {
        document.at(parent).is_none_or(|node| matches!(node.value, DocumentValue::Table(_)))
    })
}

/// Sets a default, unless there is a value or something other than a table is in the way.
fn set(document: &mut DocumentTable, path: &str, value: &str) {
    if reachable(document, path) && document.at(path).is_none() {
        document.set_at(path, parse_default(value));
    }
}

/// Keys without effect in a completed document, with the reason: refused if the scenario gives them,
/// and omitted from the resolved scenario.
pub(crate) fn without_effect(document: &DocumentTable) -> Vec<(String, &'static str)> {
    let is = |path: &str, value: &str| text(document, path) == Some(value);
    let mut all = Vec::new();
    let mut add = |parent: &str, keys: &[&str], reason: &'static str| {
        all.extend(keys.iter().map(|key| (format!("{parent}.{key}"), reason)));
    };
    if is("motion.kind", "static") {
        add("motion", &["ship"], "without effect with motion.kind = \"static\"");
    }
    if is("procedure.alignment.method", "coarse") {
        add(
            "procedure.alignment",
            &["tilt", "azimuth", "velocity", "attitude_error", "velocity_error"],
            "without effect with method = \"coarse\"",
        );
    } else if is("procedure.alignment.method", "inertial") {
        add(
            "procedure.alignment",
            &["tilt", "azimuth", "velocity", "attitude_error", "velocity_error"],
            "without effect with method = \"inertial\"",
        );
    } else {
        add("procedure.alignment", &["duration"], "without effect with method = \"given\"");
    }
    let estimator =
        |name: &str| is("procedure.calibration.estimator", name) || is("baseline.estimator", name);
    let calibration = "procedure.calibration";
    if !estimator("kalman") {
        add(
            calibration,
            &[
                "error_model",
                "g_states",
                "not_estimated",
                "refuse_above_mean_nis",
                "refuse_above_sigma",
                "prior",
            ],
            "without effect: no method of this scenario uses estimator = \"kalman\"",
        );
    }
    if !estimator("least-squares") {
        add(
            calibration,
            &["least_squares"],
            "without effect: no method of this scenario uses estimator = \"least-squares\"",
        );
    } else if is("procedure.calibration.least_squares.intervals", "commanded") {
        add(
            "procedure.calibration.least_squares",
            &["initial", "window", "threshold", "shortest"],
            "without effect with intervals = \"commanded\"",
        );
    }
    if document.at("source.reference").is_some() {
        add(
            "procedure.calibration.aiding",
            &["noise"],
            "without effect: source.reference is no simulation, to which noise is added",
        );
    }
    reference_without_effect(document, &mut add);
    let uri = text(document, "source.uri").unwrap_or_default();
    if !uri.starts_with("text:") {
        add("source", &["text"], "without effect: source.uri is not text:FILE");
    }
    if is("source.text.time_column", NO_TIME) {
        add("source.text", &["time_unit"], "without effect with time_column = \"none\"");
    }
    if !uri.starts_with("log:") {
        add("source", &["log"], "without effect: source.uri is not log:FILE");
    }
    if !uri.starts_with("replay:") {
        add("source", &["mcap"], "without effect: source.uri is not replay:FILE");
    }
    if !uri.starts_with("fmu:") {
        add("source", &["fmu"], "without effect: source.uri is not fmu:FILE");
    }
    if !octant_link::Uri::is_one(uri) {
        add("source", &["live"], "without effect: source.uri names no instrument on a port");
        add(
            "turntable",
            &["drive"],
            "a real table turns a real instrument, and source.uri names none on a port: the gimbals \
             of another source aren't those of the table",
        );
    }
    if is("turntable.drive.driver", "another run") {
        add(
            "turntable.drive",
            &["units", "dialect", "home", "tolerance", "look", "reply", "guard", "watchdog"],
            "without effect: another run drives the table",
        );
    }
    if !is("source.live.protocol", "dbc") {
        add(
            "source.live",
            &["database", "mapping"],
            "without effect: source.live.protocol is not \"dbc\"",
        );
    }
    if text(document, "source.live.pps").is_none() {
        let reason = "without effect: source.live.pps names no pulses";
        add("source.live", &["pps_edge", "pps_silence"], reason);
    }
    if text(document, "source.live.stamps").is_none_or(|stamps| stamps == "own") {
        let reason = "without effect: source.live.stamps is \"own\"";
        add("source.live", &["host_clock", "host_within", "tai_offset"], reason);
        if text(document, "source.live.pps").is_none() {
            add("source.live", &["stamps_within"], reason);
        }
    }
    let is_utc = is("source.live.stamps", "utc");
    if is_utc != text(document, "source.live.host_clock").is_some() {
        let reason =
            "without effect: the stamps and the host's clock have scales that don't differ by it";
        add("source.live", &["tai_offset"], reason);
    }
    for table in ["source.live", "source.log"] {
        if !is(&format!("{table}.protocol"), DESCRIBED) {
            add(table, &["description"], "without effect: the protocol is not \"described\"");
        }
    }
    if !text(document, "endpoint.uri").is_some_and(|uri| uri.starts_with("fmu:")) {
        add("endpoint", &["fmu"], "without effect: endpoint.uri is not fmu:FILE");
    }
    if !is_live(document) {
        add("endpoint", &["link"], "without effect: endpoint.uri names no device");
    }
    for table in ["source.fmu", "endpoint.fmu"] {
        if is(&format!("{table}.process"), "shared") {
            add(
                table,
                &["time_limit"],
                "without effect with process = \"shared\": nothing can end a call there",
            );
        }
    }
    all
}

/// Keys of a reference that another key of it, or the source, leaves without effect.
fn reference_without_effect(
    document: &DocumentTable,
    add: &mut impl FnMut(&str, &[&str], &'static str),
) {
    const TABLE: &str = "source.reference";
    const VELOCITY: &[&str] = &["north", "east", "down", "up"];
    const POSITION: &[&str] = &["latitude", "longitude", "height"];
    const TEXT: &[&str] = &["file", "time_column"];
    const MCAP: &[&str] = &["topic", "time_field", "nanoseconds_field"];
    match text(document, "source.reference.kind") {
        Some("velocity") => add(TABLE, POSITION, "without effect with kind = \"velocity\""),
        Some("position") => add(TABLE, VELOCITY, "without effect with kind = \"position\""),
        _ => {
            let reason = "without effect with kind = \"static\"";
            for keys in [VELOCITY, POSITION, TEXT, MCAP, &LAYOUT, &["unit", "time_unit"]] {
                add(TABLE, keys, reason);
            }
            return;
        }
    }
    let uri = text(document, "source.uri").unwrap_or_default();
    if !uri.starts_with("text:") {
        add(TABLE, TEXT, "without effect: source.uri is not text:FILE");
        add(TABLE, &LAYOUT, "without effect: source.uri is not text:FILE");
    } else if document.at("source.reference.file").is_none() {
        add(
            TABLE,
            &LAYOUT,
            "without effect: the columns are in the gyros' file, which source.text describes",
        );
    }
    if !uri.starts_with("replay:") {
        add(TABLE, MCAP, "without effect: source.uri is not replay:FILE");
    }
    if text(document, "source.reference.time_column") == Some(NO_TIME) {
        add(TABLE, &["time_unit"], "without effect: the rows have no stamps");
    }
}

/// Problems of keys that are given and have no effect.
pub(crate) fn refuse_without_effect(document: &DocumentTable) -> Vec<Problem> {
    let given = |(path, reason): (String, &'static str)| {
        let node = document.at(&path)?;
        Some(Problem { place: first_given(node)?.place.clone(), path, message: reason.to_owned() })
    };
    without_effect(document).into_iter().filter_map(given).collect()
}

/// First value of a tree that isn't a default.
fn first_given(node: &DocumentNode) -> Option<&DocumentNode> {
    if node.place != Place::Default {
        return Some(node);
    }
    match &node.value {
        DocumentValue::Table(table) => {
            table.entries.iter().find_map(|entry| first_given(&entry.node))
        }
        _ => None,
    }
}
