//! Any requirements survive every format unchanged.

use octant_requirements::mapping::{self, Mapping};
use octant_requirements::{exchange, needs, reqif, sdoc};
use octant_verdict::Comparison;
use octant_verdict::file;
use octant_verdict::requirement::{
    AttributeKind, Check, Definition, EnsembleRequirement, ForeignAttribute, FormattedText, Limit,
    Parent, Requirement, Requirements, Verification,
};
use proptest::collection::vec;
use proptest::option::of as maybe;
use proptest::prelude::*;

/// One line as people write it, without surrounding space.
fn line() -> impl Strategy<Value = String> {
    any_line().prop_filter("it ends a text of StrictDoc", |line| !line.starts_with("<<<"))
}

fn any_line() -> impl Strategy<Value = String> {
    prop_oneof![
        "[A-Za-z0-9µ°§≤<>&\"'\\\\\\[\\]]([ -~µ√é]{0,20}[a-z.;])?",
        Just(">>> is no beginning".to_owned()),
        Just("RELATIONS: none".to_owned()),
        Just("tab\tinside, and  two spaces".to_owned()),
        Just("[REQUIREMENT]".to_owned()),
        Just("]]> &amp; <p>".to_owned()),
    ]
}

/// A line for titles.
fn name() -> impl Strategy<Value = String> {
    line().prop_map(|line| line.replace('\t', " "))
}

fn text() -> impl Strategy<Value = String> {
    // A paragraph in the middle may be empty.
    vec(prop_oneof![4 => line(), 1 => Just(String::new())], 1..4).prop_map(|lines| {
        let text = lines.join("\n").trim().to_owned();
        if text.is_empty() { "x".to_owned() } else { text }
    })
}

fn verification() -> impl Strategy<Value = Verification> {
    let limit = prop_oneof![
        (-1000i32..1000).prop_map(|n| Limit::Number(f64::from(n) / 8.0)),
        prop::num::f64::NORMAL.prop_map(Limit::Number),
        "[0-9]{1,3}(\\.[0-9]{1,2})? (arcmin|deg/h|µg/√Hz|%)".prop_map(Limit::Quantity),
    ];
    let pass = (1u32..1000).prop_map(|n| f64::from(n) / 1000.0);
    let confidence = (500u32..1000).prop_map(|n| f64::from(n) / 1000.0);
    let ensemble = maybe((pass, confidence));
    let comparison = prop::sample::select(Comparison::ALL.to_vec());
    let measure = prop_oneof![
        4 => ("\\|?[a-z_]{1,8}(\\.[a-z_0-9]{1,8}){0,3}", Just(false)),
        1 => (Just("heading.in_motion.repeatability_deg".to_owned()), any::<bool>()),
    ];
    let test = (measure, comparison, limit, ensemble).prop_map(
        |((measure, secant_latitude), comparison, limit, ensemble)| {
            let ensemble =
                ensemble.map(|(pass, confidence)| EnsembleRequirement { pass, confidence });
            Verification::Test(Check { measure, comparison, limit, secant_latitude, ensemble })
        },
    );
    let name = "[a-z/_]{1,12}(\\.rs)?::[a-zµ, :]{0,12}[a-z]";
    let tests = vec(name, 1..4).prop_map(Verification::Tests);
    prop_oneof![
        3 => test,
        1 => tests,
        1 => Just(Verification::Analysis),
        1 => Just(Verification::Inspection)
    ]
}

/// Attributes of other tools, and their values.
fn attributes() -> Vec<(Definition, Vec<Vec<String>>)> {
    let define = |name: &str, kind, values: &[&[&str]]| {
        let values = values.iter().map(|v| v.iter().map(|s| (*s).to_owned()).collect()).collect();
        (Definition { name: name.to_owned(), kind, field: None }, values)
    };
    let options = |all: &[&str]| all.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
    vec![
        define("STATUS", AttributeKind::Text, &[&["Draft"], &["In µ-review"]]),
        define("Owner of it", AttributeKind::Text, &[&["A. Person"]]),
        define(
            "Priority",
            AttributeKind::Choice(options(&["high", "low & slow"])),
            &[&["high"], &["low & slow"]],
        ),
        define(
            "Phases",
            AttributeKind::Choices(options(&["1a", "1b", "2"])),
            &[&["1a", "2"], &["1b"]],
        ),
        define("Effort", AttributeKind::Integer, &[&["-12"]]),
        define("Weight", AttributeKind::Real, &[&["1.5e-3"]]),
        define("Safe", AttributeKind::Boolean, &[&["true"], &["false"]]),
        define("Due", AttributeKind::Date, &[&["2026-01-31T00:00:00Z"]]),
    ]
}

