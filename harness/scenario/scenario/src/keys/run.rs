//! Keys of the root, the site, the motion, and the use of the results.

use super::calibration::{BASELINE, ProcedureKeys};
use super::definition::{Bounds, Kind, SCHEMA, Section};
use super::faults::{FAULT, OperatorKeys};
use super::fmu::EndpointFmuKeys;
use super::further::DrawnSiteKeys;
use super::instrument::{ImuKeys, TurntableKeys};
use super::power::PowerKeys;
use super::screening::{ScreeningKeys, on_off};
use super::source::SourceKeys;
use super::table::{
    At, Keys, Of, Raw, boolean, choice, integer, keys, si, si_array, table, tables, text, time,
    within,
};
use crate::model::MotionComponent;
use crate::quantity::UnitDimension;
use octant_base::display::{AttitudeUnit, PositionUnit, VelocityUnit};
use octant_earth::units::DEG;
use octant_verdict::Comparison;
use octant_verdict::decision::DecisionRule;

/// Keys of a scenario.
pub(crate) const SCENARIO: &Section = ScenarioKeys::SECTION;

keys! {
    /// A scenario.
    pub(crate) struct ScenarioKeys {
        #[expect(dead_code, reason = "it has one value")]
        schema: u32 = integer(SCHEMA, SCHEMA), required, "Version of the format.";
        title: String = text(), "untitled", "What the run is about, in a line.";
        seed: u64 = integer(0, i64::MAX), "1",
            "Seed of every random draw: the same seed gives the same bytes.";
        site: SiteKeys = table(), section, "Where the instrument stands.";
        motion: MotionKeys = table(), section, "How the case of the instrument moves.";
        imu: ImuKeys = table(), section, "The sensors and their true errors.";
        turntable: TurntableKeys = table(), section, "The two gimbals.";
        procedure: ProcedureKeys = table(), section,
            "What the core does: align, calibrate, navigate.";
        screening: ScreeningKeys = table(), section,
            "Screens and gates of the core.";
        baseline: At<Option<Raw>> = Of::<Raw>::kind(Kind::Table(&BASELINE)), absent("no second method"),
            "A second method, run on the same seed and noise and compared: what it does differently.";
        requirements: Option<Vec<RequirementKeys>>
            = tables::<RequirementKeys>(0, 1000), absent("no requirement is checked"),
            "Limits that the results have to keep.";
        equipment: Option<Vec<EquipmentKeys>>
            = tables::<EquipmentKeys>(0, 100), absent("nothing is told of the bench"),
            "Equipment of the bench with its certificates. One that has expired makes a run inconclusive.";
        decision: DecisionKeys = table(), section,
            "What a value near its limit comes to, by how uncertain its reference is.";
        faults: At<Option<Vec<Raw>>>
            = Of::<Vec<Raw>>::kind(Kind::VariantTables(&FAULT, 1000)), absent("no fault is injected"),
            "Faults that are injected on the way from the instrument to the core, in the order in which \
         they act. Beside the keys that all have there are those of the kind: `octant faults list` \
         names all kinds, `octant faults describe KIND` tells what one does and takes.";
        operator: At<Option<Vec<Raw>>>
            = Of::<Vec<Raw>>::kind(Kind::Tables(OperatorKeys::SECTION, 0, 1000)), absent("nobody is asked"),
            "What a person at the bench does in the run, and is asked.";
        record: RecordKeys = table(), section, "What is recorded, and how often.";
        source: SourceKeys = table(), section, "Where the samples come from.";
        endpoint: EndpointKeys = table(), section, "Where the core runs.";
        power: Option<PowerKeys> = table::<PowerKeys>(), absent("nothing is switched"),
            "The supply or the relay that feeds the device of the endpoint, over SCPI.";
        realtime: RealtimeKeys = table(), section,
            "Whether the run goes by the clock, how, and what makes it too late.";
        display: DisplayKeys = table(), section,
            "Units of errors in report and terminal. Files for machines keep theirs.";
    }
}

