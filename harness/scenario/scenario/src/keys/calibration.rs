//! Keys of the procedure: alignment, calibration, navigation, screening, baseline.

use super::by_case::{G_DEPENDENTS, NOISES, PRIOR_POSITIONS, REFERENCE_CASES, SIGMAS};
use super::definition::{Bounds, Default, Key, Kind, Section, key, section};
use super::further::{CaseRestKeys, FurtherKeys};
use super::table::{
    At, Keys, Of, Value, boolean, choice, integer, keys, number, si, si_array, si_list, table,
    tables, text, time, within,
};
use crate::error::Problem;
use crate::model::HeadingTestKind;
use crate::quantity::UnitDimension;
use crate::read::reader::Reader;
use octant_calibration::config::{ErrorModel, GyroReference, SwayNoise};
use octant_calibration::positions::SEQUENCES;
use octant_calibration::sequence::STOPS_MAX;
use octant_earth::units::DEG;

const fn positions() -> [(&'static str, &'static str); SEQUENCES.len()] {
    let mut all = [("", ""); SEQUENCES.len()];
    let mut index = 0;
    while index < all.len() {
        all[index] = (SEQUENCES[index].0, SEQUENCES[index].2);
        index += 1;
    }
    all
}

/// Names and meanings of the core's sequences.
const POSITIONS: &[(&str, &str)] = &positions();

const fn duration() -> Of<f64> {
    time(1e-3, 366.0 * 86400.0, "above 0, up to 366 day")
}

keys! {
    /// `[procedure]`.
    pub(crate) struct ProcedureKeys {
        alignment: AlignmentKeys = table(), section, "How the initial attitude is found.";
        calibration: At<Option<CalibrationKeys>>
            = table::<CalibrationKeys>(), absent("no calibration: navigate at once"),
            "Turning through positions and estimating the sensors' errors.";
        navigation: Option<NavigationKeys>
            = table::<NavigationKeys>(), absent("no navigation: the run ends with the calibration"),
            "Free inertial navigation with the compensated sensors, height held.";
        heading_test: At<Option<HeadingTestKeys>>
            = table::<HeadingTestKeys>(), absent("the heading isn't tested"),
            "A test of the heading as type tests of marine instruments have it, over one run-up or several.";
        initial_parameters: Option<InitialKeys> = table::<InitialKeys>(), absent("zero"),
            "Parameters that the core starts from, of an earlier calibration.";
    }
}

keys! {
    /// `[procedure.heading_test]`.
    pub(crate) struct HeadingTestKeys {
        test: At<HeadingTestKind> = choice! {
                "settle" => HeadingTestKind::Settle, "settling time and settle point at rest";
                "settle-in-motion" => HeadingTestKind::SettleInMotion,
                    "settling time and settle point while the table moves, and settle point after it stopped";
                "scorsby" => HeadingTestKind::Scorsby,
                    "settle point at rest, then a motion of the table, then the heading after it stopped";
                "dynamic" => HeadingTestKind::Dynamic,
                    "settle point at rest, then the error while the table moves";
            }, required,
            "What is tested. The table's motion is that of motion.ship.";
        run_ups: At<u32> = integer::<u32>(1, 20), "1",
            "How often the unit is switched on: each run-up aligns, calibrates and navigates, and is measured.";
        off: f64 = time(0.0, 366.0 * 86400.0, "from 0 s to 366 day"), "12 h",
            "How long the unit is without power between two run-ups.";
        azimuths: At<Option<Vec<String>>> = Of::<Vec<String>>::kind(Kind::Names),
            absent("the unit stands at zero"),
            "Angle by which the table has turned the unit in each run-up of a solution: the true heading is turned as far, such as [\"0 deg\", \"90 deg\"]. turntable.drive turns it there before the unit is switched on.";
        resolution: At<f64>
            = within(&[UnitDimension::ANGLE], 0.0, DEG, "from 0 to 1 deg"), "0 deg",
            "Resolution of the headings that are read: they are rounded to it, and it counts as uncertainty. 0: exact.";
    }
}

