//! Converts a value on a wire: units, transformations, and the type at its end.

mod carried;

use super::flat::{Hop, HopEntry};
use super::ssp::parameters::{SystemEnumeration, Transformation};
use super::values::{has, is_float, is_numeric, kind_name, rounded, told};
use carried::{CarriedNumber, Step};
use octant_fmu_host::description::units::{UnitConversion, candidates, dimension, known, meant};
use octant_fmu_host::description::{BaseUnit, Description, Variable, VariableType};
use octant_fmu_host::instance::whole;

/// Operations on a value on its way to a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct WireConversion {
    /// Type at the beginning.
    from: VariableType,
    steps: Vec<Step>,
    /// Type at the end.
    kind: VariableType,
    /// Values of an enumeration at the end, where the description names them.
    items: Vec<i64>,
    /// True if every value of the source fits.
    total: bool,
}

/// Unit: its name, and its possible meanings; empty if the unit is unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct WireUnit {
    /// Name.
    pub name: String,
    /// Possible meanings in SI.
    pub bases: Vec<BaseUnit>,
}

/// Reason why a wire can't carry values from one variable to another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WireConversionError {
    /// A unit isn't known.
    #[error(
        "the unit {found:?} is neither defined nor a known one, and is to be converted with {other:?}"
    )]
    UnknownUnit {
        /// Unit found.
        found: String,
        /// Unit at the other end.
        other: String,
    },
    /// The units measure different things.
    #[error("the unit {from:?} ({from_dimension}) can't become {to:?} ({to_dimension})")]
    Units {
        /// Unit of the output.
        from: String,
        /// Its dimension.
        from_dimension: String,
        /// Unit of the input.
        to: String,
        /// Its dimension.
        to_dimension: String,
    },
    /// Whole numbers have different units.
    #[error(
        "{from_kind} and {to_kind} have the units {from:?} and {to:?}, and whole numbers are not \
         converted"
    )]
    WholeNumbers {
        /// Type of the output.
        from_kind: &'static str,
        /// Type of the input.
        to_kind: &'static str,
        /// Unit of the output.
        from: String,
        /// Unit of the input.
        to: String,
    },
    /// A transformation is for values of another type.
    #[error("a {transformation} is for {expected}, and the value is a {found}")]
    Transformation {
        /// Name of the transformation.
        transformation: &'static str,
        /// Type found.
        found: &'static str,
        /// Types that it is for.
        expected: &'static str,
    },
    /// A transformation names an item that the enumeration doesn't have.
    #[error("the enumeration has no item {found:?}")]
    Item {
        /// Name found.
        found: String,
    },
    /// The types don't fit.
    #[error("a {from} can't become a {to}")]
    Types {
        /// Type of the output.
        from: &'static str,
        /// Type of the input.
        to: &'static str,
    },
    /// The enumerations differ.
    #[error(
        "the enumerations are not the same: the input has no item {item:?} with value {value}; an \
         EnumerationMappingTransformation can say what becomes what"
    )]
    Enumerations {
        /// Item of the output.
        item: String,
        /// Its value.
        value: i64,
    },
    /// Values can't get into an entry of a signal dictionary, or out of it.
    #[error("{direction} {entry}: {reason}")]
    Entry {
        /// `into`, or `out of`.
        direction: &'static str,
        /// The entry.
        entry: Box<HopEntry>,
        /// Why not.
        reason: Box<Self>,
    },
}

impl WireUnit {
    /// Returns the unit of a variable.
    #[must_use]
    pub fn of_variable(description: &Description, variable: &Variable) -> Option<Self> {
        let name = variable.unit.as_ref()?;
        let mut bases = candidates(description, name);
        if variable.relative_quantity {
            bases.iter_mut().for_each(|base| base.offset = 0.0);
        }
        Some(Self { name: name.clone(), bases })
    }

    /// Returns a unit by its name in a file that may define it.
    #[must_use]
    pub fn named(name: &str, defined: &[(String, BaseUnit)]) -> Self {
        let found = defined.iter().find(|(known, _)| known == name).map(|(_, base)| base);
        let known = known(name);
        let bases = found.map_or(known.clone(), |base| vec![meant(base, &known)]);
        Self { name: name.to_owned(), bases }
    }

