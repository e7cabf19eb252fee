mod limits;

use super::*;

/// Makes a description of FMI 2.0: attributes of the root, the part before the variables, the
/// variables, the structure.
fn fmi2(head: &str, before: &str, variables: &str, structure: &str) -> String {
    format!(
        "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"m\" guid=\"g\" {head}>\n\
         <CoSimulation modelIdentifier=\"m\"/>{before}\n<ModelVariables>\n{variables}\n\
         </ModelVariables>\n<ModelStructure>{structure}</ModelStructure>\n</fmiModelDescription>"
    )
}

/// Makes a description of FMI 3.0 in the same way.
fn fmi3(before: &str, variables: &str, structure: &str) -> String {
    format!(
        "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"m\" instantiationToken=\"t\">\n\
         <CoSimulation modelIdentifier=\"m\"/>{before}\n<ModelVariables>\n{variables}\n\
         </ModelVariables>\n<ModelStructure>{structure}</ModelStructure>\n</fmiModelDescription>"
    )
}

fn get(text: &str) -> Description {
    read(text, "m.xml").expect("a description")
}

fn error(text: &str) -> String {
    read(text, "m.xml").expect_err("is refused").to_string()
}

/// Makes a variable of FMI 2.0.
fn scalar(attributes: &str, kind: &str) -> String {
    format!(
        "<ScalarVariable name=\"v\" valueReference=\"7\" {attributes}><{kind}/></ScalarVariable>"
    )
}

