//! Keys of the root, the site, the motion, and the use of the results.

use super::definition::{Bounds, Default, Key, Kind, SCHEMA, Section, key, section};
use super::fmu::ENDPOINT_FMU;
use super::link::ENDPOINT_LINK;
use super::{calibration, faults, instrument, screening, source};
use crate::quantity::Dimension;
use octant_earth::units::DEG;

pub(crate) static SCENARIO: Section = section(&[
    key("schema", Kind::Integer(SCHEMA, SCHEMA), Default::Required, "Version of the format."),
    key("title", Kind::Text, Default::Value("untitled"), "What the run is about, in a line."),
    key(
        "seed",
        Kind::Integer(0, i64::MAX),
        Default::Value("1"),
        "Seed of every random draw: the same seed gives the same bytes.",
    ),
    key("site", Kind::Table(&SITE), Default::Section, "Where the instrument stands."),
    key("motion", Kind::Table(&MOTION), Default::Section, "How the case of the instrument moves."),
    key(
        "imu",
        Kind::Table(&instrument::IMU),
        Default::Section,
        "The sensors and their true errors.",
    ),
    key("turntable", Kind::Table(&instrument::TURNTABLE), Default::Section, "The two gimbals."),
    key(
        "procedure",
        Kind::Table(&calibration::PROCEDURE),
        Default::Section,
        "What the core does: align, calibrate, navigate.",
    ),
    key(
        "screening",
        Kind::Table(&screening::SCREENING),
        Default::Section,
        "Screens and gates of the core.",
    ),
    key(
        "baseline",
        Kind::Table(&calibration::BASELINE),
        Default::Absent("no second method"),
        "A second method, run on the same seed and noise and compared: what it does differently.",
    ),
    key(
        "requirements",
        Kind::Tables(&REQUIREMENT, 0, 1000),
        Default::Absent("no requirement is checked"),
        "Limits that the results have to keep.",
    ),
    key(
        "equipment",
        Kind::Tables(&EQUIPMENT, 0, 100),
        Default::Absent("nothing is told of the bench"),
        "Equipment of the bench with its certificates. One that has expired makes a run inconclusive.",
    ),
    key(
        "decision",
        Kind::Table(&DECISION),
        Default::Section,
        "What a value near its limit comes to, by how uncertain its reference is.",
    ),
    key(
        "faults",
        Kind::VariantTables(&faults::FAULT, 1000),
        Default::Absent("no fault is injected"),
        "Faults that are injected on the way from the instrument to the core, in the order in which \
         they act. Beside the keys that all have there are those of the kind: `octant faults list` \
         names all kinds, `octant faults describe KIND` tells what one does and takes.",
    ),
    key("record", Kind::Table(&RECORD), Default::Section, "What is recorded, and how often."),
    key("source", Kind::Table(&source::SOURCE), Default::Section, "Where the samples come from."),
    key("endpoint", Kind::Table(&ENDPOINT), Default::Section, "Where the core runs."),
    key(
        "realtime",
        Kind::Table(&REALTIME),
        Default::Section,
        "Whether the run goes by the clock, how, and what makes it too late.",
    ),
]);

static SITE: Section = section(&[
    key(
        "latitude",
        Kind::Quantity(
            &[Dimension::ANGLE],
            Bounds::Within(
                -89.3 * DEG,
                89.3 * DEG,
                "within ±89.3 deg: at the poles east has no direction",
            ),
        ),
        Default::Value("30.5 deg"),
        "Geodetic latitude, north positive.",
    ),
    key(
        "longitude",
        Kind::Quantity(
            &[Dimension::ANGLE],
            Bounds::Within(-180.0 * DEG, 180.0 * DEG, "within ±180 deg"),
        ),
        Default::Value("114.4 deg"),
        "Longitude, east positive.",
    ),
    key(
        "height",
        Kind::Quantity(&[Dimension::LENGTH], Bounds::Within(-10e3, 100e3, "from -10 km to 100 km")),
        Default::Value("0 m"),
        "Height above the ellipsoid.",
    ),
]);

