//! Times and truth of a solution that is scored: there are no samples.

use super::{Epoch, Source, SourceError};
use octant_account::Account;
use octant_plant::Truth;
use octant_sample::time::SimulatedTime;
use octant_sample::{DeviceTime, GimbalCommand, Sample, Status};
use octant_scenario::Scenario;
use octant_scenario::trajectory::SolutionSpec;
use octant_trajectory::point::GeodeticPosition;
use octant_trajectory::{Comparison, PairsError, SolutionPair, SolutionPairs};

/// The reference at the times of a solution.
pub struct SolutionSource {
    pairs: SolutionPairs,
    last: Option<SolutionPair>,
}

impl SolutionSource {
    /// Opens the files of a scenario's solution.
    ///
    /// # Errors
    /// If they can't be read or compared.
    pub fn open(scenario: &Scenario, spec: &SolutionSpec) -> Result<Self, SourceError> {
        let duration_s = scenario.navigation.as_ref().and_then(|plan| plan.duration_s);
        let (folder, period_ns) = (&*scenario.folder, scenario.sample_period_ns);
        let site_rad = [scenario.site.latitude_rad, scenario.site.longitude_rad];
        let pairs =
            SolutionPairs::open(spec, (folder, site_rad), period_ns, duration_s).map_err(error)?;
        Ok(Self { pairs, last: None })
    }
}

fn error(error: PairsError) -> SourceError {
    match error {
        PairsError::Name(error) => SourceError::FileName(error),
        error => SourceError::Solution(Box::new(error)),
    }
}

impl Source for SolutionSource {
    fn next(&mut self, _command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        let Some(pair) = self.pairs.next_pair().map_err(error)? else { return Ok(false) };
        self.last = Some(pair);
        let sample = Sample {
            sequence: pair.sequence,
            device_time: DeviceTime::from_ns(pair.time_ns),
            status: Status::INERTIAL_INVALID | Status::GIMBAL_INVALID,
            ..Sample::default()
        };
        *epoch = Epoch { sample, aiding: None };
        Ok(true)
    }

    fn truth(&self) -> Option<Truth> {
        let SolutionPair { time_ns, reference, .. } = self.last?;
        let [north, east] = reference.velocity_mps.unwrap_or([f64::NAN; 2]);
        let q_nb = reference.q_nc.map_or([f64::NAN; 4], |q| [q.w, q.i, q.j, q.k]);
        let unknown = GeodeticPosition {
            latitude_rad: f64::NAN,
            longitude_rad: f64::NAN,
            height_m: f64::NAN,
        };
        let [is_compared, _] = self.pairs.compares();
        let GeodeticPosition { latitude_rad, longitude_rad, height_m } =
            reference.position.filter(|_| is_compared).unwrap_or(unknown);
        Some(Truth {
            time: SimulatedTime::from_ns(time_ns),
            latitude_rad,
            longitude_rad,
            height_m,
            velocity_mps: [north, east, f64::NAN],
            q_nb,
            gimbal_rad: [0.0; 2],
        })
    }

    fn samples_total(&self) -> Option<u64> {
        None
    }

    fn samples_planned(&self) -> Option<u64> {
        Some(self.pairs.planned())
    }

    fn cut_short(&self) -> Option<String> {
        self.pairs.doubt()
    }

    fn accounts(&self) -> Vec<Account> {
        self.pairs.accounts()
    }

    fn compared(&self) -> Option<&Comparison> {
        Some(self.pairs.comparison())
    }
}
