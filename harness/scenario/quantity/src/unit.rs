//! Units: products and quotients of unit names, with their SI values and powers.

use octant_earth::units::{ARCMIN, ARCSEC, DEG, NAUTICAL_MILE_M, STANDARD_GRAVITY_MPS2};

/// Powers of metre, second, radian, kelvin, sample, volt and ampere, doubled so that roots are whole numbers.
pub type Powers = [i16; 7];

/// Names of units, with their SI values and powers.
const UNITS: &[(&str, f64, Powers)] = &[
    ("1", 1.0, [0, 0, 0, 0, 0, 0, 0]),
    ("rad", 1.0, [0, 0, 2, 0, 0, 0, 0]),
    ("mrad", 1e-3, [0, 0, 2, 0, 0, 0, 0]),
    ("urad", 1e-6, [0, 0, 2, 0, 0, 0, 0]),
    ("deg", DEG, [0, 0, 2, 0, 0, 0, 0]),
    ("°", DEG, [0, 0, 2, 0, 0, 0, 0]),
    ("arcmin", ARCMIN, [0, 0, 2, 0, 0, 0, 0]),
    ("'", ARCMIN, [0, 0, 2, 0, 0, 0, 0]),
    ("′", ARCMIN, [0, 0, 2, 0, 0, 0, 0]),
    ("arcsec", ARCSEC, [0, 0, 2, 0, 0, 0, 0]),
    ("\"", ARCSEC, [0, 0, 2, 0, 0, 0, 0]),
    ("″", ARCSEC, [0, 0, 2, 0, 0, 0, 0]),
    ("s", 1.0, [0, 2, 0, 0, 0, 0, 0]),
    ("ms", 1e-3, [0, 2, 0, 0, 0, 0, 0]),
    ("us", 1e-6, [0, 2, 0, 0, 0, 0, 0]),
    ("ns", 1e-9, [0, 2, 0, 0, 0, 0, 0]),
    ("min", 60.0, [0, 2, 0, 0, 0, 0, 0]),
    ("h", 3600.0, [0, 2, 0, 0, 0, 0, 0]),
    ("day", 86400.0, [0, 2, 0, 0, 0, 0, 0]),
    ("Hz", 1.0, [0, -2, 0, 0, 0, 0, 0]),
    ("kHz", 1e3, [0, -2, 0, 0, 0, 0, 0]),
    ("m", 1.0, [2, 0, 0, 0, 0, 0, 0]),
    ("mm", 1e-3, [2, 0, 0, 0, 0, 0, 0]),
    ("cm", 1e-2, [2, 0, 0, 0, 0, 0, 0]),
    ("um", 1e-6, [2, 0, 0, 0, 0, 0, 0]),
    ("km", 1e3, [2, 0, 0, 0, 0, 0, 0]),
    ("nmi", NAUTICAL_MILE_M, [2, 0, 0, 0, 0, 0, 0]),
    ("kn", NAUTICAL_MILE_M / 3600.0, [2, -2, 0, 0, 0, 0, 0]),
    ("g", STANDARD_GRAVITY_MPS2, [2, -4, 0, 0, 0, 0, 0]),
    ("mg", 1e-3 * STANDARD_GRAVITY_MPS2, [2, -4, 0, 0, 0, 0, 0]),
    ("ug", octant_earth::units::MICRO_G, [2, -4, 0, 0, 0, 0, 0]),
    ("ppm", 1e-6, [0, 0, 0, 0, 0, 0, 0]),
    ("%", 1e-2, [0, 0, 0, 0, 0, 0, 0]),
    ("K", 1.0, [0, 0, 0, 2, 0, 0, 0]),
    ("mK", 1e-3, [0, 0, 0, 2, 0, 0, 0]),
    ("V", 1.0, [0, 0, 0, 0, 0, 2, 0]),
    ("mV", 1e-3, [0, 0, 0, 0, 0, 2, 0]),
    ("A", 1.0, [0, 0, 0, 0, 0, 0, 2]),
    ("mA", 1e-3, [0, 0, 0, 0, 0, 0, 2]),
    ("samples", 1.0, [0, 0, 0, 0, 2, 0, 0]),
    ("sample", 1.0, [0, 0, 0, 0, 2, 0, 0]),
];

