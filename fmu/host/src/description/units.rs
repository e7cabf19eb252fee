//! Conversion between units, with a check of their dimension.
//!
//! The definition in the description has priority; a name without one is read by the grammar of
//! Modelica, in which most tools write (`rad/s`, `N.m`, `m/s2`, `deg/h`).

use super::{BaseUnit, Description, Variable};

/// The base units, in the order of the exponents.
pub const BASE_NAMES: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

/// Largest relative distance of a definition's factor from the exact one of a known name, for which
/// the known unit is meant: tools write `0.0174533` for a degree.
const SAME_FACTOR: f64 = 1e-5;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;

/// Conversion of a number in one unit to a number in another: factor · number + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitConversion {
    /// Factor; exactly 1 between equal units.
    pub factor: f64,
    /// Offset; exactly 0 between units with the same zero.
    pub offset: f64,
}

/// Reason why two units can't be converted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// The name is neither defined nor known.
    #[error(
        "unit {unit:?} is neither defined in {file} nor a known one, expected one like {wanted:?}"
    )]
    Unknown {
        /// File name of the description.
        file: String,
        /// Unit.
        unit: String,
        /// Unit to or from which it is converted.
        wanted: String,
    },
    /// The units measure different quantities.
    #[error("unit {from:?} ({}) can't become {to:?} ({})", Dimension(*.from_exponents), Dimension(*.to_exponents))]
    Dimension {
        /// Unit of the value.
        from: String,
        /// Exponents of that unit.
        from_exponents: [i8; 8],
        /// Unit wanted.
        to: String,
        /// Exponents of the unit wanted.
        to_exponents: [i8; 8],
    },
    /// The variable has no unit.
    #[error("variable {variable:?} of {file} has no unit, expected one like {wanted:?}")]
    None {
        /// File name of the description.
        file: String,
        /// Variable.
        variable: String,
        /// Unit wanted.
        wanted: String,
    },
}

/// Exponents in words: `m·s^-2`.
struct Dimension([i8; 8]);

impl std::fmt::Display for Dimension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parts: Vec<String> = BASE_NAMES
            .iter()
            .zip(self.0)
            .filter(|&(_, exponent)| exponent != 0)
            .map(|(name, exponent)| match exponent {
                1 => (*name).to_owned(),
                _ => format!("{name}^{exponent}"),
            })
            .collect();
        match parts.is_empty() {
            true => f.write_str("no dimension"),
            false => f.write_str(&parts.join("·")),
        }
    }
}

/// Exponents in words: `m·s^-2`; `no dimension` where all are 0.
#[must_use]
pub fn dimension(exponents: [i8; 8]) -> String {
    Dimension(exponents).to_string()
}

impl UnitConversion {
    /// Identity: no bit is changed.
    pub const IDENTITY: Self = Self { factor: 1.0, offset: 0.0 };

    /// Makes the conversion from the unit of a variable to the unit `wanted`. For a variable that
    /// holds a difference, offsets don't count.
    ///
    /// # Errors
    /// If the variable has no unit, its unit is unknown or measures something else.
    pub fn of(
        description: &Description,
        variable: &Variable,
        wanted: &str,
    ) -> Result<Self, UnitError> {
        let unit = variable.unit.as_deref().ok_or_else(|| UnitError::None {
            file: description.file.clone(),
            variable: variable.name.clone(),
            wanted: wanted.into(),
        })?;
        let conversion = Self::between(description, unit, wanted)?;
        Ok(match variable.relative_quantity {
            true => Self { offset: 0.0, ..conversion },
            false => conversion,
        })
    }

    /// Makes the conversion from one unit to another: names that the description defines, or known
    /// ones.
    ///
    /// # Errors
    /// If a unit is unknown, or they measure different quantities.
    pub fn between(description: &Description, from: &str, to: &str) -> Result<Self, UnitError> {
        if from == to {
            return Ok(Self::IDENTITY);
        }
        let find = |unit: &str, wanted: &str| {
            let found = candidates(description, unit);
            if found.is_empty() {
                return Err(UnitError::Unknown {
                    file: description.file.clone(),
                    unit: unit.into(),
                    wanted: wanted.into(),
                });
            }
            Ok(found)
        };
        let (froms, tos) = (find(from, to)?, find(to, from)?);
        for a in &froms {
            for b in &tos {
                if a.exponents == b.exponents {
                    return Ok(Self::ratio(a, b));
                }
            }
        }
        Err(UnitError::Dimension {
            from: from.into(),
            from_exponents: froms[0].exponents,
            to: to.into(),
            to_exponents: tos[0].exponents,
        })
    }

