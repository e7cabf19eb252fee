//! The channels of a core, bound to the variables of an FMU.

use octant_fmu_bind::bind::{BindError, Binder, Bound, Cells, ChannelCell, Handle};
use octant_fmu_bind::find::ValueWay;
use octant_fmu_host::description::Description;
use octant_sample::Mode;
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_scenario::channel::{answer, sample};
use octant_scenario::{Code, Fmu};

/// Cells of the sensors of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) enum Triad {
    /// Rate or specific force.
    Rates(Cells<3>),
    /// Integral of rate or specific force over the sample's interval.
    Increments(Cells<3>),
}

/// Cells of the FMU's inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Takes {
    pub(super) gyro: Triad,
    pub(super) accelerometer: Triad,
    pub(super) gimbal: [Option<ChannelCell>; 2],
    pub(super) valid: Option<ChannelCell>,
    pub(super) status: Option<ChannelCell>,
    pub(super) sequence: Option<ChannelCell>,
    pub(super) device_time: Option<ChannelCell>,
    pub(super) reference: References,
}

/// Cells of the reference among the inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct References {
    pub(super) kind: Option<ChannelCell>,
    pub(super) valid: Option<ChannelCell>,
    pub(super) velocity: Option<Cells<3>>,
    pub(super) position: [Option<ChannelCell>; 3],
    pub(super) age_ns: Option<ChannelCell>,
}

/// Cells of the FMU's answer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answers {
    pub(super) command: [Option<ChannelCell>; 2],
    pub(super) mode: Option<ChannelCell>,
    pub(super) stop: Option<ChannelCell>,
    pub(super) moving: Option<ChannelCell>,
    /// Latitude, longitude, height.
    pub(super) position: [Option<ChannelCell>; 3],
    pub(super) velocity: Option<Cells<3>>,
    pub(super) attitude: Option<Cells<4>>,
    pub(super) nis: Option<ChannelCell>,
    pub(super) measured: Option<ChannelCell>,
    pub(super) health: Option<ChannelCell>,
    pub(super) sequence: Option<ChannelCell>,
    pub(super) device_time: Option<ChannelCell>,
    pub(super) revision: Option<ChannelCell>,
}

/// Cells of the estimates: parameters and σ; `None` where the FMU has none.
pub(super) struct Estimates {
    pub(super) parameters: [Option<ChannelCell>; PARAMETER_COUNT],
    pub(super) sigma: [Option<ChannelCell>; PARAMETER_COUNT],
}

/// All bound channels.
pub(super) struct Ports {
    pub(super) inputs: Bound,
    pub(super) takes: Takes,
    pub(super) outputs: Bound,
    pub(super) answers: Answers,
    /// Read apart from the other outputs, when the revision has changed.
    pub(super) estimated: Bound,
    pub(super) estimates: Estimates,
    pub(super) modes: Vec<(i64, Mode)>,
}

impl Ports {
    /// Binds an FMU through the mapping of a scenario.
    pub(super) fn bind(description: &Description, fmu: &Fmu) -> Result<Self, BindError> {
        let (inputs, takes) = takes(description, fmu)?;
        let (outputs, answers) = answers(description, fmu)?;
        let (estimated, estimates) = estimates(description, fmu)?;
        let modes = modes(description, fmu).map_err(|problem| BindError::Mapping(vec![problem]))?;
        Ok(Self { inputs, takes, outputs, answers, estimated, estimates, modes })
    }

    /// True if the FMU estimates parameters.
    pub(super) fn has_estimates(&self) -> bool {
        self.estimates.parameters.iter().any(Option::is_some)
    }
}

fn takes(description: &Description, fmu: &Fmu) -> Result<(Bound, Takes), BindError> {
    let mut b = Binder::new(description, fmu, ValueWay::In);
    let gyro = b.one_of(&sample::DELTA_THETA, &sample::RATE);
    let accelerometer = b.one_of(&sample::DELTA_VELOCITY, &sample::SPECIFIC_FORCE);
    let gimbal = [b.channel(&sample::AZIMUTH), b.channel(&sample::ROLL)];
    let valid = b.channel(&sample::VALID);
    let status = b.channel(&sample::STATUS);
    let sequence = b.channel(&sample::SEQUENCE);
    let device_time = b.channel(&sample::DEVICE_TIME);
    let kind = b.channel(&sample::REFERENCE_KIND);
    let reference_valid = b.channel(&sample::REFERENCE_VALID);
    let velocity = b.channel(&sample::REFERENCE_VELOCITY);
    let position = [
        b.channel(&sample::REFERENCE_LATITUDE),
        b.channel(&sample::REFERENCE_LONGITUDE),
        b.channel(&sample::REFERENCE_HEIGHT),
    ];
    let age = b.channel(&sample::REFERENCE_AGE);
    let bound = b.finish()?;
    let cells = |(increments, handle): (bool, Handle)| {
        let cells = bound.cells::<3>(Some(handle))?;
        Some(if increments { Triad::Increments(cells) } else { Triad::Rates(cells) })
    };
    let (Some(gyro), Some(accelerometer)) = (gyro.and_then(cells), accelerometer.and_then(cells))
    else {
        // Missing channels were already reported as problems.
        return Err(BindError::Mapping(Vec::new()));
    };
    let takes = Takes {
        gyro,
        accelerometer,
        gimbal: gimbal.map(|handle| bound.cell(handle)),
        valid: bound.cell(valid),
        status: bound.cell(status),
        sequence: bound.cell(sequence),
        device_time: bound.cell(device_time),
        reference: References {
            kind: bound.cell(kind),
            valid: bound.cell(reference_valid),
            velocity: bound.cells(velocity),
            position: position.map(|handle| bound.cell(handle)),
            age_ns: bound.cell(age),
        },
    };
    Ok((bound, takes))
}