    /// Returns the conversion of values in this unit into another.
    ///
    /// # Errors
    /// If a unit isn't known, or they measure different things.
    pub fn to(&self, other: &Self) -> Result<UnitConversion, WireConversionError> {
        if self.name == other.name {
            return Ok(UnitConversion::IDENTITY);
        }
        for (unit, wanted) in [(self, other), (other, self)] {
            if unit.bases.is_empty() {
                return Err(WireConversionError::UnknownUnit {
                    found: unit.name.clone(),
                    other: wanted.name.clone(),
                });
            }
        }
        for from in &self.bases {
            for to in &other.bases {
                if from.exponents == to.exponents {
                    return Ok(UnitConversion::ratio(from, to));
                }
            }
        }
        Err(WireConversionError::Units {
            from: self.name.clone(),
            from_dimension: dimension(self.bases[0].exponents),
            to: other.name.clone(),
            to_dimension: dimension(other.bases[0].exponents),
        })
    }
}

/// End of a wire: the properties of a variable that conversions need.
#[derive(Clone, Debug)]
pub struct Terminal<'a> {
    /// Type.
    pub kind: VariableType,
    /// Unit, if there is one.
    pub unit: Option<WireUnit>,
    /// Values and names of the variable's enumeration.
    pub items: &'a [(i64, String)],
    /// Enumeration of the structure that the connector names.
    pub enumeration: Option<&'a SystemEnumeration>,
}

impl Terminal<'_> {
    /// Returns the value of an item.
    fn item(&self, name: &str) -> Option<i64> {
        let own = self.items.iter().find(|(_, item)| item == name).map(|(value, _)| *value);
        let named = || {
            let items = &self.enumeration?.items;
            items.iter().find(|(item, _)| item == name).map(|(_, value)| *value)
        };
        own.or_else(named)
    }
}

impl WireConversion {
    /// Builds the conversion of a wire from one variable to another by way of some connections.
    ///
    /// # Errors
    /// If units, transformations or types don't fit.
    pub fn of(
        from: &Terminal<'_>,
        to: &Terminal<'_>,
        hops: &[Hop],
        units: &[(String, BaseUnit)],
    ) -> Result<Self, WireConversionError> {
        let mut steps = Vec::new();
        let first = from.kind;
        let mut from = from.clone();
        let mut last: Option<&HopEntry> = None;
        let mut rest = hops;
        // A value has the type of each entry on its way, one after the other.
        while let Some((at, entry)) =
            rest.iter().enumerate().find_map(|(at, hop)| Some((at, hop.entry.as_ref()?)))
        {
            let (leg, after) = rest.split_at(at + 1);
            let into = Terminal {
                kind: entry.kind,
                unit: leg[at].meant(units),
                items: &entry.items,
                enumeration: None,
            };
            let (more, unit, _) = self::leg(&from, &into, leg, units).map_err(|reason| {
                WireConversionError::Entry {
                    direction: "into",
                    entry: Box::new(entry.clone()),
                    reason: Box::new(reason),
                }
            })?;
            steps.extend(more);
            steps.push(Step::Entry(entry.clone()));
            (from, last, rest) = (Terminal { unit, ..into }, Some(entry), after);
        }
        let (more, _, total) = self::leg(&from, to, rest, units).map_err(|reason| match last {
            Some(entry) => WireConversionError::Entry {
                direction: "out of",
                entry: Box::new(entry.clone()),
                reason: Box::new(reason),
            },
            None => reason,
        })?;
        steps.extend(more);
        let items = match to.kind {
            VariableType::Enumeration => to.items.iter().map(|(value, _)| *value).collect(),
            _ => Vec::new(),
        };
        Ok(Self { from: first, steps, kind: to.kind, items, total })
    }

    /// Type at the end.
    #[must_use]
    pub const fn kind(&self) -> VariableType {
        self.kind
    }