    /// Makes the conversion between two units of the same dimension.
    pub fn ratio(from: &BaseUnit, to: &BaseUnit) -> Self {
        if from.factor == to.factor && from.offset == to.offset {
            return Self::IDENTITY;
        }
        // The quotient is rounded once; through SI it would be rounded twice.
        Self { factor: from.factor / to.factor, offset: (from.offset - to.offset) / to.factor }
    }

    /// Converts a number.
    #[must_use]
    pub fn apply(&self, number: f64) -> f64 {
        // Adding 0 would turn -0 into 0.
        match self.offset {
            0.0 => self.factor * number,
            offset => self.factor * number + offset,
        }
    }

    /// Returns whether the conversion is the identity.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        *self == Self::IDENTITY
    }
}

/// Possible meanings of a name: that in the description, else the common one. More than one only
/// for `g`, which is a gram and an acceleration.
pub fn candidates(description: &Description, name: &str) -> Vec<BaseUnit> {
    let known = known(name);
    if let Some(base) = description.unit(name).and_then(|unit| unit.base) {
        return vec![meant(&base, &known)];
    }
    if known.is_empty() {
        // Unit of a display unit: shown = factor · value + offset.
        let found = description.units.iter().find_map(|unit| {
            let display = unit.display.iter().find(|display| display.name == name)?;
            let base = meant(&unit.base?, &self::known(&unit.name));
            (!display.inverse).then(|| BaseUnit {
                exponents: base.exponents,
                factor: base.factor / display.factor,
                offset: base.offset - base.factor * display.offset / display.factor,
            })
        });
        return found.into_iter().collect();
    }
    known
}

/// Finds the known unit of angles that a definition means: one of the same dimension, apart from a
/// radian that tools leave out, and with a factor equal to the digits of π that are given.
/// Otherwise returns the definition: no other factor needs infinitely many digits.
pub fn meant(defined: &BaseUnit, known: &[BaseUnit]) -> BaseUnit {
    let close = |a: f64, b: f64| (a - b).abs() <= SAME_FACTOR * b.abs();
    let is_meant = |known: &&BaseUnit| {
        known.exponents[7] != 0
            && defined.exponents[..7] == known.exponents[..7]
            && (defined.exponents[7] == known.exponents[7] || defined.exponents[7] == 0)
            && close(defined.factor, known.factor)
            && close(defined.offset, known.offset)
    };
    *known.iter().find(is_meant).unwrap_or(defined)
}

/// Common meanings of a name; empty if there is none.
#[must_use]
pub fn known(name: &str) -> Vec<BaseUnit> {
    let name = name.trim();
    for (names, unit) in WHOLE {
        if names.contains(&name) {
            return vec![*unit];
        }
    }
    let mut found: Vec<BaseUnit> = Vec::new();
    for g_is_gravity in [false, true] {
        let mut parser = Parser { rest: name, g_is_gravity, depth: 0 };
        if let Some(unit) = parser.product()
            && parser.rest.is_empty()
            && !found.contains(&unit)
        {
            found.push(unit);
        }
    }
    found
}

const fn unit(exponents: [i8; 8], factor: f64, offset: f64) -> BaseUnit {
    BaseUnit { exponents, factor, offset }
}

const NONE: [i8; 8] = [0; 8];
const LENGTH: [i8; 8] = [0, 1, 0, 0, 0, 0, 0, 0];
const TIME: [i8; 8] = [0, 0, 1, 0, 0, 0, 0, 0];
const ANGLE: [i8; 8] = [0, 0, 0, 0, 0, 0, 0, 1];
const KELVIN: [i8; 8] = [0, 0, 0, 0, 1, 0, 0, 0];
const ENERGY: [i8; 8] = [1, 2, -2, 0, 0, 0, 0, 0];

/// One degree, rad.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Names that can't be combined with others.
const WHOLE: &[(&[&str], BaseUnit)] = &[
    (&["1", "-", "", "none"], unit(NONE, 1.0, 0.0)),
    (&["degC", "°C", "Celsius"], unit(KELVIN, 1.0, 273.15)),
    (&["degF", "°F"], unit(KELVIN, 5.0 / 9.0, 459.67 * 5.0 / 9.0)),
    (&["rpm"], unit([0, 0, -1, 0, 0, 0, 0, 1], std::f64::consts::TAU / 60.0, 0.0)),
];