keys! {
    /// `[display]`.
    pub(crate) struct DisplayKeys {
        position: PositionUnit = choice! {
                "arcmin" => PositionUnit::ArcMinute, "minutes of arc; radial errors in nautical miles";
                "nmi" => PositionUnit::NauticalMile, "nautical miles along the ground";
                "m" => PositionUnit::Metre, "metres along the ground";
                "km" => PositionUnit::Kilometre, "kilometres along the ground";
            }, "arcmin",
            "Unit of position errors.";
        attitude: AttitudeUnit = choice! {
                "arcmin" => AttitudeUnit::ArcMinute, "minutes of arc";
                "deg" => AttitudeUnit::Degree, "degrees";
                "arcsec" => AttitudeUnit::ArcSecond, "seconds of arc";
                "mrad" => AttitudeUnit::Milliradian, "milliradians";
            }, "arcmin",
            "Unit of attitude errors.";
        velocity: VelocityUnit = choice! {
                "m/s" => VelocityUnit::MetrePerSecond, "metres per second";
                "kn" => VelocityUnit::Knot, "knots";
                "cm/s" => VelocityUnit::CentimetrePerSecond, "centimetres per second";
            }, "m/s",
            "Unit of velocity errors.";
    }
}

keys! {
    /// `[site]`.
    pub(crate) struct SiteKeys {
        latitude: f64
            = within(&[UnitDimension::ANGLE], -89.3 * DEG, 89.3 * DEG, "within ±89.3 deg: at the poles east has no direction"),
            "30.5 deg",
            "Geodetic latitude, north positive.";
        longitude: f64
            = within(&[UnitDimension::ANGLE], -180.0 * DEG, 180.0 * DEG, "within ±180 deg"),
            "114.4 deg",
            "Longitude, east positive.";
        height: f64 = within(&[UnitDimension::LENGTH], -10e3, 100e3, "from -10 km to 100 km"), "0 m",
            "Height above the ellipsoid.";
        deflection_north: f64
            = within(&[UnitDimension::SMALL_ANGLE], -0.1 * DEG, 0.1 * DEG, "within ±6 arcmin"), "0 arcsec",
            "Deflection of the vertical to the north (ξ): positive where the astronomic zenith is north of the geodetic one.";
        deflection_east: f64
            = within(&[UnitDimension::SMALL_ANGLE], -0.1 * DEG, 0.1 * DEG, "within ±6 arcmin"), "0 arcsec",
            "Deflection of the vertical to the east (η).";
        gravity_anomaly: f64
            = within(&[UnitDimension::ACCEL_BIAS], -0.01, 0.01, "within ±0.01 m/s^2 (1000 mGal)"), "0 ug",
            "True minus normal gravity.";
        drawn: Option<DrawnSiteKeys> = table::<DrawnSiteKeys>(), absent("nothing is drawn"),
            "Errors of gravity that the seed draws, each group from its own stream; they add to the values given above.";
    }
}

keys! {
    /// `[motion]`.
    pub(crate) struct MotionKeys {
        kind: MotionKind = choice! {
                "static" => MotionKind::Static, "fixed to the ground";
                "dockside" => MotionKind::Dockside, "on a moored ship that sways";
            }, "static",
            "Whether the case stands still.";
        heading: f64 = angle(180.0, "within ±180 deg"), "0 deg",
            "Mean heading of the case, from north over east.";
        pitch: f64 = angle(85.0, "within ±85 deg"), "0 deg",
            "Mean pitch of the case, bow up positive.";
        roll: f64 = angle(180.0, "within ±180 deg"), "0 deg",
            "Mean roll of the case, starboard down positive.";
        ship: Option<ShipKeys>
            = table::<ShipKeys>(), derived("dockside: the default sway; static: none"),
            "Motion of the moored ship about the mean attitude and position.";
    }
}

const fn angle(limit_deg: f64, words: &'static str) -> Of<f64> {
    within(&[UnitDimension::ANGLE], -limit_deg * DEG, limit_deg * DEG, words)
}

/// Motion of the case.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MotionKind {
    Static,
    Dockside,
}

/// Amplitude (deg or m) and period (s) of each motion of a preset; `None`: no motion.
type Preset = Option<[(f64, f64); 6]>;

const DEFAULT_SWAY: Preset =
    Some([(3.0, 8.0), (1.5, 6.0), (1.0, 10.0), (0.2, 6.0), (0.2, 7.0), (0.2, 8.0)]);
/// The dynamic condition of ISO 8728: harmonic roll and pitch of 5°, horizontal acceleration up to
/// 0.22 m/s², periods from 6 to 15 s.
const SEVERE_SWAY: Preset =
    Some([(5.0, 10.0), (5.0, 8.0), (1.0, 12.0), (0.25, 8.5), (0.25, 8.0), (0.3, 8.0)]);

/// Motions of a Scorsby table: draft of ISO 22090-1 (about 2000), 6.6 and 6.5. It turns about its centre.
const SCORSBY: Preset =
    Some([(20.0, 6.0), (10.0, 10.0), (5.0, 15.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)]);