fn requirement(index: usize) -> impl Strategy<Value = Requirement> {
    let names = (maybe(name()), text(), maybe(text()), maybe(text()));
    let place = (
        vec(prop::sample::select(vec!["Navigation", "Drift & more", "1"]), 0..3),
        maybe(Just("SYSTEM_REQUIREMENT".to_owned())),
        any::<bool>(),
    );
    let all = attributes();
    let picks = vec(maybe(any::<prop::sample::Index>()), all.len());
    let parents =
        vec((0..=index, maybe(Just("Refines".to_owned()))), 0..if index == 0 { 1 } else { 3 });
    (names, verification(), place, picks, parents, "[A-Z]{2,4}[-/.: ()]?[0-9]").prop_map(
        move |(
            (title, text, clause, rationale),
            verification,
            (section, kind, mid),
            picks,
            parents,
            id,
        )| {
            let attributes = all
                .iter()
                .zip(picks)
                .filter_map(|((definition, values), pick)| {
                    let values = pick?.get(values).clone();
                    Some(ForeignAttribute { name: definition.name.clone(), values })
                })
                .collect();
            let id = format!("{id}.{index}");
            Requirement {
                title,
                clause,
                rationale,
                // Parents are given by index: the ids are known when all are made.
                parents: parents
                    .into_iter()
                    .map(|(at, role)| Parent { id: at.to_string(), role })
                    .collect(),
                section: section.into_iter().map(str::to_owned).collect(),
                kind,
                identifier: mid.then(|| format!("_{index:032x}")),
                attributes,
                ..Requirement::new(&id, &text, verification)
            }
        },
    )
}

fn requirements() -> impl Strategy<Value = Requirements> {
    let all = (0usize..6).prop_flat_map(|n| (0..n).map(requirement).collect::<Vec<_>>());
    let head = prop::sample::subsequence(
        vec!["VERSION", "DATE", "OPTIONS.MARKUP", "METADATA.Author"],
        0..=4,
    );
    let document = (head, name()).prop_map(|(keys, value)| {
        keys.into_iter().map(|key| (key.to_owned(), value.clone())).collect::<Vec<_>>()
    });
    (name(), document, all).prop_map(|(title, document, mut requirements)| {
        let ids: Vec<String> = requirements.iter().map(|r| r.id.clone()).collect();
        for (at, requirement) in requirements.iter_mut().enumerate() {
            for parent in &mut requirement.parents {
                parent.id = ids[parent.id.parse::<usize>().unwrap()].clone();
            }
            requirement.parents.retain(|parent| parent.id != ids[at]);
            requirement.parents.dedup_by(|a, b| a.id == b.id);
        }
        let definitions = attributes().into_iter().map(|(definition, _)| definition);
        let definitions = definitions.filter(|d| d.kind != AttributeKind::Text).collect();
        Requirements { title, document, definitions, requirements, accounts: Vec::new() }
    })
}

/// Removes definitions that a format doesn't keep, and sorts the rest by name.
fn sorted(mut requirements: Requirements, keep: impl Fn(&Definition) -> bool) -> Requirements {
    let used: Vec<String> = requirements
        .requirements
        .iter()
        .flat_map(|r| r.attributes.iter().map(|a| a.name.clone()))
        .collect();
    requirements.definitions.retain(|d| keep(d) && used.contains(&d.name));
    requirements.definitions.sort_by(|a, b| a.name.cmp(&b.name));
    for requirement in &mut requirements.requirements {
        requirement.attributes.sort_by(|a, b| a.name.cmp(&b.name));
    }
    requirements
}