/// Names of the units that products consist of.
pub fn unit_names() -> impl Iterator<Item = &'static str> + Clone {
    UNITS.iter().map(|(name, ..)| *name)
}

/// SI value and powers of a unit; the error is the unknown part.
pub(crate) fn parse_unit(text: &str) -> Result<(f64, Powers), String> {
    // Both code points of mu, the superscript and the product signs are replaced by their plain
    // spellings.
    let plain = text.replace(['µ', 'μ'], "u").replace('²', "^2").replace(['·', '⋅'], "*");
    let mut parser = UnitParser { rest: &plain, depth: 0 };
    let unit = parser.product()?;
    if parser.rest.trim().is_empty() { Ok(unit) } else { Err(parser.rest.trim().to_owned()) }
}

struct UnitParser<'a> {
    rest: &'a str,
    depth: u8,
}

impl UnitParser<'_> {
    fn eat(&mut self, token: &str) -> bool {
        let rest = self.rest.trim_start();
        let found = rest.strip_prefix(token);
        self.rest = found.unwrap_or(rest);
        found.is_some()
    }

    fn product(&mut self) -> Result<(f64, Powers), String> {
        let (mut factor, mut powers) = self.power()?;
        loop {
            let sign = if self.eat("/") {
                -1
            } else if self.eat("*") {
                1
            } else {
                return Ok((factor, powers));
            };
            let (f, p) = self.power()?;
            factor = if sign < 0 { factor / f } else { factor * f };
            for (a, b) in powers.iter_mut().zip(p) {
                *a = add(*a, sign, b)?;
            }
        }
    }

    fn power(&mut self) -> Result<(f64, Powers), String> {
        let (base, powers) = self.atom()?;
        if !self.eat("^") {
            return Ok((base, powers));
        }
        let exponent = ["-1", "-2", "1", "2", "3"]
            .into_iter()
            .find(|text| self.eat(text))
            .and_then(|text| text.parse::<i16>().ok())
            .ok_or_else(|| format!("^{}", self.rest))?;
        let mut factor = 1.0;
        for _ in 0..exponent.abs() {
            factor = if exponent < 0 { factor / base } else { factor * base };
        }
        let mut raised = [0; 7];
        for (a, b) in raised.iter_mut().zip(powers) {
            *a = add(0, exponent, b)?;
        }
        Ok((factor, raised))
    }

    fn atom(&mut self) -> Result<(f64, Powers), String> {
        if self.depth > 8 {
            return Err(self.rest.to_owned());
        }
        if self.eat("sqrt(") || self.eat("√(") {
            let inner = self.nested()?;
            return root(inner).ok_or_else(|| "sqrt".to_owned());
        }
        if self.eat("√") {
            self.depth += 1;
            let inner = self.atom()?;
            self.depth -= 1;
            return root(inner).ok_or_else(|| "√".to_owned());
        }
        if self.eat("(") {
            return self.nested();
        }
        let end = self.rest.find(['/', '*', '^', '(', ')', ' ']).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        let unit = UNITS.iter().find(|(known, ..)| *known == name);
        let (_, factor, powers) = unit.ok_or_else(|| name.to_owned())?;
        self.rest = rest;
        Ok((*factor, *powers))
    }

    fn nested(&mut self) -> Result<(f64, Powers), String> {
        self.depth += 1;
        let inner = self.product()?;
        self.depth -= 1;
        if self.eat(")") { Ok(inner) } else { Err(format!("{} without )", self.rest)) }
    }
}

fn add(a: i16, times: i16, b: i16) -> Result<i16, String> {
    times.checked_mul(b).and_then(|x| a.checked_add(x)).ok_or_else(|| "power too large".to_owned())
}

fn root((factor, powers): (f64, Powers)) -> Option<(f64, Powers)> {
    powers.iter().all(|p| p % 2 == 0).then(|| (factor.sqrt(), powers.map(|p| p / 2)))
}
