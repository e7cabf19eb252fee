//! Inputs that an FMU refuses.

use super::Simulation;
use crate::error::{MasterError, is_refusal};
use crate::values::told;
use octant_fmu_host::instance::{InstanceError, VariableGroup};

impl Simulation<'_> {
    /// Finds out which inputs an FMU refused. An input that a fault has altered keeps its previous
    /// value.
    #[cold]
    pub(super) fn set_one_by_one(&mut self, node: usize, time_s: f64) -> Result<(), MasterError> {
        let side = &self.system.nodes[node].inputs;
        for (number, range) in side.variables.iter().zip(&side.plan.places) {
            let instance = &mut self.instances[node];
            let description = instance.description();
            let variable = &description.variables[*number];
            let kind = variable.kind;
            let group = VariableGroup::of(description, variable).map(VariableGroup::exactly);
            let set =
                group.and_then(|group| instance.set(&group, &self.inputs[node][range.clone()]));
            let error = match set {
                Ok(()) => continue,
                Err(error) if is_refusal(&error) => error,
                Err(error) => return Err(self.failed(node, time_s)(error)),
            };
            let wires = self.into[node]
                .iter()
                .filter(|wire| range.contains(&self.system.wires[**wire].to.place));
            let wires: Vec<usize> = wires.copied().collect();
            let acts = |wire: &&usize| {
                self.faulting.as_ref().is_some_and(|faulting| faulting.station.acts_on(**wire))
            };
            if wires.iter().any(|wire| acts(&wire)) {
                self.counts[node].refused += 1;
                continue;
            }
            let said = match error {
                InstanceError::Failed { said, .. } => said,
                _ => String::new(),
            };
            let wire = wires.first().map(|wire| &self.system.wires[*wire]);
            return Err(MasterError::Refused {
                target: wire.map_or_else(String::new, |wire| wire.target.clone()),
                value: wire
                    .map_or_else(String::new, |wire| told(kind, self.inputs[node][wire.to.place])),
                time_s,
                said,
            });
        }
        Ok(())
    }
}
