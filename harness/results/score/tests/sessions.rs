//! Two sessions of one unit, and the dither that one of them has.

use octant_score::sessions::{FirstSession, PublishedPair, SessionPoint, Sessions};

const SECONDS: u64 = 400;

/// A pseudo-random number in (−1, 1) for each place.
fn number(seed: u64, place: u64) -> f64 {
    let mut x =
        seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn attitude(turn_rad: [f64; 3]) -> [f64; 4] {
    let half = turn_rad.map(|angle| 0.5 * angle);
    let w = (1.0 - half.iter().map(|a| a * a).sum::<f64>()).sqrt();
    [w, half[0], half[1], half[2]]
}

/// A session of a unit; the answers contain this share of the dither, `own` is added to them.
fn session(dithered: bool, share: f64, own: impl Fn(u64, usize) -> f64) -> Vec<SessionPoint> {
    let mut sums = [[0.0; 3]; 2];
    (1..=SECONDS)
        .map(|second| {
            let mut add = |sum: usize, of: u64, scale: f64| {
                for (i, part) in sums[sum].iter_mut().enumerate() {
                    *part += scale * number(of, 3 * second + i as u64);
                }
                sums[sum]
            };
            let noise = add(0, 1, 2e-7);
            let dither = add(1, 2, if dithered { 7e-9 } else { 0.0 });
            let answer = std::array::from_fn(|i| noise[i] + share * dither[i] + own(second, i));
            SessionPoint { second, q_nb: attitude(answer), position_rad: None, dither_rad: dither }
        })
        .collect()
}

fn compare(faulted: &[SessionPoint], twin: &[SessionPoint]) -> Sessions {
    Sessions::compare(FirstSession::Twin, 33, [faulted, twin], Some(200.0), &[])
}

#[test]
fn an_honest_unit_contains_the_dither_before_a_fault_and_after() {
    let fault = |second: u64, _| if second > 200 { 1e-6 * (second as f64 - 200.0) } else { 0.0 };
    let found = compare(&session(false, 1.0, fault), &session(true, 1.0, |_, _| 0.0));
    for share in [found.before.unwrap(), found.after.unwrap()] {
        assert!((share.share - 1.0).abs() < 0.01 && share.sigma < 0.01, "{share:?}");
    }
    assert_eq!(found.memory(), None);
}

#[test]
fn a_unit_that_repeats_the_other_session_has_a_memory() {
    let faulted = session(false, 1.0, |_, _| 0.0);
    let twin = session(true, 0.0, |_, _| 0.0);
    assert!(compare(&faulted, &twin).memory().unwrap().contains("0.00 ± 0.00"));
    // With jitter of its own.
    let twin = session(true, 0.0, |second, i| 3e-9 * number(7, 3 * second + i as u64));
    let told = compare(&faulted, &twin).memory().unwrap();
    assert!(told.contains("before the first fault"), "{told}");
    // From the fault on.
    let mut later = session(true, 1.0, |_, _| 0.0);
    later.iter_mut().zip(&faulted).skip(200).for_each(|(point, other)| point.q_nb = other.q_nb);
    let told = compare(&faulted, &later).memory().unwrap();
    assert!(told.contains("from the first fault on"), "{told}");
}

#[test]
fn answers_too_coarse_for_the_dither_are_not_tested() {
    let coarse = |points: Vec<SessionPoint>| -> Vec<SessionPoint> {
        let round = |value: f64| (value / 2e-5).round() * 2e-5;
        points.into_iter().map(|p| SessionPoint { q_nb: p.q_nb.map(round), ..p }).collect()
    };
    let drift = |second: u64, _| 1e-6 * second as f64;
    let found = compare(&coarse(session(false, 1.0, drift)), &coarse(session(true, 1.0, drift)));
    assert_eq!((found.before, found.after, found.memory()), (None, None, None));
    // One that never changes isn't either.
    let still = |points: Vec<SessionPoint>| -> Vec<SessionPoint> {
        points.into_iter().map(|p| SessionPoint { q_nb: [1.0, 0.0, 0.0, 0.0], ..p }).collect()
    };
    let found = compare(&still(session(false, 1.0, drift)), &still(session(true, 1.0, drift)));
    assert_eq!(found.before, None);
    // Nor is a short one.
    let (faulted, twin) = (session(false, 1.0, drift), session(true, 1.0, drift));
    assert_eq!(compare(&faulted[..15], &twin[..15]).before, None);
}

#[test]
fn parameters_and_positions_that_are_the_same_to_the_last_bit_are_repeated() {
    let (faulted, twin) = (session(false, 1.0, |_, _| 0.0), session(true, 1.0, |_, _| 0.0));
    let published = |estimates: &[[f64; 2]], sigmas| {
        let pair = |estimates: &[f64; 2]| PublishedPair {
            name: "gyro_bias_x",
            estimates: *estimates,
            sigmas,
        };
        let published: Vec<PublishedPair<'_>> = estimates.iter().map(pair).collect();
        Sessions::compare(FirstSession::Faulted, 33, [&faulted, &twin], None, &published).memory()
    };
    let with = |estimates: &[[f64; 2]]| published(estimates, [1.0, 1.0]);
    let told = published(&[[0.1, 0.2]], [1.0, 1000.0]).unwrap();
    assert!(told.starts_with("the unit states gyro_bias_x with 1000.0 times"), "{told}");
    assert_eq!(published(&[[0.1, 0.2]], [1.0, 0.5]), None, "the fault opens σ");
    let told = with(&[[0.1, 0.1], [0.5, 0.5]]).unwrap();
    assert!(told.starts_with("the parameters of the unit are the same"), "{told}");
    assert_eq!(with(&[[0.1, 0.1], [0.5, 0.500_001]]), None);
    assert_eq!(with(&[[0.25, 0.25], [0.5, 0.5]]), None, "so coarse that they may be the same");
    assert_eq!(with(&[]), None);
    let navigating = |points: &[SessionPoint], moved: f64| -> Vec<SessionPoint> {
        let at = |(place, point): (usize, &SessionPoint)| {
            let latitude = 0.5 + moved * place as f64 + 1e-10 * number(4, place as u64);
            SessionPoint { second: 2 * point.second, position_rad: Some([latitude, 0.1]), ..*point }
        };
        points.iter().enumerate().map(at).collect()
    };
    let one = navigating(&faulted, 0.0);
    let compare = |twin: &[SessionPoint]| {
        Sessions::compare(FirstSession::Twin, 33, [&one, twin], None, &[]).memory()
    };
    assert!(compare(&navigating(&twin, 0.0)).unwrap().starts_with("the positions of the unit"));
    assert_eq!(compare(&navigating(&twin, 1e-13)), None);
}
