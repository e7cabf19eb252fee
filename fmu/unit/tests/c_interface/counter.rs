//! A model that panics, fails and makes several periods on demand.

use octant_fmu::c::Maker;
use octant_fmu::component::ModelComponent;
use octant_fmu::table::{DeclaredEnumeration, DeclaredVariable, ElementType, Model};
use octant_fmu::values::CellValues;

static LEVEL: DeclaredEnumeration = DeclaredEnumeration {
    name: "Level",
    description: "Two levels that are not neighbours.",
    items: &[(1, "low", ""), (5, "high", "")],
};

static VARIABLES: [DeclaredVariable; 9] = [
    DeclaredVariable::input("u", ElementType::Real).elements(2),
    DeclaredVariable::input("trouble", ElementType::Integer).within(0.0, 9.0),
    DeclaredVariable::input("anything", ElementType::Real).non_finite(),
    DeclaredVariable::input("level", ElementType::Enumeration(&LEVEL)).start(&[1.0]),
    DeclaredVariable::input("on", ElementType::Boolean),
    DeclaredVariable::tunable_parameter("gain", ElementType::Real).start(&[2.0]),
    DeclaredVariable::parameter("limit", ElementType::Count).within(1.0, 1000.0).start(&[100.0]),
    depending(DeclaredVariable::output("y", ElementType::Real)),
    DeclaredVariable::output("count", ElementType::Count),
];

const fn depending(mut variable: DeclaredVariable) -> DeclaredVariable {
    variable.depends_on = &["u", "on"];
    variable
}

pub(super) static MODEL: Model = Model {
    name: "Counter",
    stem: "counter",
    description: "It counts.",
    variables: &VARIABLES,
    periods_per_step: (1, 4),
    sums_periods: false,
};

pub(super) const U: usize = MODEL.slot("u");
pub(super) const TROUBLE: usize = MODEL.slot("trouble");
pub(super) const ANYTHING: usize = MODEL.slot("anything");
pub(super) const LEVEL_SLOT: usize = MODEL.slot("level");
pub(super) const ON: usize = MODEL.slot("on");
pub(super) const GAIN: usize = MODEL.slot("gain");
pub(super) const LIMIT: usize = MODEL.slot("limit");
pub(super) const Y: usize = MODEL.slot("y");
pub(super) const COUNT: usize = MODEL.slot("count");

pub(super) const PERIOD_S: f64 = 0.01;

/// Test model that sums `gain · u[1]`; `trouble` 1 panics, 2 refuses, 3 refuses in every second
/// period, 4 panics at the end. It refuses a limit of 13, and a gain of 13 between steps.
#[derive(Clone)]
struct Counter {
    count: u64,
    sum: f64,
}

/// Reason why the model refuses.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct Trouble(&'static str);

impl ModelComponent for Counter {
    const MODEL: &'static Model = &MODEL;

    type Error = Trouble;

    fn initialize(values: &mut CellValues) -> Result<Self, Trouble> {
        if values.count(LIMIT) == 13 {
            return Err(Trouble("limit is 13, a lucky number is expected"));
        }
        values.set_real(Y, -1.0);
        values.set_count(COUNT, 0);
        Ok(Self { count: 0, sum: 0.0 })
    }

    fn period_ns(&self) -> u64 {
        10_000_000
    }

    fn tune(&mut self, values: &CellValues) -> Result<(), Trouble> {
        match values.real(GAIN) {
            13.0 => Err(Trouble("gain is 13, a lucky number is expected")),
            _ => Ok(()),
        }
    }

    fn step(&mut self, values: &mut CellValues) -> Result<(), Trouble> {
        match values.integer(TROUBLE) {
            1 => panic!("trouble was asked for"),
            2 => return Err(Trouble("trouble is 2")),
            3 if self.count % 2 == 1 => return Err(Trouble("trouble is 3")),
            _ => {}
        }
        self.count += 1;
        self.sum += values.real(GAIN) * values.real(U);
        values.set_real(Y, self.sum);
        values.set_count(COUNT, self.count);
        Ok(())
    }

    fn terminate(&mut self, values: &mut CellValues) {
        assert_ne!(values.integer(TROUBLE), 4, "trouble at the end");
        values.set_real(Y, 1000.0);
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.count.to_le_bytes());
        bytes.extend(self.sum.to_le_bytes());
    }

    fn load(bytes: &[u8], _: &CellValues) -> Result<Self, Trouble> {
        let parts = bytes.split_first_chunk().map(|(count, sum)| (count, sum.try_into()));
        let Some((count, Ok(sum))) = parts else { return Err(Trouble("16 bytes are expected")) };
        Ok(Self { count: u64::from_le_bytes(*count), sum: f64::from_le_bytes(sum) })
    }
}

pub(super) static MAKER: Maker = Maker::of::<Counter>();
