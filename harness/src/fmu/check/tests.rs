//! Each rule is tripped by a change of a description, or of an FMU, that breaks nothing else.

use super::rules::{self, RULES, Rule};
use super::*;
use dll::dll;
use std::collections::BTreeSet;
use std::io::{Cursor, Write};
use zip::write::{SimpleFileOptions, ZipWriter};

#[path = "tests/dll.rs"]
mod dll;

const GOOD2: &str = include_str!("tests/good_fmi2.xml");
const GOOD3: &str = include_str!("tests/good_fmi3.xml");

/// What is changed: the text that is there once, and what takes its place.
type Edit<'a> = (&'a str, &'a str);

fn edited(text: &str, edits: &[Edit<'_>]) -> String {
    let mut text = text.to_owned();
    for (from, to) in edits {
        assert!(text.matches(from).count() == 1, "{from:?} isn't there once");
        text = text.replace(from, to);
    }
    text
}

fn ids(findings: &[Finding]) -> Vec<&'static str> {
    let ids: BTreeSet<&str> = findings.iter().map(|finding| finding.rule.id).collect();
    ids.into_iter().collect()
}

/// Rules of the description that a change breaks.
fn broken(good: &str, edits: &[Edit<'_>]) -> (Vec<&'static str>, Vec<Finding>) {
    let (_, findings) = check_description(&edited(good, edits));
    (ids(&findings), findings)
}

#[test]
fn good_descriptions_have_no_finding() {
    for good in [GOOD2, GOOD3] {
        let (description, findings) = check_description(good);
        assert!(findings.is_empty(), "{findings:#?}");
        assert_eq!(description.expect("is read").tolerated, [] as [&str; 0]);
    }
}

/// Rule, description, what is changed, and a part of what is found and expected.
fn cases() -> Vec<(&'static Rule, &'static str, Vec<Edit<'static>>, &'static str)> {
    use rules::*;
    vec![
        // The file as XML.
        (&DESCRIPTION_READABLE, GOOD2, vec![("</ModelVariables>", "")], "well-formed"),
        (
            &DESCRIPTION_READABLE,
            GOOD2,
            vec![("fmiVersion=\"2.0\"", "fmiVersion=\"1.0\"")],
            "2.0 or 3.0",
        ),
        (
            &DESCRIPTION_READABLE,
            GOOD3,
            vec![("<Dimension valueReference=\"2\"/>", "<Dimension/>")],
            "no size",
        ),
        (
            &DESCRIPTION_IDENTIFIER,
            GOOD2,
            vec![
                (
                    "<ModelExchange modelIdentifier=\"good\"",
                    "<ModelExchange modelIdentifier=\"good-1\"",
                ),
                (
                    "<CoSimulation modelIdentifier=\"good\"",
                    "<CoSimulation modelIdentifier=\"good-1\"",
                ),
            ],
            "no digit first",
        ),
        (&DESCRIPTION_TOKEN, GOOD2, vec![("guid=\"{1}\"", "guid=\"\"")], "an empty token"),
        (
            &DESCRIPTION_NAME,
            GOOD3,
            vec![("modelName=\"Good\"", "modelName=\" \"")],
            "no model name",
        ),
        (
            &DESCRIPTION_VERSION,
            GOOD3,
            vec![("fmiVersion=\"3.0\"", "fmiVersion=\"3.1\"")],
            "checked as 3.0",
        ),
        // The schema.
        (
            &SCHEMA_ELEMENT,
            GOOD2,
            vec![("<ModelStructure>", "<Extra/><ModelStructure>")],
            "an unknown element",
        ),
        (
            &SCHEMA_ELEMENT,
            GOOD3,
            vec![("<ModelStructure>", "<ModelStructure><Outputs/>")],
            "an unknown element",
        ),
        (&SCHEMA_ATTRIBUTE, GOOD2, vec![("stepSize=", "stepsize=")], "such as stepSize"),
        (
            &SCHEMA_ATTRIBUTE,
            GOOD3,
            vec![("<EventIndicator", "<EventIndicator index=\"1\"")],
            "an unknown attribute",
        ),
        (
            &SCHEMA_MISSING_ELEMENT,
            GOOD2,
            vec![("<Category name=\"logAll\"/><Category name=\"logEvents\"/>", "")],
            "Category is missing",
        ),
        (
            &SCHEMA_MISSING_ATTRIBUTE,
            GOOD2,
            vec![("<File name=\"good.c\"/>", "<File/>")],
            "the attribute is missing",
        ),
        (
            &SCHEMA_ORDER,
            GOOD2,
            vec![
                ("<LogCategories>", "<DefaultExperiment stopTime=\"1\"/><LogCategories>"),
                (
                    "<DefaultExperiment startTime=\"0\" stopTime=\"10\" tolerance=\"1e-4\" stepSize=\"0.1\"/>",
                    "",
                ),
            ],
            "it comes after DefaultExperiment",
        ),
        (
            &SCHEMA_REPEATED,
            GOOD2,
            vec![("<DefaultExperiment", "<DefaultExperiment/><DefaultExperiment")],
            "only once",
        ),
        (
            &SCHEMA_VALUE,
            GOOD2,
            vec![("canSerializeFMUstate=\"true\"", "canSerializeFMUstate=\"True\"")],
            "true, false, 1 or 0",
        ),
        (&SCHEMA_VALUE, GOOD2, vec![("2026-01-01T00:00:00Z", "1.1.2026")], "a date and time"),
        (&SCHEMA_VALUE, GOOD3, vec![("value=\"0aff\"", "value=\"0af\"")], "hexadecimal"),
        (&SCHEMA_VALUE, GOOD3, vec![("start=\"1 2 3\"", "start=\"1 2 c\"")], "a list"),
        // Interfaces, categories, experiment.
        (&INTERFACE_STATE, GOOD2, vec![("canGetAndSetFMUstate=\"true\"", "")], "both"),
        (&INTERFACE_STATE, GOOD3, vec![("canGetAndSetFMUState=\"true\"", "")], "both"),
        (&INTERFACE_EARLY_RETURN, GOOD3, vec![("providesIntermediateUpdate=\"true\"", "")], "both"),
        (
            &INTERFACE_STEP,
            GOOD3,
            vec![("fixedInternalStepSize=\"0.1\"", "fixedInternalStepSize=\"0\"")],
            "a positive step",
        ),
        (
            &INTERFACE_STATES,
            GOOD2,
            vec![("<ModelExchange modelIdentifier=\"good\"/>", ""), ("reinit=\"true\"", "")],
            "1 event indicators",
        ),
        (
            &INTERFACE_SAME_IDENTIFIER,
            GOOD2,
            vec![(
                "<ModelExchange modelIdentifier=\"good\"/>",
                "<ModelExchange modelIdentifier=\"other\"/>",
            )],
            "good and other",
        ),
        (&LOG_UNIQUE, GOOD2, vec![("\"logEvents\"", "\"logAll\"")], "there twice"),
        (
            &EXPERIMENT_RANGE,
            GOOD2,
            vec![("stopTime=\"10\"", "stopTime=\"0\"")],
            "more than startTime",
        ),
        (
            &EXPERIMENT_RANGE,
            GOOD2,
            vec![("tolerance=\"1e-4\"", "tolerance=\"-1\"")],
            "a positive number",
        ),
        (
            &EXPERIMENT_RANGE,
            GOOD3,
            vec![("stopTime=\"10\"", "stopTime=\"INF\"")],
            "a finite number",
        ),
        (
            &EXPERIMENT_STEP,
            GOOD3,
            vec![("stepSize=\"0.1\"", "stepSize=\"11\"")],
            "at least one step",
        ),
        // Units and types.
        (
            &UNIT_UNIQUE,
            GOOD2,
            vec![(
                "<Unit name=\"m/s\">",
                "<Unit name=\"m\"><BaseUnit m=\"1\"/></Unit><Unit name=\"m/s\">",
            )],
            "there twice",
        ),
        (&UNIT_UNIQUE, GOOD2, vec![("\"mm\"", "\"km\"")], "there twice in"),
        (
            &UNIT_DEFINED,
            GOOD2,
            vec![("<Real unit=\"m/s\"", "<Real unit=\"m/h\"")],
            "unit \"m/h\" is not defined",
        ),
        (
            &UNIT_DEFINED,
            GOOD2,
            vec![("displayUnit=\"km\"", "displayUnit=\"nm\"")],
            "display unit \"nm\"",
        ),
        (
            &UNIT_DEFINED,
            GOOD3,
            vec![
                ("<Alias name=\"alias.of.u\"/>", "<Alias name=\"alias.of.u\" displayUnit=\"x\"/>"),
                ("start=\"1 2 3\"", "start=\"1 2 3\" unit=\"m\""),
            ],
            "display unit \"x\"",
        ),
        (
            &UNIT_DISPLAY,
            GOOD2,
            vec![("<Real unit=\"deg\"/>", "<Real displayUnit=\"km\"/>")],
            "without a unit",
        ),
        (&UNIT_FACTOR, GOOD2, vec![("factor=\"1000\"", "factor=\"0\"")], "a finite factor but 0"),
        (
            &UNIT_INVERSE,
            GOOD3,
            vec![("inverse=\"true\"", "inverse=\"true\" offset=\"1\"")],
            "no offset",
        ),
        (
            &UNIT_BASE,
            GOOD2,
            vec![("<BaseUnit rad=\"1\" factor=\"0.0174532925199433\"/>", "")],
            "without BaseUnit",
        ),
        (
            &UNIT_MEANING,
            GOOD2,
            vec![("factor=\"0.0174532925199433\"", "factor=\"1\"")],
            "0.017453292519943295 of rad",
        ),
        (
            &UNIT_TYPE,
            GOOD2,
            vec![
                (
                    "<Real declaredType=\"Length\" start=\"1\" reinit=\"true\"/>",
                    "<Real declaredType=\"Length\" unit=\"deg\" start=\"1\" reinit=\"true\"/>",
                ),
                ("displayUnit=\"km\"", ""),
                ("<Real unit=\"m/s\"", "<Real"),
            ],
            "a unit like \"m\"",
        ),
        (&UNIT_DERIVATIVE, GOOD2, vec![("<Real unit=\"m/s\"", "<Real unit=\"m\"")], "m·s^-1"),
        (
            &TYPE_UNIQUE,
            GOOD2,
            vec![(
                "<SimpleType name=\"Mode\">",
                "<SimpleType name=\"Length\"><Real unit=\"m\"/></SimpleType><SimpleType name=\"Mode\">",
            )],
            "there twice",
        ),
        (
            &TYPE_UNIQUE,
            GOOD3,
            vec![(
                "<EnumerationType name=\"Mode\">",
                "<Int8Type name=\"mode\"/><EnumerationType name=\"Mode\">",
            )],
            "a variable has the same name",
        ),
        (
            &TYPE_DEFINED,
            GOOD2,
            vec![(
                "<Real/></ScalarVariable>\n    <!-- 7",
                "<Real declaredType=\"Nothing\"/></ScalarVariable>\n    <!-- 7",
            )],
            "\"Nothing\" is not defined",
        ),
        (
            &TYPE_DEFINED,
            GOOD3,
            vec![("<Float64 name=\"y\"", "<Float64 declaredType=\"Mode\" name=\"y\"")],
            "is EnumerationType",
        ),
        (
            &ENUMERATION_UNIQUE,
            GOOD2,
            vec![("name=\"on\" value=\"2\"", "name=\"on\" value=\"1\"")],
            "two items with value \"1\"",
        ),
        (
            &ENUMERATION_UNIQUE,
            GOOD3,
            vec![("name=\"on\" value=\"2\"", "name=\"off\" value=\"2\"")],
            "two items with name \"off\"",
        ),
        (
            &ENUMERATION_START,
            GOOD2,
            vec![("declaredType=\"Mode\" start=\"1\"", "declaredType=\"Mode\" start=\"3\"")],
            "1 (off), 2 (on)",
        ),
        // Names.
        (&VARIABLE_NAME, GOOD2, vec![("name=\"q\"", "name=\"\"")], "an empty name"),
        (&VARIABLE_UNIQUE, GOOD2, vec![("name=\"q\"", "name=\"p\"")], "the name of line"),
        (&VARIABLE_UNIQUE, GOOD3, vec![("\"alias.of.u\"", "\"p\"")], "the name of line"),
        (
            &VARIABLE_STRUCTURED,
            GOOD2,
            vec![("name=\"q\"", "name=\"q q\"")],
            "\" q\" at character 2",
        ),
        (&VARIABLE_ARRAY_GAPS, GOOD2, vec![("name=\"a[2]\"", "name=\"a[3]\"")], "no a[2]"),
        (&VARIABLE_DESCRIPTION, GOOD2, vec![("description=\"Gain\"", "")], "1 of 9"),
        // References.
        (
            &VARIABLE_REFERENCE,
            GOOD3,
            vec![
                ("name=\"z\" valueReference=\"16\"", "name=\"z\" valueReference=\"5\""),
                ("<EventIndicator valueReference=\"16\"/>", ""),
            ],
            "value reference 5",
        ),
        (
            &VARIABLE_ALIAS,
            GOOD2,
            vec![
                (
                    "name=\"sAlias\" valueReference=\"12\" causality=\"local\" variability=\"discrete\"",
                    "name=\"sAlias\" valueReference=\"12\" causality=\"local\" variability=\"constant\"",
                ),
                (
                    "<Integer/></ScalarVariable>\n  </ModelVariables>",
                    "<Integer start=\"1\"/></ScalarVariable>\n  </ModelVariables>",
                ),
            ],
            "only one of it and \"s\"",
        ),
        (
            &VARIABLE_ALIAS,
            GOOD2,
            vec![("name=\"p\" valueReference=\"4\"", "name=\"p\" valueReference=\"1\"")],
            "and so can \"u\"",
        ),
        (
            &VARIABLE_ALIAS,
            GOOD2,
            vec![("name=\"a[2]\" valueReference=\"8\"", "name=\"a[2]\" valueReference=\"7\"")],
            "unit \"deg\" as \"a[1]\"",
        ),
        // Causality, variability, initial.
        (
            &VARIABLE_CAUSALITY,
            GOOD2,
            vec![(
                "causality=\"parameter\" variability=\"tunable\"",
                "causality=\"parameter\" variability=\"discrete\"",
            )],
            "parameter and fixed or tunable",
        ),
        (
            &VARIABLE_CAUSALITY,
            GOOD2,
            vec![("causality=\"parameter\" variability=\"tunable\"", "causality=\"parameter\"")],
            "parameter and continuous",
        ),
        (
            &VARIABLE_CAUSALITY,
            GOOD3,
            vec![(
                "causality=\"input\" start=\"1 2 3\"",
                "causality=\"input\" variability=\"fixed\" start=\"1 2 3\"",
            )],
            "input and fixed",
        ),
        (
            &VARIABLE_CONTINUOUS,
            GOOD2,
            vec![(
                "name=\"sAlias\" valueReference=\"12\" causality=\"local\" variability=\"discrete\"",
                "name=\"sAlias\" valueReference=\"12\" causality=\"local\"",
            )],
            "Integer is continuous",
        ),
        (
            &VARIABLE_INITIAL,
            GOOD2,
            vec![(
                "description=\"Input\" causality=\"input\"",
                "description=\"Input\" causality=\"input\" initial=\"exact\"",
            )],
            "no initial",
        ),
        (
            &VARIABLE_INITIAL,
            GOOD3,
            vec![(
                "causality=\"parameter\" variability=\"fixed\" start=\"2\"",
                "causality=\"parameter\" variability=\"fixed\" initial=\"approx\" start=\"2\"",
            )],
            "expected exact",
        ),
        (
            &VARIABLE_INITIAL,
            GOOD2,
            vec![(
                "causality=\"calculatedParameter\" variability=\"fixed\"",
                "causality=\"calculatedParameter\" variability=\"fixed\" initial=\"exact\"",
            )],
            "calculated or approx",
        ),
        (
            &VARIABLE_START,
            GOOD2,
            vec![("<Real min=\"-10\" max=\"10\" start=\"0\"/>", "<Real/>")],
            "no start, but it is input",
        ),
        (
            &VARIABLE_START,
            GOOD2,
            vec![("<Integer start=\"3\"/>", "<Integer/>")],
            "no start, but it is exact",
        ),
        (
            &VARIABLE_START,
            GOOD3,
            vec![("<Start value=\"a\"/>", "")],
            "no start, but it is parameter",
        ),
        (
            &VARIABLE_NO_START,
            GOOD2,
            vec![("<Real unit=\"deg\"/>", "<Real unit=\"deg\" start=\"0\"/>")],
            "but it is calculated",
        ),
        (
            &VARIABLE_NO_START,
            GOOD3,
            vec![("causality=\"independent\"", "causality=\"independent\" start=\"0\"")],
            "but it is independent",
        ),
        (
            &VARIABLE_START_RANGE,
            GOOD2,
            vec![("max=\"10\" start=\"0\"", "max=\"10\" start=\"11\"")],
            "-10 to 10",
        ),
        (
            &VARIABLE_START_RANGE,
            GOOD3,
            vec![("start=\"1 2 3\"", "start=\"1 2 3\" max=\"2\"")],
            "start 3 of element 3",
        ),
        (
            &VARIABLE_START_FINITE,
            GOOD2,
            vec![("<Real start=\"2\" nominal=\"1\"/>", "<Real start=\"NaN\" nominal=\"1\"/>")],
            "a finite number",
        ),
        (
            &VARIABLE_START_COUNT,
            GOOD3,
            vec![("start=\"1 2 3\"", "start=\"1 2\"")],
            "2 start values, expected one, or 3",
        ),
        (
            &VARIABLE_RANGE,
            GOOD2,
            vec![("min=\"-10\" max=\"10\" start=\"0\"", "min=\"10\" max=\"-10\" start=\"0\"")],
            "",
        ),
        (&VARIABLE_NOMINAL, GOOD2, vec![("nominal=\"1\"", "nominal=\"0\"")], "nominal 0"),
        (&VARIABLE_NOMINAL_SIGN, GOOD2, vec![("nominal=\"1\"", "nominal=\"-1\"")], "nominal -1"),
        (
            &VARIABLE_INDEPENDENT,
            GOOD3,
            vec![("<Float64 name=\"time\" valueReference=\"0\" causality=\"independent\"/>", "")],
            "no independent variable",
        ),
        (
            &VARIABLE_INDEPENDENT,
            GOOD2,
            vec![(
                "name=\"sAlias\" valueReference=\"12\" causality=\"local\" variability=\"discrete\"><Integer/>",
                "name=\"sAlias\" valueReference=\"13\" causality=\"independent\"><Real/>",
            )],
            "a second independent variable",
        ),
        (
            &VARIABLE_STRUCTURAL,
            GOOD3,
            vec![(
                "causality=\"structuralParameter\" start=\"3\"/>",
                "causality=\"structuralParameter\" start=\"3\"><Dimension start=\"1\"/></UInt64>",
            )],
            "that is an array",
        ),
        (
            &VARIABLE_STRUCTURAL,
            GOOD3,
            vec![
                (
                    "causality=\"structuralParameter\" start=\"3\"/>",
                    "causality=\"structuralParameter\" start=\"0\"/>",
                ),
                ("start=\"1 2 3\"", "start=\"1\""),
            ],
            "at least 1",
        ),
        (
            &VARIABLE_DIMENSION,
            GOOD3,
            vec![("<Dimension valueReference=\"2\"/>", "<Dimension start=\"0\"/>")],
            "size 0",
        ),
        (
            &VARIABLE_DIMENSION,
            GOOD3,
            vec![("<Dimension valueReference=\"2\"/>", "<Dimension valueReference=\"5\"/>")],
            "given by \"p\" (Float64)",
        ),
        (
            &VARIABLE_SIZE,
            GOOD3,
            vec![
                (
                    "<Dimension valueReference=\"2\"/>",
                    "<Dimension start=\"4294967296\"/><Dimension start=\"4294967296\"/>",
                ),
                ("start=\"1 2 3\"", "start=\"1\""),
            ],
            "at most 16777216",
        ),
        (
            &VARIABLE_DERIVATIVE,
            GOOD3,
            vec![(
                "derivative=\"3\" unit=\"m/s\"><Dimension start=\"2\"/>",
                "derivative=\"3\" unit=\"m/s\"><Dimension start=\"3\"/>",
            )],
            "other dimensions",
        ),
        (
            &VARIABLE_DERIVATIVE,
            GOOD3,
            vec![("<Float64 name=\"z\"", "<Float64 derivative=\"16\" name=\"z\"")],
            "the derivative of itself",
        ),
        (
            &VARIABLE_DERIVATIVE,
            GOOD3,
            vec![("<Float64 name=\"z\"", "<Float64 derivative=\"99\" name=\"z\"")],
            "value reference 99",
        ),
        (
            &VARIABLE_REINIT,
            GOOD2,
            vec![("<Real unit=\"deg\"/>", "<Real unit=\"deg\" reinit=\"true\"/>")],
            "no state",
        ),
        (
            &VARIABLE_MULTIPLE_SET,
            GOOD2,
            vec![("name=\"q\"", "name=\"q\" canHandleMultipleSetPerTimeInstant=\"false\"")],
            "no input",
        ),
        (
            &VARIABLE_INTERMEDIATE,
            GOOD3,
            vec![("<Float64 name=\"p\"", "<Float64 intermediateUpdate=\"true\" name=\"p\"")],
            "of a parameter",
        ),
        (&VARIABLE_PREVIOUS, GOOD3, vec![("previous=\"15\"", "previous=\"14\"")], "of itself"),
        (
            &VARIABLE_PREVIOUS,
            GOOD3,
            vec![("previous=\"15\"", "previous=\"7\"")],
            "which is Enumeration",
        ),
        (
            &VARIABLE_PREVIOUS,
            GOOD3,
            vec![(
                "name=\"state\" valueReference=\"14\" clocks=\"11\"",
                "name=\"state\" valueReference=\"14\"",
            )],
            "isn't clocked",
        ),
        (
            &VARIABLE_CLOCKS,
            GOOD3,
            vec![("clocks=\"11\" initial", "clocks=\"5\" initial")],
            "clock \"p\", which is Float64",
        ),
        (
            &VARIABLE_CLOCKS,
            GOOD3,
            vec![("<Float64 name=\"y\"", "<Float64 clocks=\"11\" name=\"y\"")],
            "that is continuous",
        ),
        // Clocks.
        (
            &CLOCK_CAUSALITY,
            GOOD3,
            vec![
                (
                    "name=\"count\" valueReference=\"12\" causality=\"local\"",
                    "name=\"count\" valueReference=\"12\" causality=\"parameter\"",
                ),
                ("supportsFraction", "description=\"c\" supportsFraction"),
            ],
            "input, output or local",
        ),
        (
            &CLOCK_INTERVAL,
            GOOD3,
            vec![("intervalDecimal=\"0.5\"", "intervalDecimal=\"0\"")],
            "more than 0 s",
        ),
        (&CLOCK_INTERVAL, GOOD3, vec![("intervalDecimal=\"0.5\"", "")], "no interval"),
        (
            &CLOCK_INTERVAL,
            GOOD3,
            vec![("intervalDecimal=\"0.5\"", "intervalDecimal=\"0.5\" shiftDecimal=\"-1\"")],
            "shift -1 s",
        ),
        (
            &CLOCK_FRACTION,
            GOOD3,
            vec![("supportsFraction=\"true\"", "")],
            "without supportsFraction",
        ),
        (&CLOCK_FRACTION, GOOD3, vec![("resolution=\"1000\"", "")], "without resolution"),
        (
            &CLOCK_FRACTION,
            GOOD3,
            vec![("intervalCounter=\"500\"", "intervalCounter=\"0\"")],
            "intervalCounter 0",
        ),
        (
            &CLOCK_PERIODIC,
            GOOD3,
            vec![(
                "intervalVariability=\"triggered\"",
                "intervalVariability=\"triggered\" intervalDecimal=\"1\"",
            )],
            "isn't periodic",
        ),
        (&CLOCK_PRIORITY, GOOD3, vec![("priority=\"1\"", "")], "without priority"),
        (&CLOCK_EVENT_MODE, GOOD3, vec![("hasEventMode=\"true\"", "")], "without hasEventMode"),
        // Structure.
        (
            &STRUCTURE_REFERENCE,
            GOOD2,
            vec![(
                "<Unknown index=\"9\"/>\n    </InitialUnknowns>",
                "<Unknown index=\"9\"/>\n      <Unknown index=\"15\"/>\n    </InitialUnknowns>",
            )],
            "index 15 in the initial unknowns, expected 1 to 14",
        ),
        (
            &STRUCTURE_REFERENCE,
            GOOD3,
            vec![(
                "dependencies=\"1 3 5\" dependenciesKind=\"dependent constant fixed\"",
                "dependencies=\"99\"",
            )],
            "depends on valueReference 99",
        ),
        (
            &STRUCTURE_DUPLICATE,
            GOOD2,
            vec![(
                "<Unknown index=\"11\" dependencies=\"\"/>",
                "<Unknown index=\"11\"/><Unknown index=\"11\"/>",
            )],
            "in the outputs twice",
        ),
        (
            &STRUCTURE_OUTPUTS,
            GOOD2,
            vec![("<Unknown index=\"11\" dependencies=\"\"/>", "")],
            "without \"c\"",
        ),
        (
            &STRUCTURE_OUTPUTS,
            GOOD3,
            vec![(
                "<Output valueReference=\"8\"",
                "<Output valueReference=\"6\"/><Output valueReference=\"8\"",
            )],
            "",
        ),
        (
            &STRUCTURE_OUTPUT_ORDER,
            GOOD3,
            vec![
                ("<Output valueReference=\"3\" dependencies=\"3\"/>", ""),
                (
                    "<ContinuousStateDerivative",
                    "<Output valueReference=\"3\"/><ContinuousStateDerivative",
                ),
            ],
            "\"x\" after",
        ),
        (
            &STRUCTURE_DERIVATIVES,
            GOOD3,
            vec![
                (
                    "<ContinuousStateDerivative valueReference=\"4\" dependencies=\"1\"/>",
                    "<ContinuousStateDerivative valueReference=\"4\" dependencies=\"1\"/><ContinuousStateDerivative valueReference=\"16\"/>",
                ),
                (
                    "<InitialUnknown valueReference=\"8\"/>",
                    "<InitialUnknown valueReference=\"8\"/><InitialUnknown valueReference=\"16\"/>",
                ),
            ],
            "without the attribute derivative",
        ),
        (
            &STRUCTURE_DERIVATIVES,
            GOOD3,
            vec![
                (
                    "<Float64 name=\"z\" valueReference=\"16\"/>",
                    "<Float64 name=\"z\" valueReference=\"16\" derivative=\"3\"><Dimension start=\"2\"/></Float64>",
                ),
                (
                    "<ContinuousStateDerivative valueReference=\"4\" dependencies=\"1\"/>",
                    "<ContinuousStateDerivative valueReference=\"4\" dependencies=\"1\"/><ContinuousStateDerivative valueReference=\"16\"/>",
                ),
                (
                    "<InitialUnknown valueReference=\"8\"/>",
                    "<InitialUnknown valueReference=\"8\"/><InitialUnknown valueReference=\"16\"/>",
                ),
            ],
            "a second derivative of \"x\"",
        ),
        (
            &STRUCTURE_STATE,
            GOOD3,
            vec![(
                "causality=\"output\" initial=\"exact\" declaredType=\"Length\"",
                "causality=\"output\" variability=\"discrete\" initial=\"exact\" declaredType=\"Length\"",
            )],
            "Float64, output, discrete",
        ),
        (
            &STRUCTURE_INITIAL,
            GOOD2,
            vec![("<Unknown index=\"6\" dependencies=\"5\"/>", "")],
            "without \"q\"",
        ),
        (
            &STRUCTURE_INITIAL,
            GOOD2,
            vec![(
                "<Unknown index=\"9\"/>\n    </InitialUnknowns>",
                "<Unknown index=\"9\"/>\n      <Unknown index=\"11\"/>\n    </InitialUnknowns>",
            )],
            "with \"c\"",
        ),
        (
            &STRUCTURE_INITIAL,
            GOOD3,
            vec![("<InitialUnknown valueReference=\"4\" dependencies=\"1 5\"/>", "")],
            "without \"der(x)\"",
        ),
        (
            &STRUCTURE_INITIAL_ORDER,
            GOOD2,
            vec![(
                "<Unknown index=\"6\" dependencies=\"5\"/>\n      <Unknown index=\"8\"/>",
                "<Unknown index=\"8\"/>\n      <Unknown index=\"6\"/>",
            )],
            "index 6 after 8",
        ),
        (
            &STRUCTURE_INDICATORS,
            GOOD3,
            vec![(
                "<EventIndicator valueReference=\"16\"/>",
                "<EventIndicator valueReference=\"5\"/>",
            )],
            "Float64, parameter, fixed",
        ),
        (
            &STRUCTURE_CLOCKED,
            GOOD3,
            vec![("<ClockedState valueReference=\"14\" dependencies=\"1\"/>", "")],
            "without \"state\"",
        ),
        (
            &STRUCTURE_DEPENDENCIES,
            GOOD2,
            vec![(
                "<Unknown index=\"11\" dependencies=\"\"/>",
                "<Unknown index=\"11\" dependencies=\"6\"/>",
            )],
            "depends on \"q\", which is calculatedParameter",
        ),
        (
            &STRUCTURE_DEPENDENCIES,
            GOOD2,
            vec![(
                "<Unknown index=\"6\" dependencies=\"5\"/>",
                "<Unknown index=\"6\" dependencies=\"13\"/>",
            )],
            "what is exact",
        ),
        (
            &STRUCTURE_DEPENDENCIES,
            GOOD3,
            vec![(
                "<ContinuousStateDerivative valueReference=\"4\" dependencies=\"1\"/>",
                "<ContinuousStateDerivative valueReference=\"4\" dependencies=\"8\"/>",
            )],
            "depends on \"y\", which is output",
        ),
        (
            &STRUCTURE_DEPENDENCY_ORDER,
            GOOD2,
            vec![("dependencies=\"2 3\"", "dependencies=\"3 2\"")],
            "ascending",
        ),
        (
            &STRUCTURE_KINDS,
            GOOD2,
            vec![("dependenciesKind=\"constant fixed\"", "dependenciesKind=\"constant\"")],
            "1 kinds of 2 dependencies",
        ),
        (
            &STRUCTURE_KINDS,
            GOOD2,
            vec![(
                "dependenciesKind=\"constant dependent\"",
                "dependenciesKind=\"fixed dependent\"",
            )],
            "the kind fixed in the initial unknowns",
        ),
        (
            &STRUCTURE_KINDS,
            GOOD3,
            vec![(
                "<Output valueReference=\"13\" dependencies=\"14\"",
                "<Output valueReference=\"13\" dependencies=\"14\" dependenciesKind=\"fixed\"",
            )],
            "the kind fixed",
        ),
        (
            &STRUCTURE_KINDS,
            GOOD3,
            vec![(
                "<Output valueReference=\"3\" dependencies=\"3\"",
                "<Output valueReference=\"3\" dependenciesKind=\"fixed\"",
            )],
            "without dependencies",
        ),
    ]
}

#[test]
fn a_change_that_breaks_one_rule_is_found_by_this_rule_alone() {
    let mut wrong = Vec::new();
    for (rule, good, edits, says) in cases() {
        let (ids, findings) = broken(good, &edits);
        let said = findings
            .iter()
            .any(|f| format!("{}: {}, expected {}", f.subject, f.found, f.expected).contains(says));
        if ids != [rule.id] || !said {
            let found: Vec<String> = findings
                .iter()
                .map(|f| {
                    format!("{} {}: {}, expected {}", f.rule.id, f.subject, f.found, f.expected)
                })
                .collect();
            wrong.push(format!("{} by {edits:?}, {says:?}: {found:#?}", rule.id));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Files of an FMU without any finding.
fn files(description: &str) -> Vec<(&'static str, Vec<u8>)> {
    let mut files = vec![
        ("modelDescription.xml", description.as_bytes().to_vec()),
        ("documentation/index.html", b"<html/>".to_vec()),
        ("documentation/licenses/license.txt", b"MIT".to_vec()),
        ("sources/good.c", b"int x;".to_vec()),
        ("terminalsAndIcons/terminalsAndIcons.xml", TERMINALS.as_bytes().to_vec()),
        ("terminalsAndIcons/icon.png", b"png".to_vec()),
        ("terminalsAndIcons/plug.png", b"png".to_vec()),
        ("resources/data.txt", b"1".to_vec()),
    ];
    if description.contains("instantiationToken") {
        files.push(("sources/buildDescription.xml", BUILD.as_bytes().to_vec()));
    }
    files
}

const TERMINALS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiTerminalsAndIcons fmiVersion="3.0">
  <GraphicalRepresentation>
    <CoordinateSystem x1="-100" y1="-100" x2="100" y2="100" suggestedScalingFactorTo_mm="0.1"/>
    <Icon x1="-100" y1="-100" x2="100" y2="100"/>
  </GraphicalRepresentation>
  <Terminals>
    <Terminal name="plug" matchingRule="plug">
      <TerminalMemberVariable variableName="u" memberName="u" variableKind="signal"/>
      <TerminalMemberVariable variableName="x" memberName="x" variableKind="signal"/>
      <Terminal name="inner" matchingRule="sequence">
        <TerminalMemberVariable variableName="mode" variableKind="signal"/>
      </Terminal>
      <TerminalGraphicalRepresentation x1="0" y1="0" x2="1" y2="1" iconBaseName="plug"/>
    </Terminal>
  </Terminals>
</fmiTerminalsAndIcons>"#;

const BUILD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="good">
    <SourceFileSet language="C99"><SourceFile name="good.c"/></SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>"#;

fn packed(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    packed_by(SimpleFileOptions::default(), files)
}

/// Without compression, so that contents can be found in it.
fn stored(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let options = SimpleFileOptions::default();
    packed_by(options.compression_method(zip::CompressionMethod::Stored), files)
}

fn packed_by(options: SimpleFileOptions, files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, contents) in files {
        writer.start_file(*name, options).expect("starts");
        writer.write_all(contents).expect("writes");
    }
    writer.finish().expect("finishes").into_inner()
}

fn survey(bytes: Vec<u8>) -> Report {
    let archive = Archive::survey_bytes("good.fmu", bytes, Limits::DEFAULT).expect("opens");
    check_archive(archive).expect("is checked").report()
}

#[test]
fn good_fmus_have_no_finding() {
    for good in [GOOD2, GOOD3] {
        let report = survey(packed(&files(good)));
        assert!(report.findings.is_empty(), "{:#?}", report.findings);
    }
}

/// A change of the files of an FMU.
enum Change {
    /// Another file.
    Add(&'static str, &'static [u8]),
    /// A file less.
    Remove(&'static str),
    /// A file with another text in it.
    Edit(&'static str, &'static str, &'static str),
}

#[test]
fn a_change_of_a_file_is_found_by_one_rule() {
    use Change::{Add, Edit, Remove};
    use rules::*;
    const ICONS: &str = "terminalsAndIcons/terminalsAndIcons.xml";
    const BUILDS: &str = "sources/buildDescription.xml";
    let cases: Vec<(&Rule, &str, Vec<Change>)> = vec![
        (&FILES_DOCUMENTATION, GOOD2, vec![Remove("documentation/index.html")]),
        (&FILES_LICENCE, GOOD2, vec![Remove("documentation/licenses/license.txt")]),
        (
            &FILES_LICENCE_ENTRY,
            GOOD3,
            vec![
                Remove("documentation/licenses/license.txt"),
                Add("documentation/licenses/MIT", b"MIT"),
            ],
        ),
        (&FILES_UNKNOWN, GOOD3, vec![Add("stuff/x", b"")]),
        (&SOURCES_FILES, GOOD2, vec![Remove("sources/good.c"), Add("sources/other.c", b"")]),
        (&SOURCES_FILES, GOOD3, vec![Remove("sources/good.c")]),
        (&SOURCES_BUILD, GOOD3, vec![Remove(BUILDS)]),
        (&SOURCES_BUILD, GOOD3, vec![Edit(BUILDS, "<SourceFile name=\"good.c\"/>", "")]),
        (&SOURCES_IDENTIFIER, GOOD3, vec![Edit(BUILDS, "\"good\"", "\"bad\"")]),
        (&TERMINALS_READABLE, GOOD3, vec![Edit(ICONS, "matchingRule=\"plug\"", "")]),
        (&TERMINALS_READABLE, GOOD2, vec![Edit(ICONS, "</Terminals>", "")]),
        (&TERMINALS_READABLE, GOOD2, vec![Remove(ICONS)]),
        (&TERMINALS_VERSION, GOOD3, vec![Edit(ICONS, "\"3.0\"", "\"3.1\"")]),
        (&TERMINALS_NAME, GOOD3, vec![Edit(ICONS, "memberName=\"x\"", "memberName=\"u\"")]),
        (&TERMINALS_MEMBER, GOOD3, vec![Edit(ICONS, "memberName=\"x\" ", "")]),
        (
            &TERMINALS_VARIABLE,
            GOOD2,
            vec![Edit(ICONS, "variableName=\"x\"", "variableName=\"xx\"")],
        ),
        (
            &TERMINALS_CAUSALITY,
            GOOD2,
            vec![Edit(ICONS, "variableName=\"x\"", "variableName=\"s\"")],
        ),
        (&TERMINALS_RULE, GOOD2, vec![Edit(ICONS, "\"sequence\"", "\"any\"")]),
        (&TERMINALS_ICON, GOOD2, vec![Remove("terminalsAndIcons/icon.png")]),
        (
            &TERMINALS_ICON,
            GOOD2,
            vec![Edit(ICONS, "iconBaseName=\"plug\"", "iconBaseName=\"../plug\"")],
        ),
        (&TERMINALS_ICON, GOOD2, vec![Remove("terminalsAndIcons/plug.png")]),
        (
            &DESCRIPTION_ENCODING,
            GOOD2,
            vec![Edit("modelDescription.xml", "encoding=\"UTF-8\"", "encoding=\"ISO-8859-1\"")],
        ),
        (&BINARY_NAME, GOOD2, vec![Add("binaries/linux64/bad.so", b"")]),
        (&BINARY_FORMAT, GOOD2, vec![Add("binaries/linux64/good.so", b"no library")]),
        (&BINARY_FOLDER, GOOD3, vec![Add("binaries/sparc-solaris/good.so", b"")]),
    ];
    for (rule, good, changes) in cases {
        let mut files = files(good);
        for change in &changes {
            match change {
                Add(name, contents) => files.push((name, contents.to_vec())),
                Remove(name) => {
                    assert!(files.iter().any(|(other, _)| other == name), "{name}");
                    files.retain(|(other, _)| other != name);
                }
                Edit(name, from, to) => {
                    let file = files.iter_mut().find(|(other, _)| other == name).expect("a file");
                    let text = String::from_utf8(file.1.clone()).expect("text");
                    file.1 = edited(&text, &[(from, to)]).into_bytes();
                }
            }
        }
        let report = survey(packed(&files));
        let found: Vec<&str> = ids(&report.findings)
            .into_iter()
            // Which platform it is on depends on where the test runs.
            .filter(|id| *id != "binary.platform" || rule.id == *id)
            .collect();
        assert_eq!(found, [rule.id], "{:#?}", report.findings);
    }
    let mut files = files(GOOD2);
    files.retain(|(name, _)| !name.starts_with("sources/"));
    let found = ids(&survey(packed(&files)).findings);
    assert_eq!(found, ["files.implementation", "sources.files"]);
}

/// The zip with all places of `from` replaced.
fn patched(mut bytes: Vec<u8>, from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut at = 0;
    while let Some(found) = bytes[at..].windows(from.len()).position(|window| window == from) {
        bytes[at + found..at + found + from.len()].copy_from_slice(to);
        at += found + from.len();
    }
    assert!(at > 0);
    bytes
}

#[test]
fn what_is_wrong_with_an_archive_is_found_and_the_rest_is_checked() {
    let good = packed(&files(GOOD2));
    let finding = |bytes: Vec<u8>| {
        let report = survey(bytes);
        assert_eq!(report.model_name.as_deref(), Some("Good"));
        ids(&report.findings)
    };
    let hostile = patched(good.clone(), b"resources/data.txt", b"../../../data1.txt");
    assert_eq!(finding(hostile), ["archive.name"]);
    let twice = patched(good.clone(), b"terminalsAndIcons/icon.png", b"terminalsAndIcons/plug.png");
    assert_eq!(finding(twice), ["archive.name", "terminals.icon"]);
    // Fields of the directory's last header: version needed, flags.
    let at = (0..good.len() - 4).rev().find(|&at| &good[at..at + 4] == b"PK\x01\x02").expect("one");
    let mut version = good.clone();
    version[at + 6] = 45;
    assert_eq!(finding(version), ["archive.version-needed"]);
    let unmarked = patched(good.clone(), b"resources/data.txt", "resources/dät.txt".as_bytes());
    assert_eq!(finding(unmarked), ["archive.name-encoding"]);
    // A reader that goes by the headers before the entries sees another file.
    let place = good.windows(18).position(|w| w == b"resources/data.txt").expect("the first");
    let mut two_faced = good.clone();
    two_faced[place..place + 18].copy_from_slice(b"resources/evil.txt");
    assert_eq!(finding(two_faced), ["archive.headers"]);
    let mut descriptor = stored(&files(GOOD2));
    let at = (0..descriptor.len() - 4)
        .rev()
        .find(|&at| &descriptor[at..at + 4] == b"PK\x01\x02")
        .expect("one");
    descriptor[at + 8] |= 1 << 3;
    let found = finding(descriptor);
    assert!(found.contains(&"archive.data-descriptor"), "{found:?}");
    // A damaged entry is found when it is read.
    let damaged = patched(stored(&files(GOOD2)), b"iconBaseName", b"iconBaseNine");
    assert_eq!(finding(damaged), ["archive.readable"]);
}

#[test]
fn every_rule_that_a_description_can_break_has_a_case() {
    let tested: BTreeSet<&str> = cases().iter().map(|(rule, ..)| rule.id).collect();
    let elsewhere = ["archive.", "files.", "sources.", "terminals.", "binary.", "load."];
    for rule in RULES {
        let is_here = !elsewhere.iter().any(|start| rule.id.starts_with(start))
            && rule.id != "description.encoding";
        assert!(!is_here || tested.contains(rule.id), "no case breaks {}", rule.id);
    }
}

#[test]
fn units_that_fmi_has_no_exponents_for_are_no_finding() {
    for name in ["rad/s^(3/2)", "deg/sqrt(h)", "kg/kg"] {
        let unit = format!("<Unit name=\"{name}\"/><Unit name=\"m/s\">");
        let (ids, findings) = broken(GOOD2, &[("<Unit name=\"m/s\">", &unit)]);
        assert_eq!(ids, [] as [&str; 0], "{findings:?}");
    }
}

#[test]
fn many_findings_of_a_rule_are_counted() {
    let variables: String = (100..200)
        .map(|i| format!("<ScalarVariable name=\"v{i}\" valueReference=\"{i}\"><Real unit=\"x\"/></ScalarVariable>"))
        .collect();
    let text = edited(GOOD2, &[("</ModelVariables>", &format!("{variables}</ModelVariables>"))]);
    let mut all = files(GOOD2);
    all[0].1 = text.into_bytes();
    let report = survey(packed(&all));
    assert_eq!(report.findings.len(), 25);
    assert_eq!(report.count(Severity::Error), 100);
    assert_eq!(report.more.get("unit.defined"), Some(&75));
    let shown = show::text(&report);
    assert!(shown.contains("unit.defined: 75 more"), "{shown}");
    assert!(shown.ends_with("  100 errors, 0 warnings, 0 notes\n"), "{shown}");
}

#[test]
fn a_finding_says_where_and_why() {
    let mut all = files(GOOD2);
    all[0].1 = edited(GOOD2, &[("max=\"10\" start=\"0\"", "max=\"10\" start=\"11\"")]).into_bytes();
    let report = survey(packed(&all));
    assert_eq!(
        show::text(&report),
        "good.fmu: FMI 2.0, \"Good\", 14 variables\n  \
         error   modelDescription.xml:18 u: start 11, expected -10 to 10 \
         [variable.start-range; FMI 2.0, 2.2.7]\n  \
         1 error, 0 warnings, 0 notes\n"
    );
    let json = serde_json::to_value(&report).expect("is JSON");
    assert_eq!(
        json["findings"][0],
        serde_json::json!({
            "severity": "error",
            "rule": "variable.start-range",
            "entry": "modelDescription.xml",
            "line": 18,
            "subject": "u",
            "found": "start 11",
            "expected": "-10 to 10",
            "clause": "FMI 2.0, 2.2.7",
        })
    );
}

/// Functions of both interfaces of the description of FMI 2.0.
fn all_functions() -> Vec<&'static str> {
    octant_fmi::fmi2::NAMES.to_vec()
}

#[test]
fn a_library_for_windows_is_read() {
    let check = |folder: &str, bytes: Vec<u8>, more: &[(&'static str, Vec<u8>)]| {
        let name = format!("binaries/{folder}/good.dll");
        let mut files: Vec<(&str, Vec<u8>)> = files(GOOD2);
        files.push((&name, bytes));
        files.extend_from_slice(more);
        let report = survey(packed(&files));
        let text: Vec<String> = report
            .findings
            .iter()
            .filter(|finding| finding.rule.id != "binary.platform")
            .map(|finding| format!("{}: {}", finding.rule.id, finding.found))
            .collect();
        (report.binaries, text)
    };
    let all = all_functions();
    let (binaries, found) = check("win64", dll(&all, &["KERNEL32.dll"]), &[]);
    assert_eq!(found, [] as [&str; 0]);
    assert_eq!(
        binaries,
        [Binary {
            entry: "binaries/win64/good.dll".into(),
            format: "Pe".into(),
            architecture: "X86_64".into(),
            functions: all.len(),
            libraries: vec!["KERNEL32.dll".into()],
            glibc: None,
        }]
    );
    let fewer: Vec<&str> =
        all.iter().copied().filter(|name| !matches!(*name, "fmi2DoStep" | "fmi2SetTime")).collect();
    let (_, found) = check("win64", dll(&fewer, &[]), &[]);
    assert_eq!(found, ["binary.symbols: no fmi2SetTime, fmi2DoStep"]);
    let prefixed: Vec<String> = all.iter().map(|name| format!("good_{name}")).collect();
    let prefixed: Vec<&str> = prefixed.iter().map(String::as_str).collect();
    let (_, found) = check("win64", dll(&prefixed, &[]), &[]);
    let expected = "binary.symbols: good_fmi2GetTypesPlatform and others with a prefix, as in a static library";
    assert_eq!(found, [expected]);
    let fewer: Vec<&str> = all.iter().copied().filter(|name| *name != "fmi2CancelStep").collect();
    let (_, found) = check("win64", dll(&fewer, &[]), &[]);
    assert_eq!(found, ["binary.optional-symbols: no fmi2CancelStep"]);
    let (_, found) = check("win32", dll(&all, &[]), &[]);
    assert_eq!(found, ["binary.architecture: Pe for X86_64"]);
    let (_, found) = check("win64", dll(&all, &["VCRUNTIME140.dll", "extra.dll"]), &[]);
    assert_eq!(found, ["binary.libraries: it needs VCRUNTIME140.dll, extra.dll"]);
    let beside = [("binaries/win64/Extra.dll", Vec::new())];
    let (_, found) = check("win64", dll(&all, &["extra.dll"]), &beside);
    assert_eq!(found, [] as [&str; 0]);
}
