//! FMUs in a few lines: a description as text, and a law that steps numbers.

use octant_fmu_host::description::{Description, read};
use octant_fmu_host::instance::{
    FmuMessage, Instance, InstanceError, StepOutcome, Stepped, Update, VariableGroup,
};
use std::collections::BTreeMap;

/// Numbers of a toy, by value reference.
pub(super) type Numbers = BTreeMap<u32, f64>;

/// Step of a toy: its numbers, the time and the length.
pub(super) type Law = Box<dyn FnMut(&mut Numbers, f64, f64) -> Stepped + Send>;

/// Calculation at every access: outputs with direct feedthrough.
pub(super) type Algebra = fn(&mut Numbers);

/// FMU for tests.
pub(super) struct Toy {
    description: Description,
    numbers: Numbers,
    texts: BTreeMap<u32, String>,
    law: Law,
    algebra: Algebra,
    /// True if it refuses NaN.
    pub refuses_nan: bool,
    states: BTreeMap<u64, Numbers>,
    next_state: u64,
    /// Log of calls.
    pub calls: std::sync::Arc<std::sync::Mutex<Vec<String>>>,
}

/// Returns a step that was done.
pub(super) fn done(time_s: f64, step_s: f64) -> Stepped {
    Stepped { time_s: time_s + step_s, outcome: StepOutcome::Done, event: false, terminate: false }
}

/// Returns a step that was refused after a part of it.
pub(super) fn refused(reached_s: f64) -> Stepped {
    Stepped { time_s: reached_s, outcome: StepOutcome::Discarded, event: false, terminate: false }
}

