//! Temperature of an instrument beside its samples: plausible, and free of jumps.
//!
//! It is checked where it is asked for: a run doesn't ask, so that a broken thermometer doesn't end one.

use octant_base::number::plain;
use octant_scenario::recorded::TemperatureUnit;

/// Temperatures of an instrument that works, °C.
const RANGE_C: [f64; 2] = [-100.0, 200.0];
/// Largest step between two values, K: of a coarse thermometer, with its noise.
const STEP_K: f64 = 5.0;
/// Largest change in time beside the step, K/s: ten times that of a heater.
const RATE_KPS: f64 = 1.0;

/// Checks the temperatures of a recording, one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TemperatureCheck {
    /// Stamp, ns, and temperature, °C, of the value before.
    before: Option<(u64, f64)>,
}

impl TemperatureCheck {
    /// Converts the next value to °C.
    ///
    /// # Errors
    /// If it isn't finite, or no temperature of an instrument, or too far from the one before.
    pub(super) fn take(
        &mut self,
        time_ns: u64,
        value: f64,
        unit: TemperatureUnit,
    ) -> Result<f64, String> {
        let found = || format!("temperature {} {}", plain(value, 6), unit.name());
        if !value.is_finite() {
            return Err(format!("temperature {value} {}, expected a finite number", unit.name()));
        }
        let celsius = unit.celsius(value);
        if !(RANGE_C[0]..=RANGE_C[1]).contains(&celsius) {
            let offset = value - celsius;
            return Err(format!(
                "{}, expected {} to {} {}: another unit or column",
                found(),
                plain(RANGE_C[0] + offset, 6),
                plain(RANGE_C[1] + offset, 6),
                unit.name()
            ));
        }
        if let Some((before_ns, before)) = self.before {
            let apart_s = time_ns.saturating_sub(before_ns) as f64 * 1e-9;
            let most = STEP_K + RATE_KPS * apart_s;
            if (celsius - before).abs() > most {
                return Err(format!(
                    "{}, {} K from the one {} s before, expected at most {} K: not the temperature of an instrument",
                    found(),
                    plain(celsius - before, 3),
                    plain(apart_s, 3),
                    plain(most, 3)
                ));
            }
        }
        self.before = Some((time_ns, celsius));
        Ok(celsius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kelvin_and_celsius_are_the_same_temperature() {
        let mut check = TemperatureCheck::default();
        let kelvin = check.take(0, 298.15, TemperatureUnit::Kelvin).unwrap();
        assert!((kelvin - 25.0).abs() < 1e-12);
        assert_eq!(check.take(1, 25.5, TemperatureUnit::Celsius), Ok(25.5));
    }

    #[test]
    fn what_is_no_temperature_is_an_error() {
        let take = |values: &[(u64, f64)], unit| {
            let mut check = TemperatureCheck::default();
            let found: Result<Vec<f64>, String> = values
                .iter()
                .map(|(s, value)| check.take(s * 1_000_000_000, *value, unit))
                .collect();
            found.unwrap_err()
        };
        let said = take(&[(0, 25.0)], TemperatureUnit::Kelvin);
        assert!(said.starts_with("temperature 25 K, expected 173.15 to 473.15 K"), "{said}");
        let said = take(&[(0, 298.0)], TemperatureUnit::Celsius);
        assert!(said.starts_with("temperature 298 degC, expected −100 to 200 degC"), "{said}");
        let said = take(&[(0, f64::NAN)], TemperatureUnit::Celsius);
        assert!(said.contains("expected a finite number"), "{said}");
        let said = take(&[(0, 25.0), (1, 32.0)], TemperatureUnit::Celsius);
        assert!(said.contains("7 K from the one 1 s before, expected at most 6 K"), "{said}");
        // After a pause an instrument may be at another temperature.
        let mut check = TemperatureCheck::default();
        check.take(0, 25.0, TemperatureUnit::Celsius).unwrap();
        check.take(60_000_000_000, 60.0, TemperatureUnit::Celsius).unwrap();
    }
}
