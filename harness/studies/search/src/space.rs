//! The space of a search: kinds of faults, and the values that each of their keys can have.

use octant_base::number::plain;
use octant_faults::catalogue::FaultKind;

/// Faults among which a search looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// Forms of faults; never empty.
    pub forms: Vec<Form>,
}

/// A form of fault: a kind, and the values of its keys.
#[derive(Clone, Debug)]
pub struct Form {
    /// The kind.
    pub kind: &'static FaultKind,
    /// Its keys, in the order in which they are written.
    pub keys: Vec<FormKey>,
}

impl PartialEq for Form {
    fn eq(&self, other: &Self) -> bool {
        self.kind.name == other.kind.name && self.keys == other.keys
    }
}

/// A key of a form.
#[derive(Clone, Debug, PartialEq)]
pub struct FormKey {
    /// Name, as in a scenario; [`ONSET`] stands for a trigger at a time.
    pub name: String,
    /// Its values.
    pub values: KeyValues,
}

/// Key of a form that is written as a trigger at a time of the run.
pub const ONSET: &str = "onset";

/// Values of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyValues {
    /// One value, as TOML.
    Fixed(String),
    /// One of these, as TOML; never empty.
    OneOf(Vec<String>),
    /// A number between two others.
    Between(NumberRange),
    /// A vector, times a number between two others.
    Multiple(ScaledVector),
}

impl KeyValues {
    /// Range of the number that is chosen.
    #[must_use]
    pub fn range(&self) -> Option<&NumberRange> {
        match self {
            Self::Between(range) => Some(range),
            Self::Multiple(vector) => Some(&vector.factor),
            Self::Fixed(_) | Self::OneOf(_) => None,
        }
    }

    /// The same, to change it.
    pub(crate) fn range_mut(&mut self) -> Option<&mut NumberRange> {
        match self {
            Self::Between(range) => Some(range),
            Self::Multiple(vector) => Some(&mut vector.factor),
            Self::Fixed(_) | Self::OneOf(_) => None,
        }
    }
}

/// A vector that is multiplied by a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaledVector {
    /// Numbers and units of its components; a unit may be empty.
    pub components: Vec<(f64, String)>,
    /// The factor; its digits are those of the components.
    pub factor: NumberRange,
}

impl ScaledVector {
    fn text(&self, place: f64) -> String {
        let factor = self.factor.at(place);
        let one = |(number, unit): &(f64, String)| {
            quantity(rounded(factor * number, self.factor.digits), unit)
        };
        format!("[{}]", self.components.iter().map(one).collect::<Vec<_>>().join(", "))
    }
}

/// A number with few digits.
fn rounded(number: f64, digits: i32) -> f64 {
    plain(number, digits).parse().unwrap_or(number)
}

/// A number and its unit as TOML.
fn quantity(number: f64, unit: &str) -> String {
    if unit.is_empty() { format!("{number:?}") } else { format!("\"{number} {unit}\"") }
}

/// A range of numbers, with the unit in which they are written.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberRange {
    /// Smallest value, in `unit`.
    pub from: f64,
    /// Largest value, in `unit`.
    pub to: f64,
    /// Unit; empty for a plain number.
    pub unit: String,
    /// True if equal steps are equal ratios. Both ends are above zero.
    pub is_logarithmic: bool,
    /// True for whole numbers.
    pub is_whole: bool,
    /// Significant digits with which a value is written.
    pub digits: i32,
}

impl NumberRange {
    /// Value at a place of the range, from 0 to 1.
    #[must_use]
    pub fn at(&self, place: f64) -> f64 {
        let place = place.clamp(0.0, 1.0);
        if self.is_logarithmic {
            self.from * (place * (self.to / self.from).ln()).exp()
        } else {
            self.from + place * (self.to - self.from)
        }
    }

    /// Distance between two places whose values have this ratio; `None` on a linear scale.
    #[must_use]
    pub fn distance_of(&self, ratio: f64) -> Option<f64> {
        (self.is_logarithmic && self.to > self.from)
            .then(|| ratio.ln() / (self.to / self.from).ln())
    }