/// Ways to the initial attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AlignmentMethod {
    Given,
    Coarse,
    Inertial,
}

keys! {
    /// `[procedure.alignment]`.
    pub(crate) struct AlignmentKeys {
        method: At<AlignmentMethod> = choice! {
                "given" => AlignmentMethod::Given, "attitude and velocity are handed over, with an error drawn from the seed";
                "coarse" => AlignmentMethod::Coarse, "gravity and Earth rate averaged over the first seconds of the first stop";
                "inertial" => AlignmentMethod::Inertial,
                    "the way in which gravity turns in the inertial frame over the first seconds of the first stop: the base may turn, and what doesn't fit the latitude is refused";
            }, "given",
            "How the initial attitude is found.";
        tilt: f64
            = within(&[UnitDimension::SMALL_ANGLE], 0.0, 5.0 * DEG, "from 0 to 5 deg"), "60 arcsec",
            "Error of the tilt handed over, one standard deviation, about north and east.";
        azimuth: f64 = within(&[UnitDimension::ANGLE], 0.0, 5.0 * DEG, "from 0 to 5 deg"), "0.1 deg",
            "Error of the azimuth handed over, one standard deviation.";
        velocity: f64 = si(&[UnitDimension::VELOCITY], Bounds::NotNegative), "0.02 m/s",
            "Error of each velocity handed over, one standard deviation.";
        attitude_error: Option<[f64; 3]>
            = si_array(UnitDimension::SMALL_ANGLE), absent("drawn from tilt and azimuth"),
            "The attitude error itself, north, east, down: computed = (I − [φ×]) true.";
        velocity_error: Option<[f64; 3]>
            = si_array(UnitDimension::VELOCITY), absent("drawn from velocity"),
            "The velocity error itself, north, east, down.";
        duration: At<f64> = duration(), "60 s",
            "Coarse and inertial alignment: how long. 300 s and more in the inertial frame, on a ship 600 s.";
    }
}

keys! {
    /// `[procedure.initial_parameters]`.
    pub(crate) struct InitialKeys {
        table: At<Option<String>> = text(), absent("the groups below"),
            "Calibration table of an earlier run, such as runs/quick/calibration.octcal, relative to the \
         scenario's folder; stands in place of the groups.";
        gyro_bias: At<Option<Vec<f64>>> = si_list(UnitDimension::GYRO_BIAS, 3), absent("zero"), "x, y, z.";
        gyro_scale: At<Option<Vec<f64>>> = si_list(UnitDimension::RATIO, 3), absent("zero"), "x, y, z.";
        gyro_misalignment: At<Option<Vec<f64>>>
            = si_list(UnitDimension::SMALL_ANGLE, 6), absent("zero"),
            "xy, xz, yx, yz, zx, zy.";
        g_dependent: At<Option<Vec<f64>>> = si_list(UnitDimension::G_DEPENDENT, 9), absent("zero"),
            "By rows.";
        accel_bias: At<Option<Vec<f64>>> = si_list(UnitDimension::ACCEL_BIAS, 3), absent("zero"), "x, y, z.";
        accel_scale: At<Option<Vec<f64>>> = si_list(UnitDimension::RATIO, 3), absent("zero"), "x, y, z.";
        accel_misalignment: At<Option<Vec<f64>>>
            = si_list(UnitDimension::SMALL_ANGLE, 3), absent("zero"),
            "yx, zx, zy.";
    }
}

const fn angle() -> Of<f64> {
    const WORDS: &str = "within ±15.9 rad (±911 deg), the range of the encoders";
    within(&[UnitDimension::ANGLE], -15.9, 15.9, WORDS)
}

const fn stops() -> Of<Vec<StopKeys>> {
    tables(1, STOPS_MAX)
}

keys! {
    /// A stop of a sequence.
    pub(crate) struct StopKeys {
        azimuth: f64 = angle(), "0 deg", "Cumulative angle of the inner gimbal, about body z.";
        roll: f64 = angle(), "0 deg", "Cumulative angle of the outer gimbal, about case x.";
        weight: f64 = number(Bounds::Positive), "1.0", "Dwell relative to the other stops.";
    }
}

