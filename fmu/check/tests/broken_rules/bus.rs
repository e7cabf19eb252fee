//! Each rule of FMI-LS-BUS is broken by a change of an FMU on a bus that breaks no other rule.

use super::{edited, ids, packed, survey};
use octant_fmu_check::rules::*;

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Node" instantiationToken="{1}">
  <CoSimulation modelIdentifier="good" hasEventMode="true" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Clock name="rx.clock" valueReference="1" causality="input" intervalVariability="triggered" description="d"/>
    <Binary name="rx" valueReference="2" causality="input" clocks="1" mimeType="application/org.fmi-standard.fmi-ls-bus.can; version=&quot;1.0.0&quot;" description="d"><Start value=""/></Binary>
    <Clock name="tx.clock" valueReference="3" causality="input" intervalVariability="countdown" description="d"/>
    <Binary name="tx" valueReference="4" causality="output" clocks="3" mimeType="application/org.fmi-standard.fmi-ls-bus.can; version=&quot;1.0.0&quot;" description="d"/>
    <Boolean name="notify" valueReference="5" causality="parameter" variability="fixed" start="false" description="d"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="4"/></ModelStructure>
</fmiModelDescription>"#;

const TERMINALS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals>
  <Terminal name="can" terminalKind="org.fmi-ls-bus.network-terminal" matchingRule="org.fmi-ls-bus.transceiver">
    <TerminalMemberVariable variableName="rx.clock" memberName="Rx_Clock" variableKind="signal"/>
    <TerminalMemberVariable variableName="rx" memberName="Rx_Data" variableKind="signal"/>
    <TerminalMemberVariable variableName="tx.clock" memberName="Tx_Clock" variableKind="signal"/>
    <TerminalMemberVariable variableName="tx" memberName="Tx_Data" variableKind="signal"/>
    <Terminal name="Configuration" terminalKind="org.fmi-ls-bus.network-terminal.configuration" matchingRule="bus">
      <TerminalMemberVariable variableName="notify" memberName="BusNotifications" variableKind="signal"/>
    </Terminal>
  </Terminal>
</Terminals></fmiTerminalsAndIcons>"#;

const MANIFEST: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiLayeredStandardManifest xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"
  fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-bus" fmi-ls:fmi-ls-version="1.0.0"
  fmi-ls:fmi-ls-description="Buses" isBusSimulationFMU="false"/>"#;

const ENTRY: &str = "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml";
const DESCRIBED: usize = 0;
const TERMINAL: usize = 1;
const MANIFESTED: usize = 2;

fn files() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("modelDescription.xml", DESCRIPTION.into()),
        ("terminalsAndIcons/terminalsAndIcons.xml", TERMINALS.into()),
        (ENTRY, MANIFEST.into()),
        ("documentation/index.html", b"<html/>".to_vec()),
        ("documentation/licenses/license.txt", b"MIT".to_vec()),
        ("sources/good.c", b"int x;".to_vec()),
        ("sources/buildDescription.xml", super::BUILD.into()),
    ]
}

#[test]
fn a_good_node_has_no_finding() {
    let report = survey(packed(&files()));
    assert!(report.findings.is_empty(), "{:#?}", report.findings);
}

