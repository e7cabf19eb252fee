//! Lasting disturbances: data that the plant keeps from their onset to their end.

use octant_sample::disturbance::{Gimbal, GimbalAction};

/// A lasting disturbance that has not ended.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) enum Lasting {
    Gimbal(usize, GimbalAction),
    LeverArm([[f64; 3]; 3]),
}

/// Lasting disturbances that have not ended, in the order of their onsets.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Registry {
    all: Vec<(u32, Lasting)>,
}

impl Registry {
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    pub(super) fn enter(&mut self, handle: u32, lasting: Lasting) {
        self.all.push((handle, lasting));
    }

    /// Removes the disturbance of a handle.
    pub(super) fn leave(&mut self, handle: u32) -> Option<Lasting> {
        let found = self.all.iter().position(|(known, _)| *known == handle)?;
        Some(self.all.remove(found).1)
    }

    pub(super) fn lever_arms(&self) -> impl Iterator<Item = &[[f64; 3]; 3]> {
        self.all.iter().filter_map(|(_, lasting)| match lasting {
            Lasting::LeverArm(arms) => Some(arms),
            Lasting::Gimbal(..) => None,
        })
    }

    /// Actions of faults on a gimbal.
    pub(super) fn of(&self, gimbal: usize) -> impl Iterator<Item = GimbalAction> + '_ {
        self.with_handles(gimbal).map(|(_, action)| action)
    }

    /// Actions of faults on a gimbal, with their handles.
    pub(super) fn with_handles(
        &self,
        gimbal: usize,
    ) -> impl Iterator<Item = (u32, GimbalAction)> + '_ {
        self.all.iter().filter_map(move |(handle, lasting)| match lasting {
            Lasting::Gimbal(known, action) if *known == gimbal => Some((*handle, *action)),
            _ => None,
        })
    }

    /// Returns whether the disturbance of a handle has not ended.
    pub(super) fn holds(&self, handle: u32) -> bool {
        self.all.iter().any(|(known, _)| *known == handle)
    }

    /// Returns whether an encoder flags its angle as invalid.
    pub(crate) fn flags_gimbal(&self) -> bool {
        [Gimbal::Azimuth, Gimbal::Roll].into_iter().any(|gimbal| {
            self.of(gimbal.index())
                .any(|action| matches!(action, GimbalAction::EncoderSlip { flagged: true, .. }))
        })
    }
}
