//! Texts of the FMUs, and their end.

use super::Simulation;
use crate::error::MasterError;
use crate::single::output::read_texts;

impl Simulation<'_> {
    /// Reads the outputs that are texts and bytes.
    ///
    /// # Errors
    /// If an FMU fails.
    pub fn read_written(&mut self) -> Result<(), MasterError> {
        let time_s = self.time_s(self.step);
        self.written.clear();
        for (node, of) in self.system.nodes.iter().enumerate() {
            for (_, group) in &of.written {
                let read = read_texts(self.instances[node].as_mut(), group, &mut self.written);
                read.map_err(self.failed(node, time_s))?;
            }
        }
        Ok(())
    }

    /// Terminates all FMUs in order.
    ///
    /// # Errors
    /// If one fails; the others are terminated all the same.
    pub fn terminate(&mut self) -> Result<(), MasterError> {
        let time_s = self.time_s(self.step);
        let mut first = Ok(());
        for node in 0..self.instances.len() {
            let ended = self.instances[node].terminate().map_err(self.failed(node, time_s));
            if first.is_ok() {
                first = ended;
            }
        }
        first
    }

    /// Frees all FMUs and unloads their libraries; returns the first failure.
    ///
    /// # Errors
    /// If an FMU crashes or hangs on the way.
    pub fn finish(&mut self) -> Result<(), MasterError> {
        let time_s = self.time_s(self.step);
        let mut first = Ok(());
        for node in 0..self.instances.len() {
            let ended = self.instances[node].finish().map_err(self.failed(node, time_s));
            if first.is_ok() {
                first = ended;
            }
        }
        first
    }
}
