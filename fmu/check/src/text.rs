//! Text of an XML file inside the FMU.

use super::finding::{Findings, Place};
use super::rules::DESCRIPTION_ENCODING;
use octant_fmu_host::description::decode;

/// Decodes the text of an XML file, if possible.
pub(super) fn text(entry: &str, bytes: &[u8], findings: &mut Findings) -> Option<String> {
    let place = Place { entry, ..Place::default() };
    match decode(bytes, entry) {
        Ok((text, tolerated)) => {
            // A mark before UTF-8 is legal in XML.
            for found in tolerated.into_iter().filter(|found| !found.contains("byte order mark")) {
                findings.add(&DESCRIPTION_ENCODING, place, found, "UTF-8");
            }
            Some(text)
        }
        Err(error) => {
            findings.add(&DESCRIPTION_ENCODING, place, error.found, error.expected);
            None
        }
    }
}
