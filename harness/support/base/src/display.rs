//! Units in which reports and the terminal show errors. Files for machines keep theirs.

use super::names::suggestion;

/// Unit of position errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PositionUnit {
    /// Minutes of arc of latitude and longitude; radial errors in nautical miles.
    #[default]
    ArcMinute,
    /// Nautical miles along the ground.
    NauticalMile,
    /// Metres along the ground.
    Metre,
    /// Kilometres along the ground.
    Kilometre,
}

/// Unit of attitude errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AttitudeUnit {
    /// Minutes of arc.
    #[default]
    ArcMinute,
    /// Degrees.
    Degree,
    /// Seconds of arc.
    ArcSecond,
    /// Milliradians.
    Milliradian,
}

/// Unit of velocity errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VelocityUnit {
    /// Metres per second.
    #[default]
    MetrePerSecond,
    /// Knots.
    Knot,
    /// Centimetres per second.
    CentimetrePerSecond,
}

/// Length of a nautical mile, m.
const NAUTICAL_MILE_M: f64 = 1852.0;

/// Units by their names.
const POSITION: [(&str, PositionUnit); 4] = [
    ("arcmin", PositionUnit::ArcMinute),
    ("nmi", PositionUnit::NauticalMile),
    ("m", PositionUnit::Metre),
    ("km", PositionUnit::Kilometre),
];
const ATTITUDE: [(&str, AttitudeUnit); 4] = [
    ("arcmin", AttitudeUnit::ArcMinute),
    ("deg", AttitudeUnit::Degree),
    ("arcsec", AttitudeUnit::ArcSecond),
    ("mrad", AttitudeUnit::Milliradian),
];
const VELOCITY: [(&str, VelocityUnit); 3] = [
    ("m/s", VelocityUnit::MetrePerSecond),
    ("kn", VelocityUnit::Knot),
    ("cm/s", VelocityUnit::CentimetrePerSecond),
];

/// Units that are chosen; the others stay as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnitChoice {
    /// Unit of position errors.
    pub position: Option<PositionUnit>,
    /// Unit of attitude errors.
    pub attitude: Option<AttitudeUnit>,
    /// Unit of velocity errors.
    pub velocity: Option<VelocityUnit>,
}

/// A list of units that can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DisplayUnitError {
    /// No quantity has the unit.
    #[error("found {found:?}, {}", suggestion(found, names(), "expected some of"))]
    Unknown {
        /// The text.
        found: String,
    },
    /// A quantity has two units.
    #[error("found {found:?}, a second unit of {quantity}: expected one of each quantity")]
    Twice {
        /// The text.
        found: String,
        /// Quantity.
        quantity: &'static str,
    },
}

/// All names, each once.
fn names() -> impl Iterator<Item = &'static str> + Clone {
    let attitude = ATTITUDE.iter().map(|(name, _)| *name).filter(|name| *name != "arcmin");
    let position = POSITION.iter().map(|(name, _)| *name);
    position.chain(attitude).chain(VELOCITY.iter().map(|(name, _)| *name))
}

impl std::str::FromStr for UnitChoice {
    type Err = DisplayUnitError;

    /// Reads a list such as `nmi,deg,kn`. `arcmin` is a unit of position and of attitude: it is that of
    /// each of them for which the list has no other.
    fn from_str(text: &str) -> Result<Self, DisplayUnitError> {
        fn put<T: Copy>(
            slot: &mut Option<T>,
            unit: T,
            found: &str,
            quantity: &'static str,
        ) -> Result<(), DisplayUnitError> {
            match slot.replace(unit) {
                None => Ok(()),
                Some(_) => Err(DisplayUnitError::Twice { found: found.to_owned(), quantity }),
            }
        }
        fn of<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
            table.iter().find(|(other, _)| *other == name).map(|(_, unit)| *unit)
        }
        let (mut choice, mut arcmin) = (Self::default(), false);
        for name in text.split(',').map(str::trim) {
            if name == "arcmin" {
                arcmin = true;
            } else if let Some(unit) = of(&POSITION, name) {
                put(&mut choice.position, unit, name, "position")?;
            } else if let Some(unit) = of(&ATTITUDE, name) {
                put(&mut choice.attitude, unit, name, "attitude")?;
            } else if let Some(unit) = of(&VELOCITY, name) {
                put(&mut choice.velocity, unit, name, "velocity")?;
            } else {
                return Err(DisplayUnitError::Unknown { found: name.to_owned() });
            }
        }
        if arcmin {
            choice.position.get_or_insert(PositionUnit::ArcMinute);
            choice.attitude.get_or_insert(AttitudeUnit::ArcMinute);
        }
        Ok(choice)
    }
}