static MOTION: Section = section(&[
    key(
        "kind",
        Kind::Choice(&[
            ("static", "fixed to the ground"),
            ("dockside", "on a moored ship that sways"),
        ]),
        Default::Value("static"),
        "Whether the case stands still.",
    ),
    key(
        "heading",
        angle(180.0, "within ±180 deg"),
        Default::Value("0 deg"),
        "Mean heading of the case, from north over east.",
    ),
    key(
        "pitch",
        angle(85.0, "within ±85 deg"),
        Default::Value("0 deg"),
        "Mean pitch of the case, bow up positive.",
    ),
    key(
        "roll",
        angle(180.0, "within ±180 deg"),
        Default::Value("0 deg"),
        "Mean roll of the case, starboard down positive.",
    ),
    key(
        "ship",
        Kind::Table(&SHIP),
        Default::Derived("dockside: the default sway; static: none"),
        "Motion of the moored ship about the mean attitude and position.",
    ),
]);

const fn angle(limit_deg: f64, words: &'static str) -> Kind {
    // The slice is a named constant because a static can't borrow a temporary array through a function.
    const ANGLE: &[Dimension] = &[Dimension::ANGLE];
    Kind::Quantity(ANGLE, Bounds::Within(-limit_deg * DEG, limit_deg * DEG, words))
}

static SHIP: Section = section(&[
    key(
        "preset",
        Kind::Choice(&[
            (
                "default",
                "roll 3°/8 s, pitch 1.5°/6 s, yaw 1°/10 s; surge, sway, heave 0.2 m at 6, 7, 8 s",
            ),
            (
                "severe",
                "roll 5°/10 s, pitch 5°/8 s, yaw 1°/12 s; surge and sway 0.25 m at 8.5 and 8 s, heave 0.3 m/8 s: horizontal acceleration up to 0.22 m/s², the dynamic condition of ISO 8728",
            ),
            ("calm", "no motion but the components listed"),
        ]),
        Default::Derived("\"default\", or \"calm\" when components or a spectrum are given"),
        "Ready-made motion; components that are given replace those of the preset.",
    ),
    key(
        "roll",
        ANGULAR,
        Default::Absent("as in the preset"),
        "Roll of the ship: a sum of sinusoids.",
    ),
    key("pitch", ANGULAR, Default::Absent("as in the preset"), "Pitch of the ship."),
    key("yaw", ANGULAR, Default::Absent("as in the preset"), "Yaw of the ship."),
    key("surge", LINEAR, Default::Absent("as in the preset"), "Motion along the mean heading."),
    key(
        "sway",
        LINEAR,
        Default::Absent("as in the preset"),
        "Motion to starboard of the mean heading.",
    ),
    key("heave", LINEAR, Default::Absent("as in the preset"), "Vertical motion, positive down."),
    key(
        "spectrum",
        Kind::Table(&SPECTRUM),
        Default::Absent("sinusoids alone"),
        "Irregular sea: sinusoids of a Pierson-Moskowitz spectrum are added, with frequencies and phases drawn from the seed.",
    ),
    key(
        "mooring_offset",
        Kind::Quantities(Dimension::LENGTH, 3),
        Default::Value("[\"0 m\", \"0 m\", \"0 m\"]"),
        "Constant offset from the dock's reference position: north, east, down.",
    ),
]);

const ANGULAR: Kind = Kind::Tables(&ANGULAR_COMPONENT, 0, 64);
const LINEAR: Kind = Kind::Tables(&LINEAR_COMPONENT, 0, 64);

static ANGULAR_COMPONENT: Section = section(&[
    key(
        "amplitude",
        Kind::Quantity(&[Dimension::ANGLE], Bounds::Within(0.0, 45.0 * DEG, "from 0 to 45 deg")),
        Default::Required,
        "Amplitude.",
    ),
    PERIOD,
    PHASE,
]);

static LINEAR_COMPONENT: Section = section(&[
    key(
        "amplitude",
        Kind::Quantity(&[Dimension::LENGTH], Bounds::Within(0.0, 100.0, "from 0 to 100 m")),
        Default::Required,
        "Amplitude.",
    ),
    PERIOD,
    PHASE,
]);