const SCORSBY_SETTLING: Preset =
    Some([(5.0, 15.0), (5.0, 6.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)]);

keys! {
    /// `[motion.ship]`.
    pub(crate) struct ShipKeys {
        preset: Preset = choice! {
                "default" => DEFAULT_SWAY,
                    "roll 3°/8 s, pitch 1.5°/6 s, yaw 1°/10 s; surge, sway, heave 0.2 m at 6, 7, 8 s";
                "severe" => SEVERE_SWAY,
                    "roll 5°/10 s, pitch 5°/8 s, yaw 1°/12 s; surge and sway 0.25 m at 8.5 and 8 s, heave 0.3 m/8 s: horizontal acceleration up to 0.22 m/s², the dynamic condition of ISO 8728";
                "scorsby" => SCORSBY,
                    "a Scorsby table in its test: roll 20°/6 s, pitch 10°/10 s, yaw 5°/15 s";
                "scorsby-settling" => SCORSBY_SETTLING,
                    "a Scorsby table on which an instrument settles: roll 5°/15 s, pitch 5°/6 s";
                "calm" => None, "no motion but the components listed";
            }, derived("\"default\", or \"calm\" when components or a spectrum are given"),
            "Ready-made motion; components that are given replace those of the preset.";
        roll: Option<Vec<AngularKeys>> = tables(0, 64), absent("as in the preset"),
            "Roll of the ship: a sum of sinusoids.";
        pitch: Option<Vec<AngularKeys>> = tables(0, 64), absent("as in the preset"), "Pitch of the ship.";
        yaw: Option<Vec<AngularKeys>> = tables(0, 64), absent("as in the preset"), "Yaw of the ship.";
        surge: Option<Vec<LinearKeys>> = tables(0, 64), absent("as in the preset"),
            "Motion along the mean heading.";
        sway: Option<Vec<LinearKeys>> = tables(0, 64), absent("as in the preset"),
            "Motion to starboard of the mean heading.";
        heave: Option<Vec<LinearKeys>> = tables(0, 64), absent("as in the preset"),
            "Vertical motion, positive down.";
        spectrum: Option<SpectrumKeys> = table::<SpectrumKeys>(), absent("sinusoids alone"),
            "Irregular sea: sinusoids of a Pierson-Moskowitz spectrum are added, with frequencies and phases drawn from the seed.";
        mooring_offset: [f64; 3] = si_array(UnitDimension::LENGTH), "[\"0 m\", \"0 m\", \"0 m\"]",
            "Constant offset from the dock's reference position: north, east, down.";
        from: Option<f64> = time(0.0, 366.0 * 86400.0, "from 0 s to 366 day"),
            absent("from the start, without a ramp"),
            "When the motion begins, since the unit was switched on: before it the case is at rest.";
        duration: Option<f64> = time(1e-3, 366.0 * 86400.0, "above 0, up to 366 day"),
            absent("to the end"),
            "How long it has its full amplitude; after it the case returns to rest.";
        ramp: f64 = time(0.0, 3600.0, "from 0 s to 1 h"), "10 s",
            "How long it grows, before that time, and dies away, after it; with from or duration.";
    }
}

macro_rules! component {
    ($name:ident, $amplitude:expr) => {
        keys! {
            /// A sinusoid.
            pub(crate) struct $name {
                amplitude: f64 = $amplitude, required, "Amplitude.";
                period: f64 = time(0.5, 86400.0, "from 0.5 s to 24 h"), required, "Period.";
                phase: Option<f64> = si(&[UnitDimension::ANGLE], Bounds::Any),
                    absent("drawn from the seed"),
                    "Phase at time 0 of amplitude · sin(2π t / period + phase).";
            }
        }

        impl From<&$name> for MotionComponent {
            fn from(keys: &$name) -> Self {
                let $name { amplitude, period: period_s, phase: phase_rad } = *keys;
                Self { amplitude, period_s, phase_rad }
            }
        }
    };
}
component!(AngularKeys, within(&[UnitDimension::ANGLE], 0.0, 45.0 * DEG, "from 0 to 45 deg"));
component!(LinearKeys, within(&[UnitDimension::LENGTH], 0.0, 100.0, "from 0 to 100 m"));

