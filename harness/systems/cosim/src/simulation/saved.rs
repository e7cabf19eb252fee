//! Saved states of the FMUs, and the return to them after a step was discarded.

use super::{Abilities, Simulation};
use crate::error::MasterError;

impl Simulation<'_> {
    /// Saves the states of all FMUs.
    pub(super) fn keep(&mut self, time_s: f64) -> Result<(), MasterError> {
        self.states.clear();
        for node in 0..self.instances.len() {
            let state = self.instances[node].keep_state().map_err(self.failed(node, time_s))?;
            self.states.push(state);
            self.before[node].copy_from_slice(&self.outputs[node]);
        }
        Ok(())
    }

    pub(super) fn forget(&mut self, time_s: f64) -> Result<(), MasterError> {
        for node in 0..self.states.len() {
            let state = self.states[node];
            self.instances[node].forget_state(state).map_err(self.failed(node, time_s))?;
        }
        self.states.clear();
        Ok(())
    }

    /// Returns all FMUs to their saved states.
    pub(super) fn go_back(&mut self, time_s: f64) -> Result<(), MasterError> {
        for node in 0..self.states.len() {
            let state = self.states[node];
            self.instances[node].restore_state(state).map_err(self.failed(node, time_s))?;
            self.outputs[node].copy_from_slice(&self.before[node]);
        }
        self.forget(time_s)
    }

    /// Computes the length of a shorter part after a step was discarded.
    pub(super) fn shorter(
        &mut self,
        node: usize,
        time_s: f64,
        length_s: f64,
        reached_s: f64,
    ) -> Result<f64, MasterError> {
        let reason = if self.rolls_back {
            // Up to the time that the FMU reached, if that part is long enough.
            let came_s = reached_s - time_s;
            let shorter = if came_s > 0.0 && came_s < length_s { came_s } else { length_s / 2.0 };
            let smallest = self.settings.step_s * 0.5f64.powi(self.settings.halvings as i32);
            if shorter >= smallest {
                return Ok(shorter);
            }
            format!("parts of less than {smallest} s are not tried")
        } else {
            let unable = |can: fn(&Abilities) -> bool| -> Vec<&str> {
                let unable = self.abilities.iter().zip(&self.system.nodes);
                unable.filter(|(one, _)| !can(one)).map(|(_, node)| node.name.as_str()).collect()
            };
            let mut reasons = Vec::new();
            let no_state = unable(|one| one.state);
            if !no_state.is_empty() {
                reasons.push(format!("{} can't go back to a kept state", no_state.join(" and ")));
            }
            let no_step = unable(|one| one.variable_step);
            if !no_step.is_empty() {
                reasons.push(format!("{} can't make shorter steps", no_step.join(" and ")));
            }
            reasons.join("; ")
        };
        let messages = self.instances[node].messages();
        let last = messages.iter().rev().find(|message| message.status != "ok");
        Err(MasterError::Discarded {
            node: self.system.nodes[node].name.clone(),
            time_s,
            end_s: time_s + length_s,
            said: last.map_or_else(String::new, |message| format!(": {}", message.text.trim())),
            reason,
        })
    }
}
