//! FMUs without a library, for tests: our own models behind the trait, and models made of closures.

#![allow(clippy::unwrap_used, reason = "tests")]

use octant_fmu::component::ModelComponent;
use octant_fmu::table::{self, Model};
use octant_fmu::values::CellValues;
use octant_fmu_host::description::{
    ArrayDimension, BaseUnit, Causality, DefaultExperiment, Description, Initial, Interface,
    ModelStructure, Standard, UnitDefinition, Variability, Variable, VariableType,
};
use octant_fmu_host::instance::{
    FmuMessage, Instance, InstanceError, StepOutcome, Stepped, Update, VariableGroup, whole,
};

/// Builds a variable with usual attributes.
pub fn variable(name: &str, reference: u32, kind: VariableType, causality: Causality) -> Variable {
    let fixed = matches!(causality, Causality::Parameter | Causality::StructuralParameter);
    Variable {
        name: name.to_owned(),
        reference,
        description: String::new(),
        kind,
        enumeration: None,
        causality,
        variability: match (fixed, kind.is_float()) {
            (true, _) => Variability::Fixed,
            (false, true) => Variability::Continuous,
            (false, false) => Variability::Discrete,
        },
        initial: fixed.then_some(Initial::Exact),
        dimensions: Vec::new(),
        start: Vec::new(),
        min: None,
        max: None,
        nominal: None,
        unit: None,
        display_unit: None,
        relative_quantity: false,
        declared_type: None,
        aliases: Vec::new(),
        derivative_of: None,
        clocks: Vec::new(),
        previous: None,
        clock: None,
        mime_type: None,
        line: 1,
    }
}

/// Adds attributes to a variable.
pub trait With {
    /// Adds a unit.
    fn in_unit(self, unit: &str) -> Self;
    /// Makes it an array.
    fn array(self, elements: u64) -> Self;
}

impl With for Variable {
    fn in_unit(mut self, unit: &str) -> Self {
        self.unit = Some(unit.to_owned());
        self
    }

    fn array(mut self, elements: u64) -> Self {
        self.dimensions = vec![ArrayDimension::Fixed(elements)];
        self
    }
}

/// Builds a description of these variables.
pub fn description(name: &str, variables: Vec<Variable>) -> Description {
    Description {
        file: format!("{name}.fmu/modelDescription.xml"),
        standard: Standard::Fmi3,
        fmi_version: "3.0".to_owned(),
        model_name: name.to_owned(),
        token: "token".to_owned(),
        description: String::new(),
        version: String::new(),
        generation_tool: String::new(),
        structured_names: true,
        co_simulation: Some(Interface::default()),
        model_exchange: None,
        scheduled_execution: None,
        log_categories: Vec::new(),
        default_experiment: DefaultExperiment::default(),
        units: Vec::new(),
        enumerations: Vec::new(),
        variables,
        structure: ModelStructure::default(),
        event_indicators: 0,
        tolerated: Vec::new(),
    }
}

/// Step of a test model: gets its cells by value reference and the time at the step's end.
pub type StepBehaviour = Box<dyn FnMut(&mut [f64], f64) -> Result<bool, String> + Send>;

/// Model made of a closure. Its cells are numbers; those of an array follow each other from the
/// value reference on.
pub struct Scripted {
    description: Description,
    pub(crate) cells: Vec<f64>,
    behaviour: StepBehaviour,
}

impl Scripted {
    /// Creates a model whose step is `behaviour`; false ends the simulation.
    pub fn boxed(
        description: Description,
        behaviour: impl FnMut(&mut [f64], f64) -> Result<bool, String> + Send + 'static,
    ) -> Box<dyn Instance> {
        Box::new(Self { description, cells: vec![0.0; 64], behaviour: Box::new(behaviour) })
    }

    /// Returns the places of a group's elements.
    fn places(&self, group: &VariableGroup) -> Vec<usize> {
        let of = |reference: &u32| {
            let variable = self.description.by_reference(*reference);
            let count = variable.map_or(1, |v| self.description.elements(v).unwrap_or(1));
            let first = *reference as usize;
            first..first + count
        };
        group.references.iter().flat_map(of).collect()
    }
}

/// One of our own models, presented as FMI 3.0.
pub struct OwnModel<C: ModelComponent> {
    description: Description,
    values: CellValues,
    component: Option<C>,
    messages: Vec<FmuMessage>,
}