keys! {
    /// `[motion.ship.spectrum]`.
    pub(crate) struct SpectrumKeys {
        peak_period: f64 = time(1.0, 60.0, "from 1 s to 60 s"), required,
            "Period at which the spectrum has its peak.";
        components: u32 = integer(2, 64), "16", "Sinusoids of each motion, spread over frequency.";
        roll: f64 = rms_angle(), "0 deg", "Root mean square of roll.";
        pitch: f64 = rms_angle(), "0 deg", "Root mean square of pitch.";
        yaw: f64 = rms_angle(), "0 deg", "Root mean square of yaw.";
        surge: f64 = rms_length(), "0 m", "Root mean square of surge.";
        sway: f64 = rms_length(), "0 m", "Root mean square of sway.";
        heave: f64 = rms_length(), "0 m", "Root mean square of heave.";
    }
}

const fn rms_angle() -> Of<f64> {
    within(&[UnitDimension::ANGLE], 0.0, 20.0 * DEG, "from 0 to 20 deg")
}

const fn rms_length() -> Of<f64> {
    within(&[UnitDimension::LENGTH], 0.0, 50.0, "from 0 to 50 m")
}

keys! {
    /// `[decision]`.
    pub(crate) struct DecisionKeys {
        rule: Option<DecisionRule> = choice! {
                "guard-band" => DecisionRule::GuardBand, "within the uncertainty of its limit it is inconclusive";
                "simple-acceptance" => DecisionRule::SimpleAcceptance, "it is held against its limit as it is";
            }, absent("guard-band; of simulated truth the band is zero"),
            "What a value comes to that its reference can't tell from its limit (JCGM 106).";
        position: Option<f64>
            = si(&[UnitDimension::LENGTH], Bounds::NotNegative),
            absent("not stated: exact where it is simulated"),
            "Expanded uncertainty (95 %) of the reference position, in each direction.";
        uncertainties: Option<Vec<UncertaintyKeys>>
            = tables::<UncertaintyKeys>(0, 1000), absent("none is stated"),
            "Expanded uncertainties (95 %) of what single measures are held against, such as a turntable.";
    }
}

keys! {
    /// One of `[[equipment]]`.
    pub(crate) struct EquipmentKeys {
        name: At<String> = text(), required, "What it is: a turntable, a reference, a counter.";
        serial: Option<String> = text(), absent("not told"), "Its serial number.";
        certificate: At<String> = text(), required, "Number of its certificate of calibration.";
        expires: At<String> = text(), required,
            "The last day on which the certificate holds, UTC, such as 2027-03-31.";
    }
}

keys! {
    /// One of the uncertainties of `[decision]`.
    pub(crate) struct UncertaintyKeys {
        measure: At<String> = text(), required, "The measure, as in a requirement, without bars.";
        uncertainty: At<f64> = Of::<f64>::kind(Kind::Limit), required,
            "Its uncertainty: a quantity, or a number in the measure's unit.";
    }
}

keys! {
    /// One of `[[requirements]]`.
    pub(crate) struct RequirementKeys {
        id: At<String> = text(), required, "Identifier, unique in the scenario.";
        text: String = text(), required, "What is required, as a sentence.";
        measure: At<String> = text(), required,
            "What is compared: a dotted path into summary.json, such as navigation.longitude_error_arcmin.max.";
        limit: At<f64> = Of::<f64>::kind(Kind::Limit), required,
            "The limit: a quantity, or a number in the measure's unit.";
        comparison: Comparison = choice! {
                "<=" => Comparison::AtMost, "at most the limit";
                "<" => Comparison::Below, "below the limit";
                ">=" => Comparison::AtLeast, "at least the limit";
                ">" => Comparison::Above, "above the limit";
            }, "<=",
            "How the measure is compared with the limit.";
        secant_latitude: At<bool> = boolean(), "false",
            "Whether the limit is multiplied by the secant of the site's latitude, as errors of a gyrocompass are.";
        clause: Option<String> = text(), absent("none"),
            "Where the requirement comes from: document and clause.";
        #[expect(dead_code, reason = "it is always refused")]
        pass: Option<String> = Of::<String>::kind(Kind::Refused(ONE_RUN)), absent("none"), ONE_RUN;
        #[expect(dead_code, reason = "it is always refused")]
        confidence: Option<String>
            = Of::<String>::kind(Kind::Refused(ONE_RUN)), absent("none"), ONE_RUN;
    }
}

/// Reason why a scenario takes no probability.
const ONE_RUN: &str = "one run shows no probability: write pass and confidence with the requirement in \
                       the file that a campaign names (requirements = \"requirements.toml\")";

