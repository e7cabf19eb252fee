//! The list of rules.

use octant_fmu_check::rules::RULES;
use std::collections::BTreeSet;

#[test]
fn ids_are_unique_and_say_where_they_are_from() {
    let ids: BTreeSet<&str> = RULES.iter().map(|rule| rule.id).collect();
    assert_eq!(ids.len(), RULES.len());
    for rule in RULES {
        assert!(!rule.fmi2.is_empty() || !rule.fmi3.is_empty(), "{}", rule.id);
        assert!(rule.says.ends_with('.') && rule.id.contains('.'), "{}", rule.id);
    }
}
