//! Claims from data that is looked at while it grows: boundaries and bounds against numbers that were made in another
//! way, and how often a false claim is made, by simulation.
// The printed figures are the purpose of the study.
#![allow(clippy::print_stdout)]

use super::reference::{assert_near, golden_of};
use octant_random::draws::Draws;
use octant_statistics::looks::{
    LookBoundary, open_further_if_all_pass, open_lower_bound, open_upper_bound,
};
use octant_statistics::proportion::{Demand, Needed, success_lower_bound};

const ASKED: Demand = Demand { pass: 0.95, confidence: 0.95 };
const SEED: u64 = 20_261_130;

/// One look is the bound of Clopper and Pearson.
#[test]
fn one_look_is_the_exact_bound() {
    for (pass, confidence) in [(0.95, 0.95), (0.9, 0.9), (0.5, 0.6), (0.99, 0.99)] {
        let demand = Demand { pass, confidence };
        for draws in [7, 10, 58, 59, 93, 200, 1000] {
            let look = LookBoundary::of(demand, &[draws]).looks[0];
            let kept = |failures| success_lower_bound(failures, draws, confidence) >= pass;
            let broken = |failures| demand.is_refuted(failures, draws);
            assert_eq!(look.kept_at_most, (0..=draws).rfind(|f| kept(*f)), "{demand:?} {draws}");
            assert_eq!(look.broken_from, (0..=draws).find(|f| broken(*f)), "{demand:?} {draws}");
        }
    }
}

#[test]
fn boundaries_are_those_of_exact_fractions() {
    for row in golden_of("looks.json")["boundaries"].as_array().unwrap() {
        let number = |name: &str| row[name].as_f64().unwrap();
        let demand = Demand { pass: number("pass"), confidence: number("confidence") };
        let looks = row["looks"].as_array().unwrap();
        let draws: Vec<u64> = looks.iter().map(|look| look["draws"].as_u64().unwrap()).collect();
        let found = LookBoundary::of(demand, &draws);
        assert_eq!(found.looks.len(), looks.len());
        for (found, look) in found.looks.iter().zip(looks) {
            assert_eq!(found.draws, look["draws"].as_u64().unwrap());
            assert_eq!(found.kept_at_most, look["kept_at_most"].as_u64(), "{found:?}");
            assert_eq!(found.broken_from, look["broken_from"].as_u64(), "{found:?}");
            let spent = look["kept_error"].as_f64().unwrap();
            assert!((found.kept_error - spent).abs() < 1e-12, "{found:?}");
            let spent = look["broken_error"].as_f64().unwrap();
            assert!((found.broken_error - spent).abs() < 1e-12, "{found:?}");
        }
    }
}

#[test]
fn open_bounds_are_those_of_an_integral() {
    for row in golden_of("looks.json")["open"].as_array().unwrap() {
        let count = |name: &str| row[name].as_u64().unwrap();
        let (failures, runs) = (count("failures"), count("runs"));
        let confidence = row["confidence"].as_f64().unwrap();
        let lower = row["lower"].as_f64().unwrap();
        assert_near(open_lower_bound(failures, runs, confidence), lower, 1e-9);
        assert_near(1.0 - open_upper_bound(runs - failures, runs, confidence), lower, 1e-9);
        let once = success_lower_bound(failures, runs, confidence);
        assert!(lower < once || failures == runs, "an open bound has a price");
    }
    assert_eq!(
        open_further_if_all_pass(ASKED, 0, 0),
        Needed::Runs(88),
        "59 if it is looked at once"
    );
    assert_eq!((open_lower_bound(0, 0, 0.95), open_lower_bound(3, 3, 0.95)), (0.0, 0.0));
    assert_eq!((open_upper_bound(0, 0, 0.95), open_upper_bound(0, 9, 0.95)), (1.0, 1.0));
}

/// Large numbers of draws, beyond what a factorial can have.
#[test]
fn a_boundary_of_many_draws_spends_what_is_allowed() {
    let found = LookBoundary::of(ASKED, &LookBoundary::equal(100_000, 5));
    for (number, look) in (1..).zip(&found.looks) {
        let allowed = 0.05 * f64::from(number) / 5.0;
        for spent in [look.kept_error, look.broken_error] {
            assert!(spent <= allowed && spent > 0.9 * allowed, "{look:?}");
        }
        let (kept, broken) = (look.kept_at_most.unwrap(), look.broken_from.unwrap());
        assert!(kept < look.draws / 20 && broken > look.draws / 20, "{look:?}");
    }
}

/// Way of looking in the simulation.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// A fixed number of draws, once.
    Once,
    /// The fixed bound, and more draws until it is shown: the way that this replaces.
    UntilShown,
    /// The boundary of several looks.
    Planned(u32),
    /// Each of several looks with its part of the error, as with `[stop]`.
    Shared(u32),
    /// After each draw, by the open bound.
    Open,
}

