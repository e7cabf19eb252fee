//! Tests of reading and flattening structures, and of the messages for invalid ones.

use octant_cosim::flat::Flat;
use octant_cosim::order::SteppingOrder;
use octant_cosim::ssp::package::Package;
use octant_cosim::ssp::parameters::Transformation;
use octant_cosim::ssp::structure::{Implementation, SystemStructure};
use octant_fmu_host::description::VariableType;
use std::path::Path;

const HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<SystemStructureDescription version="1.0" name="test"
    xmlns="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping">
"#;

/// Makes a package with this structure and some files.
fn package(structure: &str, files: &[(&str, &str)]) -> (tempfile::TempDir, Package) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("resources")).unwrap();
    for name in ["a.fmu", "b.fmu"] {
        std::fs::write(folder.path().join("resources").join(name), "").unwrap();
    }
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let text = format!("{HEAD}{structure}</SystemStructureDescription>");
    std::fs::write(folder.path().join("SystemStructure.ssd"), text).unwrap();
    let package = Package::open(folder.path()).unwrap();
    (folder, package)
}

pub(crate) fn read(
    structure: &str,
    files: &[(&str, &str)],
) -> Result<(SystemStructure, Flat), String> {
    let (folder, package) = package(structure, files);
    let shorter = |error: octant_cosim::ssp::SspError| {
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    let structure = SystemStructure::read(&package).map_err(shorter)?;
    let flat = Flat::of(&structure).map_err(shorter)?;
    Ok((structure, flat))
}

pub(crate) fn component(name: &str, connectors: &str, more: &str) -> String {
    format!(
        r#"<Component name="{name}" source="resources/{name}.fmu">
             <Connectors>{connectors}</Connectors>{more}</Component>"#
    )
}

pub(crate) const IN: &str =
    r#"<Connector name="u" kind="input"><ssc:Real unit="deg"/></Connector>"#;
pub(crate) const OUT: &str =
    r#"<Connector name="y" kind="output"><ssc:Real unit="rad"/></Connector>"#;

/// Builds a system with a and b, and further content after its elements.
fn two(rest: &str) -> String {
    let (a, b) =
        (component("a", &format!("{IN}{OUT}"), ""), component("b", &format!("{IN}{OUT}"), ""));
    format!(r#"<System name="s"><Elements>{a}{b}</Elements>{rest}</System>"#)
}

#[test]
fn a_structure_is_read() {
    let (structure, flat) = read(
        &format!(
            r#"{}
            <Enumerations><ssc:Enumeration name="Mode"><ssc:Item name="on" value="1"/>
            </ssc:Enumeration></Enumerations>
            <Units><ssc:Unit name="deg"><ssc:BaseUnit rad="1" factor="0.5"/></ssc:Unit></Units>
            <DefaultExperiment startTime="1" stopTime="2.5"/>
            <Annotations>
              <ssc:Annotation type="com.vendor"><x:colour xmlns:x="urn:x">blue</x:colour></ssc:Annotation>
              <ssc:Annotation type="octant.co-simulation">
                <CoSimulation xmlns="urn:octant:co-simulation:1" step="5 ms"
                              order="gauss-seidel=b,a" seed="3">
                  <Faults><![CDATA[
[[faults]]
]]></Faults></CoSimulation></ssc:Annotation>
            </Annotations>"#,
            two(r#"<Connections>
                <Connection startElement="a" startConnector="y" endElement="b" endConnector="u"
                            suppressUnitConversion="true">
                  <ssc:LinearTransformation factor="2" offset="-1"/>
                  <ConnectionGeometry pointsX="1 2" pointsY="3 4"/>
                </Connection>
                <Connection startElement="a" startConnector="u" endElement="b" endConnector="y"/>
                </Connections>
                <Annotations><ssc:Annotation type="x"/></Annotations>"#)
        ),
        &[],
    )
    .unwrap();
    assert_eq!(structure.name, "test");
    assert_eq!((structure.start_s, structure.stop_s), (Some(1.0), Some(2.5)));
    assert_eq!(structure.units[0].1.exponents, [0, 0, 0, 0, 0, 0, 0, 1]);
    assert_eq!(structure.enumerations[0].items, [("on".to_owned(), 1)]);
    let ours = &structure.co_simulation;
    assert_eq!((ours.step_s, ours.seed), (Some(0.005), Some(3)));
    assert_eq!(ours.order, Some(SteppingOrder::GaussSeidel(vec!["b".into(), "a".into()])));
    // Line numbers of inline content are those of the file.
    let faults = ours.faults.as_ref().unwrap();
    let line = faults.text.lines().position(|line| line == "[[faults]]").unwrap();
    let file = format!("{HEAD}{}", "");
    assert!(line > file.lines().count());

    assert_eq!(flat.components.len(), 2);
    assert_eq!(flat.components[0].implementation, Implementation::Any);
    let wires: Vec<_> = flat
        .wires
        .iter()
        .map(|w| {
            (w.from.component, w.from.connector.as_str(), w.to.component, w.to.connector.as_str())
        })
        .collect();
    // The direction doesn't depend on which end is the start.
    assert_eq!(wires, [(0, "y", 1, "u"), (1, "y", 0, "u")]);
    let hop = &flat.wires[0].hops[0];
    assert!(hop.suppress_unit_conversion);
    assert_eq!(hop.transformation, Some(Transformation::Linear { factor: 2.0, offset: -1.0 }));
}

#[test]
fn systems_within_systems_are_flattened() {
    let inner = format!(
        r#"<System name="inner">
             <Connectors>
               <Connector name="in" kind="input"><ssc:Real unit="rad"/></Connector>
               <Connector name="out" kind="output"/>
               <Connector name="free" kind="input"/>
             </Connectors>
             <ParameterBindings>
               <ParameterBinding><ParameterValues><ssv:ParameterSet version="1.0" name="p">
                 <ssv:Parameters>
                   <ssv:Parameter name="b.gain"><ssv:Real value="1"/></ssv:Parameter>
                   <ssv:Parameter name="b.name"><ssv:String value="low"/></ssv:Parameter>
                   <ssv:Parameter name="free"><ssv:Real value="7"/></ssv:Parameter>
                 </ssv:Parameters></ssv:ParameterSet></ParameterValues></ParameterBinding>
             </ParameterBindings>
             <Elements>{}</Elements>
             <Connections>
               <Connection startConnector="in" endElement="b" endConnector="u">
                 <ssc:LinearTransformation factor="3"/></Connection>
               <Connection startElement="b" startConnector="y" endConnector="out"/>
               <Connection startConnector="free" endElement="b" endConnector="v"/>
             </Connections></System>"#,
        component("b", &format!("{IN}{OUT}{}", IN.replace("\"u\"", "\"v\"")), "")
    );
    let (_, flat) = read(
        &format!(
            r#"<System name="top">
               <ParameterBindings>
                 <ParameterBinding source="set.ssv" prefix="inner.">
                   <ParameterMapping source="map.ssm"/></ParameterBinding>
               </ParameterBindings>
               <Elements>{}{inner}</Elements>
               <Connections>
                 <Connection startElement="a" startConnector="y" endElement="inner" endConnector="in"/>
                 <Connection startElement="inner" startConnector="out" endElement="a" endConnector="u"/>
               </Connections></System>"#,
            component("a", &format!("{IN}{OUT}"), "")
        ),
        &[
            (
                "set.ssv",
                r#"<ssv:ParameterSet version="1.0" name="p"
                     xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
                     xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
                   <ssv:Parameters>
                     <ssv:Parameter name="g"><ssv:Real value="INF" unit="x"/></ssv:Parameter>
                     <ssv:Parameter name="unmapped"><ssv:Integer value="-3"/></ssv:Parameter>
                   </ssv:Parameters>
                   <ssv:Units><ssc:Unit name="x"><ssc:BaseUnit m="1"/></ssc:Unit></ssv:Units>
                   </ssv:ParameterSet>"#,
            ),
            (
                "map.ssm",
                r#"<ParameterMapping version="1.0"
                     xmlns="http://ssp-standard.org/SSP1/SystemStructureParameterMapping">
                   <MappingEntry source="inner.g" target="inner.b.gain"/>
                   <MappingEntry source="inner.absent" target="inner.b.gain"/>
                   </ParameterMapping>"#,
            ),
        ],
    )
    .unwrap();
    let names: Vec<&str> = flat.components.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["a", "inner.b"]);
    let wires: Vec<_> = flat
        .wires
        .iter()
        .map(|w| (w.from.component, w.to.component, w.to.connector.as_str(), w.hops.len()))
        .collect();
    assert_eq!(wires, [(0, 1, "u", 2), (1, 0, "u", 2)]);
    // The value is converted to the unit of the system's connector, then to that of the input.
    assert_eq!(flat.wires[0].hops[0].unit.as_deref(), Some("rad"));
    assert_eq!(flat.wires[0].hops[1].unit, None);
    let given: Vec<_> = flat.components[1]
        .parameters
        .iter()
        .map(|p| (p.name.as_str(), p.value.kind, p.value.numbers.clone(), p.value.text.as_str()))
        .collect();
    assert_eq!(
        given,
        [
            ("gain", VariableType::Float64, vec![1.0], ""),
            ("name", VariableType::String, vec![], "low"),
            // Values of the outer system come later, and win.
            ("gain", VariableType::Float64, vec![f64::INFINITY], ""),
            // An unconnected input takes the value given to its connector.
            ("v", VariableType::Float64, vec![7.0], ""),
        ]
    );
    assert_eq!(flat.warnings.len(), 2, "{:?}", flat.warnings);
    assert!(flat.warnings[0].contains("\"inner.unmapped\" has no entry"), "{:?}", flat.warnings);
    assert!(flat.warnings[1].contains("no parameter \"inner.absent\""), "{:?}", flat.warnings);
}

#[test]
fn what_is_wrong_is_told_with_file_line_and_element() {
    let connect =
        |attributes: &str| two(&format!("<Connections><Connection {attributes}/></Connections>"));
    let y_to_u = r#"startElement="a" startConnector="y" endElement="b" endConnector="u""#;
    for (structure, expected) in [
        (
            r#"<System name="s"><Elements><SignalDictionaryReference name="d" dictionary="x"/>
               </Elements></System>"#
                .to_owned(),
            "SystemStructure.ssd:7: SignalDictionaryReference \"d\": found the dictionary \"x\", \
             expected one of this system or of those around it",
        ),
        (r#"<System name="s"/>"#.to_owned(), "the system has no FMU"),
        (
            connect(r#"startElement="a" startConnector="y" endElement="c" endConnector="u""#),
            "the element \"c\" isn't there, elements: a, b",
        ),
        (
            connect(r#"startElement="a" startConnector="yy" endElement="b" endConnector="u""#),
            "a has no connector \"yy\", did you mean \"y\"?",
        ),
        (
            connect(r#"startElement="a" startConnector="y" endElement="b" endConnector="y""#),
            "a.y and b.y both give values and none takes",
        ),
        (
            connect(r#"startElement="a" startConnector="u" endElement="b" endConnector="u""#),
            "both take values and none gives",
        ),
        (
            two(&format!(
                "<Connections><Connection {y_to_u}/>\n<Connection {y_to_u}/></Connections>"
            )),
            "b.u gets its values from the connection in line",
        ),
        (connect(&format!("{y_to_u} supressUnitConversion=\"true\"")), "unknown attribute"),
        (connect(&format!("{y_to_u} startIndices=\"1\"")), "unknown attribute \"startIndices\""),
        (
            two(&format!(
                "<Connections><Connection {y_to_u}><ssc:Cubic/></Connection></Connections>"
            )),
            "Cubic: unknown element <Cubic>",
        ),
        (
            two(&format!(
                "<Connections><Connection {y_to_u}><ssc:LinearTransformation factor=\"x\"/>\
                 </Connection></Connections>"
            )),
            "LinearTransformation: factor is \"x\", expected a number",
        ),
        (two("").replace("a.fmu", "../x.fmu"), "leads out of the package"),
        (
            two("").replace("a.fmu", "x.fmu"),
            "Component \"a\": found the source \"resources/x.fmu\"",
        ),
        (two("").replace("name=\"b\"", "name=\"a\""), "the name is taken"),
        (two("").replace("ssc:Real unit=\"deg\"", "ssc:Clock"), "clocks are not part"),
        (two("").replace("kind=\"input\"", "kind=\"inout\""), "the kind \"inout\" was found"),
        (
            two("").replace("source=\"resources/a.fmu\"", "type=\"application/x-ssp-package\""),
            "it has no source: there is no system to be run",
        ),
        (
            two("<Annotations/>")
                + r#"<Annotations><ssc:Annotation type="octant.co-simulation">
                     <CoSimulation xmlns="urn:octant:co-simulation:1" step="5"/>
                     </ssc:Annotation></Annotations>"#,
            "CoSimulation: step is \"5\", expected a time above 0",
        ),
        (
            two("") + "<DefaultExperiment startTime=\"soon\"/>",
            "DefaultExperiment: startTime is \"soon\"",
        ),
    ] {
        let error = read(&structure, &[]).unwrap_err();
        assert!(error.contains(expected), "{expected}: {error}");
        assert!(error.starts_with("SystemStructure.ssd:"), "{error}");
    }
}

#[test]
fn other_versions_and_drafts_are_refused_in_plain_words() {
    let of = |head: &str| {
        let (folder, package) = package("", &[]);
        let text = format!("{head}{}</SystemStructureDescription>", two(""));
        std::fs::write(folder.path().join("SystemStructure.ssd"), text).unwrap();
        SystemStructure::read(&package).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(of(&HEAD.replace("version=\"1.0\" name", "version=\"2.0\" name")), Ok(()));
    let newer = of(&HEAD.replace("version=\"1.0\" name", "version=\"3.0\" name")).unwrap_err();
    assert!(newer.contains("version \"3.0\" was found; this program reads 1.0"), "{newer}");
    let draft = of(&HEAD.replace(
        "http://ssp-standard.org/SSP1/SystemStructureDescription",
        "http://www.pmsf.net/xsd/SystemStructureDescriptionDraft",
    ));
    let draft = draft.unwrap_err();
    assert!(draft.contains("a draft from before SSP 1.0"), "{draft}");
    let broken = of("<SystemStructureDescription").unwrap_err();
    assert!(broken.contains("not XML"), "{broken}");
    assert!(Package::open(Path::new("/nowhere")).is_err());
}

/// OMSimulator writes all of these.
#[test]
fn what_other_tools_write_is_read_with_a_warning_each() {
    let connector = r#"<Connector name="u" kind="input"><ssc:Real unit=""/></Connector>
        <Connector name="v" kind="input"><ssc:Real unit="knots of Mars"/></Connector>"#;
    let values = |name: &str, unit: &str| {
        format!(
            r#"<ParameterBindings><ParameterBinding><ParameterValues>
               <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
               <ssv:Parameter name="{name}"><ssv:Real value="1" unit="{unit}"/></ssv:Parameter>
               </ssv:Parameters></ssv:ParameterSet>
               </ParameterValues></ParameterBinding></ParameterBindings>"#
        )
    };
    let bindings = [values("p", "km/h"), values("q", ""), values("r", "furlong per fortnight")];
    let structure = format!(
        r#"<System name="s"><Connectors><Connector name="in" kind="input"/></Connectors>
           <Elements>{}</Elements><Connections>
           <Connection startElement="" startConnector="in" endElement="a" endConnector="u"/>
           </Connections></System>
           <Units><ssc:Unit name="rad"><ssc:BaseUnit rad="1"/></ssc:Unit></Units>"#,
        component("a", connector, &bindings.concat())
    );
    let (structure, flat) = read(&structure, &[]).unwrap();
    let parameters = &flat.components[0].parameters;
    let units: Vec<Option<&str>> = parameters
        .iter()
        .map(|parameter| parameter.value.unit.as_ref().map(|(name, _)| name.as_str()))
        .collect();
    assert_eq!(units, [Some("km/h"), None, None]);
    let factor = parameters[0].value.unit.as_ref().unwrap().1.factor;
    assert!((factor - 1.0 / 3.6).abs() < 1e-15, "{factor}");
    let connectors = &flat.components[0].connectors;
    assert!(connectors.iter().all(|c| c.of_type.as_ref().unwrap().unit.is_none()));
    let expected = [
        "the unit is empty: it is read as none",
        "the unit \"knots of Mars\" is not defined in this file: it is read as none",
        "ParameterBindings: found once more, expected once: all are read",
        "ParameterBindings: found once more",
        "the unit \"km/h\" is not defined in this file: its common meaning is used",
        "the unit \"furlong per fortnight\" is not defined in this file: it is read as none",
        "Connection: startElement is empty: it is read as left out",
    ];
    assert_eq!(structure.warnings.len(), expected.len(), "{:#?}", structure.warnings);
    for (warning, expected) in structure.warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}: {expected}");
        assert!(warning.contains("SystemStructure.ssd:"), "{warning}");
    }
}

/// An output without a unit.
const PLAIN: &str = r#"<Connector name="y" kind="output"/>"#;

#[test]
fn the_step_of_omsimulator_is_read() {
    let of = |master: &str, around: &str| {
        let (open, close) = match around {
            "" => (String::new(), String::new()),
            name => (format!("<{name}>"), format!("</{name}>")),
        };
        let structure = format!(
            r#"<System name="s" xmlns:oms="https://example.org/oms.xsd"><Elements>{}</Elements>
               <Annotations><ssc:Annotation type="org.openmodelica">{open}
               <oms:SimulationInformation>{master}</oms:SimulationInformation>{close}
               </ssc:Annotation></Annotations></System>"#,
            component("a", PLAIN, "")
        );
        let (structure, _) = read(&structure, &[]).unwrap();
        (structure.others_step_s, structure.warnings)
    };
    let fixed = r#"<oms:FixedStepMaster description="oms-ma" stepSize="0.02"/>"#;
    assert_eq!(of(fixed, "oms:Annotations"), (Some(0.02), Vec::new()));
    // As older versions write it.
    let old = r#"<FixedStepMaster description="oms-ma" stepSize="0.001000"/>"#;
    assert_eq!(of(old, "").0, Some(0.001));
    let solver = r#"<oms:VariableStepSolver description="cvode" maximumStepSize="0.1"/>"#;
    let (step_s, warnings) = of(solver, "oms:Annotations");
    assert_eq!((step_s, warnings.len()), (Some(0.1), 1));
    assert!(warnings[0].contains("varies its step up to 0.1 s"), "{warnings:?}");
}

#[test]
fn a_prefix_that_is_not_declared_is_the_usual_one() {
    let set = r#"<ssv:ParameterSet version="1.0" name="p">
        <ssv:Parameters><ssv:Parameter name="p"><ssv:Real value="2"/></ssv:Parameter></ssv:Parameters>
        </ssv:ParameterSet>"#;
    let bound = r#"<ParameterBindings><ParameterBinding source="p.ssv"/></ParameterBindings>"#;
    let structure = format!(
        r#"<System name="s"><Elements>{}</Elements></System>"#,
        component("a", PLAIN, bound)
    );
    let (structure, flat) = read(&structure, &[("p.ssv", set)]).unwrap();
    assert_eq!(flat.components[0].parameters[0].value.numbers, [2.0]);
    assert_eq!(structure.warnings.len(), 1);
    let found = &structure.warnings[0];
    assert!(
        found.contains("p.ssv:1") && found.contains("the prefix ssv isn't declared"),
        "{found}"
    );
}

#[test]
fn units_of_the_structure_are_those_of_its_inline_parameters() {
    let inline = r#"<ParameterBindings><ParameterBinding><ParameterValues>
        <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
        <ssv:Parameter name="p"><ssv:Real value="1" unit="furlong"/></ssv:Parameter>
        </ssv:Parameters></ssv:ParameterSet>
        </ParameterValues></ParameterBinding></ParameterBindings>"#;
    let structure = format!(
        r#"<System name="s"><Elements>{}</Elements></System>
           <Units><ssc:Unit name="furlong"><ssc:BaseUnit m="1" factor="201.168"/></ssc:Unit></Units>"#,
        component("a", PLAIN, inline)
    );
    let (structure, flat) = read(&structure, &[]).unwrap();
    let unit = flat.components[0].parameters[0].value.unit.clone().unwrap();
    assert_eq!((unit.0.as_str(), unit.1.factor), ("furlong", 201.168));
    assert!(structure.warnings.is_empty(), "{:?}", structure.warnings);
}

#[test]
fn a_component_may_be_a_structure_of_its_own() {
    let inner = |unit: &str| {
        format!(
            r#"{HEAD}<System name="whatever"><Connectors>
               <Connector name="angle" kind="output"/></Connectors>
               <Elements>{}</Elements><Connections>
               <Connection startElement="b" startConnector="y" endConnector="angle"/>
               </Connections></System>
               <Units><ssc:Unit name="turn"><ssc:BaseUnit {unit}/></ssc:Unit></Units>
               </SystemStructureDescription>"#,
            component("b", OUT, "")
        )
    };
    let outer = |connector: &str| {
        format!(
            r#"<System name="s"><Elements>{}
               <Component name="part" type="application/x-ssp-definition" source="part.ssd">
               <Connectors><Connector name="{connector}" kind="output"/></Connectors></Component>
               </Elements><Connections>
               <Connection startElement="part" startConnector="angle" endElement="a" endConnector="u"/>
               </Connections></System>
               <Units><ssc:Unit name="turn"><ssc:BaseUnit rad="1" factor="6.25"/></ssc:Unit></Units>"#,
            component("a", IN, "")
        )
    };
    let good = inner(r#"rad="1" factor="6.25""#);
    let (_, flat) = read(&outer("angle"), &[("part.ssd", &good)]).unwrap();
    let names: Vec<&str> = flat.components.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["a", "part.b"]);
    assert_eq!((flat.wires[0].from.connector.as_str(), flat.wires.len()), ("y", 1));
    for (structure, part, expected) in [
        (
            outer("angel"),
            &good,
            "it has the connector \"angel\", which the system in part.ssd doesn't",
        ),
        (outer("angle"), &inner(r#"rad="1""#), "the unit \"turn\" has another meaning"),
    ] {
        let error = read(&structure, &[("part.ssd", part)]).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}
