//! State of a run from the messages so far.

use super::about::About;
use super::series::Series;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use octant_recorder::event::{FaultResult, Pace, PacingRecord};
use octant_recorder::reader::Item;
use octant_recorder::{Event, concluded};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{GimbalAngles, Health, Mode, Output, Truth};
use octant_score::health;
use std::collections::VecDeque;

/// Maximum number of lines of the log.
const LOG_LINES: usize = 200;

/// Error of the navigation solution, navigation minus truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolutionError {
    /// Latitude error, arcmin.
    pub latitude_arcmin: f64,
    /// Longitude error, arcmin.
    pub longitude_arcmin: f64,
    /// Radial error, nmi.
    pub radial_nmi: f64,
}

impl SolutionError {
    /// Computes the error of an output against the truth of its epoch.
    #[must_use]
    pub fn of(output: &Output, truth: &Truth) -> Self {
        let navigation = &output.navigation;
        let latitude_rad = navigation.latitude_rad - truth.latitude_rad;
        let longitude_rad = navigation.longitude_rad - truth.longitude_rad;
        let earth = Ellipsoid::at(truth.latitude_rad, truth.height_m);
        let north_m = latitude_rad * earth.meridian_radius_m;
        let east_m = longitude_rad * earth.transverse_radius_m * earth.cos_latitude;
        Self {
            latitude_arcmin: latitude_rad / ARCMIN,
            longitude_arcmin: longitude_rad / ARCMIN,
            radial_nmi: libm::hypot(north_m, east_m) / NAUTICAL_MILE_M,
        }
    }

    /// Returns the largest magnitudes of both.
    #[must_use]
    pub fn largest(self, other: Self) -> Self {
        Self {
            latitude_arcmin: self.latitude_arcmin.abs().max(other.latitude_arcmin.abs()),
            longitude_arcmin: self.longitude_arcmin.abs().max(other.longitude_arcmin.abs()),
            radial_nmi: self.radial_nmi.max(other.radial_nmi),
        }
    }
}

/// A fault of the run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultState {
    /// Id in the scenario.
    pub id: String,
    /// Kind.
    pub kind: String,
    /// Condition that it waits for, as text; empty if the scenario doesn't state it.
    pub when: String,
    /// Number of times that it set in.
    pub firings: u64,
    /// True while it acts.
    pub acts: bool,
    /// Time at which it last set in or ended, run time, ns.
    pub last_ns: Option<u64>,
    /// Receipt, at the end of the run.
    pub receipt: Option<FaultResult>,
}

/// Cause that the core has reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReportedCause {
    /// One flag.
    pub flag: Health,
    /// Number of recorded outputs that carried it.
    pub outputs: u64,
    /// Last of these outputs, run time, ns.
    pub last_ns: u64,
}

impl ReportedCause {
    /// Returns the name of the flag.
    #[must_use]
    pub fn name(&self) -> &'static str {
        health::name(self.flag)
    }
}

/// Normalized innovation squared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nis {
    /// NIS of the last measurement.
    pub last: f64,
    sum: f64,
    /// Number of measurements that were recorded and not rejected.
    pub measurements: u64,
}

impl Nis {
    /// Returns the mean over the measurements that were not rejected.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.measurements as f64
    }
}

