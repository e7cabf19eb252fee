//! A core at the other end of a wire: a device on a serial line, a CAN bus or UDP.
//!
//! In lock-step each sample is sent, and its answer is awaited and requested again until it has
//! come: the outputs are therefore those of the device's core to the last bit, however bad the line
//! is. By the clock a sample is sent once, and its answer is taken when it comes.

use super::powered::Powered;
use super::{Conclusion, Endpoint, EndpointError, EndpointOpenError, RemoteClock, Sent};
use octant_calibration::CoreConfig;
use octant_faults::catalogue::Acts;
use octant_faults::wire::Wired;
use octant_link::clock::ClockEstimator;
use octant_link::harness::{
    ANEW, Harness, LinkEvent, Patience, Sending, SessionError, SessionOptions,
};
use octant_link::{PortError, Uri, Wire, load, port};
use octant_power::PowerError;
use octant_realtime::clock::{MonotonicTime, now};
use octant_recorder::event::{self, LinkRecord};
use octant_sample::Epoch;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Output, Parameters};
use octant_scenario::{Live, Scenario};
use octant_wire::message::{EndRole, Gathered, OutputMessage, Reason, StepNumber, StepPacing};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Endpoint of a device.
#[derive(Debug)]
pub struct LiveEndpoint {
    harness: Harness,
    uri: Uri,
    /// Longest time to wait for a port that went away.
    reconnect: Duration,
    estimate: ParameterEstimate,
    begun: Instant,
    underway: Underway,
    /// Supply or relay of the device. Dropped last: the device hears its bye before.
    power: Option<Powered>,
    /// Failure to bring the power to its end state.
    power_error: Option<PowerError>,
}

/// Samples that were sent by the clock and are not answered yet.
#[derive(Debug)]
struct Underway {
    steps: VecDeque<StepNumber>,
    /// Answer whose parameters haven't come yet.
    held: Option<Held>,
    clock: ClockEstimator,
    /// Time of the last time exchange.
    asked: MonotonicTime,
    /// Number of hellos without a session since the last answer.
    anew: u32,
}

/// Answer, with a flag that tells whether parameters come after it.
#[derive(Debug)]
struct Held {
    message: OutputMessage,
    waits: bool,
}

/// Interval between time exchanges, ns.
const TIME_EXCHANGE_NS: u64 = 1_000_000_000;

impl LiveEndpoint {
    /// Checks whether a device can do what a scenario requires, before any port is opened.
    ///
    /// # Errors
    /// If it can't.
    pub fn check(scenario: &Scenario, live: &Live) -> Result<(), EndpointOpenError> {
        if scenario.baseline.is_some() {
            return Err(EndpointOpenError::OneMethod { uri: live.uri.to_string() });
        }
        if scenario.realtime.by_clock {
            let rate_hz = 1e9 / scenario.sample_period_ns as f64;
            load::real_time(&live.uri, rate_hz, load::bus(&live.uri))?;
        }
        Ok(())
    }

    /// Begins a session with the device of a scenario, in lock-step.
    ///
    /// # Errors
    /// If no device answers, or the device doesn't fit.
    pub fn open(
        scenario: &Scenario,
        live: &Live,
        config: &CoreConfig,
    ) -> Result<Self, EndpointOpenError> {
        Self::check(scenario, live)?;
        let options = SessionOptions {
            configuration: configuration(config),
            patience: Patience {
                hello: Duration::from_secs_f64(live.hello_s),
                answer: Duration::from_secs_f64(live.answer_s),
                repeat: Duration::from_secs_f64(live.repeat_s),
            },
            ..SessionOptions::lock_step(config.sample_period_ns)
        };
        let pacing =
            if scenario.realtime.by_clock { StepPacing::RealTime } else { StepPacing::LockStep };
        let options = SessionOptions { pacing, ..options };
        let power = scenario.power.as_ref();
        let power =
            power.map(|plan| Powered::begin(plan, scenario.sample_period_ns)).transpose()?;
        let mut port = match &power {
            None => port::open(&live.uri, EndRole::Harness),
            Some(_) => Powered::open_port(&live.uri, options.patience.hello),
        }
        .map_err(SessionError::from)?;
        if scenario.faults.iter().any(|fault| fault.spec.kind.acts == Acts::Wire) {
            port = octant_link::fault::around(port);
        }
        let mut wire = Wire::new(live.uri.to_string(), port, EndRole::Harness);
        if let Some(bus) = load::bus(&live.uri) {
            wire.set_bus(bus);
        }
        let harness = Harness::open(wire, options)?;
        Ok(Self {
            harness,
            uri: live.uri.clone(),
            reconnect: Duration::from_secs_f64(live.reconnect_s),
            estimate: NOTHING,
            begun: Instant::now(),
            underway: Underway {
                // As many steps as a step number can distinguish.
                steps: VecDeque::with_capacity(1 << 14),
                held: None,
                clock: ClockEstimator::new(10.0),
                asked: MonotonicTime::default(),
                anew: 0,
            },
            power,
            power_error: None,
        })
    }

