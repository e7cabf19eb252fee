//! Reads the reference of a source that brings none, from `[source.reference]`.

use crate::error::Problem;
use crate::keys::{
    At, CalibrationKeys, Reference, ReferenceKind, ScenarioKeys, SourceReferenceKeys,
};
use crate::model::{AlignmentSpec, Scenario, SourceSpec};
use crate::recorded::{MappedStamp, NO_TIME, RecordedColumn, TextFiles, TextMapping, TimeColumn};
use crate::reference::{
    RecordedReference, RecordedReferenceKind, ReferenceColumns, ReferenceFields, ReferencePlace,
    ReferenceSpec,
};
use std::path::PathBuf;

/// Reads the reference of a scenario whose other parts are read, and checks that a filter has one
/// reference, and not two.
pub(super) fn read(
    keys: &ScenarioKeys,
    scenario: &Scenario,
) -> Result<Option<ReferenceSpec>, Problem> {
    let of_reference = &keys.source.reference;
    let tells_nothing = match &scenario.source {
        SourceSpec::Text(_) | SourceSpec::Log(_) | SourceSpec::Replay { mapping: Some(_), .. } => {
            true
        }
        SourceSpec::Live(_) => of_reference.is_some(),
        SourceSpec::Plant
        | SourceSpec::Fmu(_)
        | SourceSpec::Solution(_)
        | SourceSpec::Replay { mapping: None, .. } => false,
    };
    if of_reference.is_some() && !tells_nothing {
        return Err(of_reference.problem(format!(
            "found with source.uri = {:?}, which brings a reference of its own",
            keys.source.uri.text
        )));
    }
    let real = tells_nothing || scenario.source.instrument().is_some();
    let filters =
        [&scenario.calibration, &scenario.baseline].into_iter().flatten().any(|calibration| {
            matches!(calibration.estimator, octant_calibration::config::Estimator::Kalman(_))
        });
    if tells_nothing && filters && of_reference.is_none() {
        return Err(keys.source.uri.problem(format!(
            "found {:?}, which brings no reference for estimator = \"kalman\": expected \
             [source.reference] with kind = \"static\" or the columns of a measured one, or another \
             estimator",
            keys.source.uri.text
        )));
    }
    if real && filters && matches!(scenario.alignment, AlignmentSpec::Coarse { .. }) {
        return Err(keys.procedure.alignment.method.problem(
            "found \"coarse\" with a filter on real data: an average takes a base that tilts by 0.2 deg in half an \
             hour for 1.8 deg of heading, and nothing shows it. Expected \"inertial\", which sees the base turn, \
             or \"given\"",
        ));
    }
    let Some(own) = &**of_reference else { return Ok(None) };
    let Some(calibration) = &*keys.procedure.calibration else {
        return Err(of_reference
            .problem("found without procedure.calibration: navigation uses no reference"));
    };
    let kind = match *own.kind {
        ReferenceKind::Static => return Ok(Some(known(keys, calibration))),
        ReferenceKind::Velocity => RecordedReferenceKind::Velocity,
        ReferenceKind::Position => RecordedReferenceKind::Position,
    };
    if !filters {
        return Err(own.kind.problem(format!(
            "found {:?}, and no method of this scenario uses estimator = \"kalman\": nothing else \
             measures against a reference",
            own.kind.text
        )));
    }
    let reference = &calibration.aiding.reference;
    let of_position = **reference == Reference::DockPosition;
    if of_position != (kind == RecordedReferenceKind::Position) {
        return Err(own.kind.problem(format!(
            "found {:?} with procedure.calibration.aiding.reference = {:?}, which measures a {}: \
             expected the same of both",
            own.kind.text,
            reference.text,
            if of_position { "position" } else { "velocity" }
        )));
    }
    let recorded = recorded(kind, own, keys, calibration, scenario)?;
    Ok(Some(ReferenceSpec::Recorded(Box::new(recorded))))
}

/// The reference of an instrument at rest, as `procedure.calibration.aiding` measures it.
fn known(keys: &ScenarioKeys, calibration: &CalibrationKeys) -> ReferenceSpec {
    ReferenceSpec::Static(match *calibration.aiding.reference {
        Reference::DockPosition => octant_sample::Reference::Position {
            latitude_rad: keys.site.latitude,
            longitude_rad: keys.site.longitude,
            height_m: keys.site.height,
        },
        Reference::ZeroVelocity | Reference::Velocity => {
            octant_sample::Reference::Velocity([0.0; 3])
        }
    })
}