/// Symbols without prefixes.
const SYMBOLS: &[(&str, BaseUnit)] = &[
    ("1", unit(NONE, 1.0, 0.0)),
    ("%", unit(NONE, 1e-2, 0.0)),
    ("ppm", unit(NONE, 1e-6, 0.0)),
    ("deg", unit(ANGLE, DEGREE, 0.0)),
    ("°", unit(ANGLE, DEGREE, 0.0)),
    ("arcmin", unit(ANGLE, DEGREE / 60.0, 0.0)),
    ("arcsec", unit(ANGLE, DEGREE / 3600.0, 0.0)),
    ("rev", unit(ANGLE, std::f64::consts::TAU, 0.0)),
    ("min", unit(TIME, 60.0, 0.0)),
    ("h", unit(TIME, 3600.0, 0.0)),
    ("hr", unit(TIME, 3600.0, 0.0)),
    ("d", unit(TIME, 86_400.0, 0.0)),
    ("ft", unit(LENGTH, 0.3048, 0.0)),
    ("in", unit(LENGTH, 0.0254, 0.0)),
    ("nmi", unit(LENGTH, 1852.0, 0.0)),
    ("mi", unit(LENGTH, 1609.344, 0.0)),
    ("kn", unit([0, 1, -1, 0, 0, 0, 0, 0], 1852.0 / 3600.0, 0.0)),
    ("knot", unit([0, 1, -1, 0, 0, 0, 0, 0], 1852.0 / 3600.0, 0.0)),
    // A difference of temperatures, in a combination such as J/degC.
    ("degC", unit(KELVIN, 1.0, 0.0)),
    ("degK", unit(KELVIN, 1.0, 0.0)),
    ("lb", unit([1, 0, 0, 0, 0, 0, 0, 0], 0.453_592_37, 0.0)),
];

/// Symbols that accept prefixes.
const PREFIXED: &[(&str, BaseUnit)] = &[
    ("m", unit(LENGTH, 1.0, 0.0)),
    ("g", unit([1, 0, 0, 0, 0, 0, 0, 0], 1e-3, 0.0)),
    ("s", unit(TIME, 1.0, 0.0)),
    ("A", unit([0, 0, 0, 1, 0, 0, 0, 0], 1.0, 0.0)),
    ("K", unit(KELVIN, 1.0, 0.0)),
    ("mol", unit([0, 0, 0, 0, 0, 1, 0, 0], 1.0, 0.0)),
    ("cd", unit([0, 0, 0, 0, 0, 0, 1, 0], 1.0, 0.0)),
    ("rad", unit(ANGLE, 1.0, 0.0)),
    ("Hz", unit([0, 0, -1, 0, 0, 0, 0, 0], 1.0, 0.0)),
    ("N", unit([1, 1, -2, 0, 0, 0, 0, 0], 1.0, 0.0)),
    ("Pa", unit([1, -1, -2, 0, 0, 0, 0, 0], 1.0, 0.0)),
    ("bar", unit([1, -1, -2, 0, 0, 0, 0, 0], 1e5, 0.0)),
    ("J", unit(ENERGY, 1.0, 0.0)),
    ("Wh", unit(ENERGY, 3600.0, 0.0)),
    ("W", unit([1, 2, -3, 0, 0, 0, 0, 0], 1.0, 0.0)),
    ("C", unit([0, 0, 1, 1, 0, 0, 0, 0], 1.0, 0.0)),
    ("V", unit([1, 2, -3, -1, 0, 0, 0, 0], 1.0, 0.0)),
    ("F", unit([-1, -2, 4, 2, 0, 0, 0, 0], 1.0, 0.0)),
    ("Ohm", unit([1, 2, -3, -2, 0, 0, 0, 0], 1.0, 0.0)),
    ("Ω", unit([1, 2, -3, -2, 0, 0, 0, 0], 1.0, 0.0)),
    ("S", unit([-1, -2, 3, 2, 0, 0, 0, 0], 1.0, 0.0)),
    ("Wb", unit([1, 2, -2, -1, 0, 0, 0, 0], 1.0, 0.0)),
    ("T", unit([1, 0, -2, -1, 0, 0, 0, 0], 1.0, 0.0)),
    ("H", unit([1, 2, -2, -2, 0, 0, 0, 0], 1.0, 0.0)),
    ("l", unit([0, 3, 0, 0, 0, 0, 0, 0], 1e-3, 0.0)),
    ("L", unit([0, 3, 0, 0, 0, 0, 0, 0], 1e-3, 0.0)),
    ("t", unit([1, 0, 0, 0, 0, 0, 0, 0], 1e3, 0.0)),
];

const PREFIXES: &[(&str, f64)] = &[
    ("da", 1e1),
    ("T", 1e12),
    ("G", 1e9),
    ("M", 1e6),
    ("k", 1e3),
    ("h", 1e2),
    ("d", 1e-1),
    ("c", 1e-2),
    ("m", 1e-3),
    ("u", 1e-6),
    ("µ", 1e-6),
    ("μ", 1e-6),
    ("n", 1e-9),
    ("p", 1e-12),
];

/// Parser of `a.b/c`, with exponents `m2`, `m^2`, `s-1`, `s^(-1)` and parentheses.
struct Parser<'a> {
    rest: &'a str,
    /// True if `g` is standard gravity, not a gram.
    g_is_gravity: bool,
    depth: u8,
}

