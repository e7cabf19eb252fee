//! Formats of files of requirements.

use std::path::Path;

/// Formats of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExchangeFormat {
    /// `requirements.toml`.
    Toml,
    /// StrictDoc's `.sdoc`.
    StrictDoc,
    /// `.reqif`.
    ReqIf,
    /// `.reqifz`.
    ReqIfArchive,
    /// `needs.json` of sphinx-needs.
    Needs,
    /// A folder of Doorstop.
    Doorstop,
}

impl ExchangeFormat {
    /// Format that the name of a file tells, if it is one of them. A folder, and a name without an ending,
    /// is one of Doorstop.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        if path.is_dir() {
            return Some(Self::Doorstop);
        }
        let Some(ending) = path.extension() else { return Some(Self::Doorstop) };
        let ending = ending.to_str()?;
        match ending.to_ascii_lowercase().as_str() {
            "toml" => Some(Self::Toml),
            "sdoc" => Some(Self::StrictDoc),
            "reqif" => Some(Self::ReqIf),
            "reqifz" => Some(Self::ReqIfArchive),
            "json" => Some(Self::Needs),
            _ => None,
        }
    }

    /// True if the names of its attributes can be mapped.
    pub(crate) const fn is_mapped(self) -> bool {
        !matches!(self, Self::Toml | Self::StrictDoc)
    }
}
