//! An instrument on a CAN bus, by a database and a mapping of its signals.

use super::arrival::{Arrival, ArrivalClock};
use crate::SourceError;
use octant_account::{Account, AccountEntry, Weight};
use octant_base::encoding::utf8_or_windows_1252;
use octant_base::number::counted;
use octant_instruments::Reading;
use octant_instruments::dbc::{CanFrame, Database, DbcProblem, Gatherer, SignalMapping};
use octant_link::Uri;
use octant_link::port::{HeardFrame, Listener};
use octant_scenario::{FileName, Messages};
use std::path::Path;
use std::time::Duration;

/// More lost readings than one for so many that came make a run inconclusive.
const LOST_MAX: u64 = 100;

/// Messages on a bus, and what is gathered of a reading.
#[derive(Debug)]
pub(super) struct Bus {
    listener: Listener,
    gatherer: Gatherer,
    /// Frame that was not taken yet, with its time of arrival.
    frame: Option<(HeardFrame, Arrival)>,
    clock: ArrivalClock,
}

impl Bus {
    /// Opens the bus. File names are relative to `folder`.
    pub(super) fn open(uri: &Uri, messages: &Messages, folder: &Path) -> Result<Self, SourceError> {
        let gatherer = gatherer(messages, folder)?;
        let identifiers: Vec<(u32, bool)> = gatherer.identifiers().collect();
        let listener = Listener::open(uri, &identifiers).map_err(|error| SourceError::Gone {
            uri: uri.to_string(),
            reason: error.to_string(),
        })?;
        Ok(Self { listener, gatherer, frame: None, clock: ArrivalClock::default() })
    }

    pub(super) fn reading(&mut self) -> Option<(Reading, Arrival)> {
        let (heard, came) = self.frame.take()?;
        let frame = CanFrame { id: heard.id, extended: heard.extended, data: heard.data() };
        self.gatherer.receive(&frame).map(|reading| (reading, came))
    }

    pub(super) fn receive(&mut self, wait: Duration) -> Result<bool, String> {
        let heard = self.listener.hear(wait).map_err(|error| error.to_string())?;
        self.frame = heard.map(|(heard, stamp)| (heard, self.clock.arrival(stamp)));
        Ok(self.frame.is_some())
    }

    /// Adds what was lost on the bus to an account.
    pub(super) fn losses(&self, account: Account) -> Account {
        let counters = self.gatherer.counters();
        let lost = counters.incomplete + counters.mixed;
        let many = Weight::doubt_if(lost > counters.readings / LOST_MAX);
        let entry = AccountEntry::new;
        account
            .left_out(entry(counters.incomplete, "readings with a missing message").weight(many))
            .left_out(
                entry(counters.mixed, "readings with messages of different samples").weight(many),
            )
            .note(entry(
                counters.orphaned,
                "messages of readings that had not begun or were given up",
            ))
            .note(entry(counters.short, "frames shorter than their message"))
            .note(entry(counters.other, "frames of other messages"))
    }

    pub(super) fn said(&self) -> String {
        let counters = self.gatherer.counters();
        format!(
            "{}, {}, {} of other messages, {} with a missing message, {} with messages \
             of another sample",
            counted(counters.frames, "frame", "frames"),
            counted(counters.readings, "reading", "readings"),
            counted(counters.other, "frame", "frames"),
            counted(counters.incomplete, "reading", "readings"),
            counted(counters.mixed, "reading", "readings"),
        )
    }
}

/// Checks that the files of an instrument exist and fit each other.
pub(super) fn check(messages: &Messages, folder: &Path) -> Result<(), SourceError> {
    gatherer(messages, folder).map(drop)
}