/// Numbers of failures that decide after each draw, by the open bound.
fn open_boundary(draws: usize) -> LookBoundary {
    let mut looks = LookBoundary::of(ASKED, &(1..=draws as u64).collect::<Vec<_>>());
    let (mut kept, mut broken) = (0, 0);
    for look in &mut looks.looks {
        let runs = look.draws;
        let is_kept = |failures| open_lower_bound(failures, runs, ASKED.confidence) >= ASKED.pass;
        let is_broken = |failures| open_upper_bound(failures, runs, ASKED.confidence) < ASKED.pass;
        kept += u64::from(is_kept(kept + 1));
        look.kept_at_most = is_kept(kept).then_some(kept);
        broken += (broken..=runs).take_while(|failures| !is_broken(*failures)).count() as u64;
        look.broken_from = (broken <= runs).then_some(broken);
        broken = broken.min(runs);
    }
    looks
}

/// Returns whether draws, each of which fails or not, come to "kept" and to "broken".
fn claims(way: Way, failed: &[bool], boundary: &LookBoundary) -> [bool; 2] {
    let mut failures = 0;
    let mut claims = [false; 2];
    let all = failed.len() as u64;
    for (runs, failed) in (1..).zip(failed) {
        failures += u64::from(*failed);
        let at = |confidence: f64| {
            let demand = Demand { confidence, ..ASKED };
            [demand.is_shown(failures, runs), demand.is_refuted(failures, runs)]
        };
        let found = match way {
            Way::Once if runs == all => at(ASKED.confidence),
            // First after 59 draws, then after each further 19.
            Way::UntilShown if runs >= 59 && (runs - 59) % 19 == 0 => at(ASKED.confidence),
            Way::Planned(_) | Way::Open => {
                let look = boundary.looks.iter().find(|look| look.draws == runs);
                look.map_or([false; 2], |look| {
                    [
                        look.kept_at_most.is_some_and(|most| failures <= most),
                        look.broken_from.is_some_and(|from| failures >= from),
                    ]
                })
            }
            Way::Shared(looks) if LookBoundary::equal(all, looks).contains(&runs) => {
                at(1.0 - (1.0 - ASKED.confidence) / f64::from(looks))
            }
            _ => [false; 2],
        };
        claims = [claims[0] || found[0], claims[1] || found[1]];
    }
    claims
}

/// Shares of trials with a claim of "kept" and of "broken", %, if draws pass with a probability.
fn shares(way: Way, draws: usize, passes: f64, trials: u64) -> [f64; 2] {
    let looks = if let Way::Planned(looks) = way { looks } else { 1 };
    let boundary = match way {
        Way::Open => open_boundary(draws),
        _ => LookBoundary::of(ASKED, &LookBoundary::equal(draws as u64, looks)),
    };
    let mut counts = [0_u64; 2];
    for trial in 0..trials {
        let mut numbers = Draws::of(SEED, "looks", trial);
        let failed: Vec<bool> = (0..draws).map(|_| numbers.unit() >= passes).collect();
        for (count, is_made) in counts.iter_mut().zip(claims(way, &failed, &boundary)) {
            *count += u64::from(is_made);
        }
    }
    counts.map(|count| 100.0 * count as f64 / trials as f64)
}

const WAYS: [(&str, Way, bool); 6] = [
    ("once", Way::Once, true),
    ("4 looks", Way::Planned(4), true),
    ("10 looks", Way::Planned(10), true),
    ("[stop], 10 looks", Way::Shared(10), true),
    ("open, after each draw", Way::Open, true),
    ("59 draws, then 19 more until shown", Way::UntilShown, false),
];

/// Prints a table, and checks the errors of each way: at most 5 % where draws pass exactly as often as required, within
/// three standard errors of the study.
fn study(draws: usize, trials: u64) {
    println!(
        "| way of looking | false \"kept\" at 95 %, % | false \"broken\" at 95 %, % | \"kept\" at 99 %, % | \"broken\" at 85 %, % |"
    );
    println!("|---|---|---|---|---|");
    let limit = 5.0 + 300.0 * (0.05 * 0.95 / trials as f64).sqrt();
    for (name, way, holds) in WAYS {
        let [kept, broken] = shares(way, draws, 0.95, trials);
        let [power, _] = shares(way, draws, 0.99, trials);
        let [_, other] = shares(way, draws, 0.85, trials);
        println!("| {name} | {kept:.1} | {broken:.1} | {power:.1} | {other:.1} |");
        assert_eq!(holds, kept <= limit, "{name}: {kept} % false, at most {limit}");
        assert!(!holds || broken <= limit, "{name}: {broken} % false, at most {limit}");
        assert!(power > 2.0 * kept.min(40.0), "{name}: {power}");
    }
}

#[test]
fn false_claims_are_as_rare_as_each_way_says() {
    study(200, 300);
}

#[test]
#[ignore = "the figures of docs/statistics.md: a minute"]
fn study_of_looks() {
    study(200, 20_000);
}
