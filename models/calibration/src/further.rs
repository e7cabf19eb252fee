//! Further states: errors beside the thirty parameters that a calibration can take into account.
//!
//! Each group is off, considered or estimated (see [`crate::config::Further`]). Errors are measured
//! − true, and the estimates are their coefficients, as with the parameters:
//!
//! | group | error of the sensor or of the model | unit |
//! |---|---|---|
//! | [`AccelLever`](FurtherGroup::AccelLever) | ∇_i = (ω̇ × r_i + ω × (ω × r_i))_i: size effect, r_i the position of proof mass i from the centre of rotation, in b | m |
//! | [`GyroAsymmetry`](FurtherGroup::GyroAsymmetry) | ε_i = a_i abs(ω_i) | 1 |
//! | [`AccelAsymmetry`](FurtherGroup::AccelAsymmetry) | ∇_i = a_i abs(f_i) | 1 |
//! | [`AccelQuadratic`](FurtherGroup::AccelQuadratic) | ∇_i = k_i f_i² (K2 of IEEE Std 1293) | 1/(m/s²) |
//! | [`GyroGaussMarkov`](FurtherGroup::GyroGaussMarkov) | ε_i = x_i, first-order Gauss-Markov | rad/s |
//! | [`AccelGaussMarkov`](FurtherGroup::AccelGaussMarkov) | ∇_i = x_i, first-order Gauss-Markov | m/s² |
//! | [`Deflection`](FurtherGroup::Deflection) | gravity in n is (−ξ g, −η g, g) | rad |
//! | [`GravityAnomaly`](FurtherGroup::GravityAnomaly) | gravity in n is (0, 0, g + Δg), g normal gravity | m/s² |
//! | [`GyroBiasTemperature`](FurtherGroup::GyroBiasTemperature) | ε_i = c_i (T − T₀) | (rad/s)/K |
//! | [`GyroScaleTemperature`](FurtherGroup::GyroScaleTemperature) | ε_i = c_i (T − T₀) ω_i | 1/K |
//! | [`AccelBiasTemperature`](FurtherGroup::AccelBiasTemperature) | ∇_i = c_i (T − T₀) | (m/s²)/K |
//! | [`AccelScaleTemperature`](FurtherGroup::AccelScaleTemperature) | ∇_i = c_i (T − T₀) f_i | 1/K |
//! | [`GimbalMounting`](FurtherGroup::GimbalMounting) | `c_cb = Rx(roll) · Ry(η) · Rz(azimuth) · exp([μ×])` | rad |
//! | [`GimbalNonOrthogonality`](FurtherGroup::GimbalNonOrthogonality) | η in the same | rad |
//! | [`EncoderEccentricity`](FurtherGroup::EncoderEccentricity) | measured − true angle is c cos(angle) + s sin(angle), for azimuth and for roll | rad |
//!
//! T is the temperature that the core is told ([`Core::feel`](crate::Core::feel)), T₀ the one at which the
//! parameters are as they are estimated.
//!
//! The last three are there where the gimbal angles are measurements: see [`crate::filter`]'s angles.
//!
//! Sign of the deflection of the vertical: ξ is positive where the astronomic zenith is north of the
//! geodetic one, η where it is east (Torge, *Geodesy*). The plumb line then points to the south
//! and west.
//!
//! Only some of them can be observed on two gimbals over a base at rest:
//!
//! - Size effect: all nine. A turn about body z (azimuth) shows r_xx and r_yy by `−ω²` and r_xy and
//!   r_yx by `±ω̇`; one about an axis across it (roll, at azimuths of 0° and 90°) shows the others. A
//!   zero velocity is that of the point where the gimbals' axes cross, which rests, and the arms
//!   count from there: one hour through the eight positions brings each from 30 mm to 2 mm (1σ). The
//!   six that the literature counts are those of an instrument whose own point is that of one of its
//!   accelerometers, r_x = 0. Then, or where the axes don't cross, three combinations are the place of
//!   that point. The nine remain states: a combination that the motion doesn't show keeps its prior.
//! - Asymmetry: on positions with both signs of an axis it is separated from the scale factor.
//! - Temperature: as well as the temperature changes, and as the parameter is seen whose change it is.
//!   At T₀ nothing shows it, and it does nothing.
//! - Deflection: at rest it is inseparable from a tilt of the whole attitude, and the anomaly from a
//!   common scale factor of the accelerometers. Both are there to be considered.

pub(crate) mod compensation;
pub(crate) mod size_effect;

pub use compensation::FurtherIntegrals;
pub use octant_sample::further::{
    DRIVING_COUNT, FURTHER_COUNT, FURTHER_NAMES, FurtherEstimates, FurtherGroup, TEMPERATURE_START,
};
