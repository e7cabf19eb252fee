//! Quantities as users write them, `"0.005 deg/h"`: a number with a unit, which has a dimension.
//!
//! A unit is a product or quotient of unit names, each with an integer power or under a root:
//! `deg/h/g`, `ug/sqrt(Hz)`, `m/s^2`, `°/√h`. Values are SI and rad inside; g is 9.80665 m/s².

mod unit;

pub use unit::{Powers, unit_names};

use octant_base::names::nearest;
use unit::parse_unit;

/// Dimension of a quantity: the powers of its unit, with texts for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitDimension {
    powers: Powers,
    /// Name with its article: `an angular rate`.
    pub name: &'static str,
    /// A quantity of this dimension, as an example in messages.
    pub example: &'static str,
    /// Unit in which values of this dimension are written.
    pub unit: &'static str,
    /// SI unit, in which every value can be written exactly.
    si_unit: &'static str,
}

/// Declares the dimensions: powers of m, s, rad, K, samples, V and A in halves, name, example, unit, SI unit.
macro_rules! dimensions {
    ($($(#[$doc:meta])* $item:ident
        = $powers:expr, $name:literal, $example:literal, $unit:literal, $si_unit:literal;)+) => {
        impl UnitDimension {
            $( $(#[$doc])* pub const $item: Self = Self {
                powers: $powers, name: $name, example: $example, unit: $unit, si_unit: $si_unit,
            }; )+

            const ALL: &[Self] = &[$(Self::$item),+];
        }
    };
}

dimensions! {
    /// Duration or period.
    TIME = [0, 2, 0, 0, 0, 0, 0], "a time", "12 h", "s", "s";
    /// Duration much shorter than a run.
    SHORT_TIME = [0, 2, 0, 0, 0, 0, 0], "a time", "500 us", "s", "s";
    /// Number of samples, distinguished from a ratio: `"20 samples"`.
    SAMPLES = [0, 0, 0, 0, 2, 0, 0], "a number of samples", "20 samples", "samples", "samples";
    /// Frequency or rate of samples.
    FREQUENCY = [0, -2, 0, 0, 0, 0, 0], "a frequency", "200 Hz", "Hz", "Hz";
    /// Angle.
    ANGLE = [0, 0, 2, 0, 0, 0, 0], "an angle", "30.5 deg", "deg", "rad";
    /// Small angle, written in arcsec.
    SMALL_ANGLE = [0, 0, 2, 0, 0, 0, 0], "an angle", "40 arcsec", "arcsec", "rad";
    /// Angular rate of a motion.
    ANGULAR_RATE = [0, -2, 2, 0, 0, 0, 0], "an angular rate", "10 deg/s", "deg/s", "rad/s";
    /// Angular rate of a gyro error.
    GYRO_BIAS = [0, -2, 2, 0, 0, 0, 0], "an angular rate", "0.005 deg/h", "deg/h", "rad/s";
    /// Angular acceleration.
    ANGULAR_ACCELERATION = [0, -4, 2, 0, 0, 0, 0], "an angular acceleration", "10 deg/s^2", "deg/s^2", "rad/s^2";
    /// Angle random walk.
    ANGLE_RANDOM_WALK = [0, -1, 2, 0, 0, 0, 0], "an angle random walk", "0.0007 deg/sqrt(h)", "deg/sqrt(h)", "rad/sqrt(s)";
    /// Rate random walk.
    RATE_RANDOM_WALK = [0, -3, 2, 0, 0, 0, 0], "a rate random walk", "0.0001 deg/h/sqrt(h)", "deg/h/sqrt(h)", "rad/s/sqrt(s)";
    /// Gyro bias per acceleration.
    G_DEPENDENT = [-2, 2, 2, 0, 0, 0, 0], "a g-dependent gyro bias", "0.0005 deg/h/g", "deg/h/g", "rad/s/(m/s^2)";
    /// Length.
    LENGTH = [2, 0, 0, 0, 0, 0, 0], "a length", "0.15 m", "m", "m";
    /// Velocity.
    VELOCITY = [2, -2, 0, 0, 0, 0, 0], "a velocity", "1 mm/s", "m/s", "m/s";
    /// Acceleration.
    ACCELERATION = [2, -4, 0, 0, 0, 0, 0], "an acceleration", "9.81 m/s^2", "m/s^2", "m/s^2";
    /// Acceleration of an accelerometer error.
    ACCEL_BIAS = [2, -4, 0, 0, 0, 0, 0], "an acceleration", "100 ug", "ug", "m/s^2";
    /// Accelerometer noise density.
    VELOCITY_RANDOM_WALK = [2, -3, 0, 0, 0, 0, 0], "an accelerometer noise density", "50 ug/sqrt(Hz)", "ug/sqrt(Hz)", "m/s^2/sqrt(Hz)";
    /// Ratio.
    RATIO = [0, 0, 0, 0, 0, 0, 0], "a ratio", "30 ppm", "ppm", "m/m";
    /// Temperature difference.
    TEMPERATURE = [0, 0, 0, 2, 0, 0, 0], "a temperature difference", "20 K", "K", "K";
    /// Temperature rate.
    TEMPERATURE_RATE = [0, -2, 0, 2, 0, 0, 0], "a temperature rate", "5 K/h", "K/h", "K/s";
    /// Gyro bias per kelvin.
    GYRO_BIAS_PER_K = [0, -2, 2, -2, 0, 0, 0], "a gyro bias sensitivity", "0.0002 deg/h/K", "deg/h/K", "rad/s/K";
    /// Accelerometer bias per kelvin.
    ACCEL_BIAS_PER_K = [2, -4, 0, -2, 0, 0, 0], "an accelerometer bias sensitivity", "2 ug/K", "ug/K", "m/s^2/K";
    /// Scale factor per kelvin.
    SCALE_PER_K = [0, 0, 0, -2, 0, 0, 0], "a scale factor sensitivity", "0.5 ppm/K", "ppm/K", "1/K";
    /// Random walk of an accelerometer bias.
    ACCEL_RANDOM_WALK = [2, -5, 0, 0, 0, 0, 0], "a random walk of acceleration", "1 ug/sqrt(h)", "ug/sqrt(h)", "m/s^2/sqrt(s)";
    /// Second-order coefficient of an accelerometer.
    ACCEL_QUADRATIC = [-2, 4, 0, 0, 0, 0, 0], "a second-order coefficient", "10 ug/g^2", "ug/g^2", "s^2/m";
    /// Power spectral density of a vibration.
    ACCELERATION_PSD = [4, -6, 0, 0, 0, 0, 0], "a spectral density of acceleration", "0.01 g^2/Hz", "g^2/Hz", "(m/s^2)^2/Hz";
    /// Voltage.
    VOLTAGE = [0, 0, 0, 0, 0, 2, 0], "a voltage", "24 V", "V", "V";
    /// Current.
    CURRENT = [0, 0, 0, 0, 0, 0, 2], "a current", "2 A", "A", "A";
}

impl UnitDimension {
    /// Exponents of kg, m, s, A, K, mol, cd, rad in the unit of FMUs; `None` if they are not whole, or
    /// if it counts samples.
    #[must_use]
    pub fn exponents(self) -> Option<[i8; 8]> {
        exponents(self.powers)
    }

    /// SI unit, in which every value can be written exactly.
    #[must_use]
    pub const fn si_unit(self) -> &'static str {
        self.si_unit
    }

    /// Dimension of scenarios with these exponents, if there is one.
    pub fn with_exponents(exponents: &[i8; 8]) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|dimension| dimension.exponents().as_ref() == Some(exponents))
    }

    /// Dimension of a parsed quantity, if it is one of scenarios.
    pub fn of(quantity: Quantity) -> Option<Self> {
        Self::ALL.iter().copied().find(|d| d.powers == quantity.powers)
    }

    /// Writes an SI value as a quantity that parses back to the same bits: in the user's unit with as
    /// few digits as possible, else in SI.
    #[must_use]
    pub fn write(self, value: f64) -> String {
        for unit in [self.unit, self.si_unit] {
            let Ok((factor, _)) = parse_unit(unit) else { continue };
            for digits in 0..17 {
                let text = format!("{:.digits$e}", value / factor);
                // Converted to f64 again, for its shortest plain spelling.
                let Ok(number) = text.parse::<f64>() else { continue };
                if (number * factor).to_bits() == value.to_bits() {
                    return format!("{} {unit}", plain(number));
                }
            }
        }
        format!("{value:e} {}", self.si_unit)
    }
}

