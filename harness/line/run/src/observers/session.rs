//! Attitude answers of a session at whole seconds, and the dither of its samples, for the comparison with another session of
//! the same unit.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::{Epoch, Mode, Output};
use octant_score::sessions::SessionPoint;
use octant_source::session_dither::SessionDither;

const SECOND_NS: u64 = 1_000_000_000;
/// Most points that are kept; beyond, every second one is dropped.
const POINTS_MAX: usize = 1 << 15;

/// A session of a unit that may remember another one.
#[derive(Clone, Copy, Debug)]
pub struct Session {
    /// True if it comes before the other one.
    pub is_first: bool,
    /// SessionDither of its samples.
    pub dither: Option<SessionDither>,
}

/// Evidence in a session's answers.
#[derive(Clone, Debug)]
pub struct SessionTrack {
    /// The session.
    pub session: Session,
    /// Answers at whole seconds.
    pub points: Vec<SessionPoint>,
    /// SessionDither so far, n frame, counts.
    sum_counts: Vector3<f64>,
    stride_s: u64,
    /// False for a unit without an attitude.
    tells_attitude: bool,
}

impl SessionTrack {
    pub(crate) fn of(session: Session, tells_attitude: bool) -> Self {
        let sum_counts = Vector3::zeros();
        Self { session, points: Vec::new(), sum_counts, stride_s: 1, tells_attitude }
    }

    /// Takes the answer to an epoch.
    pub(super) fn answer(&mut self, sent: &Epoch, output: &Output) {
        if !self.tells_attitude || !matches!(output.mode, Mode::Calibrating | Mode::Navigating) {
            return;
        }
        let q_nb = output.navigation.q_nb;
        if let Some(dither) = &self.session.dither {
            let [w, x, y, z] = q_nb;
            let to_n = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            self.sum_counts += to_n * Vector3::from(dither.at(sent.sample.sequence).map(f64::from));
        }
        let time_ns = sent.sample.device_time.ns;
        let second = time_ns / SECOND_NS;
        if !time_ns.is_multiple_of(SECOND_NS) || !second.is_multiple_of(self.stride_s) {
            return;
        }
        let dither_rad = (self.sum_counts * DELTA_THETA_LSB_RAD).into();
        let navigation = &output.navigation;
        let position_rad = (output.mode == Mode::Navigating)
            .then_some([navigation.latitude_rad, navigation.longitude_rad]);
        self.points.push(SessionPoint { second, q_nb, position_rad, dither_rad });
        if self.points.len() > POINTS_MAX {
            self.stride_s *= 2;
            let stride_s = self.stride_s;
            self.points.retain(|point| point.second.is_multiple_of(stride_s));
        }
    }
}
