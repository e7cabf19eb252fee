//! Keys of the errors that a filter can take into account beside the thirty parameters, and of their draws.

use super::definition::Bounds;
use super::table::{At, keys, number, si, table};
use crate::model::ParameterDistribution;
use crate::quantity::UnitDimension;
use octant_calibration::config::FurtherUse;

/// Keys of one group: its treatment, with the standard deviation that it starts from.
macro_rules! group {
    ($name:ident, $dimension:expr) => {
        keys! {
            /// A group of errors.
            pub(crate) one of $name {
                estimated: Option<f64> = si(&[$dimension], Bounds::Positive),
                    "The filter estimates and compensates them, from this standard deviation.";
                considered: Option<f64> = si(&[$dimension], Bounds::Positive),
                    "Their uncertainty of this standard deviation counts, and they are never moved (Schmidt).";
            }
        }

        impl $name {
            /// Treatment of the group.
            pub(crate) fn treatment(&self) -> FurtherUse {
                let estimated = self.estimated.map(|sigma| FurtherUse::Estimated { sigma });
                let considered = self.considered.map(|sigma| FurtherUse::Considered { sigma });
                estimated.or(considered).unwrap_or_default()
            }
        }
    };
}
group!(LeverUse, UnitDimension::LENGTH);
group!(RatioUse, UnitDimension::RATIO);
group!(QuadraticUse, UnitDimension::ACCEL_QUADRATIC);
group!(GyroUse, UnitDimension::GYRO_BIAS);
group!(AccelUse, UnitDimension::ACCEL_BIAS);
group!(AngleUse, UnitDimension::SMALL_ANGLE);
group!(GyroPerKelvinUse, UnitDimension::GYRO_BIAS_PER_K);
group!(AccelPerKelvinUse, UnitDimension::ACCEL_BIAS_PER_K);
group!(ScalePerKelvinUse, UnitDimension::SCALE_PER_K);

keys! {
    /// `[procedure.calibration.further.gimbal_angles]`.
    pub(crate) struct GimbalAnglesKeys {
        sigma: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "1 arcsec",
            "White noise of a reading, one standard deviation: encoders and wobble of the gimbals.";
        curve: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::NotNegative), "0 arcsec",
            "Rest of an encoder's error curve beyond its eccentricity, one standard deviation: a constant of each stop, another one after each move.";
        mounting: Option<AngleUse> = table::<AngleUse>(), absent("off"),
            "Mounting of the body on the inner gimbal, three. z stands for the zero error of the azimuth encoder too.";
        non_orthogonality: Option<AngleUse> = table::<AngleUse>(), absent("off"),
            "Angle by which the gimbal axes miss a right angle, one.";
        eccentricity: Option<AngleUse> = table::<AngleUse>(), absent("off"),
            "Eccentricity of the encoders: cosine and sine of azimuth and of roll, four.";
    }
}

keys! {
    /// `[procedure.calibration.aiding.rest]`.
    pub(crate) struct CaseRestKeys {
        wander: f64 = si(&[UnitDimension::ANGLE_RANDOM_WALK], Bounds::NotNegative), "0.2 arcsec/sqrt(h)",
            "Random walk of the case about each axis: a floor that settles, a pillar in the sun, a quay.";
        range: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "10 arcsec",
            "Turn of the case since the start, beyond what its uncertainty explains, that contradicts a case at rest.";
        jitter: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "0.5 arcsec",
            "White noise of the case's attitude about each axis, one standard deviation: people, machines.";
    }
}

keys! {
    /// `[procedure.calibration.further]`.
    pub(crate) struct FurtherKeys {
        accel_lever: Option<LeverUse> = table::<LeverUse>(), absent("off"),
            "Positions of the accelerometers' proof masses from the centre of rotation (size effect), nine.";
        gyro_asymmetry: Option<RatioUse> = table::<RatioUse>(), absent("off"),
            "Difference of the gyros' scale factors by the sign of the rate, of which this is half, three.";
        accel_asymmetry: Option<RatioUse> = table::<RatioUse>(), absent("off"),
            "The same of the accelerometers, three.";
        accel_quadratic: Option<QuadraticUse> = table::<QuadraticUse>(), absent("off"),
            "Second-order coefficients of the accelerometers (K2), three.";
        gyro_gauss_markov: Option<GyroUse> = table::<GyroUse>(), absent("off"),
            "First-order Gauss-Markov biases of the gyros, three.";
        gyro_correlation_time: f64 = si(&[UnitDimension::TIME], Bounds::Positive), "1 h",
            "Correlation time of gyro_gauss_markov.";
        accel_gauss_markov: Option<AccelUse> = table::<AccelUse>(), absent("off"),
            "First-order Gauss-Markov biases of the accelerometers, three.";
        accel_correlation_time: f64 = si(&[UnitDimension::TIME], Bounds::Positive), "1 h",
            "Correlation time of accel_gauss_markov.";
        gyro_rate_random_walk: f64
            = si(&[UnitDimension::RATE_RANDOM_WALK], Bounds::NotNegative), "0 deg/h/sqrt(h)",
            "Rate random walk of the gyros: process noise of their biases. With it the biases are no constants, and the drift test is off.";
        deflection: Option<AngleUse> = table::<AngleUse>(), absent("off"),
            "Deflection of the vertical, north and east. On a base at rest it can't be told from a tilt: to be considered.";
        gravity_anomaly: Option<AccelUse> = table::<AccelUse>(), absent("off"),
            "True minus normal gravity. On a base at rest it can't be told from a common scale factor of the accelerometers: to be considered.";
        gyro_bias_temperature: Option<GyroPerKelvinUse> = table::<GyroPerKelvinUse>(), absent("off"),
            "Temperature coefficients of the gyro biases, three.";
        gyro_scale_temperature: Option<ScalePerKelvinUse> = table::<ScalePerKelvinUse>(), absent("off"),
            "Temperature coefficients of the gyros' scale factors, three.";
        accel_bias_temperature: Option<AccelPerKelvinUse> = table::<AccelPerKelvinUse>(), absent("off"),
            "Temperature coefficients of the accelerometer biases, three.";
        accel_scale_temperature: Option<ScalePerKelvinUse> = table::<ScalePerKelvinUse>(), absent("off"),
            "Temperature coefficients of the accelerometers' scale factors, three.";
        temperature_reference_c: Option<f64> = number(Bounds::Any), absent("the first temperature"),
            "Temperature of the instrument at which its parameters are as they are estimated, degC.";
        gimbal_angles: Option<GimbalAnglesKeys> = table::<GimbalAnglesKeys>(), absent("the angles tell the filter nothing"),
            "Gimbal angles as measurements of attitude, once per aiding period while the gimbals rest. For a case at rest.";
    }
}

