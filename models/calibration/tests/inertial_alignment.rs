//! Alignment in the inertial frame against its closed forms.

use octant_calibration::CoreConfig;
use octant_calibration::alignment::CoarseAlignment;
use octant_calibration::config::{
    Alignment, Base, BaseMotion, NavigationPlan, Noise, Screening, Site, TurntableRates,
};
use octant_calibration::inertial_alignment::{AlignmentRefusal, AlignmentSigma, InertialAlignment};
use octant_calibration::sequence::{Sequence, Stop};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_nc, phi_of, quaternion_from_matrix};
use octant_earth::units::{DEG, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_earth::{UnitQuaternion, Vector3, rotation};

fn config(latitude_deg: f64, duration_s: f64) -> CoreConfig {
    CoreConfig {
        sample_period_ns: 100_000_000,
        site: Site { latitude_rad: latitude_deg * DEG, longitude_rad: 0.3, height_m: 20.0 },
        alignment: Alignment::Inertial { duration_s },
        calibration: None,
        navigation: Some(NavigationPlan {
            duration_s: None,
            rotation: Sequence::new(&[Stop { azimuth_rad: 0.0, roll_rad: 0.0, weight: 1.0 }], 1)
                .unwrap(),
            dwell_s: 100.0,
        }),
        turntable: TurntableRates { rate_radps: 0.1, acceleration_radps2: 0.1 },
        noise: Noise {
            angle_random_walk: 7e-4 * DEG_PER_SQRT_HOUR,
            velocity_random_walk: 10.0 * MICRO_G,
        },
        initial_parameters: octant_sample::Parameters::default(),
        screening: Screening::none(),
    }
}

/// Errors and motion of an alignment, by time, s.
struct Case<'a> {
    config: CoreConfig,
    duration_s: f64,
    step_s: f64,
    /// Rotation vector of the base from its attitude at the start, rad, in n.
    turn: &'a dyn Fn(f64) -> Vector3<f64>,
    /// Velocity of the base, m/s.
    velocity: &'a dyn Fn(f64) -> Vector3<f64>,
    /// Angle and velocity errors of the increments of an interval, in n.
    errors: &'a dyn Fn(f64) -> (Vector3<f64>, Vector3<f64>),
}

fn still(_: f64) -> Vector3<f64> {
    Vector3::zeros()
}

fn exact(_: f64) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::zeros(), Vector3::zeros())
}

impl Case<'_> {
    /// True attitude `q_nb` at a time.
    fn truth(&self, t: f64) -> UnitQuaternion<f64> {
        rotation::exp(&(self.turn)(t)) * quaternion_from_matrix(&c_nc(2.1, 0.3, -0.8))
    }

    /// Steps through the samples with exact increments, and the errors.
    fn each(&self, mut take: impl FnMut(&Vector3<f64>, &Vector3<f64>)) {
        let site = &self.config.site;
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let up = Vector3::new(0.0, 0.0, -earth.gravity_mps2);
        let steps = (self.duration_s / self.step_s).round() as usize;
        for step in 1..=steps {
            let (before, now) = ((step - 1) as f64 * self.step_s, step as f64 * self.step_s);
            let middle = 0.5 * (before + now);
            let (from, to) = (self.truth(before), self.truth(now));
            // In the inertial frame the navigation frame turns with the Earth.
            let turn = rotation::exp(&(earth.earth_rate() * self.step_s));
            let theta = rotation::log(&(from.inverse() * turn * to));
            let (angle_error, velocity_error) = (self.errors)(middle);
            let accrued =
                up * self.step_s + (self.velocity)(now) - (self.velocity)(before) + velocity_error;
            let q = self.truth(middle).inverse();
            // What `step` adds for the turn within the interval, taken off: the increments are those at the start.
            let theta = theta + q * angle_error;
            let at_start = self.truth(before).inverse()
                * rotation::exp(&(earth.earth_rate() * (0.5 * self.step_s)))
                * accrued;
            take(&theta, &(at_start - theta.cross(&at_start) * 0.5));
        }
    }

    fn align(&self) -> Result<UnitQuaternion<f64>, AlignmentRefusal> {
        let mut alignment = InertialAlignment::new(&self.config, self.duration_s);
        self.each(|theta, v| alignment.step(theta, v, self.step_s));
        alignment.finish()
    }

    /// φ (rad, north, east, down) at the end.
    fn phi(&self) -> Vector3<f64> {
        phi_of(&self.align().unwrap(), &self.truth(self.duration_s))
    }
}

