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
}

impl ExchangeFormat {
    /// Format that the name of a file tells, if it is one of them.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
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
