//! WGS-84 ellipsoid: radii of curvature, normal gravity, Earth rate and transport rate.

use nalgebra::Vector3;

/// Earth rotation rate Ω, rad/s.
pub const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
/// Semi-major axis a, m.
pub const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;
/// First eccentricity squared e².
pub const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_14e-3;
/// Normal gravity at the equator γ_e, m/s².
pub const EQUATOR_GRAVITY_MPS2: f64 = 9.780_325_335_9;
/// Somigliana's constant k.
pub const SOMIGLIANA_K: f64 = 0.001_931_852_652_41;
/// Flattening f of WGS-84.
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// m = Ω²a²b/GM of WGS-84 (NIMA TR8350.2, table 3.6).
const GRAVITY_RATIO: f64 = 0.003_449_786_506_84;

/// Quantities of the Earth that navigation needs at one latitude and height.
///
/// The sine and cosine are computed once; the rest are a few multiplications.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ellipsoid {
    /// sin L.
    pub sin_latitude: f64,
    /// cos L.
    pub cos_latitude: f64,
    /// R_M + h, m.
    pub meridian_radius_m: f64,
    /// R_N + h, m.
    pub transverse_radius_m: f64,
    /// Normal gravity at height h, positive down, m/s².
    pub gravity_mps2: f64,
}

impl Ellipsoid {
    /// Computes the quantities at a geodetic latitude (rad) and height above the ellipsoid (m).
    #[must_use]
    pub fn at(latitude_rad: f64, height_m: f64) -> Self {
        let (sin_latitude, cos_latitude) = libm::sincos(latitude_rad);
        Self {
            sin_latitude,
            cos_latitude,
            meridian_radius_m: meridian_radius_m(sin_latitude) + height_m,
            transverse_radius_m: transverse_radius_m(sin_latitude) + height_m,
            gravity_mps2: normal_gravity_mps2(sin_latitude, height_m),
        }
    }

    /// Earth rate ω_ie in n: Ω (cos L, 0, −sin L), rad/s.
    #[must_use]
    #[inline]
    pub fn earth_rate(&self) -> Vector3<f64> {
        Vector3::new(
            EARTH_RATE_RADPS * self.cos_latitude,
            0.0,
            -EARTH_RATE_RADPS * self.sin_latitude,
        )
    }

    /// Transport rate ω_en in n for a velocity over ground in n (m/s), rad/s.
    #[must_use]
    #[inline]
    pub fn transport_rate(&self, velocity_mps: &Vector3<f64>) -> Vector3<f64> {
        let east = velocity_mps.y / self.transverse_radius_m;
        Vector3::new(
            east,
            -velocity_mps.x / self.meridian_radius_m,
            -east * self.sin_latitude / self.cos_latitude,
        )
    }

    /// Latitude and longitude rates (rad/s) for a velocity over ground in n (m/s).
    #[must_use]
    #[inline]
    pub fn position_rate(&self, velocity_mps: &Vector3<f64>) -> (f64, f64) {
        (
            velocity_mps.x / self.meridian_radius_m,
            velocity_mps.y / (self.transverse_radius_m * self.cos_latitude),
        )
    }

    /// Schuler period along the meridian 2π √((R_M + h)/g), s.
    #[must_use]
    pub fn schuler_period_s(&self) -> f64 {
        2.0 * core::f64::consts::PI * libm::sqrt(self.meridian_radius_m / self.gravity_mps2)
    }
}

/// Meridian radius of curvature R_M at height 0, m.
#[must_use]
pub fn meridian_radius_m(sin_latitude: f64) -> f64 {
    let w2 = 1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude;
    SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / (w2 * libm::sqrt(w2))
}

/// Transverse radius of curvature R_N at height 0, m.
#[must_use]
pub fn transverse_radius_m(sin_latitude: f64) -> f64 {
    SEMI_MAJOR_AXIS_M / libm::sqrt(1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude)
}

/// Normal gravity, positive down, m/s²: Somigliana on the ellipsoid, and the second-order series
/// in height of NIMA TR8350.2, eq. 4-3, above it.
#[must_use]
pub fn normal_gravity_mps2(sin_latitude: f64, height_m: f64) -> f64 {
    let s2 = sin_latitude * sin_latitude;
    let surface = EQUATOR_GRAVITY_MPS2 * (1.0 + SOMIGLIANA_K * s2)
        / libm::sqrt(1.0 - ECCENTRICITY_SQUARED * s2);
    let h = height_m / SEMI_MAJOR_AXIS_M;
    surface
        * (1.0 - 2.0 * (1.0 + FLATTENING + GRAVITY_RATIO - 2.0 * FLATTENING * s2) * h + 3.0 * h * h)
}
