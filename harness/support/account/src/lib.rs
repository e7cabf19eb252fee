//! Accounts of what comes in.
//!
//! A reader of anything that others wrote (recording, log, port, solution, reference, requirement document, results of
//! another host) returns an [`Account`] with its content: the number of units that it read, and what became of each.
//!
//! | | counts |
//! |---|---|
//! | used | units that were used as they were found |
//! | repaired | units that were used after a repair, by the kind of repair |
//! | left out | units that were not used, by the reason |
//!
//! Each unit is in exactly one of these: [`Account::read`] is their sum, and an account whose stored sum differs can't be
//! read. Units that should be there and aren't are [`Account::missing`], which is no part of the sum; facts about the
//! whole are a [`Account::note`] each.
//!
//! An entry that could have changed the verdict is a [`Weight::Doubt`]: the run is inconclusive at best, with
//! the entry's line as the reason.

mod clock;
mod entry;

pub use clock::{ClockAccount, OutsideClock};
pub use entry::{AccountEntry, Weight};

use octant_base::number::counted;
use serde::{Deserialize, Serialize};

/// Account of one input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "StoredAccount", into = "StoredAccount")]
pub struct Account {
    name: String,
    unit: [String; 2],
    used: u64,
    repaired: Vec<AccountEntry>,
    left_out: Vec<AccountEntry>,
    missing: Vec<AccountEntry>,
    notes: Vec<AccountEntry>,
    clock: Option<Box<ClockAccount>>,
}

/// Account as it is stored, with the sum.
#[derive(Serialize, Deserialize)]
struct StoredAccount {
    input: String,
    unit: [String; 2],
    read: u64,
    used: u64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    repaired: Vec<AccountEntry>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<AccountEntry>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    missing: Vec<AccountEntry>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    notes: Vec<AccountEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clock: Option<Box<ClockAccount>>,
}

impl From<Account> for StoredAccount {
    fn from(account: Account) -> Self {
        let read = account.read();
        let Account { name, unit, used, repaired, left_out, missing, notes, clock } = account;
        Self { input: name, unit, read, used, repaired, left_out, missing, notes, clock }
    }
}

impl TryFrom<StoredAccount> for Account {
    type Error = String;

    fn try_from(stored: StoredAccount) -> Result<Self, String> {
        let StoredAccount { input, unit, read, used, repaired, left_out, missing, notes, clock } =
            stored;
        let account = Self { name: input, unit, used, repaired, left_out, missing, notes, clock };
        if account.read() == read {
            return Ok(account);
        }
        Err(format!(
            "account of {}: read is {read}, expected {}, the sum of used, repaired and left_out",
            account.name,
            account.read()
        ))
    }
}