impl std::fmt::Display for UnitChoice {
    /// Writes the list, as it is read.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut names: Vec<&str> = [
            name_of(&POSITION, self.position),
            name_of(&ATTITUDE, self.attitude),
            name_of(&VELOCITY, self.velocity),
        ]
        .into_iter()
        .flatten()
        .collect();
        // Position and attitude can have the same unit.
        names.dedup();
        f.write_str(&names.join(","))
    }
}

/// Name of a unit that is chosen.
fn name_of<T: Copy + PartialEq>(
    table: &[(&'static str, T)],
    unit: Option<T>,
) -> Option<&'static str> {
    table.iter().find(|(_, other)| Some(*other) == unit).map(|(name, _)| *name)
}

impl PositionUnit {
    /// True for a distance along the ground, whose relation to angles depends on the place.
    #[must_use]
    pub fn is_distance(self) -> bool {
        self != Self::ArcMinute
    }

    /// Name, as in lists of units.
    #[must_use]
    pub fn name(self) -> &'static str {
        name_of(&POSITION, Some(self)).unwrap_or_default()
    }
}

impl UnitChoice {
    /// Settings of a scenario that choose the same, such as `display.position="nmi"`.
    #[must_use]
    pub fn settings(&self) -> Vec<String> {
        [
            ("position", name_of(&POSITION, self.position)),
            ("attitude", name_of(&ATTITUDE, self.attitude)),
            ("velocity", name_of(&VELOCITY, self.velocity)),
        ]
        .into_iter()
        .filter_map(|(key, name)| Some(format!("display.{key}=\"{}\"", name?)))
        .collect()
    }
}

/// Units of errors, with the place that turns angles into distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayUnits {
    /// Unit of position errors.
    pub position: PositionUnit,
    /// Unit of attitude errors.
    pub attitude: AttitudeUnit,
    /// Unit of velocity errors.
    pub velocity: VelocityUnit,
    /// Length of a minute of arc of latitude and of longitude, m.
    pub arcmin_m: [f64; 2],
}

impl Default for DisplayUnits {
    /// Minutes of arc and metres per second; the lengths are those of a nautical mile.
    fn default() -> Self {
        Self {
            position: PositionUnit::default(),
            attitude: AttitudeUnit::default(),
            velocity: VelocityUnit::default(),
            arcmin_m: [NAUTICAL_MILE_M; 2],
        }
    }
}

/// Unit in which one error is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownUnit {
    /// Number of these units in the unit of the score.
    pub factor: f64,
    /// Name.
    pub name: &'static str,
    /// Digits behind the point that show the score's thousandth.
    pub decimals: usize,
}

impl ShownUnit {
    const fn new(factor: f64, name: &'static str, decimals: usize) -> Self {
        Self { factor, name, decimals }
    }

    /// Converts a value from the unit of its score.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        value * self.factor
    }
}

impl DisplayUnits {
    /// Replaces the units that are chosen.
    #[must_use]
    pub fn with(self, choice: UnitChoice) -> Self {
        Self {
            position: choice.position.unwrap_or(self.position),
            attitude: choice.attitude.unwrap_or(self.attitude),
            velocity: choice.velocity.unwrap_or(self.velocity),
            ..self
        }
    }

    fn position(&self, arcmin_m: f64) -> ShownUnit {
        match self.position {
            PositionUnit::ArcMinute => ShownUnit::new(1.0, "arcmin", 3),
            PositionUnit::NauticalMile => ShownUnit::new(arcmin_m / NAUTICAL_MILE_M, "nmi", 3),
            PositionUnit::Metre => ShownUnit::new(arcmin_m, "m", 1),
            PositionUnit::Kilometre => ShownUnit::new(arcmin_m / 1000.0, "km", 3),
        }
    }

    /// Unit of latitude errors, from arcmin.
    #[must_use]
    pub fn latitude(&self) -> ShownUnit {
        self.position(self.arcmin_m[0])
    }

    /// Unit of longitude errors, from arcmin.
    #[must_use]
    pub fn longitude(&self) -> ShownUnit {
        self.position(self.arcmin_m[1])
    }