/// Sorts parents: relations of ReqIF are a set.
fn unordered(mut requirements: Requirements) -> Requirements {
    for requirement in &mut requirements.requirements {
        requirement.parents.sort_by(|a, b| a.id.cmp(&b.id));
    }
    requirements
}

/// Puts requirements below others and formats their texts, which StrictDoc's format doesn't keep.
fn nested(mut requirements: Requirements) -> Requirements {
    for at in 1..requirements.requirements.len() {
        let (before, rest) = requirements.requirements.split_at_mut(at);
        let (above, requirement) = (&before[at - 1], &mut rest[0]);
        if at % 3 > 0 && requirement.section.starts_with(&above.section) {
            requirement.under = Some(above.id.clone());
        }
    }
    for (at, requirement) in requirements.requirements.iter_mut().enumerate().step_by(2) {
        requirement.text = format!("Below {at} µ & <not> more.\n\nIt holds.");
        let xhtml = format!(
            "<p>Below <b class=\"x &quot;y\">{at} µ</b> &amp; &lt;not&gt;\n more.</p><p>It holds.</p>"
        );
        let name = "ReqIF.Text".to_owned();
        requirement.formatted = vec![FormattedText { name, xhtml }];
    }
    requirements
}

/// Names the markup of a document that names none, as StrictDoc's format does.
fn marked(mut requirements: Requirements) -> Requirements {
    let document = &mut requirements.document;
    if !document.iter().any(|(key, _)| key == "OPTIONS.MARKUP") {
        let at = document.iter().position(|(key, _)| key.starts_with("METADATA."));
        let option = ("OPTIONS.MARKUP".to_owned(), "Text".to_owned());
        document.insert(at.unwrap_or(document.len()), option);
    }
    requirements
}

