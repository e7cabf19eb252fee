//! An endpoint whose kind is known only from the scenario.

use super::{
    Conclusion, Endpoint, EndpointError, FmuEndpoint, InProcess, LiveEndpoint, RemoteClock, Sent,
    SolutionEndpoint, Tells,
};
use octant_faults::wire::Wired;
use octant_realtime::clock::MonotonicTime;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, Innovation, NavigationCovariance, Output, Parameters};
use std::time::Duration;

/// An endpoint of any kind.
pub struct AnyEndpoint(Kind);

enum Kind {
    InProcess(Box<InProcess>),
    Fmu(Box<FmuEndpoint>),
    Live(Box<LiveEndpoint>),
    Solution(Box<SolutionEndpoint>),
    Foreign(Box<dyn Endpoint + Send>),
}

macro_rules! of {
    ($($from:ty => $kind:ident),*) => {
        $(impl From<$from> for AnyEndpoint {
            fn from(endpoint: $from) -> Self {
                Self(Kind::$kind(Box::new(endpoint)))
            }
        })*
    };
}

of!(InProcess => InProcess, FmuEndpoint => Fmu, LiveEndpoint => Live,
    SolutionEndpoint => Solution);

macro_rules! each {
    ($any:expr, $endpoint:ident => $call:expr) => {
        match $any {
            Kind::InProcess($endpoint) => $call,
            Kind::Fmu($endpoint) => $call,
            Kind::Live($endpoint) => $call,
            Kind::Solution($endpoint) => $call,
            Kind::Foreign($endpoint) => $call,
        }
    };
}

/// A unit that a host program made.
impl From<Box<dyn Endpoint + Send>> for AnyEndpoint {
    fn from(endpoint: Box<dyn Endpoint + Send>) -> Self {
        Self(Kind::Foreign(endpoint))
    }
}

impl Endpoint for AnyEndpoint {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        each!(&mut self.0, endpoint => endpoint.step(epoch, output))
    }

    fn feels(&self) -> bool {
        each!(&self.0, endpoint => endpoint.feels())
    }

    fn feel(&mut self, temperature_c: f64) {
        each!(&mut self.0, endpoint => endpoint.feel(temperature_c))
    }

    fn tells(&self) -> Tells {
        each!(&self.0, endpoint => endpoint.tells())
    }

    fn uri(&self) -> String {
        each!(&self.0, endpoint => endpoint.uri())
    }

    fn send(&mut self, epoch: &Epoch, output: &mut Output) -> Result<Sent, EndpointError> {
        each!(&mut self.0, endpoint => endpoint.send(epoch, output))
    }

    fn answer(
        &mut self,
        until: MonotonicTime,
        output: &mut Output,
    ) -> Result<Option<usize>, EndpointError> {
        each!(&mut self.0, endpoint => endpoint.answer(until, output))
    }

    fn idle(&mut self) -> Result<(), EndpointError> {
        each!(&mut self.0, endpoint => endpoint.idle())
    }

    fn remote_clock(&self) -> Option<RemoteClock> {
        each!(&self.0, endpoint => endpoint.remote_clock())
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        each!(&mut self.0, endpoint => endpoint.restart(offset))
    }

    fn power_off(&mut self, sample: u64) -> Result<(), EndpointError> {
        each!(&mut self.0, endpoint => endpoint.power_off(sample))
    }

    fn power_on(&mut self, sample: u64) -> Result<(), EndpointError> {
        each!(&mut self.0, endpoint => endpoint.power_on(sample))
    }

    fn voltage_dip(
        &mut self,
        voltage_v: f64,
        length: Duration,
        sample: u64,
    ) -> Result<bool, EndpointError> {
        each!(&mut self.0, endpoint => endpoint.voltage_dip(voltage_v, length, sample))
    }

    fn parameters(&self) -> ParameterEstimate {
        each!(&self.0, endpoint => endpoint.parameters())
    }

    fn innovation(&self) -> Option<Innovation> {
        each!(&self.0, endpoint => endpoint.innovation())
    }

    fn navigation_covariance(&self) -> Option<NavigationCovariance> {
        each!(&self.0, endpoint => endpoint.navigation_covariance())
    }

    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        each!(&mut self.0, endpoint => endpoint.end_of_stream())
    }

    fn conclusion(&mut self) -> Conclusion {
        each!(&mut self.0, endpoint => endpoint.conclusion())
    }

    fn close(&mut self) -> Result<(), EndpointError> {
        each!(&mut self.0, endpoint => endpoint.close())
    }

    fn wired(&mut self) -> Option<&mut dyn Wired> {
        each!(&mut self.0, endpoint => endpoint.wired())
    }
}