keys! {
    /// `[record]`.
    pub(crate) struct RecordKeys {
        rate: At<f64> = si(&[UnitDimension::FREQUENCY], Bounds::Positive), "1 Hz",
            "Rate of truth, output and decimated samples; a whole number of samples apart.";
        samples: bool = choice! {
                "decimated" => false, "samples at the record rate";
                "full" => true, "every sample: can be replayed";
            }, "decimated",
            "Which samples are kept.";
        parameters: f64 = si(&[UnitDimension::TIME], Bounds::Positive), "10 s",
            "Shortest time between two records of the estimated parameters.";
        topics: bool = on_off(), "on",
            "Topics for other tools in the recording: standard messages of ROS 2, and the JSON of a live run.";
        topics_period: f64 = si(&[UnitDimension::TIME], Bounds::Positive), "10 s",
            "Shortest time between two messages on each of these topics; at changes of mode there is one too.";
    }
}

keys! {
    /// `[realtime]`.
    pub(crate) struct RealtimeKeys {
        pace: At<bool> = choice! {
                "free" => false, "as fast as it goes";
                "clock" => true, "a sample leaves when its time has come; `octant run --realtime`";
            }, "free",
            "What a run goes by. What is computed is the same.";
        overrun: f64 = si(&[UnitDimension::SHORT_TIME], Bounds::Positive), "1 ms",
            "A sample that leaves later than this is an overrun.";
        overruns: u64 = integer(0, i64::MAX), "0",
            "Overruns that are allowed; beyond, the run is inconclusive.";
        lateness_p99: Option<f64>
            = si(&[UnitDimension::SHORT_TIME], Bounds::Positive), absent("no limit"),
            "Largest lateness of 99 % of the samples; beyond, the run is inconclusive.";
        late_answers: u64 = integer(0, i64::MAX), "0",
            "Periods that may end without their answer; beyond, the run is inconclusive.";
        silence: f64 = si(&[UnitDimension::SHORT_TIME], Bounds::Positive), "1 s",
            "An endpoint that owes an answer for longer is gone, which ends the run.";
        priority: u8 = integer(0, 99), "80",
            "Priority of SCHED_FIFO that the thread of the samples asks for; 0: none.";
        cpu: Option<u16> = integer::<u16>(0, 1023), absent("any"),
            "The only processor that the thread of the samples runs on.";
        lock_memory: bool = boolean(), "true", "All memory of the program stays in place.";
        spin: f64 = si(&[UnitDimension::SHORT_TIME], Bounds::NotNegative), "0 s",
            "The last part of each wait that is spent looking at the clock, where a real-time priority \
         was granted.";
    }
}

keys! {
    /// `[endpoint]`.
    pub(crate) struct EndpointKeys {
        uri: At<String> = Of::<String>::kind(Kind::Uri(&crate::choices::ENDPOINTS)), "in-process",
            "Where the core runs. A file name is relative to the scenario, and may start with ${OCTANT_RECORDINGS}.";
        fmu: Option<EndpointFmuKeys>
            = table::<EndpointFmuKeys>(), derived("fmu: the defaults of its keys"),
            "How the FMU of endpoint.uri is run, and what its variables are.";
        link: Option<LinkKeys>
            = table::<LinkKeys>(), derived("with a device: the defaults of its keys"),
            "What is waited for how long, of the device at endpoint.uri.";
    }
}

const fn wait() -> Of<f64> {
    time(1e-3, 3600.0, "from 1 ms to 1 h")
}

keys! {
    /// `[endpoint.link]`.
    pub(crate) struct LinkKeys {
        hello: f64 = wait(), "10 s",
            "How long the device's first hello is waited for, such as while it is switched on.";
        answer: f64 = wait(), "5 s",
            "How long an answer is waited for, however often it is asked for; then the device is gone.";
        repeat: At<f64> = wait(), "200 ms",
            "After how long an answer that isn't there is asked for again.";
        reconnect: At<f64> = time(0.0, 3600.0, "from 0 s to 1 h"), "0 s",
            "How long a port that was unplugged is waited for; the device has to have kept its state. 0 s: the run ends at once.";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_severe_preset_keeps_the_horizontal_acceleration_of_iso_8728() {
        let acceleration =
            |(amplitude, period): (f64, f64)| amplitude * (std::f64::consts::TAU / period).powi(2);
        let [.., surge, sway, _] = SEVERE_SWAY.unwrap();
        let horizontal = acceleration(surge).hypot(acceleration(sway));
        assert!((0.19..=0.22).contains(&horizontal), "{horizontal} m/s²");
    }
}
