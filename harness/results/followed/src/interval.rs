//! The error dynamics over one interval between two comparisons with the truth, about a second.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::frames::phi_of;
use octant_earth::rotation::{exp, log, renormalize};
use octant_sample::{Navigation, NoiseIntegral, Truth};

/// Largest turn of the body in an interval, rad: its mean attitude is then that of every sample within 1.5 %.
const TURN_RAD_MAX: f64 = 0.35;
/// Rate of the body against n below which it hardly turns, rad/s.
const QUIET_RADPS: f64 = 1e-3;
/// Largest error of an attitude for which the dynamics are linear, rad.
const TILT_RAD_MAX: f64 = 0.1;

/// Number of parameters of the gyros: bias 3, scale factors and misalignments 9, g-dependence 9.
pub const GYRO_PARAMETERS: usize = 21;
/// Number of parameters of the accelerometers: bias 3, lower triangle of scale factors and misalignments 6.
pub const ACCEL_PARAMETERS: usize = 9;

/// Quantities that a unit tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Told {
    /// Attitude, with roll and pitch.
    pub attitude: bool,
    /// Velocity over ground.
    pub velocity: bool,
    /// Latitude and longitude.
    pub position: bool,
}

/// Errors of a solution in n: attitude φ, rad; velocity north and east, m/s; position north and east, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// φ, with `c_nb(computed) = (I − [φ×]) c_nb(true)`.
    pub phi_rad: [f64; 3],
    /// Velocity north and east.
    pub velocity_mps: [f64; 2],
    /// Position north and east.
    pub position_m: [f64; 2],
}

impl Errors {
    /// Compares a solution with the truth; `None` where the errors are too large for linear dynamics, or unknown. What
    /// the unit doesn't tell has no error.
    #[must_use]
    pub fn of(answer: &Navigation, truth: &Truth, told: Told) -> Option<Self> {
        let earth = Ellipsoid::at(truth.latitude_rad, truth.height_m);
        let known = |told: bool, error: f64| if told { error } else { 0.0 };
        let phi = if told.attitude {
            phi_of(&quaternion(answer.q_nb), &quaternion(truth.q_nb))
        } else {
            Vector3::zeros()
        };
        let [north, east, _] = truth.velocity_mps;
        let [computed_north, computed_east, _] = answer.velocity_mps;
        let across_m = earth.transverse_radius_m * earth.cos_latitude;
        let north_rad = answer.latitude_rad - truth.latitude_rad;
        let east_rad = answer.longitude_rad - truth.longitude_rad;
        let errors = Self {
            phi_rad: phi.into(),
            velocity_mps: [computed_north - north, computed_east - east]
                .map(|error| known(told.velocity, error)),
            position_m: [north_rad * earth.meridian_radius_m, east_rad * across_m]
                .map(|error| known(told.position, error)),
        };
        let known = errors.phi_rad.iter().chain(&errors.velocity_mps).chain(&errors.position_m);
        let linear = known.clone().all(|value| value.is_finite()) && phi.norm() < TILT_RAD_MAX;
        linear.then_some(errors)
    }
}

/// Answers may be rounded.
fn quaternion([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(renormalize(Quaternion::new(w, x, y, z)))
}

/// Motion, noise and effects of the parameters in one interval.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    /// Length, s.
    pub dt_s: f64,
    /// True if the body hardly turns against n.
    pub is_quiet: bool,
    earth: Ellipsoid,
    /// Velocity over ground in its middle, m/s.
    velocity_mps: Vector3<f64>,
    /// Rate of n against i, rad/s.
    rate_radps: Vector3<f64>,
    /// Mean of `c_nb`.
    c_nb: Matrix3<f64>,
    /// Specific force in n times its length, m/s.
    force_n: Vector3<f64>,
    /// Turn of the body against i, in b, rad.
    turn_b: Vector3<f64>,
    /// Specific force in b times its length, m/s.
    force_b: Vector3<f64>,
    /// Effect of the noise on φ and on the velocity, north and east.
    pub noise: Noise,
}

/// Noise in n, north and east.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// On φ, rad.
    pub phi_rad: [f64; 2],
    /// On the velocity, m/s.
    pub velocity_mps: [f64; 2],
}

/// Effects of parameters in an interval, north and east.
#[derive(Clone, Copy, Debug)]
pub struct Effects {
    /// Effects of the gyros' on φ.
    pub gyro: [[f64; GYRO_PARAMETERS]; 2],
    /// Effects of the accelerometers' on the velocity.
    pub accelerometer: [[f64; ACCEL_PARAMETERS]; 2],
}

