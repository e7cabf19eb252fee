//! What a model has to do. The C interface does the rest, the same for all of them.

use crate::table::Model;
use crate::values::Values;

/// A model in an instance, from the end of initialization on.
///
/// A clone goes on exactly as the original would: it is how FMU states are kept.
pub trait Component: Clone + Send + Sized + 'static {
    /// The table of its variables.
    const MODEL: &'static Model;

    /// Makes it from its parameters and start values, and sets the outputs that hold at the start.
    /// Called when initialization ends; also with other parameters, to check them.
    ///
    /// # Errors
    /// If parameters contradict themselves: which variables, what was found and what is expected.
    fn initialize(values: &mut Values) -> Result<Self, String>;

    /// Sample period, ns: time is an integer number of them.
    fn period_ns(&self) -> u64;

    /// One sample period: takes the inputs from `values` and puts the outputs there. Parameters that
    /// are tunable may have changed.
    ///
    /// # Errors
    /// If an input can't be used; the component and its outputs are as before.
    fn step(&mut self, values: &mut Values) -> Result<(), String>;

    /// The simulation has ended: brings the outputs up to date that only the end can.
    fn terminate(&mut self, values: &mut Values) {
        let _ = values;
    }

    /// What happened in the last step that a person wants to read, once: for the log. Asked after
    /// every step, so that nothing is all that it may cost in nearly all of them.
    fn remark(&mut self) -> Option<String> {
        None
    }

    /// The bus that it is on; none of those that step with time are on one.
    fn network(&mut self) -> Option<&mut dyn Network> {
        None
    }

    /// Everything that it needs to go on, but its values, as bytes; see [`Self::load`].
    fn save(&self, bytes: &mut Vec<u8>);

    /// From the bytes of [`Self::save`], and the values that belong to them.
    ///
    /// # Errors
    /// If the bytes are not those of such a component.
    fn load(bytes: &[u8], values: &Values) -> Result<Self, String>;
}

/// A component on a bus: it is told what comes at a time, and says when it wants to send. Between
/// events nothing happens but that time goes on.
pub trait Network {
    /// Bytes have come.
    fn receive(&mut self, bytes: &[u8], time_s: f64, values: &mut Values);

    /// What it sends now, at most so many bytes. What doesn't fit it sends the next time.
    fn send(&mut self, time_s: f64, max_bytes: usize, values: &mut Values) -> Vec<u8>;

    /// When it wants to send: now or later. `None`: it doesn't know yet.
    fn due_s(&self, time_s: f64) -> Option<f64>;
}
