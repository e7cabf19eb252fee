//! Loads the library of an FMU, makes an instance, initializes it, makes one step and frees it.
//!
//! The check runs the FMU's code. In a process of its own the code can crash and hang without harm
//! to this process; it still has all rights of the user.

use super::Checked;
use super::finding::Place;
use super::rules::{
    LOAD_INSTANTIATES, LOAD_NOT_TRIED, LOAD_OPENS, LOAD_STARTS, LOAD_STEPS, LOAD_SURVIVES,
    LOAD_TOOL, Rule,
};
use octant_fmu_host::description::{Causality, Description, Initial, Variable, VariableType};
use octant_fmu_host::instance::open::{FmuOpenError, SOLVES, open_archive};
use octant_fmu_host::instance::{
    AccessPlan, Instance, InstanceError, InterfaceKind, OpenOptions, StepOutcome, whole,
};

/// Step of an FMU whose description has none, s.
const STEP_S: f64 = 0.01;

/// Largest number of variables compared with their start values.
const STARTS_MAX: usize = 100_000;

/// Loads the FMU with each of its interfaces, and makes an instance; with `step` the instance is
/// initialized, and makes a first step. Failures become findings.
pub fn load(checked: &mut Checked, options: &OpenOptions, step: bool) {
    let Some(description) = checked.description.clone() else { return };
    let kinds = [
        (InterfaceKind::CoSimulation, "CoSimulation", &description.co_simulation),
        (InterfaceKind::ModelExchange, "ModelExchange", &description.model_exchange),
    ];
    for (kind, name, interface) in kinds {
        let Some(interface) = interface else { continue };
        let place = Place { subject: name, ..Place::default() };
        if kind == InterfaceKind::ModelExchange && !SOLVES {
            not_tried(
                checked,
                name,
                "this program was built without the solver for model exchange",
            );
            continue;
        }
        // An FMU that needs its tool can't be judged without it, and might start it unasked.
        if interface.needs_execution_tool {
            let found = match &description.generation_tool[..] {
                "" => "it needs the tool that made it".to_owned(),
                tool => format!("it needs the tool that made it, {tool}"),
            };
            let expected = "an FMU that stands alone, or --allow-tool where the tool is installed";
            checked.findings.add(&LOAD_TOOL, place, found, expected);
            if !options.allow_tool {
                continue;
            }
        }
        let options = OpenOptions { interface: kind, ..options.clone() };
        if let Err(failure) = one(checked, &description, &options, name, step) {
            checked.findings.add(failure.rule, place, failure.found, failure.rule.says);
        }
    }
    if description.scheduled_execution.is_some() {
        let why = "octant fmu run --interface scheduled-execution runs it";
        not_tried(checked, "ScheduledExecution", why);
    }
}

/// Notes an interface that isn't tried, which is no error of the FMU.
fn not_tried(checked: &mut Checked, name: &str, why: &str) {
    let place = Place { subject: name, ..Place::default() };
    checked.findings.add(
        &LOAD_NOT_TRIED,
        place,
        format!("not tried: {why}"),
        "an interface that is loaded",
    );
}

/// A failed call, and the rule that it breaks.
struct Failure {
    rule: &'static Rule,
    found: String,
}

impl Failure {
    /// Assigns an error to a rule: `rule` is that of the call.
    fn of(error: &InstanceError, rule: &'static Rule) -> Self {
        let rule = match error {
            InstanceError::Process { .. } => &LOAD_SURVIVES,
            InstanceError::Load { .. } => &LOAD_OPENS,
            _ => rule,
        };
        Self { rule, found: error.to_string() }
    }
}

/// Loads one interface.
fn one(
    checked: &mut Checked,
    description: &Description,
    options: &OpenOptions,
    name: &str,
    step: bool,
) -> Result<(), Failure> {
    let mut instance =
        open_archive(&mut checked.archive, options).map_err(|error| match error {
            FmuOpenError::Instance(error) => Failure::of(&error, &LOAD_INSTANTIATES),
            error => Failure { rule: &LOAD_OPENS, found: error.to_string() },
        })?;
    if step {
        first_step(&mut *instance, checked, description, name)?;
    }
    // A crash or hang at the end changes no result, but breaks other importers.
    instance.finish().map_err(|error| Failure::of(&error, &LOAD_SURVIVES))
}

