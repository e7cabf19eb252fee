//! Maxima are over every answer, as of errors that are computed one by one.

use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, DEG, NAUTICAL_MILE_M};
use octant_score::attitude::CaseAngles;
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::every_answer::{AnsweredSolution, StandingTruth};
use octant_score::summary::HeightChannel;

const LATITUDE: f64 = 30.5 * DEG;
const SECOND_NS: u64 = 1_000_000_000;

/// Numbers that look like noise, within ±1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn right() -> AnsweredSolution {
    let (s, c) = (0.4f64.sin(), 0.4f64.cos());
    AnsweredSolution {
        latitude_rad: LATITUDE,
        longitude_rad: 1.0,
        velocity_mps: [0.0; 2],
        q_nb: [c, 0.6 * s, 0.0, 0.8 * s],
    }
}

const GIMBAL_RAD: [f64; 2] = [0.3, -1.1];

/// Turns an attitude by small angles about its own axes.
fn turned([w, x, y, z]: [f64; 4], [a, b, c]: [f64; 3]) -> [f64; 4] {
    let half = 0.5 * (a * a + b * b + c * c).sqrt();
    let scale = if half > 0.0 { 0.5 * half.sin() / half } else { 0.5 };
    let (rw, rx, ry, rz) = (half.cos(), scale * a, scale * b, scale * c);
    [
        w * rw - x * rx - y * ry - z * rz,
        w * rx + x * rw + y * rz - z * ry,
        w * ry - x * rz + y * rw + z * rx,
        w * rz + x * ry - y * rx + z * rw,
    ]
}

fn push(scorer: &mut DriftScorer, t_ns: u64, answer: &AnsweredSolution) {
    let right = right();
    let velocity: [f64; 2] =
        std::array::from_fn(|i| answer.velocity_mps[i] - right.velocity_mps[i]);
    scorer.push(&DriftSample {
        t_s: t_ns as f64 * 1e-9,
        position_error_rad: Some([
            answer.latitude_rad - right.latitude_rad,
            answer.longitude_rad - right.longitude_rad,
        ]),
        attitude_error: Some(CaseAngles::error(answer.q_nb, right.q_nb, GIMBAL_RAD)),
        velocity_error_mps: Some(velocity),
        latitude_rad: right.latitude_rad,
        height_m: 50.0,
    });
    scorer.stand(Some(StandingTruth::new(&right, 50.0, GIMBAL_RAD)));
}

#[test]
fn largest_errors_are_those_of_every_answer() {
    for size in [1e-9, 1e-6, 1e-3, 0.5] {
        let mut noise = Noise(7);
        let mut scorer = DriftScorer::new();
        let mut largest = [0.0f64; 8];
        let mut answer = right();
        let earth = Ellipsoid::at(LATITUDE, 50.0);
        for k in 0..20_000u64 {
            // A random walk, with an excursion now and then.
            let mut angles = [(); 3].map(|()| 0.05 * size * noise.next());
            if k % 977 == 500 {
                angles = angles.map(|angle| 20.0 * angle);
            }
            answer.q_nb = turned(answer.q_nb, angles).map(|q| if k % 3 == 0 { -q } else { q });
            answer.latitude_rad += 0.01 * size * noise.next();
            answer.longitude_rad += 0.01 * size * noise.next();
            answer.velocity_mps = [size * noise.next(), size * noise.next()];
            let right = right();
            let attitude = CaseAngles::error(answer.q_nb, right.q_nb, GIMBAL_RAD);
            let north_m = (answer.latitude_rad - LATITUDE) * earth.meridian_radius_m;
            let east_m =
                (answer.longitude_rad - 1.0) * earth.transverse_radius_m * earth.cos_latitude;
            let all = [
                (answer.latitude_rad - LATITUDE) / ARCMIN,
                (answer.longitude_rad - 1.0) / ARCMIN,
                attitude.heading_rad / ARCMIN,
                attitude.pitch_rad / ARCMIN,
                attitude.roll_rad / ARCMIN,
                answer.velocity_mps[0],
                answer.velocity_mps[1],
                (north_m * north_m + east_m * east_m).sqrt() / NAUTICAL_MILE_M,
            ];
            for (largest, error) in largest.iter_mut().zip(all) {
                *largest = largest.max(error.abs());
            }
            if k % 200 == 0 {
                push(&mut scorer, k * 5_000_000, &answer);
            } else {
                scorer.between(k * 5_000_000, &answer);
            }
        }
        let score = scorer.finish(HeightChannel::Held).unwrap();
        let mut found: Vec<f64> =
            score.errors().into_iter().map(|(_, _, error)| error.unwrap().max).collect();
        found.push(score.radial_error_nmi.unwrap().max);
        for (found, expected) in found.into_iter().zip(largest) {
            // Slopes order attitudes that are close to each other within 1e-9 of a turn of 1e-5.
            assert!((found - expected).abs() <= 1e-9 * expected, "{size}: {found}, {expected}");
        }
    }
}

#[test]
fn answers_after_a_mark_are_not_in_it() {
    let hour = 3600 * SECOND_NS;
    let mut scorer = DriftScorer::new();
    let off =
        |latitude: f64| AnsweredSolution { latitude_rad: LATITUDE + latitude * ARCMIN, ..right() };
    push(&mut scorer, 0, &off(0.0));
    let before = 24 * hour - SECOND_NS / 2;
    push(&mut scorer, before, &off(0.1));
    scorer.between(24 * hour - SECOND_NS / 4, &off(2.0));
    scorer.between(24 * hour, &off(3.0));
    scorer.between(24 * hour + 1, &off(60.0));
    push(&mut scorer, 24 * hour + SECOND_NS / 2, &off(0.1));
    let score = scorer.finish(HeightChannel::Held).unwrap();
    assert!((score.marks["24h"].latitude_max_arcmin - 3.0).abs() < 1e-9, "{:?}", score.marks);
    assert!((score.latitude_error_arcmin.unwrap().max - 60.0).abs() < 1e-9);
}

#[test]
fn quantities_that_are_not_told_have_no_largest_error() {
    let mut scorer = DriftScorer::new();
    let unknown = AnsweredSolution { velocity_mps: [f64::NAN; 2], q_nb: [f64::NAN; 4], ..right() };
    push(&mut scorer, 0, &right());
    scorer.stand(Some(StandingTruth::new(&unknown, 50.0, GIMBAL_RAD)));
    let wild = AnsweredSolution { velocity_mps: [9.0; 2], q_nb: [0.0, 1.0, 0.0, 0.0], ..right() };
    scorer.between(SECOND_NS / 2, &wild);
    push(&mut scorer, SECOND_NS, &right());
    let score = scorer.finish(HeightChannel::Held).unwrap();
    let largest = score.errors().map(|(_, _, error)| error.unwrap().max);
    assert_eq!(largest, [0.0; 7]);
}
