//! Rules for every table of variables.

use octant_fmu::table::{DeclaredCausality, ElementType, Model};

/// Checks that every variable is described once, and starts within its range.
pub(crate) fn check(model: &Model) {
    let mut names = std::collections::BTreeSet::new();
    for variable in model.variables {
        let name = variable.name;
        assert!(names.insert(name), "{name} twice");
        assert!(variable.description.ends_with('.'), "{name}");
        let has_start =
            matches!(variable.causality, DeclaredCausality::Parameter | DeclaredCausality::Input);
        assert_eq!(variable.start.is_empty(), !has_start, "{name}");
        assert!(variable.start.len() <= 1 || variable.start.len() == variable.slots(), "{name}");
        for start in variable.start {
            assert!(variable.min.is_none_or(|min| *start >= min), "{name}: {start}");
            assert!(variable.max.is_none_or(|max| *start <= max), "{name}: {start}");
            if let ElementType::Enumeration(of) = variable.kind {
                assert!(of.items.iter().any(|item| f64::from(item.0) == *start), "{name}");
            }
        }
        assert_eq!(model.find(name).unwrap().0, model.slot(name));
    }
    // No name may be a part of another's.
    for name in &names {
        let inner = format!("{name}.");
        assert!(!names.iter().any(|other| other.starts_with(&inner)), "{name}");
    }
}