const PERIOD: Key = key(
    "period",
    Kind::Quantity(&[Dimension::TIME], Bounds::Within(0.5, 86400.0, "from 0.5 s to 24 h")),
    Default::Required,
    "Period.",
);
const PHASE: Key = key(
    "phase",
    Kind::Quantity(&[Dimension::ANGLE], Bounds::Any),
    Default::Absent("drawn from the seed"),
    "Phase at time 0 of amplitude · sin(2π t / period + phase).",
);

static SPECTRUM: Section = section(&[
    key(
        "peak_period",
        Kind::Quantity(&[Dimension::TIME], Bounds::Within(1.0, 60.0, "from 1 s to 60 s")),
        Default::Required,
        "Period at which the spectrum has its peak.",
    ),
    key(
        "components",
        Kind::Integer(2, 64),
        Default::Value("16"),
        "Sinusoids of each motion, spread over frequency.",
    ),
    key("roll", RMS_ANGLE, Default::Value("0 deg"), "Root mean square of roll."),
    key("pitch", RMS_ANGLE, Default::Value("0 deg"), "Root mean square of pitch."),
    key("yaw", RMS_ANGLE, Default::Value("0 deg"), "Root mean square of yaw."),
    key("surge", RMS_LENGTH, Default::Value("0 m"), "Root mean square of surge."),
    key("sway", RMS_LENGTH, Default::Value("0 m"), "Root mean square of sway."),
    key("heave", RMS_LENGTH, Default::Value("0 m"), "Root mean square of heave."),
]);

const RMS_ANGLE: Kind =
    Kind::Quantity(&[Dimension::ANGLE], Bounds::Within(0.0, 20.0 * DEG, "from 0 to 20 deg"));
const RMS_LENGTH: Kind =
    Kind::Quantity(&[Dimension::LENGTH], Bounds::Within(0.0, 50.0, "from 0 to 50 m"));

static DECISION: Section = section(&[
    key(
        "rule",
        Kind::Choice(&[
            ("guard-band", "within the uncertainty of its limit it is inconclusive"),
            ("simple-acceptance", "it is held against its limit as it is"),
        ]),
        Default::Absent("guard-band; of simulated truth the band is zero"),
        "What a value comes to that its reference can't tell from its limit (JCGM 106).",
    ),
    key(
        "position",
        Kind::Quantity(&[Dimension::LENGTH], Bounds::NotNegative),
        Default::Absent("not stated: exact where it is simulated"),
        "Expanded uncertainty (95 %) of the reference position, in each direction.",
    ),
    key(
        "uncertainties",
        Kind::Tables(&UNCERTAINTY, 0, 1000),
        Default::Absent("none is stated"),
        "Expanded uncertainties (95 %) of what single measures are held against, such as a turntable.",
    ),
]);

static EQUIPMENT: Section = section(&[
    key("name", Kind::Text, Default::Required, "What it is: a turntable, a reference, a counter."),
    key("serial", Kind::Text, Default::Absent("not told"), "Its serial number."),
    key("certificate", Kind::Text, Default::Required, "Number of its certificate of calibration."),
    key(
        "expires",
        Kind::Text,
        Default::Required,
        "The last day on which the certificate holds, UTC, such as 2027-03-31.",
    ),
]);

static UNCERTAINTY: Section = section(&[
    key(
        "measure",
        Kind::Text,
        Default::Required,
        "The measure, as in a requirement, without bars.",
    ),
    key(
        "uncertainty",
        Kind::Limit,
        Default::Required,
        "Its uncertainty: a quantity, or a number in the measure's unit.",
    ),
]);