/// State of a run.
#[derive(Clone, Debug, Default)]
pub struct RunState {
    /// Description from its recording.
    pub about: About,
    /// Run time, ns.
    pub time_ns: u64,
    /// Gimbal angles from the encoders.
    pub gimbals: Option<GimbalAngles>,
    /// Last output of the core.
    pub output: Option<Output>,
    /// Beginning of the mode, run time, ns.
    pub mode_since_ns: u64,
    /// Last parameters with their run time, ns.
    pub parameters: Option<(u64, Box<ParameterEstimate>)>,
    /// Error of the last output, if truth is recorded.
    pub drift: Option<SolutionError>,
    /// Largest errors since the last calibration or navigation began.
    pub largest: SolutionError,
    /// Mode in which these largest errors occurred.
    pub largest_while: Option<Mode>,
    /// NIS, once there were measurements.
    pub nis: Option<Nis>,
    /// Causes that the core has reported, in the order of the flags.
    pub causes: Vec<ReportedCause>,
    /// The faults of the scenario.
    pub faults: Vec<FaultState>,
    /// Last report of the time keeping.
    pub pace: Option<Pace>,
    /// Largest lateness so far, µs.
    pub latest_us: f64,
    /// Time keeping, at the end.
    pub pacing: Option<Box<PacingRecord>>,
    /// Reason why the calibration was refused.
    pub refused: Option<String>,
    /// Reason why the run was aborted.
    pub error: Option<String>,
    /// Log of events: run time and text.
    pub log: VecDeque<(u64, String)>,
    /// Latitude error over hours of run time, arcmin.
    pub latitude: Series,
    /// Longitude error over hours of run time, arcmin.
    pub longitude: Series,
    /// NIS over hours of run time.
    pub nis_series: Series,
    /// Largest lateness of each second over hours of run time, µs.
    pub lateness: Series,
}

impl RunState {
    /// Creates the state of a run of which only the description is known.
    #[must_use]
    pub fn new(about: About) -> Self {
        let faults = (about.faults.iter())
            .map(|armed| FaultState {
                id: armed.id.clone(),
                kind: armed.kind.clone(),
                when: armed.when.clone(),
                ..FaultState::default()
            })
            .collect();
        Self { about, faults, ..Self::default() }
    }

    /// Returns the mode of the core; `None` before its first output.
    #[must_use]
    pub fn mode(&self) -> Option<Mode> {
        self.output.map(|output| output.mode)
    }

    /// Returns the completed fraction of the run, if its length is known.
    #[must_use]
    pub fn done(&self) -> Option<f64> {
        let length_ns = self.about.length_ns.filter(|ns| *ns > 0)?;
        Some((self.time_ns as f64 / length_ns as f64).min(1.0))
    }

    fn hours(&self) -> f64 {
        self.time_ns as f64 / 3.6e12
    }

    /// Takes the next message.
    pub fn take(&mut self, time_ns: u64, item: &Item) {
        self.time_ns = self.time_ns.max(time_ns);
        match item {
            Item::Sample(sample) => self.gimbals = Some(sample.gimbal),
            Item::Output(output) => self.output(time_ns, output),
            Item::Parameters(_, estimate) => self.parameters = Some((time_ns, estimate.clone())),
            Item::Truth(truth) => self.truth(truth),
            Item::Event(event) => self.event(time_ns, event),
            Item::CleanSample(_)
            | Item::CleanAiding(_)
            | Item::Aiding(_)
            | Item::Innovation(..)
            | Item::Covariance(..) => {}
        }
    }

    fn output(&mut self, time_ns: u64, output: &Output) {
        if self.mode() != Some(output.mode) {
            self.mode_since_ns = time_ns;
            // The end of a navigation belongs to it.
            if output.mode != Mode::Done {
                self.largest = SolutionError::default();
                self.largest_while = Some(output.mode);
            }
        }
        self.output = Some(*output);
        // The drift belongs to the output with which truth comes.
        if output.nis.is_finite() {
            let rejected = output.health.contains(Health::INNOVATION_REJECTED);
            let nis = self.nis.get_or_insert_default();
            nis.last = output.nis;
            if !rejected {
                nis.sum += output.nis;
                nis.measurements += 1;
            }
            let hours = self.hours();
            self.nis_series.push(hours, output.nis);
        }
        for flag in output.health.iter() {
            let place = self.causes.binary_search_by_key(&flag.bits(), |cause| cause.flag.bits());
            match place {
                Ok(at) => {
                    self.causes[at].outputs += 1;
                    self.causes[at].last_ns = time_ns;
                }
                Err(at) => {
                    self.causes.insert(at, ReportedCause { flag, outputs: 1, last_ns: time_ns })
                }
            }
        }
    }