#[test]
fn the_root_of_a_manifest_has_any_name_and_any_content() {
    let mut files = files();
    let edits = [
        ("fmiLayeredStandardManifest xmlns", r#"bus:Node xmlns:bus="urn:bus" xmlns"#),
        (r#""false"/>"#, r#""false"><bus:Speed>500</bus:Speed></bus:Node>"#),
    ];
    files[MANIFESTED].1 = edited(MANIFEST, &edits).into_bytes();
    // A standard that isn't known here has the folder that it mandates.
    let other = r#"<other m:fmi-ls-name="org.other" m:fmi-ls-version="1" m:fmi-ls-description="d"
        xmlns:m="http://fmi-standard.org/fmi-ls-manifest"/>"#;
    files.push(("extra/org.other.folder/fmi-ls-manifest.xml", other.into()));
    let report = survey(packed(&files));
    assert!(report.findings.is_empty(), "{:#?}", report.findings);
    // It is still that of the bus: its other rules apply.
    files[TERMINAL].1 = edited(TERMINALS, &[(r#""Rx_Data""#, r#""Rx""#)]).into_bytes();
    assert_eq!(ids(&survey(packed(&files)).findings), ["bus.members"]);
    let mut moved = self::files();
    moved[MANIFESTED].0 = "extra/bus/fmi-ls-manifest.xml";
    assert_eq!(ids(&survey(packed(&moved)).findings), ["bus.manifest"]);
}

/// Rule, file, original text and replacement.
type Case = (&'static Rule, usize, &'static str, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    (&LAYERED_MANIFEST, MANIFESTED, r#"fmi-ls:fmi-ls-description="Buses""#, ""),
    (&LAYERED_MANIFEST, MANIFESTED, r#"fmi-ls:fmi-ls-version="1.0.0""#, r#"fmi-ls-version="1.0.0""#),
    (&LAYERED_MANIFEST, MANIFESTED, r#""false"/>"#, r#""false">"#),
    (&BUS_VERSION, MANIFESTED, r#""1.0.0""#, r#""1.1.0""#),
    (&BUS_MANIFEST, MANIFESTED, r#""false""#, r#""no""#),
    (&BUS_MANIFEST, TERMINAL, r#"terminalKind="org.fmi-ls-bus.network-terminal" "#, ""),
    (&BUS_EVENT_MODE, DESCRIBED, r#"hasEventMode="true" "#, ""),
    (&BUS_MEMBERS, TERMINAL, r#""org.fmi-ls-bus.transceiver""#, r#""org.other""#),
    (&BUS_MEMBERS, TERMINAL, r#""Rx_Data""#, r#""Rx""#),
    (&BUS_MEMBERS, TERMINAL, r#"memberName="Tx_Data" variableKind="signal""#, r#"memberName="Tx_Data" variableKind="org.other""#),
    (&BUS_VARIABLES, DESCRIBED, r#"intervalVariability="triggered""#, r#"intervalVariability="countdown""#),
    (&BUS_VARIABLES, DESCRIBED, r#"intervalVariability="countdown""#, r#"intervalVariability="triggered""#),
    (&BUS_VARIABLES, DESCRIBED, r#"clocks="3""#, r#"clocks="1""#),
    (&BUS_VARIABLES, DESCRIBED, r#"<Boolean name="notify""#, r#"<Binary name="spare" valueReference="9" causality="local" clocks="1" mimeType="x"/><Boolean name="notify""#),
    (&BUS_MIME_TYPE, DESCRIBED, r#"clocks="3" mimeType="application/org.fmi-standard.fmi-ls-bus.can;"#, r#"clocks="3" mimeType="application/org.fmi-standard.fmi-ls-bus.lin;"#),
    (&BUS_MIME_TYPE, DESCRIBED, r#"clocks="1" mimeType="application/org.fmi-standard.fmi-ls-bus.can;"#, r#"clocks="1" mimeType="text;"#),
    (&BUS_STEP, DESCRIBED, r#" canHandleVariableCommunicationStepSize="true""#, ""),
    (&BUS_CONFIGURATION, TERMINAL, r#"name="Configuration""#, r#"name="Setup""#),
    (&BUS_NOTIFICATIONS, DESCRIBED, r#"start="false""#, r#"start="true""#),
    (&BUS_NOTIFICATIONS, DESCRIBED, r#"variability="fixed" start"#, r#"variability="tunable" start"#),
    (&BUS_NOTIFICATIONS, MANIFESTED, r#"FMU="false""#, r#"FMU="true""#),
];

#[test]
fn a_change_of_a_node_is_found_by_one_rule() {
    for (rule, file, from, to) in CASES {
        let mut files = files();
        let text = String::from_utf8(files[*file].1.clone()).expect("text");
        files[*file].1 = edited(&text, &[(from, to)]).into_bytes();
        if std::ptr::eq(*rule, &BUS_VARIABLES) && to.contains("spare") {
            // A binary variable outside of the bus takes the place of the one of the bus.
            let text = String::from_utf8(files[TERMINAL].1.clone()).expect("text");
            let edit = [(r#"variableName="tx" "#, r#"variableName="spare" "#)];
            files[TERMINAL].1 = edited(&text, &edit).into_bytes();
        }
        let report = survey(packed(&files));
        let found = ids(&report.findings);
        assert!(found.contains(&rule.id), "{} by {to:?}: {:#?}", rule.id, report.findings);
        // Without its manifest, with the wrong variable or without terminal, other rules are broken
        // too.
        let others = ["bus.", "layered.", "terminals.", "clock."];
        assert!(
            found.iter().all(|id| others.iter().any(|other| id.starts_with(other))),
            "{} by {to:?}: {:#?}",
            rule.id,
            report.findings
        );
    }
    let mut files = files();
    files.remove(MANIFESTED);
    assert_eq!(ids(&survey(packed(&files)).findings), ["bus.manifest"]);
    let every: std::collections::BTreeSet<&str> = CASES.iter().map(|case| case.0.id).collect();
    for rule in RULES.iter().filter(|rule| rule.id.starts_with("bus.")) {
        assert!(every.contains(rule.id), "no case breaks {}", rule.id);
    }
}