/// A measure and names that reStructuredText would take for markup are escaped in a document of it,
/// and left alone in one of plain text.
#[test]
fn the_escapes_of_a_document_follow_its_markup() {
    let check = Check {
        measure: "|calibration.gyro_x_|".to_owned(),
        comparison: Comparison::AtMost,
        limit: Limit::Number(1.0),
        secant_latitude: false,
        ensemble: None,
    };
    let one = Requirement::new("A-1", "The |drift| is *small*.", Verification::Test(check));
    let mut all = Requirements {
        title: "x".to_owned(),
        document: Vec::new(),
        definitions: Vec::new(),
        requirements: vec![one],
        accounts: Vec::new(),
    };
    let plain = sdoc::write(&all).unwrap();
    assert!(plain.contains("OPTIONS:\n  MARKUP: Text\n"), "{plain}");
    assert!(plain.contains("\nMEASURE: |calibration.gyro_x_|\n"), "{plain}");
    all.document.push(("OPTIONS.MARKUP".to_owned(), "RST".to_owned()));
    let rst = sdoc::write(&all).unwrap();
    assert!(rst.contains("\nSTATEMENT: The |drift| is *small*.\n"), "{rst}");
    assert!(rst.contains("\nMEASURE: \\|calibration.gyro_x\\_\\|\n"), "{rst}");
    // StrictDoc's default is said when a document without the option is read.
    let unsaid = sdoc::read(&rst.replace("OPTIONS:\n  MARKUP: RST\n", ""), "x.sdoc").unwrap();
    assert_eq!(unsaid.requirements, all);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn toml_comes_back_as_it_was(all in requirements().prop_map(nested)) {
        let text = file::write(&all);
        let back = file::read(&text, "test.toml", &exchange::Anything).map_err(|e| format!("{e}\n{text}"));
        prop_assert_eq!(back.unwrap(), all);
    }

    #[test]
    fn sdoc_comes_back_as_it_was(all in requirements()) {
        let text = sdoc::write(&all).unwrap();
        let back = sdoc::read(&text, "test.sdoc").map_err(|e| format!("{e}\n{text}")).unwrap();
        prop_assert_eq!(&back.notes, &[]);
        // StrictDoc knows text and choices, but no numbers and dates.
        let choice = |d: &Definition| d.kind.options().is_some();
        let sent = sorted(marked(all), choice);
        prop_assert_eq!(sorted(back.requirements, choice), sent, "{}", text);
    }

    #[test]
    fn texts_and_measures_full_of_markup_come_back_from_sdoc(
        mut all in requirements(),
        texts in vec("[a-z|*`_\\\\<>:.\\[\\]{}#~^$&-]{1,12}", 12),
        rst in any::<bool>(),
    ) {
        if rst {
            all.document.retain(|(key, _)| key != "OPTIONS.MARKUP");
            let at = all.document.iter().position(|(key, _)| key.starts_with("METADATA"));
            let markup = ("OPTIONS.MARKUP".to_owned(), "RST".to_owned());
            all.document.insert(at.unwrap_or(all.document.len()), markup);
        }
        for (requirement, two) in all.requirements.iter_mut().zip(texts.chunks(2)) {
            requirement.text = format!("a {} b", two[0]);
            match &mut requirement.verification {
                Verification::Test(check) => {
                    // No measure of that name takes the factor.
                    (check.measure, check.secant_latitude) = (format!("|{}|", two[1]), false);
                }
                Verification::Tests(tests) => tests.push(two[1].clone()),
                _ => {}
            }
        }
        let text = sdoc::write(&all).unwrap();
        let back = sdoc::read(&text, "test.sdoc").map_err(|e| format!("{e}\n{text}")).unwrap();
        let choice = |d: &Definition| d.kind.options().is_some();
        let sent = sorted(marked(all), choice);
        prop_assert_eq!(sorted(back.requirements, choice), sent, "{}", text);
    }

    #[test]
    fn reqif_comes_back_as_it_was(all in requirements().prop_map(nested)) {
        let text = reqif::write(&all, "2026-01-31T12:00:00Z").unwrap();
        let back = reqif::read(&text, "test.reqif").map_err(|e| format!("{e}\n{text}")).unwrap();
        prop_assert_eq!(&back.notes, &[]);
        let found = unordered(sorted(back.requirements, |_| true));
        prop_assert_eq!(found, unordered(sorted(all, |_| true)), "{}", text);
    }

    #[test]
    fn needs_come_back_as_they_were(mut all in requirements().prop_map(nested), rst in any::<bool>()) {
        // The file has a place for the version of a document.
        all.document.retain(|(key, _)| key == "VERSION");
        if rst {
            all.document.push(("OPTIONS.MARKUP".to_owned(), "RST".to_owned()));
        }
        all.requirements.iter_mut().for_each(|requirement| requirement.formatted.clear());
        let text = needs::write(&all, "2026-01-31T12:00:00Z").unwrap();
        let usual = Mapping::default();
        let back = needs::read(&text, "needs.json", &usual).map_err(|e| format!("{e}\n{text}")).unwrap();
        prop_assert_eq!(&back.notes, &[]);
        let found = unordered(sorted(back.requirements, |_| true));
        prop_assert_eq!(found, unordered(sorted(all, |_| true)), "{}", text);
    }

    #[test]
    fn any_text_is_read_without_a_panic(text in "\\PC*", lines in vec(line(), 0..20)) {
        let lines = lines.join("\n");
        for text in [&text, &lines, &format!("[DOCUMENT]\nTITLE: x\n\n{lines}")] {
            let _ = sdoc::read(text, "x");
            let _ = reqif::read(text, "x");
            let _ = file::read(text, "x", &exchange::Anything);
            let _ = needs::read(text, "x", &Mapping::default());
            let _ = mapping::read(text, "x");
        }
    }

    #[test]
    fn a_damaged_file_is_read_or_refused(all in requirements(), cut in any::<prop::sample::Index>(), by in any::<char>()) {
        for (text, is_sdoc) in [
            (sdoc::write(&all).unwrap(), true),
            (reqif::write(&all, "2026-01-31T12:00:00Z").unwrap(), false),
        ] {
            let mut chars: Vec<char> = text.chars().collect();
            let at = cut.index(chars.len());
            chars[at] = by;
            let damaged: String = chars.iter().collect();
            let short: String = chars[..at].iter().collect();
            for text in [&damaged, &short] {
                let error = if is_sdoc { sdoc::read(text, "x").err() } else { reqif::read(text, "x").err() };
                if let Some(error) = error {
                    prop_assert!(error.problems[0].line >= 1, "{error}");
                }
            }
        }
    }
}
