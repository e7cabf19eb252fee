//! Converts a value on a wire: units, transformations, and the type at its end.

use super::flat::Hop;
use super::ssp::parameters::{SystemEnumeration, Transformation};
use super::values::{fits, is_float, is_numeric, kind_name, rounded};
use octant_fmu_host::description::units::{UnitConversion, candidates, dimension, known, meant};
use octant_fmu_host::description::{BaseUnit, Description, Variable, VariableType};

/// One operation on a value.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    /// factor · value + offset.
    Linear(f64, f64),
    /// Table from value to value.
    Map(Vec<(f64, f64)>),
}

/// Operations on a value on its way to a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct WireConversion {
    steps: Vec<Step>,
    /// Type at the end.
    kind: VariableType,
    /// Values of an enumeration at the end, where the description names them.
    items: Vec<f64>,
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
    fn item(&self, name: &str) -> Option<f64> {
        let own = self.items.iter().find(|(_, item)| item == name).map(|(value, _)| *value);
        let named = || {
            let items = &self.enumeration?.items;
            items.iter().find(|(item, _)| item == name).map(|(_, value)| *value)
        };
        own.or_else(named).map(|value| value as f64)
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
        let mut unit = from.unit.clone();
        let mut mapped = false;
        for (index, hop) in hops.iter().enumerate() {
            let end = if index + 1 == hops.len() {
                to.unit.clone()
            } else {
                hop.unit.as_ref().map(|name| WireUnit::named(name, units))
            };
            if hop.suppress_unit_conversion {
                // Without unit conversion the value is taken to be in the unit of this end,
                // whatever it was.
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
        let items = match to.kind {
            VariableType::Enumeration => to.items.iter().map(|(value, _)| *value as f64).collect(),
            _ => Vec::new(),
        };
        Ok(Self { steps, kind: to.kind, items, total })
    }

    /// Type at the end.
    #[must_use]
    pub const fn kind(&self) -> VariableType {
        self.kind
    }

    /// Returns a value as it is at the end of its way; `None`: the type there has no such value, or
    /// a mapping has no entry for it.
    #[inline]
    #[must_use]
    pub fn apply(&self, value: f64) -> Option<f64> {
        let mut value = value;
        for step in &self.steps {
            value = match step {
                // Adding 0 would turn −0 into 0.
                Step::Linear(factor, 0.0) => factor * value,
                Step::Linear(factor, offset) => factor * value + offset,
                Step::Map(entries) => {
                    entries.iter().find(|(source, _)| *source == value).map(|(_, to)| *to)?
                }
            };
        }
        if self.total || is_float(self.kind) {
            return Some(rounded(value, self.kind));
        }
        let known = self.items.is_empty() || self.items.contains(&value);
        (known && fits(value, self.kind)).then_some(value)
    }
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
            let number = |value: bool| f64::from(u8::from(value));
            let entry = |source: bool| {
                table[usize::from(source)].map(|target| (number(source), number(target)))
            };
            Some(Step::Map([false, true].into_iter().filter_map(entry).collect()))
        }
        Transformation::Integer(table) => {
            if !whole || from.kind == VariableType::Boolean {
                return wrong("whole numbers and enumerations");
            }
            let entry = |(source, target): &(i64, i64)| (*source as f64, *target as f64);
            Some(Step::Map(table.iter().map(entry).collect()))
        }
        Transformation::Enumeration(table) => {
            if from.kind != VariableType::Enumeration || to.kind != VariableType::Enumeration {
                return wrong("enumerations at both ends");
            }
            let entry = |(source, target): &(String, String)| {
                let unknown = |name: &str| WireConversionError::Item { found: name.to_owned() };
                let source = from.item(source).ok_or_else(|| unknown(source))?;
                Ok((source, to.item(target).ok_or_else(|| unknown(target))?))
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
                if to.item(name) != Some(*value as f64) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn terminal(kind: VariableType, unit: Option<&str>) -> Terminal<'static> {
        let unit = unit.map(|name| WireUnit::named(name, &[]));
        Terminal { kind, unit, items: &[], enumeration: None }
    }

    fn convert(
        from: VariableType,
        to: VariableType,
        hops: &[Hop],
    ) -> Result<WireConversion, WireConversionError> {
        WireConversion::of(&terminal(from, None), &terminal(to, None), hops, &[])
    }

    fn hop(transformation: Transformation) -> Hop {
        Hop { transformation: Some(transformation), ..Hop::default() }
    }

    #[test]
    fn units_are_converted_before_the_transformation() {
        let (from, to) = (VariableType::Float64, VariableType::Float64);
        let linear = Transformation::Linear { factor: 2.0, offset: 1.0 };
        let ends = (terminal(from, Some("km")), terminal(to, Some("m")));
        let both = WireConversion::of(&ends.0, &ends.1, &[hop(linear.clone())], &[]).unwrap();
        assert_eq!(both.apply(3.0), Some(2.0 * 3000.0 + 1.0));
        let mut instead = hop(linear);
        instead.suppress_unit_conversion = true;
        let instead = WireConversion::of(&ends.0, &ends.1, &[instead], &[]).unwrap();
        assert_eq!(instead.apply(3.0), Some(7.0));
        // Through a connector of a system.
        let through = [Hop { unit: Some("cm".into()), ..Hop::default() }, Hop::default()];
        let through = WireConversion::of(&ends.0, &ends.1, &through, &[]).unwrap();
        assert!((through.apply(3.0).unwrap() - 3000.0).abs() < 1e-9);
        let celsius = (terminal(from, Some("degC")), terminal(to, Some("K")));
        let warm = WireConversion::of(&celsius.0, &celsius.1, &[Hop::default()], &[]).unwrap();
        assert_eq!(warm.apply(20.0), Some(293.15));
        let same = WireConversion::of(&ends.0, &ends.0, &[Hop::default()], &[]).unwrap();
        assert_eq!(same.apply(-0.0).unwrap().to_bits(), (-0.0f64).to_bits());
        for (a, b, expected) in [
            ("deg", "m", "can't become"),
            ("m", "furlong", "\"furlong\" is neither defined nor a known one"),
        ] {
            let ends = (terminal(from, Some(a)), terminal(to, Some(b)));
            let error = WireConversion::of(&ends.0, &ends.1, &[Hop::default()], &[]).unwrap_err();
            let error = error.to_string();
            assert!(error.contains(expected), "{error}");
            let suppressed = Hop { suppress_unit_conversion: true, ..Hop::default() };
            let kept = WireConversion::of(&ends.0, &ends.1, &[suppressed], &[]).unwrap();
            assert_eq!(kept.apply(5.5), Some(5.5));
        }
    }

    #[test]
    fn types_become_others_where_nothing_is_lost() {
        use VariableType::*;
        let via = |from, to, value| convert(from, to, &[Hop::default()]).unwrap().apply(value);
        assert_eq!(via(Int32, Float64, -3.0), Some(-3.0));
        assert_eq!(via(Boolean, Float64, 1.0), Some(1.0));
        assert_eq!(via(Float64, UInt64, 4.0), Some(4.0));
        assert_eq!(via(Float64, UInt64, 4.5), None);
        assert_eq!(via(Float64, Int32, 3e9), None);
        assert_eq!(via(Float64, Int32, f64::NAN), None);
        assert_eq!(via(Int32, UInt8, 255.0), Some(255.0));
        assert_eq!(via(Int32, UInt8, 256.0), None);
        assert_eq!(via(Int32, Boolean, 2.0), None);
        assert_eq!(via(Float64, Float32, 0.1), Some(f64::from(0.1f32)));
        for (from, to) in
            [(String, Float64), (Boolean, Enumeration), (Clock, Clock), (Binary, String)]
        {
            let error = convert(from, to, &[Hop::default()]).unwrap_err().to_string();
            assert!(error.contains("can't become"), "{error}");
        }
        assert!(convert(String, String, &[Hop::default()]).is_ok());
    }

    #[test]
    fn mappings_give_what_they_say_and_nothing_else() {
        let table = Transformation::Integer(vec![(1, 10), (2, -20)]);
        let map = convert(VariableType::Int32, VariableType::Int16, &[hop(table.clone())]).unwrap();
        assert_eq!([1.0, 2.0, 3.0].map(|v| map.apply(v)), [Some(10.0), Some(-20.0), None]);
        let not = Transformation::Boolean([Some(true), Some(false)]);
        let not = convert(VariableType::Boolean, VariableType::Boolean, &[hop(not)]).unwrap();
        assert_eq!([0.0, 1.0].map(|v| not.apply(v)), [Some(1.0), Some(0.0)]);
        let error = convert(VariableType::Float64, VariableType::Float64, &[hop(table)])
            .unwrap_err()
            .to_string();
        assert!(error.contains("is for whole numbers and enumerations"), "{error}");

        let items = |names: &[(i64, &str)]| {
            names.iter().map(|(value, name)| (*value, (*name).to_owned())).collect::<Vec<_>>()
        };
        let (a, b) = (items(&[(0, "off"), (1, "on")]), items(&[(5, "off"), (6, "run")]));
        let of = |items| Terminal {
            kind: VariableType::Enumeration,
            unit: None,
            items,
            enumeration: None,
        };
        let plain = WireConversion::of(&of(&a), &of(&b), &[Hop::default()], &[]).unwrap_err();
        let plain = plain.to_string();
        assert!(plain.contains("no item \"off\" with value 0"), "{plain}");
        let names = [("off", "off"), ("on", "run")];
        let names = names.map(|(a, b)| (a.to_owned(), b.to_owned())).to_vec();
        let named = hop(Transformation::Enumeration(names));
        let named = WireConversion::of(&of(&a), &of(&b), &[named], &[]).unwrap();
        assert_eq!([0.0, 1.0].map(|v| named.apply(v)), [Some(5.0), Some(6.0)]);
        let number = WireConversion::of(
            &terminal(VariableType::Int32, None),
            &of(&b),
            &[Hop::default()],
            &[],
        );
        let number = number.unwrap();
        assert_eq!([5.0, 7.0].map(|v| number.apply(v)), [Some(5.0), None]);
    }
}