/// Builds a description of FMI 2.0: inputs and outputs (`name:unit`, `name` for plain numbers),
/// with value references counted from 1, and the dependencies of each output.
pub(super) fn describe(
    model: &str,
    inputs: &[&str],
    outputs: &[(&str, Option<&[usize]>)],
    able: bool,
) -> Description {
    let mut variables = String::new();
    let mut add = |text: &str, causality: &str, number: usize| {
        let (name, unit) = text.split_once(':').map_or((text, ""), |(name, unit)| (name, unit));
        let (name, kind) = name.split_once('/').unwrap_or((name, "Real"));
        let unit = if unit.is_empty() { String::new() } else { format!(" unit=\"{unit}\"") };
        let start = match (kind, causality) {
            (_, "output") => String::new(),
            ("Real", _) => " start=\"0\"".to_owned(),
            ("Integer", _) => " start=\"0\"".to_owned(),
            ("Boolean", _) => " start=\"false\"".to_owned(),
            _ => " start=\"\"".to_owned(),
        };
        let variability = if kind == "Real" { "continuous" } else { "discrete" };
        variables += &format!(
            "<ScalarVariable name=\"{name}\" valueReference=\"{number}\" causality=\"{causality}\" \
             variability=\"{variability}\"><{kind}{unit}{start}/></ScalarVariable>\n"
        );
    };
    for (at, input) in inputs.iter().enumerate() {
        add(input, "input", at + 1);
    }
    let (mut listed, first) = (String::new(), inputs.len());
    for (at, (output, depends_on)) in outputs.iter().enumerate() {
        let number = first + at + 1;
        add(output, "output", number);
        let depends_on = depends_on.map_or_else(String::new, |list| {
            let list: Vec<String> = list.iter().map(|n| (n + 1).to_string()).collect();
            format!(" dependencies=\"{}\"", list.join(" "))
        });
        listed += &format!("<Unknown index=\"{number}\"{depends_on}/>");
    }
    let text = format!(
        "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{model}\" guid=\"{model}\">\
         <CoSimulation modelIdentifier=\"{model}\" canGetAndSetFMUstate=\"{able}\" \
         canHandleVariableCommunicationStepSize=\"{able}\"/>\
         <ModelVariables>{variables}</ModelVariables>\
         <ModelStructure><Outputs>{listed}</Outputs>\
         <InitialUnknowns>{listed}</InitialUnknowns></ModelStructure></fmiModelDescription>"
    );
    read(&text, model).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

impl Toy {
    pub(super) fn new(
        description: Description,
        start: &[(u32, f64)],
        law: Law,
        algebra: Algebra,
    ) -> Self {
        let mut numbers: Numbers =
            description.variables.iter().map(|variable| (variable.reference, 0.0)).collect();
        numbers.extend(start.iter().copied());
        Self {
            description,
            numbers,
            texts: BTreeMap::new(),
            law,
            algebra,
            refuses_nan: false,
            states: BTreeMap::new(),
            next_state: 0,
            calls: Default::default(),
        }
    }

    fn note(&self, what: impl Into<String>) {
        self.calls.lock().unwrap().push(what.into());
    }
}

impl Instance for Toy {
    fn name(&self) -> &str {
        &self.description.model_name
    }

    fn description(&self) -> &Description {
        &self.description
    }

    fn enter_initialization(
        &mut self,
        _: f64,
        _: Option<f64>,
        _: Option<f64>,
    ) -> Result<(), InstanceError> {
        Ok(())
    }

    fn exit_initialization(&mut self) -> Result<bool, InstanceError> {
        Ok(false)
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        if self.refuses_nan && values.iter().any(|value| !value.is_finite()) {
            return Err(InstanceError::Failed {
                fmu: self.name().to_owned(),
                function: "fmi2SetReal".to_owned(),
                status: "discard".to_owned(),
                said: ": not a number".to_owned(),
            });
        }
        for (reference, value) in group.references.iter().zip(values) {
            self.numbers.insert(*reference, *value);
        }
        Ok(())
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        (self.algebra)(&mut self.numbers);
        for (reference, value) in group.references.iter().zip(values) {
            *value = self.numbers[reference];
        }
        Ok(())
    }

    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError> {
        self.note(format!("text {}", values[0]));
        self.texts.insert(group.references[0], values[0].clone());
        Ok(())
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        let number = self.numbers.values().next().copied().unwrap_or_default();
        Ok(vec![self.texts.get(&group.references[0]).cloned().unwrap_or(format!("is {number}"))])
    }

    fn set_binaries(&mut self, _: &VariableGroup, _: &[Vec<u8>]) -> Result<(), InstanceError> {
        unreachable!("toys have no bytes")
    }

    fn get_binaries(&mut self, _: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
        unreachable!("toys have no bytes")
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        self.note(format!("step {time_s} {step_s}"));
        Ok((self.law)(&mut self.numbers, time_s, step_s))
    }

    fn handle_events(&mut self) -> Result<bool, InstanceError> {
        self.note("events");
        Ok(false)
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        Ok(())
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        Ok(Update::default())
    }

    fn leave_event_mode(&mut self) -> Result<(), InstanceError> {
        Ok(())
    }

    fn keep_state(&mut self) -> Result<u64, InstanceError> {
        self.next_state += 1;
        self.states.insert(self.next_state, self.numbers.clone());
        Ok(self.next_state)
    }

    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.note("back");
        self.numbers = self.states[&state].clone();
        Ok(())
    }

    fn forget_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.states.remove(&state).map(|_| ()).ok_or_else(|| InstanceError::State {
            fmu: self.name().to_owned(),
            reason: "isn't one of its".to_owned(),
        })
    }

    fn state_to_bytes(&mut self, _: u64) -> Result<Vec<u8>, InstanceError> {
        unreachable!("the master keeps states, not bytes")
    }

    fn state_from_bytes(&mut self, _: &[u8]) -> Result<u64, InstanceError> {
        unreachable!("the master keeps states, not bytes")
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        unreachable!("the master resets nothing")
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        self.note("end");
        assert!(self.states.is_empty(), "no state is left behind");
        Ok(())
    }

    fn messages(&mut self) -> Vec<FmuMessage> {
        vec![FmuMessage {
            status: "discard".into(),
            category: "step".into(),
            text: "too long for me".into(),
        }]
    }
}
