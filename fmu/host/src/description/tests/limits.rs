use super::*;

#[test]
fn many_notes_of_a_kind_are_counted() {
    let variables: String = (0..50)
        .map(|i| scalar("", "Real unit=\"x\"").replace("\"v\"", &format!("\"v{i}\"")))
        .collect();
    let found = get(&fmi2("", "", &variables, ""));
    assert_eq!(found.tolerated.len(), 21);
    assert_eq!(found.tolerated[20], "30 more of the kind: unit not defined");
}

#[test]
fn what_has_no_meaning_is_an_error_with_its_place() {
    let real = |attributes: &str| fmi2("", "", &scalar(attributes, "Real"), "");
    let cases = [
        (
            real("").replace("\"2.0\"", "\"1.0\""),
            "m.xml:1: fmiModelDescription, fmiVersion: \"1.0\", expected 2.0 or 3.0",
        ),
        (
            real("").replace("\"2.0\"", "\"4.0\""),
            "m.xml:1: fmiModelDescription, fmiVersion: \"4.0\", expected 2.0 or 3.0",
        ),
        (
            real("").replace("\"2.0\"", "\"3.0-beta.1\""),
            "m.xml:1: fmiModelDescription, fmiVersion: \"3.0-beta.1\", expected 2.0 or 3.0",
        ),
        (
            real("").replace("fmiVersion=\"2.0\"", ""),
            "m.xml:1: fmiModelDescription, fmiVersion: the attribute is missing, expected a value",
        ),
        (
            real("").replace("guid=\"g\"", ""),
            "m.xml:1: fmiModelDescription, guid: the attribute is missing, expected a value",
        ),
        (
            real("").replace("<CoSimulation modelIdentifier=\"m\"/>", ""),
            "m.xml:1: fmiModelDescription: no interface, expected CoSimulation or ModelExchange",
        ),
        (
            real("").replace("modelIdentifier=\"m\"", ""),
            "m.xml:2: CoSimulation, modelIdentifier: the attribute is missing, expected a value",
        ),
        (
            "<ssd/>".into(),
            "m.xml:1: ssd: the root element is \"ssd\", expected fmiModelDescription",
        ),
        (
            real("causality=\"internal\""),
            "m.xml:4: ScalarVariable \"v\", causality: \"internal\", expected one of parameter, \
             calculatedParameter, input, output, local, independent, structuralParameter",
        ),
        (
            real("").replace("\"7\"", "\"-7\""),
            "m.xml:4: ScalarVariable \"v\", valueReference: \"-7\", expected a whole number (u32)",
        ),
        (
            real("").replace("<Real/>", ""),
            "m.xml:4: ScalarVariable \"v\": no type, expected Real, Integer, Boolean, String or \
             Enumeration",
        ),
        (
            real("").replace("<Real/>", "<Real min=\"1,5\"/>"),
            "m.xml:4: Real, min: \"1,5\", expected a number, INF, -INF or NaN",
        ),
        (
            fmi3("", "<Clock name=\"c\" valueReference=\"1\"/>", ""),
            "m.xml:4: Clock \"c\", intervalVariability: the attribute is missing, expected a word",
        ),
        (
            fmi3("", "<Float64 name=\"a\" valueReference=\"1\"><Dimension/></Float64>", ""),
            "m.xml:4: Dimension: no size, expected start or valueReference",
        ),
        (
            "<!DOCTYPE a [<!ENTITY b \"c\">]><fmiModelDescription/>".into(),
            "m.xml: XML: a DOCTYPE, expected none: an FMU has no use for one, but an attacker",
        ),
        (
            "<a>\n<b></a>".into(),
            "m.xml:2: XML: expected 'b' tag, not 'a' at 2:4, expected well-formed XML",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(error(&text), expected, "{text}");
    }
    // A model for integration needs its states.
    let text = real("").replace("<CoSimulation", "<ModelExchange").replace(
        "<ModelStructure>",
        "<ModelStructure><Derivatives><Unknown index=\"2\"/></Derivatives>",
    );
    assert_eq!(error(&text), "m.xml:6: Unknown, index: index 2, expected 1 to 1");
    let text = real("")
        .replace("<CoSimulation", "<ModelExchange")
        .replace("<Real/>", "<Real derivative=\"2\"/>");
    let expected = "m.xml:4: ScalarVariable \"v\", derivative: index 2, expected 1 to 1";
    assert_eq!(error(&text), expected);
}

#[test]
fn sizes_of_arrays_are_limited() {
    let array = |dimensions: &str| {
        let text = fmi3(
            "",
            &format!(
                "<UInt64 name=\"n\" valueReference=\"1\" causality=\"structuralParameter\" start=\"5000\"/>\
                 <Float64 name=\"a\" valueReference=\"2\">{dimensions}</Float64>"
            ),
            "",
        );
        let found = get(&text);
        found.elements(&found.variables[1]).map_err(|error| error.to_string())
    };
    assert_eq!(array("<Dimension valueReference=\"1\"/><Dimension start=\"2\"/>"), Ok(10_000));
    assert_eq!(array("<Dimension start=\"0\"/>"), Ok(0));
    let error = "m.xml:4: dimensions of variable \"a\": too many elements, expected at most 2^24";
    assert_eq!(array("<Dimension valueReference=\"1\"/>".repeat(2).as_str()), Err(error.into()));
    let huge = "<Dimension start=\"18446744073709551615\"/>".repeat(2);
    assert_eq!(array(&huge), Err(error.into()));
    let error = array("<Dimension valueReference=\"2\"/>").expect_err("no parameter");
    assert!(error.contains("value reference 2 gives no size"), "{error}");
}

#[test]
fn deep_and_wide_files_do_no_harm() {
    let nested = |depth: usize| "<a>".repeat(depth) + &"</a>".repeat(depth);
    let limit = "m.xml:1: XML: an element at a depth of 257, expected at most 256";
    assert_eq!(error(&nested(100_000)), limit);
    let annotated = |depth| {
        fmi2("", "", &scalar("", "Real"), "").replace(
            "<ModelVariables>",
            &format!("<VendorAnnotations>{}</VendorAnnotations><ModelVariables>", nested(depth)),
        )
    };
    assert_eq!(get(&annotated(254)).variables.len(), 1);
    assert!(error(&annotated(255)).ends_with("a depth of 257, expected at most 256"));
}

/// Without the limit 40 000 attributes took 26 s, and 400 000 a hundred times that.
#[test]
fn an_element_has_few_attributes() {
    let many: String = (0..400_000).map(|i| format!(" a{i}='{i}'")).collect();
    let text = fmi2("", "", &scalar("", "Real"), "")
        .replace("<ScalarVariable", &format!("<ScalarVariable{many}"));
    assert_eq!(
        error(&text),
        "m.xml:4: XML: an element with more than 256 attributes, expected at most 256"
    );
}

#[test]
fn the_number_of_variables_is_limited() {
    let variables: String = (0..=1_000_000)
        .map(|i| {
            format!("<ScalarVariable name=\"{i}\" valueReference=\"{i}\"><Real/></ScalarVariable>")
        })
        .collect();
    assert_eq!(
        error(&fmi2("", "", &variables, "")),
        "m.xml:4: ScalarVariable \"1000000\": variable 1000001, expected at most 1000000 variables"
    );
}
