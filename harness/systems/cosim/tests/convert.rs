//! Conversion of values on wires: units, types, mappings.

use octant_cosim::convert::{Terminal, WireConversion, WireConversionError, WireUnit};
use octant_cosim::flat::Hop;
use octant_cosim::ssp::parameters::Transformation;
use octant_fmu_host::description::VariableType;

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
    for (from, to) in [(String, Float64), (Boolean, Enumeration), (Clock, Clock), (Binary, String)]
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
    let of =
        |items| Terminal { kind: VariableType::Enumeration, unit: None, items, enumeration: None };
    let plain = WireConversion::of(&of(&a), &of(&b), &[Hop::default()], &[]).unwrap_err();
    let plain = plain.to_string();
    assert!(plain.contains("no item \"off\" with value 0"), "{plain}");
    let names = [("off", "off"), ("on", "run")];
    let names = names.map(|(a, b)| (a.to_owned(), b.to_owned())).to_vec();
    let named = hop(Transformation::Enumeration(names));
    let named = WireConversion::of(&of(&a), &of(&b), &[named], &[]).unwrap();
    assert_eq!([0.0, 1.0].map(|v| named.apply(v)), [Some(5.0), Some(6.0)]);
    let number =
        WireConversion::of(&terminal(VariableType::Int32, None), &of(&b), &[Hop::default()], &[]);
    let number = number.unwrap();
    assert_eq!([5.0, 7.0].map(|v| number.apply(v)), [Some(5.0), None]);
}