    /// Unit of radial errors, from nmi.
    #[must_use]
    pub fn radial(&self) -> ShownUnit {
        match self.position {
            PositionUnit::ArcMinute | PositionUnit::NauticalMile => ShownUnit::new(1.0, "nmi", 3),
            PositionUnit::Metre => ShownUnit::new(NAUTICAL_MILE_M, "m", 1),
            PositionUnit::Kilometre => ShownUnit::new(NAUTICAL_MILE_M / 1000.0, "km", 3),
        }
    }

    /// Unit of attitude errors, from arcmin.
    #[must_use]
    pub fn attitude(&self) -> ShownUnit {
        match self.attitude {
            AttitudeUnit::ArcMinute => ShownUnit::new(1.0, "arcmin", 3),
            AttitudeUnit::Degree => ShownUnit::new(1.0 / 60.0, "deg", 5),
            AttitudeUnit::ArcSecond => ShownUnit::new(60.0, "arcsec", 1),
            AttitudeUnit::Milliradian => {
                ShownUnit::new(1000.0 * std::f64::consts::PI / 10_800.0, "mrad", 4)
            }
        }
    }

    /// Unit of velocity errors, from m/s.
    #[must_use]
    pub fn velocity(&self) -> ShownUnit {
        match self.velocity {
            VelocityUnit::MetrePerSecond => ShownUnit::new(1.0, "m/s", 3),
            VelocityUnit::Knot => ShownUnit::new(3600.0 / NAUTICAL_MILE_M, "kn", 3),
            VelocityUnit::CentimetrePerSecond => ShownUnit::new(100.0, "cm/s", 1),
        }
    }

    /// Unit of an error by its name: latitude, longitude, radial, heading, pitch, roll, north, east.
    #[must_use]
    pub fn of(&self, name: &str) -> ShownUnit {
        match name {
            "latitude" => self.latitude(),
            "longitude" => self.longitude(),
            "radial" => self.radial(),
            "heading" | "pitch" | "roll" => self.attitude(),
            _ => self.velocity(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_units_are_read() {
        let read = |text: &str| text.parse::<UnitChoice>();
        let choice = read("nmi, deg,kn").unwrap();
        assert_eq!(choice.position, Some(PositionUnit::NauticalMile));
        assert_eq!(choice.attitude, Some(AttitudeUnit::Degree));
        assert_eq!(choice.velocity, Some(VelocityUnit::Knot));
        assert_eq!(
            choice.settings(),
            ["display.position=\"nmi\"", "display.attitude=\"deg\"", "display.velocity=\"kn\""]
        );
        let choice = read("arcmin,m").unwrap();
        assert_eq!(choice.position, Some(PositionUnit::Metre));
        assert_eq!(choice.attitude, Some(AttitudeUnit::ArcMinute));
        assert_eq!(choice.velocity, None);
        for text in ["nmi,deg,kn", "km", "m,arcmin", "arcmin", "mrad,m/s"] {
            let choice = read(text).unwrap();
            assert_eq!(choice.to_string(), text);
            assert_eq!(read(&choice.to_string()), Ok(choice));
        }
        let error = read("nmi,degrees").unwrap_err().to_string();
        assert!(error.contains("\"degrees\"") && error.contains("deg"), "{error}");
        let error = read("nmi,km").unwrap_err().to_string();
        assert!(error.contains("a second unit of position"), "{error}");
        assert!(read("").is_err());
    }

    #[test]
    fn units_convert_as_defined() {
        let near = |found: f64, expected: f64| {
            assert!((found / expected - 1.0).abs() < 1e-12, "found {found}, expected {expected}");
        };
        let units = |text: &str| {
            let choice = text.parse().unwrap();
            DisplayUnits { arcmin_m: [1847.0, 1600.0], ..DisplayUnits::default() }.with(choice)
        };
        near(units("m").latitude().of(2.0), 3694.0);
        near(units("nmi").longitude().of(1.852), 1.6);
        near(units("km").radial().of(2.0), 3.704);
        near(units("nmi").radial().of(2.0), 2.0);
        near(units("deg").attitude().of(90.0), 1.5);
        near(units("arcsec").attitude().of(0.5), 30.0);
        // A radian has 3437.746770784939 minutes of arc.
        near(units("mrad").attitude().of(3.437_746_770_784_939), 1.0);
        near(units("kn").velocity().of(1852.0 / 3600.0), 1.0);
        near(units("cm/s").of("east").of(0.25), 25.0);
        near(DisplayUnits::default().of("roll").of(7.0), 7.0);
    }
}