/// Builds the gatherer that assembles readings from CAN messages. File names are relative to
/// `folder`.
///
/// # Errors
/// If a file can't be read, or the files don't fit each other.
fn gatherer(messages: &Messages, folder: &Path) -> Result<Gatherer, SourceError> {
    let read = |name: &FileName| {
        let path = name.path(folder).map_err(SourceError::FileName)?;
        let file = path.display().to_string();
        match std::fs::read(&path) {
            Ok(bytes) => Ok((file, bytes)),
            Err(error) => Err(SourceError::Read { path: file, reason: error.to_string() }),
        }
    };
    let wrong =
        |problem: DbcProblem| SourceError::Read { path: problem.place, reason: problem.what };
    // A DBC doesn't say its encoding: tools of makers write Windows-1252, others UTF-8.
    let (file, bytes) = read(&messages.database)?;
    let database = Database::parse(&file, &utf8_or_windows_1252(&bytes)).map_err(wrong)?;
    let (file, bytes) = read(&messages.mapping)?;
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = 1 + valid.iter().filter(|byte| **byte == b'\n').count();
            let reason = "these bytes aren't UTF-8, in which a mapping is written".into();
            return Err(SourceError::Read { path: format!("{file}:{line}"), reason });
        }
    };
    let mapping = SignalMapping::parse(&file, &text).map_err(wrong)?;
    Gatherer::new(&database, &mapping).map_err(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DBC: &str = "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: Unit\n\n\
        BO_ 256 Kreisel: 6 Unit\n \
        SG_ x : 0|16@1- (0.01,0) [-327|327] \"°/s\" Vector__XXX\n \
        SG_ y : 16|16@1- (0.01,0) [-327|327] \"°/s\" Vector__XXX\n \
        SG_ z : 32|16@1- (0.01,0) [-327|327] \"°/s\" Vector__XXX\n\n\
        BO_ 257 Beschleunigung: 6 Unit\n \
        SG_ x : 0|16@1- (0.001,0) [-32|32] \"m/s²\" Vector__XXX\n \
        SG_ y : 16|16@1- (0.001,0) [-32|32] \"m/s²\" Vector__XXX\n \
        SG_ z : 32|16@1- (0.001,0) [-32|32] \"m/s²\" Vector__XXX\n\n\
        CM_ BO_ 256 \"Kreisel des Geräts\";\n";

    fn built(database: &[u8], mapping: &[u8]) -> Result<Gatherer, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("unit.dbc"), database).unwrap();
        std::fs::write(folder.path().join("unit.toml"), mapping).unwrap();
        let messages = Messages {
            database: FileName("unit.dbc".to_owned()),
            mapping: FileName("unit.toml".to_owned()),
        };
        gatherer(&messages, folder.path()).map_err(|error| {
            error.to_string().replace(&format!("{}/", folder.path().display()), "")
        })
    }

    /// The database with one byte for each character, as Windows-1252 has those that it uses.
    fn latin() -> Vec<u8> {
        DBC.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
    }

    fn mapping(more: &str) -> String {
        format!(
            "rotation = {{ x = \"Kreisel.x\", y = \"Kreisel.y\", z = \"Kreisel.z\"{more} }}\nvelocity = {{ x = \
             \"Beschleunigung.x\", y = \"Beschleunigung.y\", z = \"Beschleunigung.z\" }}\n"
        )
    }

    #[test]
    fn a_database_is_read_in_windows_1252_and_in_utf_8_with_and_without_a_mark() {
        let marked = format!("\u{feff}{DBC}");
        for database in [&latin()[..], DBC.as_bytes(), marked.as_bytes()] {
            let mut gatherer = built(database, mapping("").as_bytes()).unwrap();
            let rates = CanFrame { id: 256, extended: false, data: &[100, 0, 0, 0, 0, 0] };
            assert!(gatherer.receive(&rates).is_none());
            let rest = CanFrame { id: 257, extended: false, data: &[0, 0, 0, 0, 0x4e, 0x26] };
            let reading = gatherer.receive(&rest).unwrap();
            let text = format!("{reading:?}");
            // 1 °/s, and 9.806 m/s².
            assert!(text.contains("0.01745329"), "{text}");
            assert!(text.contains("9.806"), "{text}");
        }
    }

    #[test]
    fn a_unit_of_windows_1252_is_right_in_messages_and_a_mapping_is_utf_8() {
        let more = ", unit = \"rad/s\"";
        let error = built(&latin(), mapping(more).as_bytes()).unwrap_err();
        assert!(
            error.contains("has unit `°/s` in the database (unit.dbc:10), not `rad/s`"),
            "{error}"
        );
        let latin_mapping = [mapping("").as_bytes(), b"# Ger\xe4t\n"].concat();
        let error = built(DBC.as_bytes(), &latin_mapping).unwrap_err();
        assert!(error.contains("unit.toml:3: these bytes aren't UTF-8"), "{error}");
    }
}