const GROUPS: &[&str] = &[
    "gyro_bias",
    "gyro_scale",
    "gyro_misalignment",
    "g_dependent",
    "accel_bias",
    "accel_scale",
    "accel_misalignment",
];

/// Estimator of the parameters, without its settings.
#[derive(Clone, Copy, Debug)]
pub(crate) enum EstimatorName {
    Kalman,
    LeastSquares,
    ExternalTurntable,
}

/// Reference of a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reference {
    ZeroVelocity,
    Velocity,
    DockPosition,
}

/// Ways to static intervals.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Intervals {
    Commanded,
    Detected,
}

keys! {
    /// `[procedure.calibration]`.
    pub(crate) struct CalibrationKeys {
        positions: At<Option<String>>
            = Of::<String>::kind(Kind::Choice(POSITIONS)), derived("\"eight\", unless stops are given"),
            "Named sequence of positions.";
        stops: At<Option<Vec<StopKeys>>> = stops(), absent("positions are used"), "A sequence of one's own.";
        name: At<Option<String>> = text(), absent("\"own stops\""),
            "Name of the sequence of one's own, in tables, reports and on the terminal.";
        passes: u32 = integer(1, 1000), "1", "How often the sequence is walked within the duration.";
        duration: At<f64> = duration(), "4 h", "Whole time: moves and dwells of all passes.";
        estimator: At<EstimatorName> = choice! {
                "kalman" => EstimatorName::Kalman, "error-state Kalman filter, 39 states";
                "least-squares" => EstimatorName::LeastSquares,
                    "multi-position least squares on the norm of gravity and of Earth rate";
                "external-turntable" => EstimatorName::ExternalTurntable,
                    "the case on a precise external turntable whose angles are the reference";
            }, "kalman",
            "How the parameters are estimated.";
        error_model: ErrorModel = choice! {
                "phi" => ErrorModel::Phi, "attitude error against the true navigation frame";
                "psi" => ErrorModel::Psi, "attitude error against the computer frame";
            }, "phi",
            "Form of the filter's system error model.";
        g_states: bool = boolean(), "true", "Whether the filter estimates the g-dependent biases.";
        not_estimated: Vec<String> = Of::kind(Kind::Choices(GROUPS)), "[]",
            "Further parameter groups that the filter does not estimate.";
        refuse_above_mean_nis: f64 = number(Bounds::Positive), "9.0",
            "Mean normalized innovation squared (three axes) above which the calibration is refused.";
        refuse_above_sigma: SigmaLimitKeys = table(), section,
            "Largest standard deviations at the end of a calibration that is published.";
        further: At<Option<FurtherKeys>> = table::<FurtherKeys>(), absent("none"),
            "Errors beside the thirty parameters that the filter considers or estimates.";
        prior: PriorKeys = table(), section, "Standard deviations that the filter starts from.";
        aiding: AidingKeys = table(), section, "The reference that the filter measures against.";
        least_squares: LeastSquaresKeys = table(), section,
            "Settings of the least-squares estimator.";
    }
}

keys! {
    /// `[procedure.calibration.refuse_above_sigma]`.
    pub(crate) struct SigmaLimitKeys {
        heading: Option<f64> = si(&[UnitDimension::ANGLE], Bounds::Positive),
            absent("twice the azimuth of prior.attitude, or ten times what angle_random_walk leaves of the heading by Earth rate over the duration: the larger one"),
            "Heading.";
        tilt: Option<f64> = si(&[UnitDimension::ANGLE], Bounds::Positive),
            absent("twice the tilt of prior.attitude, or twice prior.accel_bias over gravity: the larger one"),
            "Tilt, the larger one of north and east.";
        gyro_bias: Option<f64> = si(&[UnitDimension::GYRO_BIAS], Bounds::Positive), absent("no limit"),
            "Each gyro bias.";
        gyro_scale: Option<f64> = si(&[UnitDimension::RATIO], Bounds::Positive), absent("no limit"),
            "Each gyro scale factor.";
        gyro_misalignment: Option<f64> = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), absent("no limit"),
            "Each gyro misalignment.";
        g_dependent: Option<f64> = si(&[UnitDimension::G_DEPENDENT], Bounds::Positive), absent("no limit"),
            "Each g-dependent gyro bias.";
        accel_bias: Option<f64> = si(&[UnitDimension::ACCEL_BIAS], Bounds::Positive), absent("no limit"),
            "Each accelerometer bias.";
        accel_scale: Option<f64> = si(&[UnitDimension::RATIO], Bounds::Positive), absent("no limit"),
            "Each accelerometer scale factor.";
        accel_misalignment: Option<f64> = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), absent("no limit"),
            "Each accelerometer misalignment.";
    }
}