#[test]
fn a_description_of_fmi_2_is_read_in_full() {
    let text = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
  xsi:noNamespaceSchemaLocation="fmi2ModelDescription.xsd" fmiVersion="2.0" modelName="Ship"
  guid="{1-2}" description="A ship" version="1.2" generationTool="Tool"
  variableNamingConvention="structured" numberOfEventIndicators="2">
  <ModelExchange modelIdentifier="ship_me" completedIntegratorStepNotNeeded="true"/>
  <CoSimulation modelIdentifier="ship_cs" canHandleVariableCommunicationStepSize="1"
    canGetAndSetFMUstate="true" canSerializeFMUstate="true" providesDirectionalDerivative="true"
    canRunAsynchronuously="true" canInterpolateInputs="true" maxOutputDerivativeOrder="1"
    canBeInstantiatedOnlyOncePerProcess="true" needsExecutionTool="true"/>
  <UnitDefinitions>
    <Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="deg" factor="57.29577951308232"/></Unit>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
    <Unit name="furlong"/>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Angle"><Real unit="rad" displayUnit="deg" min="-4" max="4" nominal="0.1"/></SimpleType>
    <SimpleType name="Mode"><Enumeration><Item name="off" value="1"/><Item name="on" value="5"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <LogCategories><Category name="logAll"/><Category name="events" description="e"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="10.5" tolerance="1e-4" stepSize="0.005"/>
  <VendorAnnotations><Tool name="Tool"><x:any xmlns:x="urn:x" y="1"/></Tool></VendorAnnotations>
  <ModelVariables>
    <!-- 1 --><ScalarVariable name="der(roll)" valueReference="20"><Real derivative="2"/></ScalarVariable>
    <!-- 2 --><ScalarVariable name="roll" valueReference="10" causality="output" initial="exact"
      description="Roll"><Real declaredType="Angle" max="3" start="0.5"/></ScalarVariable>
    <!-- 3 --><ScalarVariable name="mode" valueReference="30" causality="input" variability="discrete">
      <Enumeration declaredType="Mode" start="5"/></ScalarVariable>
    <!-- 4 --><ScalarVariable name="name" valueReference="30" causality="parameter" variability="fixed">
      <String start=" two words "/></ScalarVariable>
    <!-- 5 --><ScalarVariable name="time" valueReference="0" causality="independent" variability="continuous"><Real/></ScalarVariable>
    <!-- 6 --><ScalarVariable name="dT" valueReference="40"><Real unit="degC" relativeQuantity="true"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies="1 3" dependenciesKind="dependent fixed"/></Outputs>
    <Derivatives><Unknown index="1"/></Derivatives>
    <InitialUnknowns><Unknown index="1" dependencies=""/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>"#;
    let found = get(text);
    assert_eq!(found.tolerated, [] as [&str; 0]);
    assert_eq!(found.standard, Standard::Fmi2);
    assert_eq!(
        [
            &found.model_name,
            &found.token,
            &found.description,
            &found.version,
            &found.generation_tool
        ],
        ["Ship", "{1-2}", "A ship", "1.2", "Tool"]
    );
    assert!(found.structured_names);
    assert_eq!(found.event_indicators, 2);
    let cs = found.co_simulation.as_ref().expect("co-simulation");
    assert_eq!(
        *cs,
        Interface {
            model_identifier: "ship_cs".into(),
            needs_execution_tool: true,
            only_once_per_process: true,
            variable_step: true,
            state: true,
            serialized_state: true,
            directional_derivatives: true,
            asynchronous: true,
            interpolates_inputs: true,
            output_derivative_order: 1,
            ..Interface::default()
        }
    );
    let me = found.model_exchange.as_ref().expect("model exchange");
    assert_eq!((&me.model_identifier[..], me.completed_step_needed), ("ship_me", false));
    assert_eq!(found.log_categories, ["logAll", "events"]);
    assert_eq!(
        found.default_experiment,
        DefaultExperiment {
            start_s: Some(0.0),
            stop_s: Some(10.5),
            tolerance: Some(1e-4),
            step_s: Some(0.005)
        }
    );
    assert_eq!(found.unit("rad").expect("rad").display[0].name, "deg");
    assert_eq!(found.unit("degC").and_then(|unit| unit.base).expect("degC").offset, 273.15);
    assert_eq!(found.unit("furlong").expect("furlong").base, None);
    assert_eq!(found.enumeration("Mode"), Some(&[(1, "off".into()), (5, "on".into())][..]));
    let roll = found.variable("roll").expect("roll");
    assert_eq!((roll.reference, roll.kind, roll.line), (10, VariableType::Float64, 25));
    assert_eq!((roll.min, roll.max, roll.nominal), (Some(-4.0), Some(3.0), Some(0.1)));
    assert_eq!((roll.unit.as_deref(), roll.display_unit.as_deref()), (Some("rad"), Some("deg")));
    assert_eq!((roll.initial, &roll.start[..]), (Some(Initial::Exact), &["0.5".to_owned()][..]));
    assert_eq!(found.elements(roll), Ok(1));
    let rate = found.variable("der(roll)").expect("its derivative");
    assert_eq!((rate.derivative_of, rate.causality), (Some(10), Causality::Local));
    assert_eq!(
        (rate.variability, rate.initial),
        (Variability::Continuous, Some(Initial::Calculated))
    );
    let mode = found.variable("mode").expect("mode");
    assert_eq!((mode.kind, mode.enumeration.as_deref()), (VariableType::Enumeration, Some("Mode")));
    assert_eq!(mode.initial, None);
    assert_eq!(found.variable("name").expect("name").start, [" two words "]);
    assert!(found.variable("dT").expect("dT").relative_quantity);
    let unknown = |reference, depends_on: Option<&[u32]>| ModelUnknown {
        reference,
        depends_on: depends_on.map(<[u32]>::to_vec),
    };
    assert_eq!(found.structure.outputs, [unknown(10, Some(&[20, 30]))]);
    assert_eq!(found.structure.derivatives, [unknown(20, None)]);
    assert_eq!(found.structure.initial_unknowns, [unknown(20, Some(&[]))]);
}

