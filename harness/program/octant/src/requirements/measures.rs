//! `octant requirements measures`: every measure that a requirement can have.

use octant_sample::further::{FURTHER_NAMES, FurtherGroup};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_verdict::measures::{MeasureEntry, MeasureNeed, all};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Version of the list as JSON.
const SCHEMA: u32 = 1;

/// List as JSON.
#[derive(Serialize)]
pub(super) struct MeasureList {
    schema: u32,
    octant: &'static str,
    /// Conditions by name, with their meaning.
    needs: BTreeMap<&'static str, &'static str>,
    measures: Vec<MeasureEntry>,
}

/// Returns the list as it is printed with `--json`.
pub(super) fn listed() -> MeasureList {
    MeasureList {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION"),
        needs: MeasureNeed::ALL.map(|need| (need.name(), need.meaning())).into(),
        measures: all(),
    }
}

/// Renders the list as text: tables of parameters and of their groups, whose rows are alike, are one row
/// each, and the second method's measures, which are those of the first, are a sentence.
pub(super) fn text() -> String {
    let mut seen = BTreeSet::new();
    let mut rows: Vec<[String; 3]> = Vec::new();
    for entry in all() {
        if entry.measure.starts_with("baseline.") {
            continue;
        }
        let row = row(&entry);
        if seen.insert(row[0].clone()) {
            rows.push(row);
        }
    }
    let width =
        |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let (first, second) = (width(0), width(1));
    let mut text = String::new();
    for [measure, unit, meaning] in &rows {
        let _ = writeln!(text, "{measure:first$}  {unit:second$}  {meaning}");
    }
    let _ = writeln!(text, "\nNAME, by unit:");
    for group in ParameterGroup::ALL {
        let _ = writeln!(text, "  {:9} {}", group.unit(), NAMES[group.range()].join(", "));
    }
    let _ = writeln!(text, "FURTHER, by unit:");
    for group in FurtherGroup::ALL {
        let names = FURTHER_NAMES[group.range()].join(", ");
        let _ = writeln!(text, "  {:9} {names}", group.unit());
    }
    let groups = ParameterGroup::ALL.map(ParameterGroup::name).join(", ");
    let _ = writeln!(text, "GROUP: {groups}");
    let _ = writeln!(text, "\nneeds:");
    for need in MeasureNeed::ALL {
        let _ = writeln!(text, "  {:15} {}", need.name(), need.meaning());
    }
    let second: BTreeSet<String> = all()
        .iter()
        .filter_map(|entry| entry.measure.strip_prefix("baseline."))
        .filter_map(|rest| rest.split('.').next().map(str::to_owned))
        .collect();
    let second: Vec<String> = second.into_iter().collect();
    let _ = writeln!(
        text,
        "\nThe second method has the measures of {} too, as baseline.navigation.radial_error_nmi.max.\n\
         A limit is a plain number in the unit, or a quantity; unit 1: a plain number. A measure with ± can be \
         negative:\nbars about it take its magnitude, \"|calibration.parameters.g_zz.error|\".",
        second.join(", ")
    );
    text
}

/// Measure with its unit, and its meaning with sign and conditions.
fn row(entry: &MeasureEntry) -> [String; 3] {
    let parts: Vec<&str> = entry.measure.split('.').collect();
    let group = |part: &str| ParameterGroup::ALL.iter().any(|group| group.name() == part);
    let is_parameter = parts.iter().any(|part| NAMES.contains(part));
    let generic: Vec<&str> = parts
        .iter()
        .map(|part| match *part {
            part if NAMES.contains(&part) => "NAME",
            part if FURTHER_NAMES.contains(&part) => "FURTHER",
            part if group(part) => "GROUP",
            part => part,
        })
        .collect();
    let is_further = parts.iter().any(|part| FURTHER_NAMES.contains(part));
    let unit = match entry.unit {
        "1" => "1",
        _ if is_parameter => "of NAME",
        _ if is_further => "of FURTHER",
        unit => unit,
    };
    // The name stands in the meaning as it does in the path.
    let is_name =
        |part: &&str| !(NAMES.contains(part) || FURTHER_NAMES.contains(part) || group(part));
    let meaning: Vec<&str> = entry.meaning.split(": ").filter(is_name).collect();
    let mut about = meaning.join(": ");
    if entry.signed {
        about += ", ±";
    }
    if !entry.needs.is_empty() {
        let needs: Vec<&str> = entry.needs.iter().map(|need| need.name()).collect();
        let _ = write!(about, " [{}]", needs.join(", "));
    }
    [generic.join("."), unit.to_owned(), about]
}