keys! {
    /// `[procedure.calibration.prior]`.
    pub(crate) struct PriorKeys {
        attitude: At<[f64; 3]>
            = si_array(UnitDimension::SMALL_ANGLE), r#"["60 arcsec", "60 arcsec", "0.1 deg"]"#,
            "Attitude error north, east, down.";
        velocity: f64 = si(&[UnitDimension::VELOCITY], Bounds::Positive), "0.02 m/s",
            "Velocity, each axis.";
        position: f64 = si(&[UnitDimension::LENGTH], Bounds::Positive), by_case(PRIOR_POSITIONS),
            "Position, each axis.";
        gyro_bias: f64 = si(&[UnitDimension::GYRO_BIAS], Bounds::Positive), "0.005 deg/h",
            "Gyro biases.";
        gyro_scale: f64 = si(&[UnitDimension::RATIO], Bounds::Positive), "30 ppm",
            "Gyro scale factors.";
        gyro_misalignment: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "40 arcsec",
            "Gyro misalignments.";
        g_dependent: f64
            = si(&[UnitDimension::G_DEPENDENT], Bounds::Positive),
            by_case(G_DEPENDENTS),
            "g-dependent gyro biases.";
        accel_bias: f64 = si(&[UnitDimension::ACCEL_BIAS], Bounds::Positive), "100 ug",
            "Accelerometer biases.";
        accel_scale: f64 = si(&[UnitDimension::RATIO], Bounds::Positive), "30 ppm",
            "Accelerometer scale factors.";
        accel_misalignment: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "40 arcsec",
            "Accelerometer misalignments.";
    }
}

keys! {
    /// `[procedure.calibration.aiding]`.
    pub(crate) struct AidingKeys {
        reference: At<Reference> = choice! {
                "zero-velocity" => Reference::ZeroVelocity, "the ground or dock doesn't move; knows nothing of sway";
                "velocity" => Reference::Velocity, "true velocity of the instrument over ground";
                "dock-position" => Reference::DockPosition, "position of the dock, from which sway moves the instrument";
            }, by_case(REFERENCE_CASES),
            "What is measured.";
        period: At<f64> = time(1e-4, 3600.0, "above 0, up to 1 h"), "1 s",
            "Time between measurements: a multiple of the sample period.";
        sway: At<SwayNoise> = choice! {
                "white" => SwayNoise::White, "noise of the reference, within sigma: no period";
                "coloured" => SwayNoise::Coloured,
                    "motion of second order on each axis of the ship, with estimated period, size and damping";
            }, "white",
            "What the sway of the ship is to the filter.";
        sigma: At<f64>
            = si(&[UnitDimension::VELOCITY, UnitDimension::LENGTH], Bounds::Positive),
            by_case(SIGMAS),
            "Standard deviation of each axis, as the filter believes it.";
        noise: At<f64>
            = si(&[UnitDimension::VELOCITY, UnitDimension::LENGTH], Bounds::NotNegative),
            by_case(NOISES),
            "Standard deviation of the white noise that the reference really has.";
        rest: At<Option<CaseRestKeys>> = table::<CaseRestKeys>(),
            absent("the velocity alone is known to be zero"),
            "Case that doesn't turn: at a stop neither do the gimbals, and a move turns the body about one axis alone. For motion.kind = \"static\".";
    }
}

