//! Rate and clock of an input's units.

use octant_base::number::plain;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Rate of an input by its own stamps, and its clock against one outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClockAccount {
    /// Rate that the scenario gives, Hz.
    pub configured_hz: f64,
    /// Rate by the stamps, or by arrivals where there are no stamps, Hz; null: nothing shows it.
    pub measured_hz: Option<f64>,
    /// Measured against configured rate, ppm: positive where the units come faster.
    pub rate_ppm: Option<f64>,
    /// Standard deviation of that difference, ppm.
    pub rate_sigma_ppm: Option<f64>,
    /// Standard deviation of the stamps about their fit on the count of units, s.
    pub scatter_s: Option<f64>,
    /// Largest distance of a stamp from the fit, s.
    pub scatter_max_s: Option<f64>,
    /// True where the units are increments: an error of the clock is one of the rates that are made of them.
    pub increments: bool,
    /// Clock outside, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<OutsideClock>,
}

/// The input's clock against one outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutsideClock {
    /// Name of the outside clock: `the host's arrivals`, `pulses`, `log times`.
    pub name: String,
    /// Relative rate of the input's clock, ppm: positive where it is fast.
    pub fast_ppm: f64,
    /// Standard deviation of that, ppm; null: not known.
    pub sigma_ppm: Option<f64>,
}

/// Difference of the rate from the configured one that is told where all else is as expected, ppm: beyond a good crystal's.
const OFF_PPM: f64 = 20.0;

impl ClockAccount {
    /// Returns whether the rate is off the configured one, or the clock off the one outside, by more than a good crystal's error.
    #[must_use]
    pub fn is_off(&self) -> bool {
        let outside = self.outside.as_ref().map(|outside| outside.fast_ppm);
        [self.rate_ppm, outside].into_iter().flatten().any(|ppm| ppm.abs() > OFF_PPM)
    }
}

impl fmt::Display for ClockAccount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.measured_hz, self.rate_ppm) {
            (Some(hz), Some(ppm)) => {
                write!(f, "{} Hz, {}", plain(hz, 9), signed(ppm))?;
                if let Some(sigma) = self.rate_sigma_ppm {
                    write!(f, " ± {}", plain(sigma, 2))?;
                }
                write!(f, " ppm from the configured {} Hz", plain(self.configured_hz, 9))?;
            }
            _ => write!(
                f,
                "no stamps; {} Hz is taken from the scenario",
                plain(self.configured_hz, 9)
            )?,
        }
        if let (Some(scatter), Some(max)) = (self.scatter_s, self.scatter_max_s)
            && max > 0.0
        {
            let ms = |s: f64| plain(s * 1e3, 3);
            write!(f, "; stamps scatter by {} ms (1 sigma), {} ms at most", ms(scatter), ms(max))?;
        }
        match &self.outside {
            Some(OutsideClock { name, fast_ppm, sigma_ppm }) => {
                write!(f, "; {}", signed(*fast_ppm))?;
                if let Some(sigma) = sigma_ppm {
                    write!(f, " ± {}", plain(*sigma, 2))?;
                }
                write!(f, " ppm against {name}")?;
            }
            None => write!(f, "; no clock outside shows the error of this one")?,
        }
        if self.increments {
            write!(f, "; of increments 1 ppm of it is 1 ug of accelerometer bias along gravity")?;
        }
        Ok(())
    }
}

/// Number with its sign, to four digits.
fn signed(ppm: f64) -> String {
    let text = plain(if ppm.abs() < 5e-4 { 0.0 } else { ppm }, 4);
    if ppm >= 5e-4 { format!("+{text}") } else { text }
}
