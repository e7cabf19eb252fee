//! The models in this library.

use super::layout::Layout;
use super::mode::ServedStandard;
use super::room::with_room;
use super::token::token;
use crate::calibrator::Calibrator;
use crate::calibrator_can::CalibratorCan;
use crate::component::{ModelComponent, Network};
use crate::plant::PlantFmu;
use crate::table::Model;
use crate::values::CellValues;
use std::sync::OnceLock;

/// A component of unknown type.
pub(super) trait AnyComponent: Send + core::fmt::Debug {
    fn tune(&mut self, values: &CellValues) -> Result<(), String>;
    fn step(&mut self, values: &mut CellValues) -> Result<(), String>;
    fn step_further(&mut self, values: &mut CellValues) -> Result<(), String>;
    fn period_ns(&self) -> u64;
    fn terminate(&mut self, values: &mut CellValues);
    fn remark(&mut self) -> Option<String>;
    fn network(&mut self) -> Option<&mut dyn Network>;
    fn save(&self, bytes: &mut Vec<u8>);
    fn boxed_clone(&self) -> Box<dyn AnyComponent>;
}

/// Adapter that adds the optional parts of a component.
struct Boxed<C>(C);

impl<C: ModelComponent> core::fmt::Debug for Boxed<C> {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        to.write_str(C::MODEL.name)
    }
}

impl<C: ModelComponent> AnyComponent for Boxed<C> {
    fn tune(&mut self, values: &CellValues) -> Result<(), String> {
        with_room(|| self.0.tune(values)).map_err(|error| error.to_string())
    }

    fn step(&mut self, values: &mut CellValues) -> Result<(), String> {
        self.0.step(values).map_err(|error| error.to_string())
    }

    fn step_further(&mut self, values: &mut CellValues) -> Result<(), String> {
        self.0.step_further(values).map_err(|error| error.to_string())
    }

    fn period_ns(&self) -> u64 {
        self.0.period_ns()
    }

    fn terminate(&mut self, values: &mut CellValues) {
        with_room(|| self.0.terminate(values));
    }

    fn remark(&mut self) -> Option<String> {
        self.0.remark()
    }

    fn network(&mut self) -> Option<&mut dyn Network> {
        self.0.network()
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        self.0.save(bytes);
    }

    fn boxed_clone(&self) -> Box<dyn AnyComponent> {
        with_room(|| Box::new(Self(self.0.clone())))
    }
}

type Made = Result<Box<dyn AnyComponent>, String>;

fn boxed<C: ModelComponent>(made: Result<C, C::Error>) -> Made {
    let component = made.map_err(|error| error.to_string())?;
    Ok(Box::new(Boxed(component)))
}

/// Factory of the components of a model.
#[derive(Debug)]
pub struct Maker {
    pub(super) model: &'static Model,
    pub(super) initialize: fn(&mut CellValues) -> Made,
    pub(super) load: fn(&[u8], &CellValues) -> Made,
    layout: OnceLock<Layout>,
    tokens: OnceLock<[String; 2]>,
}

impl Maker {
    /// Makes the factory of a type of components.
    #[must_use]
    pub const fn of<C: ModelComponent>() -> Self {
        Self {
            model: C::MODEL,
            initialize: |values| with_room(|| boxed(C::initialize(values))),
            load: |bytes, values| with_room(|| boxed(C::load(bytes, values))),
            layout: OnceLock::new(),
            tokens: OnceLock::new(),
        }
    }

    pub(super) fn layout(&self) -> &Layout {
        self.layout.get_or_init(|| Layout::of(self.model))
    }

    pub(super) fn token(&self, standard: ServedStandard) -> &str {
        let tokens = self.tokens.get_or_init(|| {
            [ServedStandard::Fmi2, ServedStandard::Fmi3].map(|standard| token(self.model, standard))
        });
        &tokens[standard as usize]
    }
}

/// All models.
static MAKERS: [Maker; 3] =
    [Maker::of::<Calibrator>(), Maker::of::<PlantFmu>(), Maker::of::<CalibratorCan>()];

/// Finds the model with this token.
pub(super) fn find(standard: ServedStandard, token: &str) -> Option<&'static Maker> {
    let found = MAKERS.iter().find(|maker| maker.token(standard) == token)?;
    (standard == ServedStandard::Fmi3 || !found.model.needs_clocks()).then_some(found)
}
