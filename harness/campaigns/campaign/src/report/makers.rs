//! Programs that made the results of a campaign: a mixture is a discrepancy, and a self-test is that of one program.

use super::selftest::SelfTest;
use octant_base::number::counted;
use octant_evidence::maker::MadeBy;
use std::collections::BTreeMap;

/// Digits of a hash that are shown.
const DIGITS: usize = 12;

/// Lists what is wrong with the programs that made the results. Hosts and operators are in the manifest alone: shards
/// have several, and the numbers don't depend on them.
pub(super) fn wrong(made_by: &[MadeBy], selftest: Option<&SelfTest>) -> Vec<String> {
    let mut programs: BTreeMap<Option<&str>, u64> = BTreeMap::new();
    for made in made_by {
        let program = made.maker.as_ref().and_then(|maker| maker.program_sha256.as_deref());
        *programs.entry(program).or_default() += made.results;
    }
    let mut found = Vec::new();
    if programs.len() > 1 {
        let each: Vec<String> = programs
            .iter()
            .map(|(program, results)| {
                let results = counted(*results, "result", "results");
                program.map_or_else(
                    || format!("{results} by an unknown one"),
                    |program| format!("{results} by {}", short(program)),
                )
            })
            .collect();
        found.push(format!(
            "the results are by {} programs, of this SHA-256: {}; expected one program",
            programs.len(),
            each.join(", ")
        ));
    }
    // A self-test of an older version doesn't name its program.
    let tested = selftest.and_then(|test| test.program_sha256.as_deref());
    let others: u64 = programs
        .iter()
        .filter(|(program, _)| program.is_some_and(|p| tested.is_some_and(|t| t != p)))
        .map(|(_, n)| n)
        .sum();
    if let (Some(tested), true) = (tested, others > 0) {
        found.push(format!(
            "the self-test is of program {}, and {} by another one",
            short(tested),
            if others == 1 { "1 result is".to_owned() } else { format!("{others} results are") }
        ));
    }
    found
}

fn short(hash: &str) -> &str {
    hash.get(..DIGITS).unwrap_or(hash)
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_evidence::maker::Maker;
    use octant_verdict::Verdict;

    fn made(program: Option<&str>, host: &str, results: u64) -> MadeBy {
        let maker = program.map(|program| Maker {
            program_sha256: Some(program.repeat(32)),
            octant: "0.1.0".into(),
            host: host.into(),
            operator: None,
        });
        MadeBy { maker, results }
    }

    fn tested(program: &str) -> SelfTest {
        SelfTest { verdict: Verdict::Pass, program_sha256: Some(program.repeat(32)), at: None }
    }

    #[test]
    fn one_program_on_several_hosts_is_right() {
        let one = [made(Some("ab"), "a", 3), made(Some("ab"), "b", 5)];
        assert!(wrong(&one, Some(&tested("ab"))).is_empty());
        // Results of before makers were noted.
        assert!(wrong(&[made(None, "", 8)], Some(&tested("ab"))).is_empty());
        assert!(wrong(&[], None).is_empty());
    }

    #[test]
    fn a_mixture_of_programs_and_the_self_test_of_another_one_are_told() {
        let two = [made(None, "", 2), made(Some("ab"), "a", 3), made(Some("cd"), "a", 1)];
        assert_eq!(
            wrong(&two, Some(&tested("ab"))),
            [
                "the results are by 3 programs, of this SHA-256: 2 results by an unknown one, 3 results by abababababab, \
                 1 result by cdcdcdcdcdcd; expected one program",
                "the self-test is of program abababababab, and 1 result is by another one",
            ]
        );
    }
}
