//! Choices of keys that follow from the lists of other crates.

use octant_instruments::Protocol;
use octant_link::uri::SCHEMES;

/// Name of a protocol by a description of its frames.
pub(crate) const DESCRIBED: &str = "described";
const DESCRIBED_DOC: &str = "records on a line of bytes, by a description of their frames";

/// Names of what an instrument speaks: the protocols on a line of bytes, that of this program first as
/// it is the default, and `dbc` on a CAN bus.
pub(crate) const PROTOCOLS: [(&str, &str); Protocol::ALL.len() + 2] = {
    let dbc = ("dbc", "messages on a CAN bus, by a database and a mapping");
    let mut choices = [dbc; Protocol::ALL.len() + 2];
    choices[Protocol::ALL.len()] = (DESCRIBED, DESCRIBED_DOC);
    let (mut from, mut to) = (0, 1);
    while from < Protocol::ALL.len() {
        let facts = Protocol::ALL[from].facts();
        if matches!(Protocol::ALL[from], Protocol::Octant) {
            choices[0] = (facts.name, facts.doc);
        } else {
            choices[to] = (facts.name, facts.doc);
            to += 1;
        }
        from += 1;
    }
    choices
};

/// The protocols on a line of bytes alone.
pub(crate) const LINES: [(&str, &str); Protocol::ALL.len() + 1] = {
    let mut choices = [(DESCRIBED, DESCRIBED_DOC); Protocol::ALL.len() + 1];
    let mut at = 0;
    while at < Protocol::ALL.len() {
        let facts = Protocol::ALL[at].facts();
        choices[at] = (facts.name, facts.doc);
        at += 1;
    }
    choices
};

/// Places where the core runs: here, in an FMU, on a device at a port.
pub(crate) const ENDPOINTS: [(&str, &str); 2 + devices()] = {
    let here = ("in-process", "in Octant itself");
    let mut choices = [here; 2 + devices()];
    choices[1] = ("fmu", "an FMU: Octant's calibrator, or another core: fmu:FILE");
    let (mut from, mut to) = (0, 2);
    while from < SCHEMES.len() {
        if let Some(doc) = SCHEMES[from].devices {
            choices[to] = (SCHEMES[from].name, doc);
            to += 1;
        }
        from += 1;
    }
    choices
};

/// Number of the schemes that a device can be at.
const fn devices() -> usize {
    let (mut count, mut at) = (0, 0);
    while at < SCHEMES.len() {
        count += SCHEMES[at].devices.is_some() as usize;
        at += 1;
    }
    count
}