fn exponents([m, s, rad, k, samples, volt, ampere]: Powers) -> Option<[i8; 8]> {
    // A volt is a kg·m²/(s³·A).
    let powers = [volt, m + 2 * volt, s - 3 * volt, ampere - volt, k, rad];
    if samples != 0 || powers.iter().any(|power| power % 2 != 0) {
        return None;
    }
    let [kg, m, s, ampere, k, rad] = powers.map(|power| i8::try_from(power / 2));
    Some([kg.ok()?, m.ok()?, s.ok()?, ampere.ok()?, k.ok()?, 0, 0, rad.ok()?])
}

/// Writes a number without exponent if that is readable.
fn plain(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-6..1e7).contains(&size) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// A parsed quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Value in SI and rad.
    pub si: f64,
    powers: Powers,
}

impl Quantity {
    /// True if two quantities have the same dimension.
    #[must_use]
    pub fn same_dimension(self, other: Self) -> bool {
        self.powers == other.powers
    }

    /// Exponents of kg, m, s, A, K, mol, cd, rad; `None`: it has roots, or counts samples.
    pub fn exponents(self) -> Option<[i8; 8]> {
        exponents(self.powers)
    }

    /// True if this is a quantity of the dimension.
    #[must_use]
    pub fn is(self, dimension: UnitDimension) -> bool {
        self.powers == dimension.powers
    }
}

