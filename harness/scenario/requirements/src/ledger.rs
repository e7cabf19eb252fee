//! Fate of each object of a document: the account that an import returns.
//!
//! A reader tells the ledger what became of an object where that is decided, once for each: as a requirement or a
//! section, repaired or not, or as left out. So the sums of the account are those of the document.

use crate::error::Note;
use octant_account::{Account, AccountEntry, Weight};

/// Longest text of a repair that is shown, in characters.
const SHOWN: usize = 60;

/// Reason why an object was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeftOut {
    /// No attribute that names it.
    NoId,
    /// No text and no title.
    NoText,
    /// The id or identifier of an object before it.
    Again,
    /// A part that can't be read.
    Damaged,
    /// A type or an attribute that the document doesn't define.
    Undefined,
    /// Another document that is a part of this one.
    Document,
    /// The same object as in another file of the archive.
    Copy,
    /// Information by its type or an attribute.
    Information,
    /// An item that is switched off, or isn't normative.
    #[cfg(feature = "doorstop")]
    Inactive,
}

impl LeftOut {
    const fn words(self) -> &'static str {
        match self {
            Self::NoId => "without an id",
            Self::NoText => "without a text",
            Self::Again => "with the id of another",
            Self::Damaged => "that can't be read",
            Self::Undefined => "of a type or with a value that the document doesn't define",
            Self::Document => "that are documents of their own",
            Self::Copy => "equal to those of another file",
            Self::Information => "that are information",
            #[cfg(feature = "doorstop")]
            Self::Inactive => "not active or not normative",
        }
    }

    /// Returns whether such an object could have been a requirement.
    const fn is_doubt(self) -> bool {
        match self {
            Self::Copy | Self::Information => false,
            #[cfg(feature = "doorstop")]
            Self::Inactive => false,
            _ => true,
        }
    }
}

/// A repair of an object.
#[derive(Clone, Debug)]
pub(crate) struct Repair {
    /// Kind, in the words of an account: `with deleted text, which is left out`.
    pub(crate) kind: &'static str,
    /// Detail: before and after, or the names of what was left out.
    pub(crate) detail: String,
    /// True if the other choice could have another verdict.
    pub(crate) is_doubt: bool,
}

impl Repair {
    /// Repair with the text before and after it.
    pub(crate) fn of_text(kind: &'static str, before: &str, after: &str) -> Self {
        let detail = format!("{:?} became {:?}", short(before), short(after));
        Self { kind, detail, is_doubt: false }
    }
}

fn short(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(SHOWN) {
        None => line,
        Some((end, _)) => format!("{}…", &line[..end]),
    }
}

/// Place of an object.
#[derive(Clone, Debug)]
pub(crate) struct Whereabouts {
    pub(crate) name: String,
    /// File in an archive or folder; empty if there is only one.
    pub(crate) file: String,
    /// Line in the file, from 1; 0 if it isn't known.
    pub(crate) line: usize,
}

impl Whereabouts {
    pub(crate) fn new(name: impl Into<String>, file: &str, line: usize) -> Self {
        Self { name: name.into(), file: file.to_owned(), line }
    }

    fn words(&self) -> String {
        let Self { name, file, line } = self;
        match (file.as_str(), line) {
            ("", 0) => name.clone(),
            ("", line) => format!("{name} in line {line}"),
            (file, 0) => format!("{name} in {file}"),
            (file, line) => format!("{name} in {file}, line {line}"),
        }
    }

    fn note(&self, message: String) -> Note {
        Note::new(self.line, message).in_file(&self.file)
    }
}

/// Object of which no requirement can be made, and why.
#[derive(Clone, Debug)]
pub(crate) struct Lost {
    pub(crate) why: LeftOut,
    pub(crate) at: Whereabouts,
    /// Description for a note: `is of a type "x" that isn't in the file`.
    pub(crate) message: String,
}

/// Account of a document, while it is read.
#[derive(Debug)]
pub(crate) struct Ledger {
    account: Account,
}

impl Ledger {
    /// Begins the account of a document.
    pub(crate) fn new(document: &str) -> Self {
        Self { account: Account::new(document, ["object", "objects"]) }
    }

    fn change(&mut self, change: impl FnOnce(Account) -> Account) {
        let account = std::mem::replace(&mut self.account, Account::new("", ["", ""]));
        self.account = change(account);
    }

    /// Counts an object that became a requirement or a section, and returns a note for each repair.
    pub(crate) fn kept(&mut self, at: &Whereabouts, repairs: &[Repair]) -> Vec<Note> {
        let Some(first) = repairs.first() else {
            self.change(|account| account.used(1));
            return Vec::new();
        };
        let is_doubt = repairs.iter().any(|repair| repair.is_doubt);
        let entry = AccountEntry::new(1, first.kind)
            .first(format!("{}: {}", at.words(), first.detail))
            .weight(Weight::doubt_if(is_doubt));
        self.change(|account| account.repaired(entry));
        let note = |Repair { kind, detail, .. }: &Repair| {
            at.note(format!("{} is an object {kind}: {detail}", at.name))
        };
        repairs.iter().map(note).collect()
    }

    /// Counts an object that was left out.
    pub(crate) fn left_out(&mut self, why: LeftOut, at: &Whereabouts) {
        let entry = AccountEntry::new(1, why.words())
            .first(at.words())
            .weight(Weight::doubt_if(why.is_doubt()));
        self.change(|account| account.left_out(entry));
    }

    /// Counts an object of which no requirement can be made, and returns a note of it.
    pub(crate) fn lost(&mut self, lost: &Lost) -> Note {
        self.left_out(lost.why, &lost.at);
        lost.at.note(format!("the object {} {}: it is left out", lost.at.name, lost.message))
    }

    /// Counts an object that the document names and doesn't have.
    pub(crate) fn missing(&mut self, at: &Whereabouts) {
        let entry = AccountEntry::new(1, "that the hierarchy names and the document doesn't have")
            .first(at.words())
            .weight(Weight::Doubt);
        self.change(|account| account.missing(entry));
    }

    /// Adds a fact about the whole document.
    pub(crate) fn fact(&mut self, words: impl Into<String>) {
        self.change(|account| account.note(AccountEntry::fact(true, words)));
    }

    /// Ends the account.
    pub(crate) fn finish(self) -> Account {
        self.account
    }
}