    /// Returns why a value, as it is exchanged, can't be carried: the first entry of a dictionary that
    /// doesn't have it, else the type at the end.
    #[must_use]
    pub fn misfit(&self, value: f64) -> String {
        for (count, step) in self.steps.iter().enumerate() {
            let Step::Entry(entry) = step else { continue };
            if self.steps[..=count].iter().try_fold(self.begin(value), Step::apply).is_none() {
                return format!("{entry} is a {} and has no such value", kind_name(entry.kind));
            }
        }
        format!("the input is a {} and has no such value", kind_name(self.kind))
    }

    /// Returns a value at the beginning, as it is exchanged, in words.
    #[must_use]
    pub fn told(&self, value: f64) -> String {
        told(self.from, value)
    }

    fn begin(&self, value: f64) -> CarriedNumber {
        if whole::is_wide(self.from) {
            return CarriedNumber::Whole(whole::from_bits(self.from, value));
        }
        CarriedNumber::Real(value)
    }

    /// Returns a value as it is at the end of its way, whole numbers of 64 bits at both ends as their
    /// bits; `None`: the type there has no such value, or a mapping has no entry for it.
    #[inline]
    #[must_use]
    pub fn carry(&self, value: f64) -> Option<f64> {
        if self.total && self.steps.is_empty() && self.from == self.kind {
            return Some(value);
        }
        let value = self.convert(self.begin(value))?;
        match value {
            CarriedNumber::Whole(whole) => whole::to_bits(self.kind, whole),
            CarriedNumber::Real(number) => Some(number),
        }
    }

    /// Returns a number as it is at the end of its way; `None`: the type there has no such value, or a
    /// mapping has no entry for it.
    #[must_use]
    pub fn apply(&self, value: f64) -> Option<f64> {
        let value = match whole::is_wide(self.from) {
            true => CarriedNumber::Whole(whole::of(value)?),
            false => CarriedNumber::Real(value),
        };
        self.convert(value)?.real()
    }

    /// Converts a value: wide types end as whole numbers, all others as real ones.
    fn convert(&self, value: CarriedNumber) -> Option<CarriedNumber> {
        let value = self.steps.iter().try_fold(value, Step::apply)?;
        if is_float(self.kind) {
            return Some(CarriedNumber::Real(rounded(value.real()?, self.kind)));
        }
        let whole = value.whole()?;
        let item = || i64::try_from(whole).is_ok_and(|whole| self.items.contains(&whole));
        let known = self.items.is_empty() || item();
        if !(self.total || known && has(self.kind, whole)) {
            return None;
        }
        Some(match whole::is_wide(self.kind) {
            true => CarriedNumber::Whole(whole),
            false => CarriedNumber::Real(whole as f64),
        })
    }
}

impl Hop {
    /// Returns the unit at the end of the connection.
    fn meant(&self, units: &[(String, BaseUnit)]) -> Option<WireUnit> {
        let name = self.unit.as_ref()?;
        match &self.entry {
            // Units of a dictionary are those of its file.
            Some(entry) => {
                let own = entry.meaning.map(|base| (name.clone(), base));
                Some(WireUnit::named(name, own.as_slice()))
            }
            None => Some(WireUnit::named(name, units)),
        }
    }
}

/// Returns the operations on a value between two types, the unit that it has after them, and
/// whether every value fits.
fn leg(
    from: &Terminal<'_>,
    to: &Terminal<'_>,
    hops: &[Hop],
    units: &[(String, BaseUnit)],
) -> Result<(Vec<Step>, Option<WireUnit>, bool), WireConversionError> {
    let mut steps = Vec::new();
    let mut unit = from.unit.clone();
    let mut mapped = false;
    for (index, hop) in hops.iter().enumerate() {
        let end = if index + 1 == hops.len() { to.unit.clone() } else { hop.meant(units) };
        if hop.suppress_unit_conversion {
            // Without unit conversion the value is taken to be in the unit of this end, whatever
            // it was.
            unit = end;
        } else {
            if let (Some(unit), Some(end)) = (&unit, &end) {
                let conversion = unit.to(end)?;
                if !conversion.is_identity() {
                    if !is_float(from.kind) && !is_float(to.kind) {
                        return Err(WireConversionError::WholeNumbers {
                            from_kind: kind_name(from.kind),
                            to_kind: kind_name(to.kind),
                            from: unit.name.clone(),
                            to: end.name.clone(),
                        });
                    }
                    steps.push(Step::Linear(conversion.factor, conversion.offset));
                }
            }
            unit = end.or(unit);
        }
        if let Some(transformation) = &hop.transformation {
            mapped |= !matches!(transformation, Transformation::Linear { .. });
            if let Some(step) = step(transformation, from, to)? {
                steps.push(step);
            }
        }
    }
    let total = check_types(from, to, mapped, !steps.is_empty())?;
    Ok((steps, unit, total))
}

