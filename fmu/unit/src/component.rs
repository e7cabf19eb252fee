//! Interface of a model. The C interface does the rest, the same for all models.

use crate::table::Model;
use crate::values::CellValues;

/// A model in an instance, from the end of initialization on.
///
/// A clone continues exactly as the original: FMU states are stored as clones.
pub trait ModelComponent: Clone + Send + Sync + Sized + 'static {
    /// Table of the model's variables.
    const MODEL: &'static Model;

    /// Reason why a component can't be made, stepped or loaded.
    type Error: core::error::Error + Send + Sync + 'static;

    /// Makes the model from its parameters and start values, and sets the outputs that hold at the
    /// start. Called when initialization ends; also with other parameters, to check them.
    ///
    /// # Errors
    /// If parameters contradict each other: the variables, the value found and the values expected.
    fn initialize(values: &mut CellValues) -> Result<Self, Self::Error>;

    /// Sample period, ns; time is an integer number of periods.
    fn period_ns(&self) -> u64;

    /// Takes tunable parameters that have changed after the initialization, for the next step and
    /// all later ones. Outputs stay as they are until then. A model that reads its tunable
    /// parameters in every step has nothing to do.
    ///
    /// # Errors
    /// If the parameters contradict each other; the component is as before, and so are the values.
    fn tune(&mut self, values: &CellValues) -> Result<(), Self::Error> {
        let _ = values;
        Ok(())
    }

    /// Makes one sample period: takes the inputs from `values` and writes the outputs there.
    ///
    /// # Errors
    /// If an input can't be used; the component and its outputs are as before.
    fn step(&mut self, values: &mut CellValues) -> Result<(), Self::Error>;

    /// Makes a further sample period of the same communication step. Outputs that are increments become
    /// those since the beginning of the communication step.
    ///
    /// # Errors
    /// As [`Self::step`].
    fn step_further(&mut self, values: &mut CellValues) -> Result<(), Self::Error> {
        self.step(values)
    }

    /// Ends the simulation: updates the outputs that change only at the end.
    fn terminate(&mut self, values: &mut CellValues) {
        let _ = values;
    }

    /// Returns a remark on the last step for the log, once. Called after every step, so that it
    /// must cost nothing in nearly all of them.
    fn remark(&mut self) -> Option<String> {
        None
    }

    /// Returns the component's bus; components that step with time have none.
    fn network(&mut self) -> Option<&mut dyn Network> {
        None
    }

    /// Saves everything but the values that the component needs to continue; see [`Self::load`].
    fn save(&self, bytes: &mut Vec<u8>);

    /// Loads the bytes of [`Self::save`], with the values that belong to them.
    ///
    /// # Errors
    /// If the bytes are not those of such a component.
    fn load(bytes: &[u8], values: &CellValues) -> Result<Self, Self::Error>;
}

/// A component on a bus: it is told of data with its time, and reports when it wants to send.
/// Between events only time advances.
pub trait Network {
    /// Receives bytes.
    fn receive(&mut self, bytes: &[u8], time_s: f64, values: &mut CellValues);

    /// Returns the bytes to send now, at most `max_bytes`; the rest is sent the next time.
    fn send(&mut self, time_s: f64, max_bytes: usize, values: &mut CellValues) -> Vec<u8>;

    /// Time at which the component wants to send, now or later; `None`: not known yet.
    fn due_s(&self, time_s: f64) -> Option<f64>;
}