/// Initializes an instance, and makes its first step.
fn first_step(
    instance: &mut dyn Instance,
    checked: &mut Checked,
    description: &Description,
    name: &str,
) -> Result<(), Failure> {
    let experiment = description.default_experiment;
    let start_s = experiment.start_s.filter(|start| start.is_finite()).unwrap_or(0.0);
    let initialize = |error: InstanceError| Failure::of(&error, &LOAD_INSTANTIATES);
    instance.enter_initialization(start_s, None, experiment.tolerance).map_err(initialize)?;
    if let Some(found) = other_starts(instance, description).map_err(initialize)? {
        let place = Place { subject: name, ..Place::default() };
        checked.findings.add(&LOAD_STARTS, place, found, "the start values of the description");
    }
    if instance.exit_initialization().map_err(initialize)? {
        return Ok(());
    }
    let fixed = description.co_simulation.as_ref().and_then(|cs| cs.fixed_internal_step_s);
    let step_s = [experiment.step_s, fixed]
        .into_iter()
        .flatten()
        .find(|&step| step > 0.0 && step.is_finite())
        .unwrap_or(STEP_S);
    let steps = |error: InstanceError| Failure::of(&error, &LOAD_STEPS);
    let stepped = instance.advance(start_s, step_s).map_err(steps)?;
    if stepped.outcome == StepOutcome::Discarded {
        let found = format!("a step of {step_s} s from {start_s} s is refused");
        return Err(Failure { rule: &LOAD_STEPS, found });
    }
    instance.terminate().map_err(steps)
}

/// Finds a variable with `initial` exact that has another value than its start value before it was
/// set.
fn other_starts(
    instance: &mut dyn Instance,
    description: &Description,
) -> Result<Option<String>, InstanceError> {
    let is_exact = |variable: &&Variable| {
        let number = !matches!(
            variable.kind,
            VariableType::String | VariableType::Binary | VariableType::Clock
        );
        let exact =
            variable.initial == Some(Initial::Exact) || variable.causality == Causality::Input;
        number && exact && !variable.start.is_empty() && variable.clocks.is_empty()
    };
    let variables: Vec<&Variable> =
        description.variables.iter().filter(is_exact).take(STARTS_MAX).collect();
    let plan = AccessPlan::exactly(description, &variables)?;
    // Variables that can't be read don't count as different; another rule reports a missing
    // function.
    let mut values = vec![None; plan.elements];
    let mut first = 0;
    for group in &plan.groups {
        let mut numbers = vec![0.0; group.elements];
        match instance.get(group, &mut numbers) {
            Ok(()) => {
                for (value, number) in values[first..].iter_mut().zip(numbers) {
                    *value = Some(number);
                }
            }
            Err(InstanceError::Unsupported { .. }) => {}
            Err(error) => return Err(error),
        }
        first += group.elements;
    }
    for (variable, place) in variables.iter().zip(&plan.places) {
        for (element, value) in values[place.clone()].iter().enumerate() {
            let text = variable.start.get(element).or(variable.start.first());
            let start = text.and_then(|text| start(variable.kind, text));
            let (Some(start), Some(value)) = (start, value) else { continue };
            // A start value may be NaN.
            let alike = !whole::is_wide(variable.kind) && *value == start;
            if value.to_bits() != start.to_bits() && !alike {
                let (name, kind) = (&variable.name, variable.kind);
                let [value, start] = [*value, start].map(|number| told(kind, number));
                return Ok(Some(format!("{name:?} is {value}, its start value is {start}")));
            }
        }
    }
    Ok(None)
}

/// Returns a value as it is exchanged in words.
fn told(kind: VariableType, value: f64) -> String {
    match whole::is_wide(kind) {
        true => whole::from_bits(kind, value).to_string(),
        false => value.to_string(),
    }
}

/// Reads a start value as f64, the form in which numbers are exchanged.
fn start(kind: VariableType, text: &str) -> Option<f64> {
    use octant_fmu_host::description::xml::{boolean, real};
    match kind {
        VariableType::Boolean => boolean(text).map(f64::from),
        kind if whole::is_wide(kind) => whole::to_bits(kind, whole::parse(text)?),
        VariableType::Float32 => text.trim().parse::<f32>().ok().map(f64::from),
        _ => real(text),
    }
}