impl Parser<'_> {
    fn product(&mut self) -> Option<BaseUnit> {
        let mut product = self.power()?;
        loop {
            let Some(sign) = self.rest.chars().next() else { return Some(product) };
            if !matches!(sign, '.' | '*' | '·' | ' ' | '/') {
                return Some(product);
            }
            self.rest = &self.rest[sign.len_utf8()..];
            let factor = self.power()?;
            product = combined(&product, &factor, sign == '/')?;
        }
    }

    fn power(&mut self) -> Option<BaseUnit> {
        let base = match self.rest.strip_prefix('(') {
            Some(rest) => {
                // Names come from foreign files, so that the depth is limited.
                self.depth = self.depth.checked_add(1).filter(|&depth| depth < 16)?;
                self.rest = rest;
                let inner = self.product()?;
                self.rest = self.rest.strip_prefix(')')?;
                self.depth -= 1;
                inner
            }
            None => self.symbol()?,
        };
        let exponent = self.exponent()?;
        raised(&base, exponent)
    }

    fn symbol(&mut self) -> Option<BaseUnit> {
        // `1` is no unit: `1/s`.
        if let Some(rest) = self.rest.strip_prefix('1')
            && !rest.starts_with(|c: char| c.is_ascii_digit())
        {
            self.rest = rest;
            return Some(unit(NONE, 1.0, 0.0));
        }
        let end = self
            .rest
            .find(|c: char| !(c.is_alphabetic() || matches!(c, '%' | '°')))
            .unwrap_or(self.rest.len());
        let (symbol, rest) = self.rest.split_at(end);
        self.rest = rest;
        let gravity = unit([0, 1, -2, 0, 0, 0, 0, 0], GRAVITY, 0.0);
        let find = |table: &[(&str, BaseUnit)], symbol: &str| {
            if symbol == "g" && self.g_is_gravity {
                return Some(gravity);
            }
            table.iter().find(|(name, _)| *name == symbol).map(|&(_, unit)| unit)
        };
        if let Some(unit) = find(SYMBOLS, symbol).or_else(|| find(PREFIXED, symbol)) {
            return Some(unit);
        }
        PREFIXES.iter().find_map(|&(prefix, factor)| {
            let rest = symbol.strip_prefix(prefix)?;
            // kg never means a thousand times gravity.
            if self.g_is_gravity && rest == "g" && factor > 1.0 {
                return None;
            }
            let mut unit = find(PREFIXED, rest)?;
            unit.factor *= factor;
            // A kilogram is exactly one, not a thousand times a thousandth.
            if symbol == "kg" {
                unit.factor = 1.0;
            }
            Some(unit)
        })
    }

    /// Reads the exponent after a symbol; 1 if there is none.
    fn exponent(&mut self) -> Option<i8> {
        let marked = self.rest.strip_prefix("**").or_else(|| self.rest.strip_prefix('^'));
        let mut rest = marked.unwrap_or(self.rest);
        for (sign, exponent) in [("²", 2), ("³", 3)] {
            if let Some(after) = rest.strip_prefix(sign) {
                self.rest = after;
                return Some(exponent);
            }
        }
        let open = marked.is_some() && rest.starts_with('(');
        if open {
            rest = &rest[1..];
        }
        let signs = usize::from(rest.starts_with(['-', '+']));
        let digits = rest[signs..].bytes().take_while(u8::is_ascii_digit).count();
        if digits == 0 {
            return (marked.is_none() && signs == 0).then_some(1);
        }
        let (number, mut after) = rest.split_at(signs + digits);
        if open {
            after = after.strip_prefix(')')?;
        }
        self.rest = after;
        number.parse().ok()
    }
}

/// Multiplies or divides two units; each rounded once.
fn combined(a: &BaseUnit, b: &BaseUnit, divided: bool) -> Option<BaseUnit> {
    let mut exponents = a.exponents;
    for (exponent, other) in exponents.iter_mut().zip(b.exponents) {
        *exponent =
            if divided { exponent.checked_sub(other)? } else { exponent.checked_add(other)? };
    }
    let factor = if divided { a.factor / b.factor } else { a.factor * b.factor };
    (factor.is_finite() && factor != 0.0).then(|| unit(exponents, factor, 0.0))
}

fn raised(base: &BaseUnit, exponent: i8) -> Option<BaseUnit> {
    let mut exponents = base.exponents;
    for one in &mut exponents {
        *one = one.checked_mul(exponent)?;
    }
    let factor = match exponent {
        1 => base.factor,
        _ => base.factor.powi(exponent.into()),
    };
    (factor.is_finite() && factor != 0.0).then(|| unit(exponents, factor, 0.0))
}

#[cfg(test)]
mod tests;