    fn truth(&mut self, truth: &Truth) {
        let Some(output) = &self.output else { return };
        // Truth belongs to the output of the same epoch; a sample that a fault lost has truth and
        // no output.
        if output.device_time.ns != truth.time.ns {
            return;
        }
        let drift = SolutionError::of(output, truth);
        self.drift = Some(drift);
        self.largest = self.largest.largest(drift);
        let hours = self.hours();
        self.latitude.push(hours, drift.latitude_arcmin);
        self.longitude.push(hours, drift.longitude_arcmin);
    }

    fn event(&mut self, time_ns: u64, event: &Event) {
        match event {
            Event::Pace(pace) => {
                self.latest_us = self.latest_us.max(pace.latest_us);
                self.pace = Some(*pace);
                let hours = self.hours();
                self.lateness.push(hours, pace.latest_us);
                return;
            }
            Event::Pacing { pacing, .. } => self.pacing = Some(pacing.clone()),
            Event::Fault { begins, id, kind, .. } => {
                let fault = self.fault_of(id, kind);
                fault.firings += u64::from(*begins);
                fault.acts = *begins;
                fault.last_ns = Some(time_ns);
            }
            Event::Receipts(receipts) => self.receipts(receipts),
            Event::Calibration { .. } => {
                if let Some(estimate) = concluded::estimate(event) {
                    self.parameters = Some((time_ns, Box::new(estimate)));
                }
            }
            Event::Refused { reason } => self.refused = Some(reason.clone()),
            Event::Error { reason } => self.error = Some(reason.clone()),
            _ => {}
        }
        if self.log.len() == LOG_LINES {
            self.log.pop_front();
        }
        self.log.push_back((time_ns, words(event)));
    }

    /// Returns the fault of this id, and adds it if the scenario doesn't have it.
    fn fault_of(&mut self, id: &str, kind: &str) -> &mut FaultState {
        let at = self.faults.iter().position(|fault| fault.id == id).unwrap_or_else(|| {
            let (id, kind) = (id.to_owned(), kind.to_owned());
            self.faults.push(FaultState { id, kind, ..FaultState::default() });
            self.faults.len() - 1
        });
        &mut self.faults[at]
    }

    fn receipts(&mut self, receipts: &[FaultResult]) {
        for receipt in receipts {
            let fault = self.fault_of(&receipt.id, &receipt.kind);
            fault.acts = false;
            fault.firings = u64::from(receipt.firings);
            fault.receipt = Some(receipt.clone());
        }
    }
}

/// Describes an event in a line.
fn words(event: &Event) -> String {
    match event {
        Event::Mode { to, .. } => format!("mode {to}"),
        Event::Fault { begins, id, kind, sample } => {
            let what = if *begins { "sets in" } else { "ends" };
            format!("fault {id} ({kind}) {what}, sample {sample}")
        }
        Event::Unit { action, sample, .. } => format!("unit: {}, sample {sample}", action.name()),
        Event::Refused { reason } => format!("calibration refused: {reason}"),
        Event::Error { reason } => format!("the run broke off: {reason}"),
        Event::Receipts(_) => "receipts of the faults".to_owned(),
        Event::Pacing { .. } => "how time was kept".to_owned(),
        Event::Calibration { .. } => "calibration concluded by the end of the stream".to_owned(),
        Event::Operator(record) => {
            let words = ["act", "step", "value", "by"].map(|name| record[name].as_str());
            format!("operator: {}", words.into_iter().flatten().collect::<Vec<_>>().join(" "))
        }
        Event::Other { kind, detail } => format!("{kind}: {detail}"),
        Event::Bench(_)
        | Event::Host { .. }
        | Event::Link(_)
        | Event::Pace(_)
        | Event::Power(_) => {
            let stored = serde_json::to_value(event).unwrap_or_default();
            format!("{}: {}", stored["kind"].as_str().unwrap_or_default(), stored["detail"])
        }
    }
}