keys! {
    /// `[procedure.calibration.least_squares]`.
    pub(crate) struct LeastSquaresKeys {
        gravity: Option<f64>
            = within(&[UnitDimension::ACCELERATION], 9.0, 11.0, "from 9 to 11 m/s^2"),
            absent("normal gravity at the site"),
            "Local gravity.";
        gyro: GyroReference = choice! {
                "earth-rate" => GyroReference::EarthRate, "norm of Earth rate: gyros that see it";
                "rotated-gravity" => GyroReference::RotatedGravity,
                    "gravity turned between static attitudes: gyros that don't see Earth rate";
            }, "earth-rate",
            "What the gyros are measured against.";
        intervals: Intervals = choice! {
                "commanded" => Intervals::Commanded, "from the procedure";
                "detected" => Intervals::Detected, "from the data, by windowed standard deviation";
            }, "commanded",
            "How static intervals are found.";
        initial: f64 = duration(), "50 s",
            "Detected: length of the first interval, known to be static.";
        window: f64 = duration(), "1 s", "Detected: window of the standard deviation.";
        threshold: f64 = number(Bounds::Positive), "5.0",
            "Detected: multiple of the first interval's standard deviation.";
        shortest: f64 = duration(), "2 s", "Detected: shortest interval to use.";
    }
}

/// Rotation while navigating.
#[derive(Clone, Debug)]
pub(crate) enum Rotation {
    Sixteen,
    Tetrahedral,
    None,
    Stops(Vec<StopKeys>),
}

impl Value for Rotation {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        Vec::read(table, key).map(|stops| stops.map(Self::Stops))
    }
}

const fn rotation() -> Of<Rotation> {
    const STOPS: Kind = Kind::Tables(StopKeys::SECTION, 1, STOPS_MAX);
    const NAMES: Kind = Kind::Choice(&[
        ("sixteen", "sixteen moves of 180° about both gimbals, that average out most drifts"),
        (
            "tetrahedral",
            "twelve attitudes, equally long, out and back, over which vectors of the body average as over the \
             tetrahedral group: of the drifts by g-dependent biases the isotropic part alone is left",
        ),
        ("none", "gimbals stand at zero"),
    ]);
    Of::or_choice(
        const { Kind::Either(&[NAMES, STOPS]) },
        const { &[Rotation::Sixteen, Rotation::Tetrahedral, Rotation::None] },
    )
}

keys! {
    /// `[procedure.navigation]`.
    pub(crate) struct NavigationKeys {
        duration: At<Option<f64>>
            = duration(), derived("plant: has to be given; recordings: until they end"),
            "How long.";
        rotation: At<Rotation> = rotation(), "sixteen",
            "Rotation while navigating: a named scheme, or stops that are repeated.";
        dwell: f64 = duration(), "300 s",
            "Rest at each stop of weight 1; the move to the next stop comes on top.";
    }
}

/// Key of the baseline: one of the calibration, with its kind.
const fn as_primary(name: &'static str, doc: &'static str) -> Key {
    let keys = CalibrationKeys::SECTION.keys;
    let mut index = 0;
    while !same(keys[index].name, name) {
        index += 1;
    }
    key(name, keys[index].kind, Default::Absent("as in procedure.calibration"), doc)
}

const fn same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let mut index = 0;
    while index < one.len() && index < other.len() && one[index] == other[index] {
        index += 1;
    }
    index == one.len() && index == other.len()
}

/// Keys of `[baseline]`, which are read in place of those of the calibration.
pub(super) static BASELINE: Section = section(&[
    as_primary("positions", "Named sequence of positions."),
    as_primary("stops", "A sequence of one's own."),
    as_primary(
        "name",
        "Name of this sequence of one's own; other stops don't inherit the first one's.",
    ),
    as_primary("passes", "How often the sequence is walked."),
    as_primary("estimator", "How the parameters are estimated."),
    as_primary("error_model", "Form of the filter's system error model."),
    as_primary("g_states", "Whether the filter estimates the g-dependent biases."),
    as_primary("not_estimated", "Further groups that the filter does not estimate."),
    as_primary(
        "further",
        "Errors beside the thirty parameters that this filter considers or estimates; {} for none.",
    ),
]);