impl<C: ModelComponent> OwnModel<C> {
    /// Creates an instance.
    pub fn boxed() -> Box<dyn Instance> {
        Box::new(Self {
            description: of_model(C::MODEL),
            values: CellValues::new(C::MODEL),
            component: None,
            messages: Vec::new(),
        })
    }
}

/// Builds the description of one of our own models.
fn of_model(model: &Model) -> Description {
    let mut slot = 1;
    let one = |of: &table::DeclaredVariable| {
        let kind = match of.kind {
            table::ElementType::Real => VariableType::Float64,
            table::ElementType::Integer => VariableType::Int32,
            table::ElementType::Count => VariableType::UInt64,
            table::ElementType::Boolean => VariableType::Boolean,
            table::ElementType::Enumeration(_) => VariableType::Enumeration,
            table::ElementType::Binary(_) => VariableType::Binary,
            table::ElementType::Clock(_) => VariableType::Clock,
        };
        let causality = match of.causality {
            table::DeclaredCausality::Parameter => Causality::Parameter,
            table::DeclaredCausality::CalculatedParameter => Causality::CalculatedParameter,
            table::DeclaredCausality::Input => Causality::Input,
            table::DeclaredCausality::Output => Causality::Output,
            table::DeclaredCausality::Local => Causality::Local,
        };
        let mut variable = variable(of.name, slot, kind, causality);
        slot += of.slots() as u32;
        if of.elements > 0 {
            variable = variable.array(of.elements as u64);
        }
        variable.unit = of.quantity.map(|quantity| quantity.unit.name.to_owned());
        variable
    };
    let variables: Vec<Variable> = model.variables.iter().map(one).collect();
    let mut units: Vec<UnitDefinition> = Vec::new();
    for quantity in model.variables.iter().filter_map(|variable| variable.quantity) {
        let of = quantity.unit;
        if !units.iter().any(|unit| unit.name == of.name) {
            let base = of.exponents.map(|exponents| BaseUnit {
                exponents,
                factor: of.factor,
                offset: 0.0,
            });
            units.push(UnitDefinition { name: of.name.to_owned(), base, display: Vec::new() });
        }
    }
    Description {
        units,
        generation_tool: "Octant test".to_owned(),
        ..description(model.name, variables)
    }
}

impl<C: ModelComponent> OwnModel<C> {
    fn fail(&self, function: &str, reason: String) -> InstanceError {
        InstanceError::Failed {
            fmu: self.description.model_name.clone(),
            function: function.to_owned(),
            status: "error".to_owned(),
            said: format!(": {reason}"),
        }
    }

    fn slots(&self, group: &VariableGroup) -> Vec<usize> {
        let of = |reference: &u32| {
            let variable = self.description.by_reference(*reference);
            let count = variable.map_or(1, |v| self.description.elements(v).unwrap_or(1));
            let first = *reference as usize;
            first..first + count
        };
        group.references.iter().flat_map(of).collect()
    }

    fn take_remark(&mut self) {
        if let Some(text) = self.component.as_mut().and_then(C::remark) {
            let (status, category) = ("ok".to_owned(), "logEvents".to_owned());
            self.messages.push(FmuMessage { status, category, text });
        }
    }
}

/// Functions that no test calls.
macro_rules! not_asked_for {
    () => {
        fn set_strings(&mut self, _: &VariableGroup, _: &[String]) -> Result<(), InstanceError> {
            unimplemented!("no test sets texts")
        }

        /// The value references, as texts with a quotation mark.
        fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
            Ok(group.references.iter().map(|reference| format!("\"{reference}, text")).collect())
        }

        fn set_binaries(&mut self, _: &VariableGroup, _: &[Vec<u8>]) -> Result<(), InstanceError> {
            unimplemented!("no test sets bytes")
        }

        /// The value references, as bytes.
        fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
            Ok(group.references.iter().map(|reference| reference.to_be_bytes().to_vec()).collect())
        }

        fn handle_events(&mut self) -> Result<bool, InstanceError> {
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
            unimplemented!("no test keeps states")
        }

        fn restore_state(&mut self, _: u64) -> Result<(), InstanceError> {
            unimplemented!("no test keeps states")
        }

        fn forget_state(&mut self, _: u64) -> Result<(), InstanceError> {
            unimplemented!("no test keeps states")
        }

        fn state_to_bytes(&mut self, _: u64) -> Result<Vec<u8>, InstanceError> {
            unimplemented!("no test keeps states")
        }

        fn state_from_bytes(&mut self, _: &[u8]) -> Result<u64, InstanceError> {
            unimplemented!("no test keeps states")
        }

        fn name(&self) -> &str {
            &self.description.model_name
        }

        fn description(&self) -> &Description {
            &self.description
        }
    };
}

