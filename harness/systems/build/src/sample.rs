//! A model with every kind of variable, for tests.

use core::array::TryFromSliceError;
use octant_fmu::component::ModelComponent;
use octant_fmu::quantities;
use octant_fmu::table::{DeclaredEnumeration, DeclaredVariable, ElementType, Model};
use octant_fmu::values::CellValues;

static COLOUR: DeclaredEnumeration = DeclaredEnumeration {
    name: "Colour",
    description: "A colour",
    items: &[(0, "none", "none at all"), (2, "red", "red & \"warm\"")],
};

/// Model of the tests.
pub(super) static SAMPLE: Model = Model {
    name: "Sample",
    stem: "sample",
    description: "A model with every kind of variable",
    variables: &[
        DeclaredVariable::input("gyro.delta_theta", ElementType::Real)
            .described("Increments x, y, z")
            .elements(3)
            .of(&quantities::ANGLE_INCREMENT)
            .within(-0.03, 0.03)
            .nominal(1e-6),
        DeclaredVariable::input("imu.valid", ElementType::Boolean).described("There is a sample"),
        DeclaredVariable::input("reference.kind", ElementType::Enumeration(&COLOUR))
            .described("What is given"),
        DeclaredVariable::input("imu.sequence", ElementType::Count)
            .described("Number of the sample"),
        DeclaredVariable {
            depends_on: &["imu.valid", "gyro.delta_theta"],
            ..DeclaredVariable::output("navigation.latitude", ElementType::Real)
                .described("Latitude")
                .of(&quantities::ANGLE)
                .within(-1.6, 1.6)
        },
        DeclaredVariable::output("health", ElementType::Integer).described("Flags").elements(2),
        DeclaredVariable::output("answer.sequence", ElementType::Count)
            .described("Number of the sample answered"),
        DeclaredVariable::parameter("sequence.azimuth", ElementType::Real)
            .described("Stops")
            .elements(4)
            .of(&quantities::ANGLE)
            .start(&[0.0, 1.5, 0.1, 1e-9]),
        DeclaredVariable::parameter("noise", ElementType::Real)
            .described("Random walk")
            .of(&quantities::ANGLE_RANDOM_WALK)
            .min(0.0)
            .start(&[2e-7]),
        DeclaredVariable::tunable_parameter("gate", ElementType::Boolean)
            .described("With the gate")
            .start(&[1.0]),
        DeclaredVariable::parameter("seed", ElementType::Count)
            .within(0.0, 9007199254740992.0)
            .described("Seed")
            .start(&[9007199254740992.0]),
        DeclaredVariable::parameter("colour", ElementType::Enumeration(&COLOUR))
            .described("Its colour")
            .start(&[2.0]),
    ],
    periods_per_step: (1, 1),
    sums_periods: false,
};

/// Counts its steps.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    steps: u64,
}

impl ModelComponent for Sample {
    const MODEL: &'static Model = &SAMPLE;

    type Error = TryFromSliceError;

    fn initialize(_: &mut CellValues) -> Result<Self, TryFromSliceError> {
        Ok(Self { steps: 0 })
    }

    fn period_ns(&self) -> u64 {
        5_000_000
    }

    fn step(&mut self, values: &mut CellValues) -> Result<(), TryFromSliceError> {
        self.steps += 1;
        values.set_count(SAMPLE.slot("answer.sequence"), self.steps);
        values.set_real(SAMPLE.slot("navigation.latitude"), self.steps as f64 * 0.1);
        Ok(())
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.steps.to_le_bytes());
    }

    fn load(bytes: &[u8], _: &CellValues) -> Result<Self, TryFromSliceError> {
        Ok(Self { steps: u64::from_le_bytes(bytes.try_into()?) })
    }
}