/// Converts a transformation into a step; `None` if it does nothing.
fn step(
    transformation: &Transformation,
    from: &Terminal<'_>,
    to: &Terminal<'_>,
) -> Result<Option<Step>, WireConversionError> {
    let whole = is_numeric(from.kind) && !is_float(from.kind);
    let wrong = |expected| {
        Err(WireConversionError::Transformation {
            transformation: transformation.name(),
            found: kind_name(from.kind),
            expected,
        })
    };
    Ok(match transformation {
        Transformation::Linear { factor, offset } => {
            if matches!(from.kind, VariableType::Boolean | VariableType::Enumeration)
                || !is_numeric(from.kind)
            {
                return wrong("numbers");
            }
            (*factor != 1.0 || *offset != 0.0).then_some(Step::Linear(*factor, *offset))
        }
        Transformation::Boolean(table) => {
            if from.kind != VariableType::Boolean {
                return wrong("Booleans");
            }
            let number = |value: bool| i128::from(value);
            let entry = |source: bool| {
                table[usize::from(source)].map(|target| (number(source), number(target)))
            };
            Some(Step::Map([false, true].into_iter().filter_map(entry).collect()))
        }
        Transformation::Integer(table) => {
            if !whole || from.kind == VariableType::Boolean {
                return wrong("whole numbers and enumerations");
            }
            let entry = |(source, target): &(i64, i64)| ((*source).into(), (*target).into());
            Some(Step::Map(table.iter().map(entry).collect()))
        }
        Transformation::Enumeration(table) => {
            if from.kind != VariableType::Enumeration || to.kind != VariableType::Enumeration {
                return wrong("enumerations at both ends");
            }
            let entry = |(source, target): &(String, String)| {
                let unknown = |name: &str| WireConversionError::Item { found: name.to_owned() };
                let source = from.item(source).ok_or_else(|| unknown(source))?;
                let target = to.item(target).ok_or_else(|| unknown(target))?;
                Ok((i128::from(source), i128::from(target)))
            };
            Some(Step::Map(table.iter().map(entry).collect::<Result<_, WireConversionError>>()?))
        }
    })
}

/// Checks whether one type can become another at all; true if every value of it can.
fn check_types(
    from: &Terminal<'_>,
    to: &Terminal<'_>,
    mapped: bool,
    altered: bool,
) -> Result<bool, WireConversionError> {
    let (source, target) = (from.kind, to.kind);
    let refused =
        || Err(WireConversionError::Types { from: kind_name(source), to: kind_name(target) });
    if !is_numeric(source) || !is_numeric(target) {
        // Texts and bytes go only to their own type, unchanged.
        return if source == target && source != VariableType::Clock && !altered {
            Ok(true)
        } else {
            refused()
        };
    }
    match (source, target) {
        (_, VariableType::Float64 | VariableType::Float32) => Ok(true),
        (VariableType::Boolean, VariableType::Enumeration)
        | (VariableType::Enumeration, VariableType::Boolean)
            if !mapped =>
        {
            refused()
        }
        (VariableType::Enumeration, VariableType::Enumeration) if !mapped => {
            for (value, name) in from.items {
                if to.item(name) != Some(*value) {
                    return Err(WireConversionError::Enumerations {
                        item: name.clone(),
                        value: *value,
                    });
                }
            }
            Ok(!from.items.is_empty())
        }
        _ => Ok(source == target && !altered),
    }
}