    /// A value as TOML, rounded to the digits of the range and kept within it.
    fn text(&self, place: f64) -> String {
        let value = self.at(place);
        if self.is_whole {
            let whole = value.round().clamp(self.from, self.to);
            let unit = &self.unit;
            return if unit.is_empty() { whole.to_string() } else { format!("\"{whole} {unit}\"") };
        }
        quantity(rounded(value, self.digits).clamp(self.from, self.to), &self.unit)
    }
}

impl FormKey {
    /// Writes the key with the value at a place of its values, from 0 to 1.
    #[must_use]
    pub fn line(&self, place: f64) -> String {
        let value = match &self.values {
            KeyValues::Fixed(text) => text.clone(),
            KeyValues::OneOf(texts) => texts[index(place, texts.len())].clone(),
            KeyValues::Between(range) => range.text(place),
            KeyValues::Multiple(vector) => vector.text(place),
        };
        if self.name == ONSET {
            format!("trigger = {{ at = {value} }}")
        } else {
            format!("{} = {value}", self.name)
        }
    }

    /// Number of values among which a search has to choose one by one; 1 for a range.
    #[must_use]
    pub fn choices(&self) -> usize {
        match &self.values {
            KeyValues::OneOf(texts) => texts.len(),
            _ => 1,
        }
    }
}

/// Index among `count` values at a place from 0 to 1.
fn index(place: f64, count: usize) -> usize {
    ((place * count as f64) as usize).min(count - 1)
}

impl Form {
    /// Index of the key that makes the fault larger or smaller: the first range on a logarithmic scale other
    /// than a time, else the duration.
    #[must_use]
    pub fn size(&self) -> Option<usize> {
        let is_scaled =
            |key: &FormKey| key.values.range().is_some_and(|range| range.is_logarithmic);
        let is_size = |key: &&FormKey| is_scaled(key) && !is_time(&key.name);
        let named = |key: &FormKey| key.name == "duration" && is_scaled(key);
        let sized = self.keys.iter().find(is_size).map(|key| &key.name);
        match sized {
            Some(name) => self.keys.iter().position(|key| key.name == *name),
            None => self.keys.iter().position(named),
        }
    }
}

/// True for keys that say when and how long, and not how much.
fn is_time(name: &str) -> bool {
    matches!(name, ONSET | "duration" | "recovery" | "rise" | "correlation_time" | "period")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(from: f64, to: f64, is_logarithmic: bool) -> NumberRange {
        let unit = "deg/h".to_owned();
        NumberRange { from, to, unit, is_logarithmic, is_whole: false, digits: 3 }
    }

    #[test]
    fn a_value_is_written_within_its_range_with_few_digits() {
        let key =
            |range| FormKey { name: "amplitude".to_owned(), values: KeyValues::Between(range) };
        let logarithmic = key(range(0.001, 1000.0, true));
        assert_eq!(logarithmic.line(0.0), "amplitude = \"0.001 deg/h\"");
        assert_eq!(logarithmic.line(0.5), "amplitude = \"1 deg/h\"");
        assert_eq!(logarithmic.line(1.0), "amplitude = \"1000 deg/h\"");
        assert_eq!(logarithmic.line(0.123_456), "amplitude = \"0.0055 deg/h\"");
        assert_eq!(key(range(-1.0, 2.0, false)).line(0.5), "amplitude = \"0.5 deg/h\"");
    }

    #[test]
    fn places_of_one_ratio_are_equally_far_apart() {
        let range = range(0.01, 100.0, true);
        let step = range.distance_of(10.0).unwrap();
        assert!((range.at(0.3 + step) / range.at(0.3) - 10.0).abs() < 1e-9);
        assert!((step - 0.25).abs() < 1e-12);
    }

    #[test]
    fn every_choice_has_an_equal_share() {
        let values = KeyValues::OneOf((0..3).map(|i| i.to_string()).collect());
        let key = FormKey { name: "bit".to_owned(), values };
        let counts = (0..300).fold([0; 3], |mut counts, i| {
            let line = key.line(f64::from(i) / 300.0);
            counts[line.trim_start_matches("bit = ").parse::<usize>().unwrap()] += 1;
            counts
        });
        assert_eq!(counts, [100, 100, 100]);
        assert_eq!(key.line(1.0), "bit = 2");
    }
}
