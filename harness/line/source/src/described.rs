//! The decoder of an instrument's line, which a protocol or a description gives.

use crate::SourceError;
use octant_instruments::AnyDecoder;
use octant_instruments::description::{DescriptionProblem, UnitDescription};
use octant_instruments::novatel::CountScale;
use octant_scenario::{DescriptionChoice, Speaks};
use std::path::Path;

/// Makes a decoder of a file, from its start; `None` for messages on a CAN bus. File names are relative to `folder`.
///
/// # Errors
/// If the description can't be read, or isn't one.
pub(super) fn decoder(
    speaks: &Speaks,
    count: Option<CountScale>,
    folder: &Path,
) -> Result<Option<AnyDecoder>, SourceError> {
    Ok(match speaks {
        Speaks::Bytes(protocol) => Some(AnyDecoder::scaled(*protocol, count)),
        Speaks::Described(choice) => Some(description(choice, folder)?.decoder()),
        Speaks::Can(_) => None,
    })
}

/// Makes a decoder of a port, likewise.
///
/// # Errors
/// Likewise, or if it describes what can't be read from a port.
pub(super) fn port_decoder(
    speaks: &Speaks,
    count: Option<CountScale>,
    folder: &Path,
) -> Result<Option<AnyDecoder>, SourceError> {
    let Speaks::Described(choice) = speaks else { return decoder(speaks, count, folder) };
    match description(choice, folder)?.port_decoder() {
        Some(decoder) => Ok(Some(decoder)),
        None => Err(SourceError::Read {
            path: speaks.told(),
            reason: "found [record] for a port, expected [[frame]] or [[line]]: nothing tells where a record \
                     begins; what the port sends can be kept by octant capture and read as log:FILE"
                .to_owned(),
        }),
    }
}

/// Reads a description.
///
/// # Errors
/// If it can't be read, or isn't one.
pub(super) fn description(
    choice: &DescriptionChoice,
    folder: &Path,
) -> Result<UnitDescription, SourceError> {
    let wrong = |problem: DescriptionProblem| SourceError::Read {
        path: problem.place,
        reason: problem.what,
    };
    match choice {
        DescriptionChoice::Ready(name) => {
            let found = UnitDescription::ready(name).map_err(wrong)?;
            found.ok_or_else(|| SourceError::Read {
                path: name.clone(),
                reason: "no description of this name comes with the program".to_owned(),
            })
        }
        DescriptionChoice::File(name) => {
            let path = name.path(folder).map_err(SourceError::FileName)?;
            let file = path.display().to_string();
            let text = std::fs::read_to_string(&path).map_err(|error| SourceError::Read {
                path: file.clone(),
                reason: error.to_string(),
            })?;
            UnitDescription::parse(&file, &text).map_err(wrong)
        }
    }
}