impl<C: ModelComponent> Instance for OwnModel<C> {
    not_asked_for!();

    fn enter_initialization(
        &mut self,
        _: f64,
        _: Option<f64>,
        _: Option<f64>,
    ) -> Result<(), InstanceError> {
        Ok(())
    }

    fn exit_initialization(&mut self) -> Result<bool, InstanceError> {
        let made = C::initialize(&mut self.values);
        self.component = Some(made.map_err(|error| self.fail("exit", error.to_string()))?);
        Ok(false)
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        for (slot, value) in self.slots(group).into_iter().zip(values) {
            match group.kind {
                VariableType::Float64 => self.values.set_real(slot, *value),
                VariableType::Enumeration if group.bits => {
                    self.values.set_integer(slot, value.to_bits() as i32)
                }
                VariableType::Int32 | VariableType::Enumeration => {
                    self.values.set_integer(slot, *value as i32)
                }
                VariableType::UInt64 if group.bits => self.values.set_count(slot, value.to_bits()),
                VariableType::UInt64 => self.values.set_count(slot, *value as u64),
                VariableType::Boolean => self.values.set_boolean(slot, *value != 0.0),
                other => panic!("no variable is a {other:?}"),
            }
        }
        Ok(())
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        for (slot, value) in self.slots(group).into_iter().zip(values) {
            *value = match group.kind {
                VariableType::Float64 => self.values.real(slot),
                VariableType::Enumeration if group.bits => {
                    f64::from_bits(i64::from(self.values.integer(slot)) as u64)
                }
                VariableType::Int32 | VariableType::Enumeration => {
                    f64::from(self.values.integer(slot))
                }
                VariableType::UInt64 if group.bits => f64::from_bits(self.values.count(slot)),
                VariableType::UInt64 => self.values.count(slot) as f64,
                VariableType::Boolean => f64::from(u8::from(self.values.boolean(slot))),
                other => panic!("no variable is a {other:?}"),
            };
        }
        Ok(())
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let component = self.component.as_mut().unwrap();
        let period_s = component.period_ns() as f64 * 1e-9;
        assert!((step_s / period_s - 1.0).abs() < 1e-6, "{step_s}");
        let stepped = component.step(&mut self.values);
        stepped.map_err(|error| self.fail("step", error.to_string()))?;
        self.take_remark();
        let time_s = time_s + step_s;
        Ok(Stepped { time_s, outcome: StepOutcome::Done, event: false, terminate: false })
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.values = CellValues::new(C::MODEL);
        self.component = None;
        Ok(())
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        if let Some(component) = &mut self.component {
            component.terminate(&mut self.values);
        }
        self.take_remark();
        Ok(())
    }

    fn messages(&mut self) -> Vec<FmuMessage> {
        std::mem::take(&mut self.messages)
    }
}

impl Instance for Scripted {
    not_asked_for!();

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
        for (place, value) in self.places(group).into_iter().zip(values) {
            self.cells[place] = match group.bits {
                true => whole::from_bits(group.kind, *value) as f64,
                false => *value,
            };
        }
        Ok(())
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        for (place, value) in self.places(group).into_iter().zip(values) {
            *value = match group.bits {
                true => whole::to_bits(group.kind, self.cells[place] as i128).unwrap(),
                false => self.cells[place],
            };
        }
        Ok(())
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let end_s = time_s + step_s;
        let goes_on = (self.behaviour)(&mut self.cells, end_s).map_err(|what| {
            InstanceError::Process { fmu: self.description.model_name.clone(), what }
        })?;
        let outcome = StepOutcome::Done;
        Ok(Stepped { time_s: end_s, outcome, event: false, terminate: !goes_on })
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.cells.fill(0.0);
        Ok(())
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        Ok(())
    }

    fn messages(&mut self) -> Vec<FmuMessage> {
        Vec::new()
    }
}