fn answers(description: &Description, fmu: &Fmu) -> Result<(Bound, Answers), BindError> {
    let mut b = Binder::new(description, fmu, ValueWay::Out);
    let command = [b.channel(&sample::COMMAND_AZIMUTH), b.channel(&sample::COMMAND_ROLL)];
    let mode = b.channel(&answer::MODE);
    let stop = b.channel(&answer::STOP);
    let moving = b.channel(&answer::MOVING);
    let position =
        [b.channel(&answer::LATITUDE), b.channel(&answer::LONGITUDE), b.channel(&answer::HEIGHT)];
    let velocity = b.channel(&answer::VELOCITY);
    let attitude = b.channel(&answer::ATTITUDE);
    let nis = b.channel(&answer::NIS);
    let measured = b.channel(&answer::MEASURED);
    let health = b.channel(&answer::HEALTH);
    let sequence = b.channel(&answer::SEQUENCE);
    let device_time = b.channel(&answer::DEVICE_TIME);
    let revision = b.channel(&answer::REVISION);
    let estimates = answer::PARAMETERS.iter().any(|channel| fmu.mapped(channel).is_some());
    if !estimates && command.iter().chain(&position).all(Option::is_none) {
        b.problem(
            "found neither gimbal_command, navigation nor parameters in the FMU's answer: expected \
             one of them in endpoint.fmu.map",
        );
    }
    let bound = b.finish()?;
    let answers = Answers {
        command: command.map(|handle| bound.cell(handle)),
        mode: bound.cell(mode),
        stop: bound.cell(stop),
        moving: bound.cell(moving),
        position: position.map(|handle| bound.cell(handle)),
        velocity: bound.cells(velocity),
        attitude: bound.cells(attitude),
        nis: bound.cell(nis),
        measured: bound.cell(measured),
        health: bound.cell(health),
        sequence: bound.cell(sequence),
        device_time: bound.cell(device_time),
        revision: bound.cell(revision),
    };
    Ok((bound, answers))
}

fn estimates(description: &Description, fmu: &Fmu) -> Result<(Bound, Estimates), BindError> {
    let mut b = Binder::new(description, fmu, ValueWay::Out);
    let handles = ParameterGroup::ALL.map(|group| {
        let (estimate, sigma) = answer::group(group);
        (group, b.channel(estimate), b.channel(sigma))
    });
    let bound = b.finish()?;
    let mut estimates =
        Estimates { parameters: [None; PARAMETER_COUNT], sigma: [None; PARAMETER_COUNT] };
    for (group, estimate, sigma) in handles {
        for (all, handle) in [(&mut estimates.parameters, estimate), (&mut estimates.sigma, sigma)]
        {
            for (place, cell) in all[group.range()].iter_mut().zip(bound.channel(handle)) {
                *place = Some(*cell);
            }
        }
    }
    Ok((bound, estimates))
}

/// Returns the values of the mode variable with the modes that they represent.
fn modes(
    description: &Description,
    fmu: &Fmu,
) -> Result<Vec<(i64, Mode)>, octant_scenario::Problem> {
    if fmu.modes.is_empty() {
        return Ok(Mode::ALL.map(|mode| (mode as i64, mode)).into());
    }
    let Some(mapped) = fmu.mapped(&answer::MODE) else {
        return Err(fmu.at.problem(
            "found modes without map.mode, expected map.mode with the variable whose values they are",
        ));
    };
    let name = match &mapped.ports[0].what {
        octant_scenario::Made::Variable { name, .. } => name.as_str(),
        octant_scenario::Made::Constant(_) => "",
    };
    let items = description
        .variable(name)
        .and_then(|variable| variable.enumeration.as_ref())
        .and_then(|of| description.enumeration(of))
        .unwrap_or_default();
    let mut all: Vec<(i64, Mode)> = Vec::new();
    for (mode, codes) in &fmu.modes {
        for code in codes {
            let value = match code {
                Code::Number(value) => *value,
                Code::Name(wanted) => match items.iter().find(|(_, item)| item == wanted) {
                    Some((value, _)) => *value,
                    None => {
                        let known: Vec<&str> =
                            items.iter().map(|(_, item)| item.as_str()).collect();
                        return Err(mapped.at.problem(format!(
                            "modes.{}: found {wanted:?}, expected a value of {name}: {}",
                            mode.name(),
                            if known.is_empty() {
                                "numbers and no names".to_owned()
                            } else {
                                known.join(", ")
                            }
                        )));
                    }
                },
            };
            if let Some((_, other)) = all.iter().find(|(known, _)| *known == value) {
                return Err(mapped.at.problem(format!(
                    "the value {value} means both {} and {}",
                    other.name(),
                    mode.name()
                )));
            }
            all.push((value, *mode));
        }
    }
    Ok(all)
}
