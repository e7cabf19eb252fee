//! The turntable alone: the plant's gimbals without an instrument on them.
//!
//! For a simulated table controller: the same drives, rates and play as in a run, by a clock that
//! the caller reads.

use crate::config::TurntableConfig;
use crate::gimbal::Gimbal;
use octant_sample::GimbalAngles;

/// Gimbal of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GimbalAxis {
    /// Inner gimbal.
    Azimuth,
    /// Outer gimbal.
    Roll,
}

/// Present motion of a gimbal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisMotion {
    /// Angle that the encoder reads, rad.
    pub angle_rad: f64,
    /// Rate of the drive, rad/s.
    pub rate_radps: f64,
    /// True while a move goes on.
    pub moves: bool,
}

/// Two gimbals at rest at zero, at time 0. Times are nanoseconds that never go back.
#[derive(Clone, Debug)]
pub struct GimbalTable {
    azimuth: Gimbal,
    roll: Gimbal,
    rate_radps: f64,
    now_ns: u64,
}

impl GimbalTable {
    /// Makes a table with the rates, accelerations and play of a configuration, and encoders
    /// without error.
    #[must_use]
    pub fn new(config: &TurntableConfig) -> Self {
        let gimbal =
            Gimbal::new(config.rate_radps, config.acceleration_radps2, config.backlash_rad);
        Self { azimuth: gimbal, roll: gimbal, rate_radps: config.rate_radps, now_ns: 0 }
    }

    /// Turns to an angle at no more than a rate. An angle that isn't finite, or a rate that isn't
    /// above 0, is ignored; a rate above that of the drive is limited to it.
    pub fn go_to(&mut self, axis: GimbalAxis, angle_rad: f64, rate_radps: f64, now_ns: u64) {
        if !angle_rad.is_finite() || !(rate_radps > 0.0) {
            return;
        }
        let target = GimbalAngles::from_rad(angle_rad, 0.0).azimuth;
        let rate = rate_radps.min(self.rate_radps);
        let now_ns = self.at(now_ns);
        self.gimbal(axis).aim(target, rate, now_ns);
    }

    /// Turns on with a constant rate; 0 brakes and stops. A rate that isn't finite is ignored.
    pub fn run_on(&mut self, axis: GimbalAxis, rate_radps: f64, now_ns: u64) {
        if !rate_radps.is_finite() {
            return;
        }
        let rate = rate_radps.clamp(-self.rate_radps, self.rate_radps);
        let now_ns = self.at(now_ns);
        self.gimbal(axis).run_on(rate, now_ns);
    }

    /// Present motion of a gimbal.
    #[must_use]
    pub fn motion(&self, axis: GimbalAxis, now_ns: u64) -> AxisMotion {
        let gimbal = match axis {
            GimbalAxis::Azimuth => &self.azimuth,
            GimbalAxis::Roll => &self.roll,
        };
        let now_ns = now_ns.max(self.now_ns);
        AxisMotion {
            angle_rad: gimbal.read(now_ns),
            rate_radps: gimbal.drive.at(gimbal.drive.seconds(now_ns)).rate,
            moves: !gimbal.rests(now_ns),
        }
    }

    fn gimbal(&mut self, axis: GimbalAxis) -> &mut Gimbal {
        match axis {
            GimbalAxis::Azimuth => &mut self.azimuth,
            GimbalAxis::Roll => &mut self.roll,
        }
    }

    /// Advances the time, never back.
    fn at(&mut self, now_ns: u64) -> u64 {
        self.now_ns = self.now_ns.max(now_ns);
        self.now_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND_NS: u64 = 1_000_000_000;

    fn table() -> GimbalTable {
        let degrees = f64::to_radians;
        GimbalTable::new(&TurntableConfig {
            rate_radps: degrees(10.0),
            acceleration_radps2: degrees(10.0),
            encoder_sigma_rad: 0.0,
            non_orthogonality_rad: 0.0,
            backlash_rad: 0.0,
            errors: Default::default(),
        })
    }

    #[test]
    fn a_move_takes_what_a_trapeze_takes() {
        let mut table = table();
        // 90° at 10 °/s with 10 °/s²: 1 s up, 8 s on, 1 s down.
        table.go_to(GimbalAxis::Roll, 90f64.to_radians(), 1.0, 0);
        let at =
            |table: &GimbalTable, ms: u64| table.motion(GimbalAxis::Roll, ms * SECOND_NS / 1000);
        assert!((at(&table, 5000).angle_rad - 45f64.to_radians()).abs() < 1e-8);
        assert!((at(&table, 5000).rate_radps - 10f64.to_radians()).abs() < 1e-12);
        assert!(at(&table, 9999).moves && !at(&table, 10_001).moves);
        // The same set point again is no move; the way back is one.
        table.go_to(GimbalAxis::Roll, 90f64.to_radians(), 1.0, 11 * SECOND_NS);
        assert!(!at(&table, 11_001).moves);
        table.go_to(GimbalAxis::Roll, 0.0, 5f64.to_radians(), 12 * SECOND_NS);
        assert!((at(&table, 20_000).rate_radps + 5f64.to_radians()).abs() < 1e-12);
        // Stop from 5 °/s: half a second, 1.25°.
        let before = at(&table, 20_000).angle_rad;
        table.run_on(GimbalAxis::Roll, 0.0, 20 * SECOND_NS);
        let after = at(&table, 21_000);
        assert!(!after.moves && after.rate_radps == 0.0);
        assert!((after.angle_rad - before + 1.25f64.to_radians()).abs() < 1e-8);
        assert_eq!(table.motion(GimbalAxis::Azimuth, 0).angle_rad, 0.0);
    }
}