/// Reason why a text isn't a quantity, a fragment that fits after "found".
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotAQuantity {
    /// The text doesn't start with a finite number.
    NoNumber,
    /// The number has no unit.
    NoUnit,
    /// The unit is unknown; with the unknown part.
    UnknownUnit(String),
}

/// Error of a text that is no quantity, a fragment that fits after "found …".
pub fn explain(error: &NotAQuantity) -> String {
    match error {
        NotAQuantity::NoNumber => "which doesn't start with a finite number".to_owned(),
        NotAQuantity::NoUnit => "a number without unit".to_owned(),
        NotAQuantity::UnknownUnit(unit) => match nearest(unit, unit_names()) {
            Some(name) => format!("with the unknown unit {unit:?} (did you mean {name:?}?)"),
            None => format!("with the unknown unit {unit:?}"),
        },
    }
}

/// Parses a number with its unit.
pub fn parse(text: &str) -> Result<Quantity, NotAQuantity> {
    let text = text.trim();
    let (number, unit) = text.split_at(number_length(text));
    let value: f64 = number.parse().map_err(|_| NotAQuantity::NoNumber)?;
    let unit = unit.trim();
    if unit.is_empty() {
        return Err(NotAQuantity::NoUnit);
    }
    let (factor, powers) = parse_unit(unit).map_err(NotAQuantity::UnknownUnit)?;
    let si = value * factor;
    if !si.is_finite() {
        return Err(NotAQuantity::NoNumber);
    }
    Ok(Quantity { si, powers })
}