#[test]
fn a_description_of_fmi_3_is_read_in_full() {
    let text = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Ship" instantiationToken="{1-2}">
  <ModelExchange modelIdentifier="ship" needsCompletedIntegratorStep="true"/>
  <CoSimulation modelIdentifier="ship" hasEventMode="true" providesIntermediateUpdate="true"
    mightReturnEarlyFromDoStep="true" canReturnEarlyAfterIntermediateUpdate="true"
    fixedInternalStepSize="0.001" canGetAndSetFMUState="true" canSerializeFMUState="true"
    providesDirectionalDerivatives="true" providesAdjointDerivatives="true"/>
  <ScheduledExecution modelIdentifier="ship"/>
  <UnitDefinitions><Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="1/deg" inverse="true"/></Unit></UnitDefinitions>
  <TypeDefinitions>
    <Float64Type name="Angle" unit="rad" min="-4"/>
    <EnumerationType name="Mode"><Item name="off" value="-9"/></EnumerationType>
    <ClockType name="Tick" intervalVariability="constant" intervalDecimal="0.5"/>
    <BinaryType name="Frame" mimeType="application/x-frame"/>
  </TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent"/>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" start="3"/>
    <Float64 name="m" valueReference="2" declaredType="Angle" causality="input" start="1 2 3 4 5 6">
      <Dimension start="2"/><Dimension valueReference="1"/>
      <Alias name="n.m" description="also" displayUnit="deg"/></Float64>
    <Float32 name="der(x)" valueReference="3" derivative="4"/>
    <Float32 name="x" valueReference="4" initial="exact" start="0"/>
    <String name="s" valueReference="5" causality="parameter"><Dimension start="2"/><Start value="a b"/><Start value=""/></String>
    <Binary name="b" valueReference="6" causality="input" declaredType="Frame" clocks="8"><Start value="0aFF"/></Binary>
    <Enumeration name="e" valueReference="7" causality="output" declaredType="Mode"/>
    <Clock name="c" valueReference="8" causality="input" declaredType="Tick" shiftDecimal="0.25"/>
    <Clock name="d" valueReference="9" causality="input" intervalVariability="countdown" priority="2" canBeDeactivated="true" resolution="1000" intervalCounter="5" shiftCounter="1" supportsFraction="true"/>
    <Boolean name="p" valueReference="10" clocks="8" previous="11"/>
    <Boolean name="q" valueReference="11" clocks="8" initial="exact" start="true"/>
    <Float64 name="z" valueReference="12"><Dimension start="4"/></Float64>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="7" dependencies="2" dependenciesKind="dependent"/>
    <ContinuousStateDerivative valueReference="3"/>
    <ClockedState valueReference="10"/>
    <InitialUnknown valueReference="3"/>
    <EventIndicator valueReference="12"/><EventIndicator valueReference="4"/>
  </ModelStructure>
  <Annotations><Annotation type="x"/></Annotations>
</fmiModelDescription>"#;
    let found = get(text);
    assert_eq!(found.tolerated, [] as [&str; 0]);
    assert_eq!((found.standard, &found.token[..]), (Standard::Fmi3, "{1-2}"));
    let cs = found.co_simulation.as_ref().expect("co-simulation");
    assert_eq!(
        *cs,
        Interface {
            model_identifier: "ship".into(),
            event_mode: true,
            intermediate_update: true,
            might_return_early: true,
            returns_early_on_request: true,
            fixed_internal_step_s: Some(0.001),
            state: true,
            serialized_state: true,
            directional_derivatives: true,
            adjoint_derivatives: true,
            ..Interface::default()
        }
    );
    assert!(found.model_exchange.as_ref().expect("model exchange").completed_step_needed);
    let scheduled = found.scheduled_execution.as_ref().unwrap();
    assert_eq!(scheduled.model_identifier, "ship");
    let m = found.variable("m").expect("m");
    assert_eq!(m.dimensions, [ArrayDimension::Fixed(2), ArrayDimension::Of(1)]);
    assert_eq!((found.elements(m), m.start.len()), (Ok(6), 6));
    assert_eq!((m.unit.as_deref(), m.min), (Some("rad"), Some(-4.0)));
    assert!(std::ptr::eq(found.variable("n.m").expect("its alias"), m));
    assert_eq!(found.variable("der(x)").expect("x'").derivative_of, Some(4));
    assert_eq!(found.variable("s").expect("s").start, ["a b", ""]);
    let b = found.variable("b").expect("b");
    assert_eq!((b.mime_type.as_deref(), &b.clocks[..]), (Some("application/x-frame"), &[8][..]));
    assert_eq!(b.start, ["0aFF"]);
    let clock = |name| found.variable(name).expect("a clock").clock.expect("a clock");
    assert_eq!(
        clock("c"),
        ClockProperties {
            interval_variability: IntervalVariability::Constant,
            interval_s: Some(0.5),
            shift_s: 0.25,
            supports_fraction: false,
            resolution: None,
            interval_counter: None,
            shift_counter: 0,
            priority: None,
            can_be_deactivated: false
        }
    );
    assert_eq!(
        clock("d"),
        ClockProperties {
            interval_variability: IntervalVariability::Countdown,
            interval_s: None,
            shift_s: 0.0,
            supports_fraction: true,
            resolution: Some(1000),
            interval_counter: Some(5),
            shift_counter: 1,
            priority: Some(2),
            can_be_deactivated: true
        }
    );
    assert_eq!(found.variable("p").expect("p").previous, Some(11));
    assert_eq!(found.structure.clocked_states.len(), 1);
    assert_eq!(found.event_indicators, 5);
    assert!(found.unit("rad").expect("rad").display[0].inverse);
}