    /// Releases the held answer, when its parameters have come or won't come any more. Returns the
    /// number of earlier samples that will have no answer.
    fn release(&mut self, output: &mut Output) -> Option<usize> {
        let held = self.underway.held.take()?;
        let position = self.underway.steps.iter().position(|step| *step == held.message.step)?;
        self.underway.steps.drain(..=position);
        *output = held.message.output;
        // If parameters were lost on the way, their revision is not announced.
        output.parameters_revision = self.estimate.revision;
        Some(position)
    }

    /// Returns the session, for its counters.
    #[must_use]
    pub fn harness(&self) -> &Harness {
        &self.harness
    }

    /// Waits for a port that went away in the middle of a step, and requests the answer again.
    #[cold]
    fn back(&mut self, error: SessionError, output: &mut Output) -> Result<(), EndpointError> {
        let SessionError::Port(PortError::Gone { .. }) = error else { return Err(error.into()) };
        let begun = Instant::now();
        loop {
            if begun.elapsed() >= self.reconnect {
                return Err(error.into());
            }
            std::thread::sleep(Duration::from_millis(50));
            if self.harness.reopen(begun.elapsed()).is_err() {
                continue;
            }
            match self.harness.step_again(output) {
                Ok(_) => return Ok(()),
                Err(SessionError::Port(PortError::Gone { .. })) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn take_parameters(&mut self) {
        if let Some(Gathered { revision, parameters, sigma, .. }) = self.harness.parameters()
            && (*revision != self.estimate.revision || self.estimate.sigma[0].is_nan())
        {
            self.estimate =
                ParameterEstimate { revision: *revision, parameters: *parameters, sigma: *sigma };
        }
    }
}

const NOTHING: ParameterEstimate = ParameterEstimate {
    revision: 0,
    parameters: Parameters {
        gyro_bias: [0.0; 3],
        gyro_scale: [0.0; 3],
        gyro_misalignment: [0.0; 6],
        g_dependent: [0.0; 9],
        accel_bias: [0.0; 3],
        accel_scale: [0.0; 3],
        accel_misalignment: [0.0; 3],
    },
    sigma: [f64::NAN; PARAMETER_COUNT],
};

impl Endpoint for LiveEndpoint {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        let answer = self.harness.step(&epoch.sample, epoch.aiding.as_ref(), output);
        if let Err(error) = answer {
            self.back(error, output)?;
        }
        if output.parameters_revision != self.estimate.revision || self.estimate.sigma[0].is_nan() {
            self.take_parameters();
        }
        Ok(())
    }

    fn uri(&self) -> String {
        self.uri.to_string()
    }

    fn send(&mut self, epoch: &Epoch, _output: &mut Output) -> Result<Sent, EndpointError> {
        let time = now();
        if time.since(self.underway.asked) >= TIME_EXCHANGE_NS {
            self.underway.asked = time;
            self.harness.request_time()?;
        }
        Ok(match self.harness.send_sample(&epoch.sample, epoch.aiding.as_ref())? {
            Sending::Sent(step) => {
                self.underway.steps.push_back(step);
                Sent::Underway
            }
            Sending::NotTaken(_) | Sending::WindowFull => Sent::NotSent,
        })
    }

    fn answer(
        &mut self,
        until: MonotonicTime,
        output: &mut Output,
    ) -> Result<Option<usize>, EndpointError> {
        loop {
            if self.underway.held.as_ref().is_some_and(|held| !held.waits)
                && let Some(skipped) = self.release(output)
            {
                return Ok(Some(skipped));
            }
            let wait = Duration::from_nanos(until.since(now()));
            let Some(event) = self.harness.poll(wait)? else {
                // The port may have waited slightly less than requested.
                if now() >= until {
                    return Ok(None);
                }
                continue;
            };
            match event {
                LinkEvent::Output(message) => {
                    self.underway.anew = 0;
                    // Messages come in order, so the parameters of an answer that is still held
                    // won't come any more.
                    let before = self.release(output);
                    let waits = message.parameters_follow
                        && message.output.parameters_revision != self.estimate.revision;
                    self.underway.held = Some(Held { message, waits });
                    if before.is_some() {
                        return Ok(before);
                    }
                }
                LinkEvent::Parameters(_) => {
                    self.take_parameters();
                    if let Some(held) = &mut self.underway.held {
                        held.waits &=
                            held.message.output.parameters_revision != self.estimate.revision;
                    }
                }
                LinkEvent::Time(stamps) => self.underway.clock.add(&stamps),
                LinkEvent::Anew => {
                    self.underway.anew += 1;
                    if self.underway.anew >= ANEW {
                        return Err(self.harness.started_anew().into());
                    }
                }
                _ => {}
            }
        }
    }

    fn idle(&mut self) -> Result<(), EndpointError> {
        if self.power.as_ref().is_some_and(Powered::is_cut) {
            // Nobody is there to hear it.
            return Ok(());
        }
        self.harness.keep_alive()?;
        // Its heartbeats are taken, so that no buffer fills up. A device that began anew says so at the next step.
        while self.harness.poll(Duration::ZERO)?.is_some() {}
        Ok(())
    }

    fn remote_clock(&self) -> Option<RemoteClock> {
        let estimate = self.underway.clock.estimate()?;
        Some(RemoteClock {
            offset_ns: estimate.offset_ns,
            bound_ns: estimate.bound_ns,
            skew: estimate.skew,
            exchanges: estimate.exchanges,
        })
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        self.estimate = NOTHING;
        self.underway.steps.clear();
        self.underway.held = None;
        Ok(self.harness.restart(offset)?)
    }

    fn power_off(&mut self, sample: u64) -> Result<(), EndpointError> {
        Ok(self.power.as_mut().map_or(Ok(()), |power| power.cut(sample))?)
    }

    fn power_on(&mut self, sample: u64) -> Result<(), EndpointError> {
        if self.power.is_none() {
            return self.restart(None);
        }
        self.estimate = NOTHING;
        self.underway.steps.clear();
        self.underway.held = None;
        match &mut self.power {
            Some(power) => power.back(sample, &mut self.harness),
            None => Ok(()),
        }
    }

    fn voltage_dip(
        &mut self,
        voltage_v: f64,
        length: Duration,
        sample: u64,
    ) -> Result<bool, EndpointError> {
        let Some(power) = &mut self.power else {
            return Err(EndpointError::Unpowered { uri: self.uri.to_string() });
        };
        let restarted = power.dip((voltage_v, length), sample, &mut self.harness)?;
        if restarted {
            self.estimate = NOTHING;
        }
        Ok(restarted)
    }

    fn parameters(&self) -> ParameterEstimate {
        self.estimate
    }

    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        if self.power.as_ref().is_some_and(Powered::is_cut) {
            // Nobody is there to conclude.
            return Ok(None);
        }
        let output = self.harness.end()?;
        self.take_parameters();
        Ok(output)
    }

    fn wired(&mut self) -> Option<&mut dyn Wired> {
        self.harness.wire().wired()
    }

    fn conclusion(&mut self) -> Conclusion {
        let (counts, effort) = (self.harness.counts(), self.harness.effort());
        let theirs = self.harness.theirs();
        let wall_s = self.begun.elapsed().as_secs_f64();
        let link = LinkRecord {
            arbitration_lost: counts.arbitration_lost,
            away_s: effort.away.as_secs_f64(),
            bus_load: (counts.bus_s > 0.0).then(|| counts.bus_s / wall_s),
            bus_off: counts.bus_off,
            configuration_compared: self.harness.agreement().configuration_compared,
            damaged: counts.damaged,
            device: theirs.name.as_str().to_owned(),
            doubled: effort.doubled,
            error_frames: counts.error_frames,
            error_passive: counts.error_passive,
            firmware: theirs.firmware.as_str().to_owned(),
            lost: counts.lost,
            missing: counts.missing,
            not_sent: counts.not_sent,
            out_of_order: counts.out_of_order,
            pacing: theirs.pacing.name().to_owned(),
            port: self.uri.to_string(),
            received: counts.received,
            reconnected: effort.reconnected,
            repeated: effort.repeated,
            restarted: counts.restarted,
            sent: counts.sent,
            unreadable: counts.unreadable,
            wall_s,
        };
        let mut events = vec![event::Event::Link(Box::new(link))];
        if let Some(power) = &mut self.power {
            // Before its power goes, the device hears that the run is over.
            self.harness.bye(Reason::DONE, "the run is over");
            self.power_error = power.end().err();
            events.push(event::Event::Power(Box::new(power.record())));
        }
        Conclusion { events, ..Conclusion::default() }
    }

    fn close(&mut self) -> Result<(), EndpointError> {
        self.power_error.take().map_or(Ok(()), |error| Err(error.into()))
    }
}

impl Drop for LiveEndpoint {
    fn drop(&mut self) {
        self.harness.bye(Reason::DONE, "the run is over");
    }
}

/// Computes the hash that both ends compare in their hello, over the whole configuration of the
/// core; zeros if it can't be encoded.
#[must_use]
pub fn configuration(config: &CoreConfig) -> [u8; 32] {
    // The configuration consists of numbers and names, which are encoded bit by bit.
    postcard::to_stdvec(config).map_or([0; 32], |bytes| blake3::hash(&bytes).into())
}