/// Length of the decimal number at the start of a text, bytes.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    at += digits(at);
    if bytes.get(at) == Some(&b'.') {
        at += 1 + digits(at + 1);
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::units;
    use proptest::prelude::*;

    #[test]
    fn the_units_of_the_field_have_their_si_values() {
        let cases = [
            ("0.005 deg/h", 0.005 * units::DEG_PER_HOUR, UnitDimension::GYRO_BIAS),
            ("0.005°/h", 0.005 * units::DEG_PER_HOUR, UnitDimension::GYRO_BIAS),
            ("12 h", 43200.0, UnitDimension::TIME),
            ("200 Hz", 200.0, UnitDimension::FREQUENCY),
            ("30.5 deg", 30.5 * units::DEG, UnitDimension::ANGLE),
            ("18 arcsec", 18.0 * units::ARCSEC, UnitDimension::ANGLE),
            ("18″", 18.0 * units::ARCSEC, UnitDimension::ANGLE),
            ("50 ug/sqrt(Hz)", 50.0 * units::MICRO_G, UnitDimension::VELOCITY_RANDOM_WALK),
            ("50 µg/√Hz", 50.0 * units::MICRO_G, UnitDimension::VELOCITY_RANDOM_WALK),
            ("50 μg/√(Hz)", 50.0 * units::MICRO_G, UnitDimension::VELOCITY_RANDOM_WALK),
            ("7e-4 deg/sqrt(h)", 7e-4 * units::DEG_PER_SQRT_HOUR, UnitDimension::ANGLE_RANDOM_WALK),
            ("30 ppm", 30.0 * units::PPM, UnitDimension::RATIO),
            ("5e-4 deg/h/g", 5e-4 * units::DEG_PER_HOUR_PER_G, UnitDimension::G_DEPENDENT),
            ("10 deg/s", 10.0 * units::DEG, UnitDimension::ANGULAR_RATE),
            ("10 deg/s^2", 10.0 * units::DEG, UnitDimension::ANGULAR_ACCELERATION),
            ("10 °/s²", 10.0 * units::DEG, UnitDimension::ANGULAR_ACCELERATION),
            ("1 mm/s", 1e-3, UnitDimension::VELOCITY),
            ("2.4 m/s^2", 2.4, UnitDimension::ACCELERATION),
            ("24 V", 24.0, UnitDimension::VOLTAGE),
            ("500 mA", 0.5, UnitDimension::CURRENT),
            ("40 g", 40.0 * units::STANDARD_GRAVITY_MPS2, UnitDimension::ACCELERATION),
        ];
        for (text, si, dimension) in cases {
            let quantity = parse(text).unwrap();
            assert_eq!(quantity.si, si, "{text}");
            assert!(quantity.is(dimension), "{text} is {}", dimension.name);
        }
    }

    #[test]
    fn what_is_not_a_quantity_says_why() {
        assert_eq!(parse("fast"), Err(NotAQuantity::NoNumber));
        assert_eq!(parse("1e999 s"), Err(NotAQuantity::NoNumber));
        assert_eq!(parse("12"), Err(NotAQuantity::NoUnit));
        assert_eq!(parse("12 parsec"), Err(NotAQuantity::UnknownUnit("parsec".into())));
        assert_eq!(parse("1 deg/hour"), Err(NotAQuantity::UnknownUnit("hour".into())));
        assert!(parse("1 m/").is_err() && parse("1 sqrt(Hz").is_err());
    }

    #[test]
    fn a_volt_has_the_exponents_of_the_si() {
        // kg·m²/(s³·A): the SI brochure, table 4.
        let volt = parse("1 V").unwrap().exponents().unwrap();
        assert_eq!(volt, [1, 2, -3, -1, 0, 0, 0, 0]);
        assert_eq!(UnitDimension::with_exponents(&volt), Some(UnitDimension::VOLTAGE));
        assert_eq!(parse("1 A").unwrap().exponents().unwrap(), [0, 0, 0, 1, 0, 0, 0, 0]);
        // A watt.
        assert_eq!(parse("1 V*A").unwrap().exponents().unwrap(), [1, 2, -3, 0, 0, 0, 0, 0]);
    }

    proptest! {
        #[test]
        fn any_text_is_parsed_without_a_panic(text in "\\PC*") {
            let _ = parse(&text);
            let _ = parse(&format!("1 {text}"));
        }

        #[test]
        fn a_written_quantity_parses_to_the_same_bits(
            value in prop::num::f64::NORMAL.prop_filter("of instruments", |v| {
                (1e-25..1e25).contains(&v.abs())
            }),
            index in 0..UnitDimension::ALL.len(),
        ) {
            let dimension = UnitDimension::ALL[index];
            let text = dimension.write(value);
            let parsed = parse(&text).unwrap();
            prop_assert!(parsed.is(dimension), "{text}");
            prop_assert_eq!(parsed.si.to_bits(), value.to_bits(), "{}", text);
        }
    }

    #[test]
    fn round_numbers_are_written_round() {
        let bias = parse("0.005 deg/h").unwrap().si;
        assert_eq!(UnitDimension::GYRO_BIAS.write(bias), "0.005 deg/h");
        assert_eq!(UnitDimension::SMALL_ANGLE.write(parse("40 arcsec").unwrap().si), "40 arcsec");
        assert_eq!(UnitDimension::TIME.write(0.0), "0 s");
    }
}