#[test]
fn what_vendors_write_is_tolerated_and_listed() {
    let real = |attributes: &str| scalar(attributes, "Real");
    let cases = [
        // Attributes and elements of another namespace, and annotations, are legal and not noted.
        (fmi2("xmlns:dym=\"urn:d\" dym:version=\"2024\"", "", &real(""), ""), ""),
        (format!("\u{feff}{}", fmi2("", "", &real(""), "")), ""),
        (format!("\n <?xml version=\"1.0\"?>\n{}", fmi2("", "", &real(""), "")), "blanks before"),
        (fmi2("", "", &scalar("causality=\"input\"", "Real"), ""), "no start value"),
        (fmi2("", "", &scalar("hidden=\"1\"", "Real"), ""), "hidden: an unknown attribute"),
        (fmi2("", "<Extras/>", &real(""), ""), "an unknown element in fmiModelDescription"),
        (fmi2("", "", &scalar("", "Real start=\"1\""), ""), "is calculated, but has a start"),
        (
            fmi2("", "", &scalar("", "Real unit=\"furlong\""), ""),
            "\"furlong\" of \"v\" is not defined",
        ),
        (fmi2("", "", &scalar("", "Integer"), ""), "no variability"),
        (
            fmi2("", "", &scalar("causality=\"parameter\"", "Real start=\"1\""), ""),
            "no variability",
        ),
        (fmi2("", "", &scalar("", "Real declaredType=\"T\""), ""), "type \"T\" is not defined"),
        (
            fmi2(
                "",
                "<TypeDefinitions><SimpleType name=\"T\"><Integer/></SimpleType></TypeDefinitions>",
                &scalar("", "Real declaredType=\"T\""),
                "",
            ),
            "type \"T\" is Integer, not Real",
        ),
        (
            fmi2(
                "",
                "<UnitDefinitions><Unit name=\"u\"><BaseUnit factor=\"0\"/></Unit></UnitDefinitions>",
                &real(""),
                "",
            ),
            "factor 0 and offset 0 convert nothing",
        ),
        (fmi2("", "", &(real("") + &real("")), ""), "name \"v\" is there twice"),
        (fmi2("", "", &scalar("", "Real derivative=\"0\""), ""), "derivative of index 0"),
        (
            fmi2("", "", &real(""), "<Outputs><Unknown index=\"0\"/></Outputs>"),
            "index 0 of Outputs",
        ),
        (
            fmi2("", "", &real(""), "<Outputs><Unknown index=\"1\" dependencies=\"9\"/></Outputs>"),
            "depend on everything",
        ),
        (
            fmi2(
                "",
                "<UnitDefinitions><Unit name=\"u\"/><Unit name=\"u\"/></UnitDefinitions>",
                &real(""),
                "",
            ),
            "defined twice",
        ),
        (
            fmi2("", "", &real(""), "").replace("fmiVersion=\"2.0\"", "fmiVersion=\"2.0.3\""),
            "read as 2.0",
        ),
        (fmi2("", "", &real(""), "").replace("modelName=\"m\"", ""), "modelName is missing"),
        (
            fmi2("", "", &real(""), "").replace("<ModelStructure></ModelStructure>", ""),
            "ModelStructure is missing",
        ),
        (
            fmi3("", "<Float64 name=\"v\" valueReference=\"1\"/><Float128 name=\"w\"/>", ""),
            "an unknown element in ModelVariables",
        ),
        (
            fmi3(
                "",
                "<Float64 name=\"v\" valueReference=\"1\"/>",
                "<Output valueReference=\"9\"/>",
            ),
            "of no variable",
        ),
        (
            fmi3(
                "",
                "<String name=\"v\" valueReference=\"1\" causality=\"parameter\" start=\"a b\"/>",
                "",
            ),
            "expected an element Start",
        ),
        (
            fmi3("", "<Float64 name=\"v\" valueReference=\"1\"/>", "")
                .replace("\"3.0\"", "\"3.1\""),
            "read as 3.0",
        ),
    ];
    for (text, expected) in cases {
        let found = get(&text);
        assert!(found.variable("v").is_some(), "{text}");
        match expected {
            "" => assert_eq!(found.tolerated, [] as [&str; 0], "{text}"),
            _ => assert!(
                found.tolerated.len() == 1 && found.tolerated[0].contains(expected),
                "{:?}, expected {expected:?} in\n{text}",
                found.tolerated
            ),
        }
    }
}