impl Account {
    /// Creates the account of an input, with the name that messages give it, and the name of its units, singular and
    /// plural: `["row", "rows"]`.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: [&str; 2]) -> Self {
        Self {
            name: name.into(),
            unit: unit.map(str::to_owned),
            used: 0,
            repaired: Vec::new(),
            left_out: Vec::new(),
            missing: Vec::new(),
            notes: Vec::new(),
            clock: None,
        }
    }

    /// Gives the input another name in messages.
    #[must_use]
    pub fn renamed(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Adds units that were used as they were found.
    #[must_use]
    pub fn used(mut self, count: u64) -> Self {
        self.used = self.used.saturating_add(count);
        self
    }

    /// Adds units that were used after a repair. Nothing is added if the entry counts none; so in the functions below.
    #[must_use]
    pub fn repaired(mut self, entry: AccountEntry) -> Self {
        add(&mut self.repaired, entry);
        self
    }

    /// Adds units that were left out.
    #[must_use]
    pub fn left_out(mut self, entry: AccountEntry) -> Self {
        add(&mut self.left_out, entry);
        self
    }

    /// Adds units that should be there and aren't.
    #[must_use]
    pub fn missing(mut self, entry: AccountEntry) -> Self {
        add(&mut self.missing, entry);
        self
    }

    /// Adds a fact about the whole: a choice that was made, a share by quality.
    #[must_use]
    pub fn note(mut self, entry: AccountEntry) -> Self {
        add(&mut self.notes, entry);
        self
    }

    /// Adds the rate and the clock of the units.
    #[must_use]
    pub fn clock(mut self, clock: Option<ClockAccount>) -> Self {
        self.clock = clock.map(Box::new);
        self
    }

    /// Name of the input.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name of the units, singular and plural.
    #[must_use]
    pub fn unit(&self) -> &[String; 2] {
        &self.unit
    }

    /// Rate and clock of the units.
    #[must_use]
    pub fn clocked(&self) -> Option<&ClockAccount> {
        self.clock.as_deref()
    }

    /// Number of units that were read.
    #[must_use]
    pub fn read(&self) -> u64 {
        self.used.saturating_add(sum(&self.repaired)).saturating_add(sum(&self.left_out))
    }

    /// Number of units that were used, repaired ones included.
    #[must_use]
    pub fn used_count(&self) -> u64 {
        self.used.saturating_add(sum(&self.repaired))
    }

    /// Number of units that were repaired.
    #[must_use]
    pub fn repaired_count(&self) -> u64 {
        sum(&self.repaired)
    }

    /// Number of units that were left out.
    #[must_use]
    pub fn left_out_count(&self) -> u64 {
        sum(&self.left_out)
    }

    /// Number of units that are missing.
    #[must_use]
    pub fn missing_count(&self) -> u64 {
        sum(&self.missing)
    }

    /// Returns all entries with the heading of each.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, &AccountEntry)> {
        [
            ("repaired", &self.repaired),
            ("left out", &self.left_out),
            ("missing", &self.missing),
            ("note", &self.notes),
        ]
        .into_iter()
        .flat_map(|(heading, entries)| entries.iter().map(move |entry| (heading, entry)))
    }

    /// Returns whether every unit was used as it was found, and none is missing.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.repaired.is_empty() && self.left_out.is_empty() && self.missing.is_empty()
    }

    /// Sums the account up in one line.
    #[must_use]
    pub fn headline(&self) -> String {
        let [singular, plural] = &self.unit;
        let read = format!("{}: {} read", self.name, counted(self.read(), singular, plural));
        let mut parts = vec![if self.used_count() == self.read() && self.read() > 0 {
            "all used".to_owned()
        } else {
            format!("{} used", self.used_count())
        }];
        let counts = [
            ("repaired", self.repaired_count()),
            ("left out", self.left_out_count()),
            ("missing", self.missing_count()),
        ];
        parts.extend(counts.iter().filter(|(_, n)| *n > 0).map(|(name, n)| format!("{n} {name}")));
        format!("{read}, {}", parts.join(", "))
    }

    /// Describes the account: its headline, then a line for each kind of repair, loss and note, and for the clock.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.headline()];
        lines.extend(self.entries().map(|(heading, entry)| format!("{heading}: {entry}")));
        lines.extend(self.clock.iter().map(|clock| format!("clock: {clock}")));
        lines
    }

    /// Lists the reasons why a run with this input is inconclusive.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        self.entries()
            .filter(|(_, entry)| entry.weight == Weight::Doubt)
            .map(|(heading, entry)| match heading {
                "note" => format!("{}: {entry}", self.name),
                heading => format!("{}: {heading}: {entry}", self.name),
            })
            .collect()
    }
}

/// Adds an entry; those of one kind are one.
fn add(entries: &mut Vec<AccountEntry>, entry: AccountEntry) {
    if entry.count == 0 {
        return;
    }
    match entries.iter_mut().find(|there| there.kind == entry.kind) {
        Some(there) => there.merge(entry),
        None => entries.push(entry),
    }
}

fn sum(entries: &[AccountEntry]) -> u64 {
    entries.iter().fold(0, |sum, entry| sum.saturating_add(entry.count))
}
