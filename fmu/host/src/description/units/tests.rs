use super::*;
use crate::description::read;

/// Makes a description with these unit definitions, and a variable `v` of unit `unit`.
fn description(definitions: &str, attributes: &str) -> Description {
    let text = format!(
        r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
        <CoSimulation modelIdentifier="m"/>
        <UnitDefinitions>{definitions}</UnitDefinitions>
        <ModelVariables><ScalarVariable name="v" valueReference="1" causality="output">
        <Real {attributes}/></ScalarVariable></ModelVariables>
        <ModelStructure/></fmiModelDescription>"#
    );
    read(&text, "m.xml").expect("a description")
}

fn factor(from: &str, to: &str) -> f64 {
    let conversion = UnitConversion::between(&description("", ""), from, to).expect("converts");
    assert_eq!(conversion.offset, 0.0);
    conversion.factor
}

#[test]
fn the_same_unit_changes_no_bit() {
    for unit in ["rad", "m/s", "deg", "furlong", "degC"] {
        let same = UnitConversion::between(&description("", ""), unit, unit).expect("the same");
        assert!(same.is_identity());
        for number in [0.1, -0.0, 1e-300, f64::INFINITY] {
            assert_eq!(same.apply(number).to_bits(), number.to_bits());
        }
        assert!(same.apply(f64::NAN).is_nan());
    }
    // Other names of the same unit.
    for (from, to) in [("rad/s", "rad.s-1"), ("m/s2", "m/s^2"), ("Hz", "1/s"), ("kg", "kg")] {
        assert_eq!(factor(from, to).to_bits(), 1f64.to_bits(), "{from} to {to}");
    }
}

#[test]
fn factors_are_those_of_the_textbook() {
    // Each from its definition, calculated by hand.
    for (from, to, expected) in [
        ("deg", "rad", 0.017_453_292_519_943_295),
        ("rad", "deg", 57.295_779_513_082_32),
        ("deg/s", "rad/s", 0.017_453_292_519_943_295),
        ("deg/h", "rad/s", 4.848_136_811_095_36e-6),
        ("arcsec", "rad", 4.848_136_811_095_36e-6),
        ("arcmin", "deg", 1.0 / 60.0),
        ("rev/min", "rad/s", 0.104_719_755_119_659_77),
        ("rpm", "rad/s", 0.104_719_755_119_659_77),
        ("km/h", "m/s", 1000.0 / 3600.0),
        ("kn", "m/s", 1852.0 / 3600.0),
        ("ms", "s", 1e-3),
        ("us", "s", 1e-6),
        ("µs", "s", 1e-6),
        ("ns", "s", 1e-9),
        ("min", "s", 60.0),
        ("h", "s", 3600.0),
        ("d", "h", 24.0),
        ("g", "kg", 1e-3),
        ("g", "m/s2", 9.806_65),
        ("mg", "m/s2", 9.806_65e-3),
        ("ug", "m/s^2", 9.806_65e-6),
        ("g/s", "kg/s", 1e-3),
        ("N", "kg.m/s2", 1.0),
        ("N.m", "J", 1.0),
        ("N.m/rad", "kg.m2/(s2.rad)", 1.0),
        ("kN", "N", 1e3),
        ("bar", "Pa", 1e5),
        ("kWh", "J", 3.6e6),
        ("%", "1", 1e-2),
        ("ppm", "1", 1e-6),
        ("mm2", "m2", 1e-6),
        ("m/s/s", "m/s2", 1.0),
        ("cm", "m", 1e-2),
        ("nmi", "m", 1852.0),
        ("ft", "m", 0.3048),
        ("l", "m3", 1e-3),
        ("1/min", "Hz", 1.0 / 60.0),
        ("kHz", "Hz", 1e3),
    ] {
        let found = factor(from, to);
        assert!(
            (found - expected).abs() <= 2.0 * f64::EPSILON * expected,
            "{from} to {to}: {found:e}"
        );
    }
}