impl Interval {
    /// Makes the interval between two true states with the noise in it; `None` where the body turns too far in it.
    #[must_use]
    pub fn between(
        from: &Truth,
        to: &Truth,
        noise: [&NoiseIntegral; 2],
        dt_s: f64,
    ) -> Option<Self> {
        let earth = Ellipsoid::at(from.latitude_rad, from.height_m);
        let (before, now) = (quaternion(from.q_nb), quaternion(to.q_nb));
        let turned = log(&(before.inverse() * now));
        if !(turned.norm() < TURN_RAD_MAX) {
            return None;
        }
        let (start, end) = (Vector3::from(from.velocity_mps), Vector3::from(to.velocity_mps));
        let velocity_mps = 0.5 * (start + end);
        let earth_rate = earth.earth_rate();
        let rate_radps = earth_rate + earth.transport_rate(&velocity_mps);
        let half = exp(&(0.5 * turned));
        let c_nb = (before * half).to_rotation_matrix().into_inner();
        let coriolis = (rate_radps + earth_rate).cross(&velocity_mps);
        let gravity = Vector3::new(0.0, 0.0, earth.gravity_mps2);
        let force_n = end - start + dt_s * (coriolis - gravity);
        let in_n = |of: fn(&NoiseIntegral) -> [f64; 3]| {
            c_nb * (Vector3::from(of(noise[1])) - Vector3::from(of(noise[0])))
        };
        let phi = -in_n(|noise| noise.delta_theta_rad);
        let pushed = in_n(|noise| noise.delta_velocity_mps);
        Some(Self {
            dt_s,
            is_quiet: turned.norm() < QUIET_RADPS * dt_s,
            earth,
            velocity_mps,
            rate_radps,
            c_nb,
            force_n,
            turn_b: turned + c_nb.transpose() * rate_radps * dt_s,
            force_b: c_nb.transpose() * force_n,
            noise: Noise { phi_rad: [phi.x, phi.y], velocity_mps: [pushed.x, pushed.y] },
        })
    }

    /// Carries errors over the interval, without noise and errors of parameters; the vertical channel has none.
    pub fn carry(&self, errors: &mut Errors) {
        let Self { dt_s, earth, velocity_mps, rate_radps, force_n, .. } = self;
        let [north_mps, east_mps] = errors.velocity_mps;
        let phi = Vector3::from(errors.phi_rad);
        let (sin, cos) = (earth.sin_latitude, earth.cos_latitude);
        let latitude = errors.position_m[0] / earth.meridian_radius_m;
        let earth_rate = EARTH_RATE_RADPS * latitude * Vector3::new(-sin, 0.0, -cos);
        let east = east_mps / earth.transverse_radius_m;
        let true_east = velocity_mps.y / earth.transverse_radius_m;
        let transport = Vector3::new(
            east,
            -north_mps / earth.meridian_radius_m,
            -east * sin / cos - true_east * latitude / (cos * cos),
        );
        let moved = phi + *dt_s * (earth_rate + transport - rate_radps.cross(&phi));
        // The tilt in the middle of the interval.
        let pushed = force_n.cross(&(0.5 * (phi + moved)));
        let error = Vector3::new(north_mps, east_mps, 0.0);
        let turning = (rate_radps + earth.earth_rate()).cross(&error)
            + (2.0 * earth_rate + transport).cross(velocity_mps);
        errors.phi_rad = moved.into();
        errors.velocity_mps =
            [north_mps + pushed.x - dt_s * turning.x, east_mps + pushed.y - dt_s * turning.y];
        errors.position_m[0] += 0.5 * dt_s * (north_mps + errors.velocity_mps[0]);
        errors.position_m[1] += 0.5 * dt_s * (east_mps + errors.velocity_mps[1]);
    }

    /// Carries an attitude error over the interval by itself.
    pub fn carry_attitude(&self, phi_rad: &mut [f64; 3]) {
        let phi = Vector3::from(*phi_rad);
        *phi_rad = (phi - self.dt_s * self.rate_radps.cross(&phi)).into();
    }

    /// Turn of the body against i, in b, rad.
    #[must_use]
    pub fn turn_rad(&self) -> [f64; 3] {
        self.turn_b.into()
    }

    /// Specific force in b over the interval, m/s.
    #[must_use]
    pub fn force_mps(&self) -> [f64; 3] {
        self.force_b.into()
    }

    /// Effects of the parameters, north and east.
    #[must_use]
    pub fn effects(&self) -> Effects {
        Effects {
            gyro: [0, 1].map(|axis| self.gyro_effects(axis)),
            accelerometer: [0, 1].map(|axis| self.accel_effects(axis)),
        }
    }

    /// Change of the velocity, north and east, by a tilt φ, m/s.
    #[must_use]
    pub fn pushed(&self, [north, east]: [f64; 2]) -> [f64; 2] {
        [-self.force_n.z * east, self.force_n.z * north]
    }

    /// Effect of each parameter of the gyros on φ north (`axis` 0) or east (1).
    fn gyro_effects(&self, axis: usize) -> [f64; GYRO_PARAMETERS] {
        let mut effects = [0.0; GYRO_PARAMETERS];
        for sensor in 0..3 {
            let c = -self.c_nb[(axis, sensor)];
            effects[sensor] = c * self.dt_s;
            for along in 0..3 {
                effects[3 + 3 * sensor + along] = c * self.turn_b[along];
                effects[12 + 3 * sensor + along] = c * self.force_b[along];
            }
        }
        effects
    }

    /// Effect of each parameter of the accelerometers on the velocity north (`axis` 0) or east (1).
    fn accel_effects(&self, axis: usize) -> [f64; ACCEL_PARAMETERS] {
        let mut effects = [0.0; ACCEL_PARAMETERS];
        let mut next = 3;
        for sensor in 0..3 {
            let c = self.c_nb[(axis, sensor)];
            effects[sensor] = c * self.dt_s;
            for along in 0..=sensor {
                effects[next] = c * self.force_b[along];
                next += 1;
            }
        }
        effects
    }
}