#[test]
fn numbers_are_read_as_vendors_write_them() {
    let text =
        fmi2("", "", &scalar("", "Real min=\"-INF\" max=\"inf\" nominal=\" +1.5E+03 \""), "");
    let found = get(&text);
    let v = &found.variables[0];
    assert_eq!(
        (v.min, v.max, v.nominal),
        (Some(f64::NEG_INFINITY), Some(f64::INFINITY), Some(1500.0))
    );
    let text = fmi2("", "", &scalar("", "Real relativeQuantity=\"True\""), "");
    assert!(get(&text).variables[0].relative_quantity);
    let defaults = [
        ("causality=\"parameter\" variability=\"fixed\"", Some(Initial::Exact)),
        ("causality=\"calculatedParameter\" variability=\"fixed\"", Some(Initial::Calculated)),
        ("causality=\"output\" variability=\"constant\"", Some(Initial::Exact)),
        ("causality=\"output\"", Some(Initial::Calculated)),
        ("causality=\"input\"", None),
        ("causality=\"independent\"", None),
    ];
    for (attributes, initial) in defaults {
        assert_eq!(
            get(&fmi2("", "", &scalar(attributes, "Real"), "")).variables[0].initial,
            initial
        );
    }
}

#[test]
fn fmi_1_is_said_before_anything_else() {
    let head = b"<?xml version='1.0' encoding='EBCDIC'?>\n<fmiModelDescription modelName=\"\xb0\"\n fmiVersion = '1.0'>";
    let error = super::read_bytes(head, "m.xml").expect_err("is of FMI 1.0").to_string();
    assert!(error.contains("FMI 1.0") && error.contains("export the model anew"), "{error}");
    assert!(!error.contains("EBCDIC"), "{error}");
    for other in ["fmiVersion=\"2.0\"", "fmiVersion=\"3.1\"", "version=\"1.0\""] {
        let text = format!("<fmiModelDescription {other}>");
        assert!(!super::is_of_fmi_1(text.as_bytes()), "{other}");
    }
    let wide: Vec<u8> = "<fmiModelDescription fmiVersion=\"1.0\">"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert!(super::is_of_fmi_1(&wide));
}

#[test]
fn a_minor_version_that_is_newer_is_noted() {
    let text = fmi2("", "", "", "").replace("fmiVersion=\"2.0\"", "fmiVersion=\"2.0.4\"");
    let read = get(&text);
    assert!(read.tolerated.iter().any(|one| one.contains("\"2.0.4\" is read as 2.0")), "{read:?}");
}