fn recorded(
    kind: RecordedReferenceKind,
    own: &SourceReferenceKeys,
    keys: &ScenarioKeys,
    calibration: &CalibrationKeys,
    scenario: &Scenario,
) -> Result<RecordedReference, Problem> {
    let unit = own.unit.as_str();
    let of_angle = matches!(unit, "deg" | "rad");
    if of_angle != (kind == RecordedReferenceKind::Position) {
        return Err(own.unit.problem(format!(
            "found {unit:?}, which is not a unit of kind = {:?}",
            own.kind.text
        )));
    }
    let si = own.unit.unit_si()?;
    let (names, chosen, scale) = match kind {
        RecordedReferenceKind::Velocity => {
            let (name, vertical, sign) = match (&*own.down, &*own.up) {
                (Some(_), None) => ("down", &own.down, 1.0),
                (None, Some(_)) => ("up", &own.up, -1.0),
                (None, None) => {
                    return Err(own.down.problem("missing, expected down or up"));
                }
                (Some(_), Some(_)) => {
                    return Err(own.up.problem("found beside down, expected one of both"));
                }
            };
            (["north", "east", name], [&own.north, &own.east, vertical], [si, si, sign * si])
        }
        RecordedReferenceKind::Position => (
            ["latitude", "longitude", "height"],
            [&own.latitude, &own.longitude, &own.height],
            [si, si, 1.0],
        ),
    };
    let [first, second, third] = chosen.map(|column| match &**column {
        Some(found) => Ok((column, found.clone())),
        None => Err(column.problem(format!("missing with kind = {:?}", own.kind.text))),
    });
    let chosen = [first?, second?, third?];
    let place = match &scenario.source {
        SourceSpec::Text(mapping) => ReferencePlace::Text(columns(chosen, own, keys, mapping)?),
        SourceSpec::Replay { file, .. } => {
            ReferencePlace::Mcap(fields(chosen, own, PathBuf::from(&file.0))?)
        }
        _ => {
            return Err(own.kind.problem(format!(
                "found {:?} with source.uri = {:?}, beside which nothing is recorded: expected \
                 \"static\"",
                own.kind.text, keys.source.uri.text
            )));
        }
    };
    Ok(RecordedReference {
        kind,
        scale,
        names,
        place,
        period_ns: (*calibration.aiding.period * 1e9).round() as u64,
        site_rad: [keys.site.latitude, keys.site.longitude],
    })
}

type Chosen<'a> = [(&'a At<Option<RecordedColumn>>, RecordedColumn); 3];

fn columns(
    chosen: Chosen<'_>,
    own: &SourceReferenceKeys,
    keys: &ScenarioKeys,
    mapping: &TextMapping,
) -> Result<ReferenceColumns, Problem> {
    let samples = match &mapping.files {
        TextFiles::One(file) | TextFiles::Split { gyro: file, .. } => file,
    };
    let file = own.file.as_ref().map_or_else(|| samples.clone(), PathBuf::from);
    let own_file = file != *samples;
    let header = match &*keys.source.text {
        Some(text) if !own_file => text.header,
        _ => own.header,
    };
    // The name of a column that has none, as a message.
    let unnamed = |column: &RecordedColumn| match column {
        RecordedColumn::Name(name) if !header => {
            Some(format!("found the name {name:?} with header = false, expected a column number"))
        }
        _ => None,
    };
    for (key, column) in &chosen {
        if let Some(message) = unnamed(column) {
            return Err(key.problem(message));
        }
    }
    let without_stamps = matches!(&*own.time_column, RecordedColumn::Name(name) if name == NO_TIME);
    let time = match (&mapping.time, without_stamps) {
        (None, true) if !own_file => None,
        (None, _) => {
            return Err(own.time_column.problem(
                "the samples have no stamps, source.text.time_column = \"none\", by which a reference \
                 could be found: expected it in the same rows, without stamps too",
            ));
        }
        (Some(_), true) => {
            return Err(own.time_column.problem(
                "found \"none\", and the samples have stamps: expected the column of the reference's",
            ));
        }
        (Some(_), false) => {
            if let Some(message) = unnamed(&own.time_column) {
                return Err(own.time_column.problem(message));
            }
            Some(TimeColumn { column: own.time_column.value.clone(), unit: own.time_unit })
        }
    };
    let layout = !own_file;
    Ok(ReferenceColumns {
        columns: chosen.map(|(_, column)| column),
        time,
        row_period_ns: (1e9 / mapping.nominal_rate_hz).round() as u64,
        delimiter: if layout { mapping.delimiter } else { own.delimiter },
        comment: if layout { mapping.comment.clone() } else { own.comment.clone() },
        skip_lines: if layout { mapping.skip_lines } else { own.skip_lines },
        header,
        file,
        own_file,
    })
}

fn fields(
    chosen: Chosen<'_>,
    own: &SourceReferenceKeys,
    file: PathBuf,
) -> Result<ReferenceFields, Problem> {
    let [first, second, third] = chosen.map(|(key, column)| match column {
        RecordedColumn::Name(path) => Ok(path),
        RecordedColumn::Number(number) => Err(key.problem(format!(
            "found the column {number} in an MCAP file, expected the dotted name of a field"
        ))),
    });
    let fields = [first?, second?, third?];
    let Some(topic) = own.topic.value.clone() else {
        return Err(own.topic.problem("missing, expected the topic of the reference's messages"));
    };
    let nanoseconds = own.nanoseconds_field.value.clone();
    let stamp = match own.time_field.clone() {
        None if nanoseconds.is_some() => {
            let message = "found without time_field, to which it is added";
            return Err(own.nanoseconds_field.problem(message));
        }
        None => MappedStamp::LogTime,
        Some(path) => MappedStamp::Field { path, unit: own.time_unit, nanoseconds },
    };
    Ok(ReferenceFields { file, topic, fields, stamp })
}
