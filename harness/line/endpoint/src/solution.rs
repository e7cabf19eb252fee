//! A unit under test that has answered already: its solution comes from a file.

use super::{Endpoint, EndpointError, Tells};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate};
use octant_sample::{Epoch, Health, Mode, Output, Parameters};
use octant_scenario::Scenario;
use octant_scenario::trajectory::SolutionSpec;
use octant_trajectory::point::{GeodeticPosition, PointAttitude};
use octant_trajectory::track::q_nc;
use octant_trajectory::{PairsError, SolutionPair, SolutionPairs};

/// The solution of a file, point by point as the source gives their times.
pub struct SolutionEndpoint {
    pairs: SolutionPairs,
    file: String,
    last: Option<Output>,
    /// Where an instrument is whose position isn't compared.
    site: GeodeticPosition,
}

impl SolutionEndpoint {
    /// Opens the files of a scenario's solution.
    ///
    /// # Errors
    /// If they can't be read or compared.
    pub fn open(scenario: &Scenario, spec: &SolutionSpec) -> Result<Self, PairsError> {
        let duration_s = scenario.navigation.as_ref().and_then(|plan| plan.duration_s);
        let (folder, period_ns) = (&*scenario.folder, scenario.sample_period_ns);
        let site_rad = [scenario.site.latitude_rad, scenario.site.longitude_rad];
        let pairs = SolutionPairs::open(spec, (folder, site_rad), period_ns, duration_s)?;
        let site = GeodeticPosition {
            latitude_rad: scenario.site.latitude_rad,
            longitude_rad: scenario.site.longitude_rad,
            height_m: scenario.site.height_m,
        };
        Ok(Self { pairs, file: spec.solution.file.0.clone(), last: None, site })
    }

    fn gone(&self, reason: String) -> EndpointError {
        EndpointError::Gone { uri: self.uri(), reason }
    }
}

impl Endpoint for SolutionEndpoint {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        let next = self.pairs.next_pair().map_err(|error| self.gone(error.to_string()))?;
        let stamp = epoch.sample.device_time;
        // Source and endpoint read the same files: they differ if somebody writes to one of them.
        let Some(pair) = next.filter(|pair| pair.time_ns == stamp.ns) else {
            return Err(self.gone(format!("it has no point at {:.3} s any more", stamp.seconds())));
        };
        let SolutionPair { sequence, solution, .. } = pair;
        let mut answer = Output { mode: Mode::Navigating, ..Output::default() };
        (answer.sequence, answer.device_time) = (sequence, stamp);
        (answer.nis, answer.health) = (f64::NAN, Health::empty());
        let navigation = &mut answer.navigation;
        let [is_compared, _] = self.pairs.compares();
        let position = solution.position.filter(|_| is_compared).unwrap_or(self.site);
        navigation.latitude_rad = position.latitude_rad;
        navigation.longitude_rad = position.longitude_rad;
        navigation.height_m = position.height_m;
        let [north, east] = solution.velocity_mps.unwrap_or_default();
        navigation.velocity_mps = [north, east, 0.0];
        let attitude = solution.attitude.map(PointAttitude::or_level_rad);
        let q = attitude.map(q_nc).unwrap_or_default();
        navigation.q_nb = [q.w, q.i, q.j, q.k];
        *output = answer;
        self.last = Some(answer);
        Ok(())
    }

    fn tells(&self) -> Tells {
        let survey = self.pairs.survey();
        let [position, tilt] = self.pairs.compares();
        Tells {
            commands: false,
            position,
            velocity: survey.velocity,
            attitude: survey.attitude,
            tilt,
            follows: false,
        }
    }

    fn uri(&self) -> String {
        format!("solution:{}", self.file)
    }

    fn restart(&mut self, _offset: Option<&Parameters>) -> Result<(), EndpointError> {
        let reason = "a solution is made already, and can't be restarted".to_owned();
        Err(EndpointError::Restart { uri: self.uri(), reason })
    }

    fn parameters(&self) -> ParameterEstimate {
        ParameterEstimate {
            revision: 0,
            parameters: Parameters::default(),
            sigma: [f64::NAN; PARAMETER_COUNT],
        }
    }

    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        Ok(self.last.map(|last| Output { mode: Mode::Done, ..last }))
    }
}