static REQUIREMENT: Section = section(&[
    key("id", Kind::Text, Default::Required, "Identifier, unique in the scenario."),
    key("text", Kind::Text, Default::Required, "What is required, as a sentence."),
    key(
        "measure",
        Kind::Text,
        Default::Required,
        "What is compared: a dotted path into summary.json, such as navigation.longitude_error_arcmin.max.",
    ),
    key(
        "limit",
        Kind::Limit,
        Default::Required,
        "The limit: a quantity, or a number in the measure's unit.",
    ),
    key(
        "comparison",
        Kind::Choice(&[
            ("<=", "at most the limit"),
            ("<", "below the limit"),
            (">=", "at least the limit"),
            (">", "above the limit"),
        ]),
        Default::Value("<="),
        "How the measure is compared with the limit.",
    ),
    key(
        "clause",
        Kind::Text,
        Default::Absent("none"),
        "Where the requirement comes from: document and clause.",
    ),
]);

static RECORD: Section = section(&[
    key(
        "rate",
        Kind::Quantity(&[Dimension::FREQUENCY], Bounds::Positive),
        Default::Value("1 Hz"),
        "Rate of truth, output and decimated samples; a whole number of samples apart.",
    ),
    key(
        "samples",
        Kind::Choice(&[
            ("decimated", "samples at the record rate"),
            ("full", "every sample: can be replayed"),
        ]),
        Default::Value("decimated"),
        "Which samples are kept.",
    ),
    key(
        "parameters",
        Kind::Quantity(&[Dimension::TIME], Bounds::Positive),
        Default::Value("10 s"),
        "Shortest time between two records of the estimated parameters.",
    ),
]);

static REALTIME: Section = section(&[
    key(
        "pace",
        Kind::Choice(&[
            ("free", "as fast as it goes"),
            ("clock", "a sample leaves when its time has come; `octant run --realtime`"),
        ]),
        Default::Value("free"),
        "What a run goes by. What is computed is the same.",
    ),
    key(
        "overrun",
        Kind::Quantity(&[Dimension::TIME], Bounds::Positive),
        Default::Value("1 ms"),
        "A sample that leaves later than this is an overrun.",
    ),
    key(
        "overruns",
        Kind::Integer(0, i64::MAX),
        Default::Value("0"),
        "Overruns that are allowed; beyond, the run is inconclusive.",
    ),
    key(
        "lateness_p99",
        Kind::Quantity(&[Dimension::TIME], Bounds::Positive),
        Default::Absent("no limit"),
        "Largest lateness of 99 % of the samples; beyond, the run is inconclusive.",
    ),
    key(
        "late_answers",
        Kind::Integer(0, i64::MAX),
        Default::Value("0"),
        "Periods that may end without their answer; beyond, the run is inconclusive.",
    ),
    key(
        "silence",
        Kind::Quantity(&[Dimension::TIME], Bounds::Positive),
        Default::Value("1 s"),
        "An endpoint that owes an answer for longer is gone, which ends the run.",
    ),
    key(
        "priority",
        Kind::Integer(0, 99),
        Default::Value("80"),
        "Priority of SCHED_FIFO that the thread of the samples asks for; 0: none.",
    ),
    key(
        "cpu",
        Kind::Integer(0, 1023),
        Default::Absent("any"),
        "The only processor that the thread of the samples runs on.",
    ),
    key(
        "lock_memory",
        Kind::Boolean,
        Default::Value("true"),
        "All memory of the program stays in place.",
    ),
    key(
        "spin",
        Kind::Quantity(&[Dimension::TIME], Bounds::NotNegative),
        Default::Value("0 s"),
        "The last part of each wait that is spent looking at the clock, where a real-time priority \
         was granted.",
    ),
]);

static ENDPOINT: Section = section(&[
    key(
        "uri",
        Kind::Uri(&crate::choices::ENDPOINTS),
        Default::Value("in-process"),
        "Where the core runs. A file name is relative to the scenario, and may start with ${OCTANT_RECORDINGS}.",
    ),
    key(
        "fmu",
        Kind::Table(&ENDPOINT_FMU),
        Default::Derived("fmu: the defaults of its keys"),
        "How the FMU of endpoint.uri is run, and what its variables are.",
    ),
    key(
        "link",
        Kind::Table(&ENDPOINT_LINK),
        Default::Derived("with a device: the defaults of its keys"),
        "What is waited for how long, of the device at endpoint.uri.",
    ),
]);