fn case(latitude_deg: f64, duration_s: f64) -> Case<'static> {
    Case {
        config: config(latitude_deg, duration_s),
        duration_s,
        step_s: 0.1,
        turn: &still,
        velocity: &still,
        errors: &exact,
    }
}

#[test]
fn a_base_at_rest_gives_its_attitude() {
    for latitude_deg in [-60.0, 0.0, 30.5, 75.0] {
        for duration_s in [60.0, 600.0, 7200.0] {
            let mut case = case(latitude_deg, duration_s);
            // So that a minute is enough near the pole too.
            case.config.noise.angle_random_walk *= 0.1;
            let found = case.phi();
            assert!(found.norm() < 2e-7, "{latitude_deg}, {duration_s}: {found:?}");
        }
    }
}

#[test]
fn a_base_that_tilts_keeps_its_heading() {
    let tilt = 0.2 * DEG;
    let settles = |t: f64| Vector3::new(0.0, tilt * (t / 1800.0), 0.0);
    // Somebody enters in the middle.
    let enters =
        |t: f64| Vector3::new(0.3 * tilt, tilt, 0.1 * tilt) / (1.0 + libm::exp(-(t - 150.0) / 2.0));
    let turns: [&dyn Fn(f64) -> Vector3<f64>; 2] = [&settles, &enters];
    for turn in turns {
        let tilting = Case { turn, ..case(30.5, 300.0) };
        let found = tilting.phi();
        assert!(found.norm() < 1e-6, "{found:?}");
        // Averages take the turn for Earth rate.
        let mut coarse = CoarseAlignment::new(&tilting.config.site);
        tilting.each(|theta, v| coarse.step(theta, v, 0.1));
        let turned = turn(300.0) - turn(0.0);
        let rate = Ellipsoid::at(30.5 * DEG, 20.0).earth_rate().x * 300.0;
        let found = phi_of(&coarse.finish().unwrap(), &tilting.truth(300.0)).z;
        let expected = libm::atan2(turned.y, rate + turned.x);
        assert!((found - expected).abs() < 0.2 * expected, "{found:e}, expected {expected:e}");
        assert!(expected > 1.5 * DEG);
    }
}

#[test]
fn a_swing_of_the_base_moves_the_heading_by_its_weight_at_the_ends() {
    // A velocity A ω cos(ω t) enters the fit with the displacements at both ends, which here are opposite:
    // 2 · 60 A/T³, over g.
    let (amplitude, period, duration_s) = (0.3, 8.0, 604.0);
    let omega = 2.0 * core::f64::consts::PI / period;
    let base = Base::Moving(BaseMotion {
        angle_rad: 0.0,
        rate_radps: 0.0,
        acceleration_radps2: 0.0,
        force_mps2: amplitude * omega * omega,
        jerk_mps3: amplitude * omega * omega * omega,
    });
    let mut largest: f64 = 0.0;
    for phase in 0..8 {
        let phase = f64::from(phase) * core::f64::consts::FRAC_PI_4;
        let velocity =
            |t: f64| Vector3::new(amplitude * omega * libm::cos(omega * t + phase), 0.0, 0.0);
        let mut swinging = Case { velocity: &velocity, ..case(30.5, duration_s) };
        swinging.config.screening.base = base;
        largest = largest.max(swinging.phi().z.abs());
    }
    let earth = Ellipsoid::at(30.5 * DEG, 20.0);
    let expected = 120.0 * amplitude
        / (duration_s * duration_s * duration_s * earth.gravity_mps2 * earth.earth_rate().x);
    assert!((largest / expected - 1.0).abs() < 0.25, "{largest:e}, expected {expected:e}");
    let mut swinging = config(30.5, duration_s);
    let still = AlignmentSigma::of(&swinging, duration_s).rate_radps;
    swinging.screening.base = base;
    let found = AlignmentSigma::of(&swinging, duration_s).rate_radps;
    let swing = libm::sqrt(found * found - still * still) / earth.earth_rate().x;
    assert!((swing / (0.5 * expected) - 1.0).abs() < 1e-9);
}