#[test]
fn temperatures_have_offsets_and_differences_have_none() {
    let plain = description("", r#"unit="degC""#);
    let conversion = UnitConversion::of(&plain, &plain.variables[0], "K").expect("converts");
    assert_eq!(conversion.apply(20.0), 293.15);
    let back = UnitConversion::between(&plain, "K", "degC").expect("converts");
    assert!((back.apply(293.15) - 20.0).abs() < 1e-12);
    let fahrenheit = UnitConversion::between(&plain, "degF", "degC").expect("converts");
    assert!((fahrenheit.apply(212.0) - 100.0).abs() < 1e-12);
    let difference = description("", r#"unit="degC" relativeQuantity="true""#);
    let conversion =
        UnitConversion::of(&difference, &difference.variables[0], "K").expect("converts");
    assert!(conversion.is_identity());
}

#[test]
fn definitions_count_before_names() {
    // Modelica tools write a degree with 15 digits; the exact degree is meant.
    let tool = description(
        r#"<Unit name="deg"><BaseUnit rad="1" factor="0.0174532925199433"/></Unit>
           <Unit name="Grad"><BaseUnit rad="1" factor="0.0157079632679490"/></Unit>
           <Unit name="rad"><BaseUnit factor="1"/>
             <DisplayUnit name="Strich" factor="1018.5916357881302"/></Unit>
           <Unit name="deg/h"><BaseUnit s="-1" rad="1" factor="0.5"/></Unit>
           <Unit name="Umin"><BaseUnit s="-1" factor="0.01666666666666667"/></Unit>"#,
        "",
    );
    let factor = |from, to| UnitConversion::between(&tool, from, to).expect("converts").factor;
    assert_eq!(factor("deg", "rad").to_bits(), 0.017_453_292_519_943_295_f64.to_bits());
    assert_eq!(factor("Grad", "rad"), 0.015_707_963_267_949);
    assert_eq!(factor("deg/h", "rad/s"), 0.5);
    assert_eq!(factor("rad", "rad"), 1.0);
    assert!((factor("Strich", "deg") - 360.0 / 6400.0).abs() < 1e-15);
    // A survey mile is 3 mm longer, and is left so.
    let survey = description(r#"<Unit name="mi"><BaseUnit m="1" factor="1609.3472"/></Unit>"#, "");
    let mile = UnitConversion::between(&survey, "mi", "m").expect("converts");
    assert_eq!(mile.factor, 1609.3472);
    // A number of turns isn't an angle, even if a tool leaves the radian out of "rad".
    assert!(UnitConversion::between(&tool, "Umin", "rad/s").is_err());
}

#[test]
fn what_measures_something_else_is_refused_with_both_names() {
    let plain = description("", r#"unit="m""#);
    let error =
        |from, to| UnitConversion::between(&plain, from, to).expect_err("refused").to_string();
    assert_eq!(error("m", "rad"), "unit \"m\" (m) can't become \"rad\" (rad)");
    assert_eq!(error("Hz", "rad/s"), "unit \"Hz\" (s^-1) can't become \"rad/s\" (s^-1·rad)");
    assert_eq!(error("1", "rad"), "unit \"1\" (no dimension) can't become \"rad\" (rad)");
    assert_eq!(error("g", "K"), "unit \"g\" (kg) can't become \"K\" (K)");
    assert_eq!(error("kg", "m/s2"), "unit \"kg\" (kg) can't become \"m/s2\" (m·s^-2)");
    assert_eq!(
        error("furlong", "m"),
        "unit \"furlong\" is neither defined in m.xml nor a known one, expected one like \"m\""
    );
    let none = description("", "");
    let error = UnitConversion::of(&none, &none.variables[0], "rad").expect_err("refused");
    assert_eq!(error.to_string(), "variable \"v\" of m.xml has no unit, expected one like \"rad\"");
}

#[test]
fn names_without_meaning_are_none() {
    for name in [
        "furlong",
        "m/",
        "/s",
        "m..s",
        "m^",
        "m^(2",
        "(m",
        "m)",
        "m2m",
        "s-",
        "m200",
        "m-200",
        "m^99.m^99",
        "((((((((((((((((((m))))))))))))))))))",
        "Mm100",
        "2",
        "m 2 s",
        "\u{0}",
    ] {
        assert!(known(name).is_empty(), "{name}");
    }
}

proptest::proptest! {
    #[test]
    fn there_and_back_is_where_it_was(number in -1e6..1e6f64, a in 0..8usize, b in 0..8usize) {
        let units = ["deg", "rad", "arcsec", "arcmin", "rev", "mrad", "urad", "°"];
        let plain = description("", "");
        let there = UnitConversion::between(&plain, units[a], units[b]).expect("converts");
        let back = UnitConversion::between(&plain, units[b], units[a]).expect("converts");
        let again = back.apply(there.apply(number));
        proptest::prop_assert!((again - number).abs() <= 4.0 * f64::EPSILON * number.abs());
    }

    #[test]
    fn no_name_does_harm(name in "\\PC*") {
        let _ = known(&name);
    }

    #[test]
    fn no_name_of_known_parts_does_harm(name in "[mkgsradNH1z%°/.*^()0-9+-]{0,24}") {
        let _ = known(&name);
    }
}
