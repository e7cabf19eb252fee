//! `terminalsAndIcons/terminalsAndIcons.xml` of FMI 3.0, used in FMUs of FMI 2.0 too.

use super::finding::{Findings, Place};
use super::model::Model;
use super::rules::{
    TERMINALS_CAUSALITY, TERMINALS_ICON, TERMINALS_MEMBER, TERMINALS_NAME, TERMINALS_RULE,
    TERMINALS_VARIABLE, TERMINALS_VERSION,
};
use octant_fmu_host::description::Causality;
use octant_fmu_host::description::xml::Element;
use std::collections::BTreeSet;

/// Path in the FMU.
pub(super) const FILE: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// Largest depth of nested terminals that is checked.
const DEPTH_MAX: usize = 32;

/// Checks terminals and icons; `has` tells whether the FMU has a file.
pub(super) fn check(
    model: &Model<'_, '_>,
    root: Element<'_, '_>,
    has: &dyn Fn(&str) -> bool,
    findings: &mut Findings,
) {
    let place = Place { entry: FILE, line: Some(root.line()), subject: "" };
    let version = root.text("fmiVersion").unwrap_or_default();
    let wrong = match model.is_fmi2() {
        // The file was made for 3.0, and has its version.
        true => !version.starts_with('3'),
        false => version != model.description.fmi_version,
    };
    if wrong {
        let expected = match model.is_fmi2() {
            true => "the version of FMI 3 that defines the file",
            false => &model.description.fmi_version,
        };
        findings.add(&TERMINALS_VERSION, place, format!("version {version:?}"), expected);
    }
    let graphic = root.child("GraphicalRepresentation");
    let has_icon = graphic.is_some_and(|graphic| graphic.child("Icon").is_some());
    // A drawing accompanies a picture, which has to exist as well.
    if has_icon || has("terminalsAndIcons/icon.svg") {
        icon(place, "icon", has, findings);
    }
    if let Some(list) = root.child("Terminals") {
        level(model, list, has, 0, findings);
    }
}

/// Checks the terminals of a level.
fn level(
    model: &Model<'_, '_>,
    list: Element<'_, '_>,
    has: &dyn Fn(&str) -> bool,
    depth: usize,
    findings: &mut Findings,
) {
    let mut names = BTreeSet::new();
    for terminal in list.children().filter(|child| child.name() == "Terminal") {
        let name = terminal.text("name").unwrap_or_default();
        let place = Place { entry: FILE, line: Some(terminal.line()), subject: name };
        if !names.insert(name) {
            findings.add(&TERMINALS_NAME, place, "the terminal is there twice", "one of each name");
        }
        members(model, terminal, place, findings);
        if let Some(graphic) = terminal.child("TerminalGraphicalRepresentation")
            && let Some(base) = graphic.text("iconBaseName")
        {
            icon(place, base, has, findings);
        }
        if depth < DEPTH_MAX {
            level(model, terminal, has, depth + 1, findings);
        }
    }
}

fn members(
    model: &Model<'_, '_>,
    terminal: Element<'_, '_>,
    place: Place<'_>,
    findings: &mut Findings,
) {
    let rule = terminal.text("matchingRule").unwrap_or_default();
    // The name of a domain contains a dot.
    if !matches!(rule, "plug" | "bus" | "sequence" | "") && !rule.contains('.') {
        let found = format!("matching rule {rule:?}");
        findings.add(&TERMINALS_RULE, place, found, "plug, bus, sequence, or com.example.rule");
    }
    let mut names = BTreeSet::new();
    for member in terminal.children() {
        let place = Place { line: Some(member.line()), ..place };
        let pairs: &[(&str, &str)] = match member.name() {
            "TerminalMemberVariable" => &[("variableName", "memberName")],
            "TerminalStreamMemberVariable" => &[
                ("inStreamVariableName", "inStreamMemberName"),
                ("outStreamVariableName", "outStreamMemberName"),
            ],
            _ => continue,
        };
        for (variable, member_name) in pairs {
            if let Some(name) = member.text(member_name) {
                if !names.insert(name) {
                    let found = format!("two members {name:?}");
                    findings.add(&TERMINALS_NAME, place, found, "one of each name");
                }
            } else if matches!(rule, "plug" | "bus") {
                let found = format!("a member without memberName in a terminal matched as {rule}");
                findings.add(&TERMINALS_MEMBER, place, found, "memberName");
            }
            let Some(name) = member.text(variable) else { continue };
            let Some(&index) = model.by_name.get(name) else {
                let found = format!("{variable} {name:?}, which no variable has");
                findings.add(&TERMINALS_VARIABLE, place, found, "the name of a variable");
                continue;
            };
            let causality = model.variables[index].variable.causality;
            let kind = member.text("variableKind");
            let is_restricted =
                kind.is_none_or(|kind| matches!(kind, "signal" | "inflow" | "outflow"));
            if is_restricted
                && !matches!(
                    causality,
                    Causality::Input
                        | Causality::Output
                        | Causality::Parameter
                        | Causality::CalculatedParameter
                )
            {
                let found = format!("{name:?}, which is {}", causality.name());
                findings.add(
                    &TERMINALS_CAUSALITY,
                    place,
                    found,
                    "an input, an output or a parameter",
                );
            }
        }
    }
}

/// Checks a picture: `base.png`, with or without `base.svg`.
fn icon(place: Place<'_>, base: &str, has: &dyn Fn(&str) -> bool, findings: &mut Findings) {
    let name = format!("{base}.png");
    // The name is a URI: a scheme, a root and a step up lead out of the folder.
    if base.starts_with('/') || base.contains(':') || base.split('/').any(|part| part == "..") {
        let found = format!("icon {base:?}");
        findings.add(&TERMINALS_ICON, place, found, "a file in terminalsAndIcons/");
    } else if !has(&format!("terminalsAndIcons/{}", name.trim_start_matches("./"))) {
        let found = format!("no terminalsAndIcons/{name}");
        findings.add(&TERMINALS_ICON, place, found, "the file");
    }
}