/// Keys of the draw of one group of errors.
macro_rules! drawn {
    ($name:ident, $dimension:expr) => {
        keys! {
            /// Distribution of a group's draws.
            pub(crate) one of $name {
                normal: Option<f64> = si(&[$dimension], Bounds::NotNegative),
                    "Drawn from a normal distribution of this standard deviation, each entry alone.";
                uniform: Option<f64> = si(&[$dimension], Bounds::NotNegative),
                    "Drawn evenly within plus and minus this half width, each entry alone.";
            }
        }

        impl $name {
            /// Distribution of each entry.
            pub(crate) fn distribution(&self) -> ParameterDistribution {
                let uniform = self.uniform.map(ParameterDistribution::Uniform);
                uniform.unwrap_or(ParameterDistribution::Normal(self.normal.unwrap_or(0.0)))
            }
        }
    };
}
drawn!(DrawnLengths, UnitDimension::LENGTH);
drawn!(DrawnRatios, UnitDimension::RATIO);
drawn!(DrawnQuadratics, UnitDimension::ACCEL_QUADRATIC);
drawn!(DrawnAngles, UnitDimension::SMALL_ANGLE);
drawn!(DrawnAccelerations, UnitDimension::ACCEL_BIAS);
drawn!(DrawnGyrosPerKelvin, UnitDimension::GYRO_BIAS_PER_K);
drawn!(DrawnAccelsPerKelvin, UnitDimension::ACCEL_BIAS_PER_K);
drawn!(DrawnScalesPerKelvin, UnitDimension::SCALE_PER_K);

keys! {
    /// `[imu.extensions.drawn]`.
    pub(crate) struct DrawnExtensionsKeys {
        lever_arm: Option<DrawnLengths> = table::<DrawnLengths>(), absent("as given"),
            "Positions of the accelerometers, nine.";
        gyro_asymmetry: Option<DrawnRatios> = table::<DrawnRatios>(), absent("as given"),
            "Asymmetry of the gyros' scale factors, three.";
        accel_asymmetry: Option<DrawnRatios> = table::<DrawnRatios>(), absent("as given"),
            "Asymmetry of the accelerometers' scale factors, three.";
        accel_quadratic: Option<DrawnQuadratics> = table::<DrawnQuadratics>(), absent("as given"),
            "Second-order coefficients of the accelerometers, three.";
        gyro_bias_temperature: At<Option<DrawnGyrosPerKelvin>>
            = table::<DrawnGyrosPerKelvin>(), absent("as given"),
            "Temperature coefficients of the gyro biases, three.";
        gyro_scale_temperature: At<Option<DrawnScalesPerKelvin>>
            = table::<DrawnScalesPerKelvin>(), absent("as given"),
            "Temperature coefficients of the gyros' scale factors, three.";
        accel_bias_temperature: At<Option<DrawnAccelsPerKelvin>>
            = table::<DrawnAccelsPerKelvin>(), absent("as given"),
            "Temperature coefficients of the accelerometer biases, three.";
        accel_scale_temperature: At<Option<DrawnScalesPerKelvin>>
            = table::<DrawnScalesPerKelvin>(), absent("as given"),
            "Temperature coefficients of the accelerometers' scale factors, three.";
    }
}

keys! {
    /// `[turntable.drawn]`.
    pub(crate) struct DrawnTurntableKeys {
        mounting: Option<DrawnAngles> = table::<DrawnAngles>(), absent("as given"),
            "Mounting of the body on the inner gimbal, three.";
        non_orthogonality: Option<DrawnAngles> = table::<DrawnAngles>(), absent("as given"),
            "Angle by which the gimbal axes miss a right angle, one.";
        eccentricity: Option<DrawnAngles> = table::<DrawnAngles>(), absent("as given"),
            "Eccentricity of the encoders: cosine and sine of azimuth and of roll, four.";
    }
}

keys! {
    /// `[site.drawn]`.
    pub(crate) struct DrawnSiteKeys {
        deflection: Option<DrawnAngles> = table::<DrawnAngles>(), absent("as given"),
            "Deflection of the vertical, north and east.";
        gravity_anomaly: Option<DrawnAccelerations>
            = table::<DrawnAccelerations>(), absent("as given"),
            "True minus normal gravity.";
    }
}