#[test]
fn a_gyro_error_shows_along_north_and_turns_the_heading_along_east() {
    let earth = Ellipsoid::at(30.5 * DEG, 20.0);
    let size = 0.2 * DEG_PER_HOUR;
    let east = |_| (Vector3::new(0.0, size * 0.1, 0.0), Vector3::zeros());
    let found = Case { errors: &east, ..case(30.5, 300.0) }.phi();
    let expected = libm::atan(size / earth.earth_rate().x);
    assert!((found.z - expected).abs() < 0.01 * expected, "{:e}, expected {expected:e}", found.z);

    let north = |_| (Vector3::new(size * 0.1, 0.0, 0.0), Vector3::zeros());
    let refused = Case { errors: &north, ..case(30.5, 300.0) }.align().unwrap_err();
    let AlignmentRefusal::Rate { found, expected, .. } = refused else { panic!("{refused}") };
    assert!(((found - expected) / size - 1.0).abs() < 0.02, "{refused}");
    assert!(refused.to_string().starts_with("gravity turned by 13.1"), "{refused}");
}

#[test]
fn what_is_no_gravity_and_what_finds_no_north_is_refused() {
    let heavy = |_| (Vector3::zeros(), Vector3::new(0.0, 0.0, -0.02));
    let refused = Case { errors: &heavy, ..case(30.5, 60.0) }.align().unwrap_err();
    assert!(matches!(refused, AlignmentRefusal::Force { .. }), "{refused}");
    let broken = |_| (Vector3::repeat(f64::NAN), Vector3::zeros());
    let refused = Case { errors: &broken, ..case(30.5, 60.0) }.align().unwrap_err();
    assert_eq!(refused, AlignmentRefusal::Nothing);
    let mut mems = case(30.5, 60.0);
    mems.config.noise.angle_random_walk = 0.3 * DEG_PER_SQRT_HOUR;
    let refused = mems.align().unwrap_err();
    assert!(matches!(refused, AlignmentRefusal::Heading { .. }), "{refused}");
    let ended = InertialAlignment::new(&config(30.5, 60.0), 60.0).finish().unwrap_err();
    assert_eq!(ended, AlignmentRefusal::Nothing);
}

/// The alignment is linear in small errors: the variance by white noise is the sum of the squares of what one
/// impulse at a time does.
#[test]
fn sigma_is_that_of_all_impulses_together() {
    let duration_s = 120.0;
    let small = 1e-7;
    let mut sums = [[0.0; 3]; 2];
    for (kind, sum) in sums.iter_mut().enumerate() {
        for direction in 0..3 {
            for impulse in 0..120 {
                let errors = |t: f64| {
                    let mut error = Vector3::zeros();
                    if t.floor() == f64::from(impulse) {
                        error[direction] = small;
                    }
                    if kind == 0 {
                        (error, Vector3::zeros())
                    } else {
                        (Vector3::zeros(), error * 10.0)
                    }
                };
                let one = Case { step_s: 1.0, errors: &errors, ..case(30.5, duration_s) };
                let exact = Case { step_s: 1.0, ..case(30.5, duration_s) };
                let moved =
                    (one.phi() - exact.phi()) / if kind == 0 { small } else { 10.0 * small };
                for axis in 0..3 {
                    sum[axis] += moved[axis] * moved[axis];
                }
            }
        }
    }
    let mut only = case(30.5, duration_s).config;
    let (arw, vrw) = (only.noise.angle_random_walk, only.noise.velocity_random_walk);
    for (kind, sum) in sums.iter().enumerate() {
        // Each kind of noise alone.
        only.noise.angle_random_walk = if kind == 0 { arw } else { 0.0 };
        only.noise.velocity_random_walk = if kind == 0 { 0.0 } else { vrw };
        let sigma = AlignmentSigma::of(&only, duration_s).attitude_rad;
        let noise = if kind == 0 { arw } else { vrw };
        let heading = libm::sqrt(sum[2]) * noise;
        assert!(
            (sigma[2] / heading - 1.0).abs() < 0.02,
            "{kind}: {:e}, expected {heading:e}",
            sigma[2]
        );
        // About north; about east, where the heading takes a part of the error, it is less.
        let [north, east] = [0, 1].map(|axis| libm::sqrt(sum[axis]) * noise);
        let bounds = (0.98 * north.max(east), 1.02 * north.max(east));
        assert!(
            (bounds.0..bounds.1).contains(&sigma[0]),
            "{kind}: {:e}, expected {bounds:?}",
            sigma[0]
        );
    }
}
