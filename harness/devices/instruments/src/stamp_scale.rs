//! Time scales of stamps.
//!
//! A unit whose clock is set by PTP, NTP or a satellite receiver stamps its samples by a scale that clocks of the
//! host have too: UTC is the realtime clock's, TAI that of a network card that PTP sets.

/// Beginning of GPS time, 6 January 1980, s since 1970 (IS-GPS-200, 3.3.4).
pub const GPS_EPOCH_S: i64 = 315_964_800;
/// Seconds by which TAI is ahead of GPS time, for good.
const TAI_AHEAD_OF_GPS_S: i128 = 19;
const SECOND_NS: i128 = 1_000_000_000;

/// Time scale of stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StampScale {
    /// UTC since 1970, without leap seconds.
    Utc,
    /// TAI since 1970, as PTP has it.
    Tai,
    /// GPS time since 6 January 1980.
    Gps,
}

impl StampScale {
    /// Name of the scale.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Utc => "utc",
            Self::Tai => "tai",
            Self::Gps => "gps",
        }
    }

    /// Time as TAI since 1970, ns. `tai_offset_s` is the number of seconds by which TAI is ahead of UTC;
    /// TAI and GPS time don't need it.
    #[must_use]
    pub const fn tai_ns(self, ns: u64, tai_offset_s: u32) -> i128 {
        let ns = ns as i128;
        match self {
            Self::Utc => ns + tai_offset_s as i128 * SECOND_NS,
            Self::Tai => ns,
            Self::Gps => ns + (GPS_EPOCH_S as i128 + TAI_AHEAD_OF_GPS_S) * SECOND_NS,
        }
    }

    /// Time as UTC since 1970, ns, which needs no offset only of UTC.
    #[must_use]
    pub const fn utc_ns(self, ns: u64, tai_offset_s: u32) -> i128 {
        match self {
            Self::Utc => ns as i128,
            Self::Tai | Self::Gps => {
                self.tai_ns(ns, tai_offset_s) - tai_offset_s as i128 * SECOND_NS
            }
        }
    }
}
