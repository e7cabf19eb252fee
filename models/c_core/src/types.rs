//! The structures of the header. Numbers come first, whole numbers after them: there is no padding inside.

use octant_calibration::sequence::STOPS_MAX;
use octant_sample::parameters::PARAMETER_COUNT;

/// Declares structures as C has them, with the names and places of their fields for the test of the header.
macro_rules! structures {
    ($($(#[$doc:meta])* $name:ident $in_c:literal { $($(#[$field_doc:meta])* $field:ident: $kind:ty,)* })*) => {
        $(
            $(#[$doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $name { $($(#[$field_doc])* pub $field: $kind,)* }
        )*

        /// Each structure with its name in C and its size, and each field with its place.
        #[must_use]
        pub fn layout() -> Vec<(&'static str, usize, Vec<(&'static str, usize)>)> {
            vec![$((
                $in_c,
                size_of::<$name>(),
                vec![$((stringify!($field), core::mem::offset_of!($name, $field))),*],
            )),*]
        }
    };
}

structures! {
    /// Stops of the gimbals.
    CStops "octant_stops" {
        /// Inner gimbal, cumulative, rad.
        azimuth_rad: [f64; STOPS_MAX],
        /// Outer gimbal, cumulative, rad.
        roll_rad: [f64; STOPS_MAX],
        /// Dwell relative to weight 1.
        weight: [f64; STOPS_MAX],
        /// Number of stops.
        count: u32,
        /// Passes.
        passes: u32,
    }

    /// Configuration of a core: one with the Kalman filter.
    CConfig "octant_config" {
        /// Latitude, rad.
        latitude_rad: f64,
        /// Longitude, rad.
        longitude_rad: f64,
        /// Height, m.
        height_m: f64,
        /// Time of the alignment, s.
        alignment_duration_s: f64,
        /// Given attitude `q_nb`.
        alignment_q_nb: [f64; 4],
        /// Given velocity, m/s.
        alignment_velocity_mps: [f64; 3],
        /// Time of the calibration, s.
        calibration_duration_s: f64,
        /// Stops of the calibration.
        calibration_stops: CStops,
        /// Prior σ of attitude, rad.
        prior_attitude_rad: [f64; 3],
        /// Prior σ of velocity, m/s.
        prior_velocity_mps: f64,
        /// Prior σ of position, m.
        prior_position_m: f64,
        /// Prior σ of the groups of parameters.
        prior_parameters: [f64; 7],
        /// σ of the reference, m/s or m.
        aiding_sigma: f64,
        /// Mean NIS above which the calibration is refused.
        refuse_above_mean_nis: f64,
        /// Duration of the navigation, s; 0: endless.
        navigation_duration_s: f64,
        /// Dwell at each stop of the navigation, s.
        navigation_dwell_s: f64,
        /// Stops of the navigation.
        navigation_stops: CStops,
        /// Rate of the turntable, rad/s.
        turntable_rate_radps: f64,
        /// Acceleration of the turntable, rad/s².
        turntable_acceleration_radps2: f64,
        /// Angle random walk, rad/√s.
        angle_random_walk: f64,
        /// Velocity random walk, m/s/√s.
        velocity_random_walk: f64,
        /// Initial parameters.
        initial_parameters: [f64; PARAMETER_COUNT],
        /// NIS above which a measurement is rejected; 0: no gate.
        gate_nis: f64,
        /// Recovery by reset: σ of attitude, rad.
        reset_attitude_rad: f64,
        /// Recovery by reset: σ of velocity, m/s.
        reset_velocity_mps: f64,
        /// Recovery by reset: σ of position, m.
        reset_position_m: f64,
        /// Limit of the drift test, σ; 0: no test.
        drift_sigmas: f64,
        /// Moving base: largest angle, rad.
        base_angle_rad: f64,
        /// Moving base: largest rate, rad/s.
        base_rate_radps: f64,
        /// Moving base: largest angular acceleration, rad/s².
        base_acceleration_radps2: f64,
        /// Moving base: largest acceleration, m/s².
        base_force_mps2: f64,
        /// Moving base: largest jerk, m/s³.
        base_jerk_mps3: f64,
        /// σ of a gimbal angle, rad.
        encoder_sigma_rad: f64,
        /// Coarsest step of an angle increment, rad.
        resolution_theta_rad: f64,
        /// Coarsest step of a velocity increment, m/s.
        resolution_velocity_mps: f64,
        /// Largest change of an angle increment by vibration, rad.
        vibration_theta_rad: f64,
        /// Largest change of a velocity increment by vibration, m/s.
        vibration_velocity_mps: f64,
        /// Sample period, ns.
        sample_period_ns: u64,
        /// Period of the reference, ns.
        aiding_period_ns: u64,
        /// Alignment: 0 given, 1 coarse, 2 inertial.
        alignment: i32,
        /// There is a calibration.
        calibrates: i32,
        /// There is navigation.
        navigates: i32,
        /// Error model: 0 phi, 1 psi.
        error_model: i32,
        /// Groups that the filter estimates.
        estimated: [i32; 7],
        /// Reference: 0 velocity, 1 position.
        aiding: i32,
        /// Sway: 0 white, 1 coloured.
        sway: i32,
        /// Recovery: 0 widening, 1 reset.
        gate_recovery: i32,
        /// Base: 0 still, 1 moving.
        base: i32,
        /// Screens for jumps.
        jumps: i32,
        /// Bridges what is missing.
        bridging: i32,
        /// Compares gyros and encoders.
        gimbals: i32,
        /// Recoveries go back to checkpoints.
        checkpoints: i32,
        /// Checks the stamps of references.
        aiding_stamps: i32,
        /// Rejections that start a recovery.
        gate_rejections: u32,
        /// Identical counts that make a channel stuck; 0: no test.
        stuck_samples: u32,
    }

    /// A sample.
    CSample "octant_sample" {
        /// Number, from 1.
        sequence: u64,
        /// End of the interval, ns.
        device_time_ns: u64,
        /// Angle increments, counts of 2⁻³⁶ rad.
        delta_theta: [i32; 3],
        /// Velocity increments, counts of 2⁻³⁰ m/s.
        delta_velocity: [i32; 3],
        /// Inner gimbal, counts of 2⁻²⁷ rad.
        azimuth: i32,
        /// Outer gimbal, counts of 2⁻²⁷ rad.
        roll: i32,
        /// Flags.
        status: u32,
        /// Not used.
        reserved: u32,
    }

    /// A reference.
    CAiding "octant_aiding" {
        /// Velocity north, east, down, m/s; or latitude, longitude (rad) and height (m).
        value: [f64; 3],
        /// Stamp, ns.
        device_time_ns: u64,
        /// 0 velocity, 1 position.
        kind: i32,
        /// Not used.
        reserved: u32,
    }

    /// An answer.
    COutput "octant_output" {
        /// Latitude, rad.
        latitude_rad: f64,
        /// Longitude, rad.
        longitude_rad: f64,
        /// Height, m.
        height_m: f64,
        /// Velocity, m/s.
        velocity_mps: [f64; 3],
        /// Attitude `q_nb`.
        q_nb: [f64; 4],
        /// NIS of the measurement; NaN: none.
        nis: f64,
        /// Number of the sample.
        sequence: u64,
        /// Stamp of the sample, ns.
        device_time_ns: u64,
        /// Mode.
        mode: i32,
        /// Set point of the inner gimbal, counts of 2⁻²⁷ rad.
        command_azimuth: i32,
        /// Set point of the outer gimbal, counts of 2⁻²⁷ rad.
        command_roll: i32,
        /// True while the gimbals move.
        moving: i32,
        /// Stop.
        stop: u32,
        /// Health flags.
        health: u32,
        /// Number of changes of the parameters.
        parameters_revision: u32,
        /// Not used.
        reserved: u32,
    }
}
