//! The two standards, and their names.

/// Standard that an FMU is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

impl Standard {
    /// Suffix of the model identifier.
    pub(super) fn suffix(self) -> &'static str {
        match self {
            Self::Fmi2 => "fmi2",
            Self::Fmi3 => "fmi3",
        }
    }

    /// Converts into the library's type.
    pub(super) fn of_library(self) -> octant_fmu::c::ServedStandard {
        match self {
            Self::Fmi2 => octant_fmu::c::ServedStandard::Fmi2,
            Self::Fmi3 => octant_fmu::c::ServedStandard::Fmi3,
        }
    }

    /// Name with its version.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Fmi2 => "FMI 2.0",
            Self::Fmi3 => "FMI 3.0",
        }
    }
}
