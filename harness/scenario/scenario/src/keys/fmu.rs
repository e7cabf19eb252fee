//! Keys of imported FMUs: execution, settings, and the mapping of variables.

use super::by_case::TIME_LIMITS;
use super::definition::{Bounds, Default, Key, Kind, Section, key, section};
use super::table::{At, Of, Raw, boolean, choice, keys, number, si, time};
use crate::channel::{Channel, answer, case, sample, truth};
use crate::model::{InterfaceChoice, Process};
use crate::quantity::UnitDimension;
use octant_sample::Mode;

/// Keys of every FMU.
pub(crate) struct FmuKeys<'a> {
    pub(crate) interface: InterfaceChoice,
    pub(crate) process: Process,
    pub(crate) time_limit: Option<f64>,
    pub(crate) allow_tool: bool,
    pub(crate) tolerance: Option<f64>,
    pub(crate) parameters: Option<&'a Raw>,
    pub(crate) map: Option<&'a Raw>,
}

/// Keys of an FMU, with those that only a source or only a core has.
macro_rules! fmu {
    ($(#[$attribute:meta])* $name:ident, $map:ident, [$($step:tt)*], [$($modes:tt)*]) => {
        keys! {
            $(#[$attribute])*
            pub(crate) struct $name {
                interface: InterfaceChoice = choice! {
                        "auto" => InterfaceChoice::Auto,
                            "co-simulation where the FMU has it, else model exchange";
                        "co-simulation" => InterfaceChoice::CoSimulation, "the FMU steps itself";
                        "model-exchange" => InterfaceChoice::ModelExchange,
                            "the FMU's equations are integrated by Octant";
                    }, "auto", "Interface type of the FMU.";
                process: Process = choice! {
                        "own" => Process::Own,
                            "in a process of its own: a crash or a hang ends the run in order";
                        "shared" => Process::Shared,
                            "in Octant's own process: faster, and a crash takes Octant with it";
                    }, "own", "Where the FMU runs.";
                time_limit: Option<f64> = time(1e-3, 86400.0, "from 1 ms to 24 h"),
                    by_case(TIME_LIMITS),
                    "Wall time that one call of the FMU may take; longer, and it counts as hung.";
                allow_tool: bool = boolean(), "false",
                    "Whether the FMU is run although it needs the tool that made it, which has to be installed.";
                $($step)*
                tolerance: Option<f64> = number(Bounds::Within(1e-14, 1e-1, "from 1e-14 to 0.1")),
                    absent("that of the FMU's default experiment"),
                    "Relative tolerance of the FMU's solver, or of Octant's in model exchange.";
                parameters: Option<Raw> = Of::<Raw>::kind(Kind::Settings), absent("nothing is set"),
                    "Values of the FMU's parameters, and of inputs that are held: a number is in the variable's own unit, a quantity is converted into it.";
                map: Option<Raw> = Of::<Raw>::kind(Kind::Table(&$map)), absent(BY_NAME),
                    "Which variable of the FMU is what. Units are converted as the FMU's description says; a name after a minus sign is negated.";
                $($modes)*
            }
        }

        impl $name {
            pub(crate) fn common(&self) -> FmuKeys<'_> {
                FmuKeys {
                    interface: self.interface,
                    process: self.process,
                    time_limit: self.time_limit,
                    allow_tool: self.allow_tool,
                    tolerance: self.tolerance,
                    parameters: self.parameters.as_ref(),
                    map: self.map.as_ref(),
                }
            }
        }
    };
}

fmu! {
    /// `[source.fmu]`.
    SourceFmuKeys, SOURCE_MAP, [
        step: At<Option<f64>> = si(&[UnitDimension::TIME], Bounds::Positive), derived("the sample period"),
            "Communication step: a whole part of the sample period, or of a ship a multiple of it, between which its motion is interpolated.";
    ], []
}

fmu! {
    /// `[endpoint.fmu]`.
    EndpointFmuKeys, ENDPOINT_MAP, [], [
        modes: Option<Raw> = Of::<Raw>::kind(Kind::Table(&MODES)),
            absent("0, 1, 2, 3, 4 in the order aligning, calibrating, refused, navigating, done"),
            "Which values of the variable of map.mode mean what.";
    ]
}

const BY_NAME: &str = "the variable of the channel's own name, where the FMU has it";

/// Key of a channel, with the last part of its name.
const fn port(name: &'static str, channel: &'static Channel) -> Key {
    key(name, Kind::Port(channel), Default::Absent(BY_NAME), channel.doc)
}

const fn group(name: &'static str, keys: &'static Section, doc: &'static str) -> Key {
    key(name, Kind::Table(keys), Default::Absent(BY_NAME), doc)
}

pub(crate) static SOURCE_MAP: Section = section(&[
    group("gyro", &GYRO, "Gyros: rates or increments."),
    group("accelerometer", &ACCELEROMETER, "Accelerometers: specific force or increments."),
    group("gimbal", &GIMBAL, "Encoders; without them the angles are flagged invalid."),
    group(
        "gimbal_command",
        &GIMBAL_COMMAND,
        "Inputs of the FMU: where the core wants the gimbals. Without them the FMU turns as it likes.",
    ),
    group("imu", &IMU, "Flags and stamps of samples."),
    group("reference", &REFERENCE, "The reference of a calibration: a velocity or a position."),
    group("truth", &TRUTH, "Truth, for scoring the navigation."),
    group(
        "case",
        &CASE,
        "Motion of the case, of a ship or a turntable: the simulated instrument stands on it. Needs motion.kind = \"dockside\", whose sway then only tells the core what to expect.",
    ),
]);

pub(crate) static ENDPOINT_MAP: Section = section(&[
    group("gyro", &GYRO, "Gyros: rates or increments."),
    group("accelerometer", &ACCELEROMETER, "Accelerometers: specific force or increments."),
    group("gimbal", &GIMBAL, "Encoders."),
    group("imu", &IMU, "Flags and stamps of samples."),
    group("reference", &REFERENCE, "The reference of a calibration."),
    group("gimbal_command", &GIMBAL_COMMAND, "Outputs of the FMU: where it wants the gimbals."),
    port("mode", &answer::MODE),
    port("stop", &answer::STOP),
    port("moving", &answer::MOVING),
    group("navigation", &NAVIGATION, "The navigation solution."),
    group("filter", &FILTER, "The measurement of a calibration."),
    port("health", &answer::HEALTH),
    group("answer", &ANSWER, "Which sample is answered; left out: the one that was set."),
    group("parameters", &ESTIMATES, "Estimated parameters."),
    group("sigma", &SIGMAS, "Standard deviations of the estimated parameters."),
]);

static GYRO: Section =
    section(&[port("rate", &sample::RATE), port("delta_theta", &sample::DELTA_THETA)]);

static ACCELEROMETER: Section = section(&[
    port("specific_force", &sample::SPECIFIC_FORCE),
    port("delta_velocity", &sample::DELTA_VELOCITY),
]);

static GIMBAL: Section = section(&[port("azimuth", &sample::AZIMUTH), port("roll", &sample::ROLL)]);

static GIMBAL_COMMAND: Section =
    section(&[port("azimuth", &sample::COMMAND_AZIMUTH), port("roll", &sample::COMMAND_ROLL)]);

static IMU: Section = section(&[
    port("valid", &sample::VALID),
    port("status", &sample::STATUS),
    port("sequence", &sample::SEQUENCE),
    port("device_time_ns", &sample::DEVICE_TIME),
]);

static REFERENCE: Section = section(&[
    port("kind", &sample::REFERENCE_KIND),
    port("valid", &sample::REFERENCE_VALID),
    port("velocity", &sample::REFERENCE_VELOCITY),
    port("latitude", &sample::REFERENCE_LATITUDE),
    port("longitude", &sample::REFERENCE_LONGITUDE),
    port("height", &sample::REFERENCE_HEIGHT),
    port("age_ns", &sample::REFERENCE_AGE),
]);

static TRUTH: Section = section(&[
    port("latitude", &truth::LATITUDE),
    port("longitude", &truth::LONGITUDE),
    port("height", &truth::HEIGHT),
    port("velocity", &truth::VELOCITY),
    port("attitude", &truth::ATTITUDE),
    group("gimbal", &TRUE_GIMBAL, "True angles of the gimbals; left out: those of the encoders."),
]);

static TRUE_GIMBAL: Section =
    section(&[port("azimuth", &truth::AZIMUTH), port("roll", &truth::ROLL)]);

static CASE: Section = section(&[
    port("heading", &case::HEADING),
    port("pitch", &case::PITCH),
    port("roll", &case::ROLL),
    port("north", &case::NORTH),
    port("east", &case::EAST),
    port("down", &case::DOWN),
    port("latitude", &case::LATITUDE),
    port("longitude", &case::LONGITUDE),
    port("height", &case::HEIGHT),
]);

static NAVIGATION: Section = section(&[
    port("latitude", &answer::LATITUDE),
    port("longitude", &answer::LONGITUDE),
    port("height", &answer::HEIGHT),
    port("velocity", &answer::VELOCITY),
    port("attitude", &answer::ATTITUDE),
]);

static FILTER: Section = section(&[port("nis", &answer::NIS), port("measured", &answer::MEASURED)]);

static ANSWER: Section =
    section(&[port("sequence", &answer::SEQUENCE), port("device_time_ns", &answer::DEVICE_TIME)]);

static ESTIMATES: Section = section(&[
    port("revision", &answer::REVISION),
    port("gyro_bias", &answer::PARAMETERS[0]),
    port("gyro_scale", &answer::PARAMETERS[1]),
    port("gyro_misalignment", &answer::PARAMETERS[2]),
    port("g_dependent", &answer::PARAMETERS[3]),
    port("accel_bias", &answer::PARAMETERS[4]),
    port("accel_scale", &answer::PARAMETERS[5]),
    port("accel_misalignment", &answer::PARAMETERS[6]),
]);

static SIGMAS: Section = section(&[
    port("gyro_bias", &answer::SIGMA[0]),
    port("gyro_scale", &answer::SIGMA[1]),
    port("gyro_misalignment", &answer::SIGMA[2]),
    port("g_dependent", &answer::SIGMA[3]),
    port("accel_bias", &answer::SIGMA[4]),
    port("accel_scale", &answer::SIGMA[5]),
    port("accel_misalignment", &answer::SIGMA[6]),
]);

static MODES: Section = section(&[
    mode(Mode::Aligning),
    mode(Mode::Calibrating),
    mode(Mode::Refused),
    mode(Mode::Navigating),
    mode(Mode::Done),
]);

const fn mode(mode: Mode) -> Key {
    const DOC: &str = "Values that mean this mode.";
    key(mode.name(), Kind::Codes, Default::Absent("no value means it"), DOC)
}
