//! Binds channels to the variables of one FMU: the place of each element among the numbers that are
//! set or read together, and its conversion.

use super::convert::{ChannelConversion, conversion, fits};
use super::find::{FoundElements, ValueWay, allowed, described, find, unknown};
use octant_fmu_host::description::{Description, Variable};
use octant_fmu_host::instance::{AccessPlan, InstanceError, whole};
use octant_scenario::channel::Channel;
use octant_scenario::{EntryPlace, Fmu, Made, Mapped, Problem};

/// One element of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelCell {
    /// Number of the FMU, by its place.
    At(usize, ChannelConversion),
    /// A constant, SI.
    Constant(f64),
}

impl ChannelCell {
    /// Value, SI.
    #[must_use]
    #[inline]
    pub fn read(&self, numbers: &[f64]) -> f64 {
        match *self {
            Self::At(index, conversion) => conversion.to_si(numbers[index]),
            Self::Constant(value) => value,
        }
    }

    /// Writes a value, SI, to its place; a constant is left alone.
    #[inline]
    pub fn write(&self, numbers: &mut [f64], value: f64) {
        if let Self::At(index, conversion) = *self {
            numbers[index] = conversion.from_si(value);
        }
    }
}

/// A channel of `N` elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells<const N: usize>([ChannelCell; N]);

impl<const N: usize> Cells<N> {
    /// Values, SI.
    #[must_use]
    #[inline]
    pub fn read(&self, numbers: &[f64]) -> [f64; N] {
        std::array::from_fn(|i| self.0[i].read(numbers))
    }

    /// Writes values, SI, to their places.
    #[inline]
    pub fn write(&self, numbers: &mut [f64], values: &[f64; N]) {
        for (cell, value) in self.0.iter().zip(values) {
            cell.write(numbers, *value);
        }
    }
}

/// Element located by its variable; the place follows when all variables are known.
#[derive(Clone, Copy, Debug)]
enum Loose {
    At { variable: usize, element: usize, conversion: ChannelConversion },
    Constant(f64),
}

/// Collects the channels of one FMU in one direction.
pub struct Binder<'a> {
    description: &'a Description,
    fmu: &'a Fmu,
    way: ValueWay,
    variables: Vec<&'a Variable>,
    /// Elements of variables that are set, with their channel: no two channels may set the same
    /// element.
    taken: Vec<(usize, usize, &'static str)>,
    loose: Vec<Vec<Loose>>,
    problems: Vec<Problem>,
}

/// Number of a channel that is being bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handle(usize);

impl<'a> Binder<'a> {
    /// Creates a binder for an FMU with the mapping of a scenario.
    #[must_use]
    pub fn new(description: &'a Description, fmu: &'a Fmu, way: ValueWay) -> Self {
        Self {
            description,
            fmu,
            way,
            variables: Vec::new(),
            taken: Vec::new(),
            loose: Vec::new(),
            problems: Vec::new(),
        }
    }

    /// Binds a channel: as the scenario maps it, or to the variable of its own name. `None`: there
    /// is neither, or there is a problem, which is kept.
    pub fn channel(&mut self, channel: &'static Channel) -> Option<Handle> {
        let fmu = self.fmu;
        let cells = match fmu.mapped(channel) {
            Some(mapped) => match self.mapped(mapped) {
                Ok(cells) => cells,
                Err(problem) => {
                    self.problems.push(problem);
                    return None;
                }
            },
            None => self.by_own_name(channel)?,
        };
        self.loose.push(cells);
        Some(Handle(self.loose.len() - 1))
    }

    /// Binds a required channel; else as [`Self::channel`].
    pub fn needed(&mut self, channel: &'static Channel) -> Option<Handle> {
        let problems = self.problems.len();
        let handle = self.channel(channel);
        if handle.is_none() && self.problems.len() == problems {
            let way = match self.way {
                ValueWay::Out => "an output",
                ValueWay::In => "an input",
            };
            self.problem(format!(
                "{} is mapped to nothing, and the FMU has no variable of that name: expected {way} \
                 in {}.map.{}",
                channel.name,
                self.table(),
                channel.name
            ));
        }
        handle
    }

    /// Binds one of two channels, true for the first: the one that the scenario maps, else the one
    /// whose name a variable has, the first before the second. One of them is required.
    pub fn one_of(
        &mut self,
        first: &'static Channel,
        second: &'static Channel,
    ) -> Option<(bool, Handle)> {
        let fmu = self.fmu;
        match (fmu.mapped(first), fmu.mapped(second)) {
            (Some(_), Some(other)) => {
                self.problem_at(
                    &other.at,
                    format!("found beside {}, expected one of them", first.name),
                );
                None
            }
            (Some(_), None) => self.channel(first).map(|handle| (true, handle)),
            (None, Some(_)) => self.channel(second).map(|handle| (false, handle)),
            (None, None) => {
                let found = self.channel(first).map(|handle| (true, handle));
                let found = found.or_else(|| self.channel(second).map(|handle| (false, handle)));
                if found.is_none() {
                    self.problem(format!(
                        "neither {} nor {} is mapped, and the FMU has no variable of that name: \
                         expected one of them in {}.map",
                        first.name,
                        second.name,
                        self.table()
                    ));
                }
                found
            }
        }
    }

    /// Notes a problem with a setting of the scenario.
    pub fn problem_at(&mut self, at: &EntryPlace, message: impl Into<String>) {
        self.problems.push(at.problem(message));
    }

    /// Notes a problem with the FMU as a whole.
    pub fn problem(&mut self, message: impl Into<String>) {
        self.problems.push(self.fmu.at.problem(message));
    }

    /// Name of the table: `source.fmu` or `endpoint.fmu`.
    fn table(&self) -> String {
        self.fmu.at.path.replace(".uri", ".fmu")
    }

    fn by_own_name(&mut self, channel: &'static Channel) -> Option<Vec<Loose>> {
        let found = find(self.description, channel.name, channel.elements)?;
        let fits = |(variable, _): &(&Variable, usize)| {
            allowed(variable, self.way).is_ok()
                && conversion(self.description, variable, channel, None, 1.0).is_ok()
        };
        if found.negated
            || found.elements.len() != channel.elements
            || !found.elements.iter().all(fits)
        {
            return None;
        }
        let mut cells = Vec::with_capacity(channel.elements);
        for (variable, element) in found.elements {
            let conversion = conversion(self.description, variable, channel, None, 1.0).ok()?;
            cells.push(self.place(channel, variable, element, conversion).ok()?);
        }
        Some(cells)
    }

    fn mapped(&mut self, mapped: &Mapped) -> Result<Vec<Loose>, Problem> {
        let channel = mapped.channel;
        let each = if mapped.ports.len() == 1 { channel.elements } else { 1 };
        let mut cells = Vec::with_capacity(channel.elements);
        for port in &mapped.ports {
            match &port.what {
                Made::Constant(_) if self.way == ValueWay::In => {
                    return Err(port.at.problem(format!(
                        "found a constant, and {} goes into the FMU: expected a variable; inputs \
                         that are held are set in {}.parameters",
                        channel.name,
                        self.table()
                    )));
                }
                Made::Constant(value) => {
                    cells.extend(std::iter::repeat_n(Loose::Constant(*value), each));
                }
                Made::Variable { name, unit, scale } => {
                    let unit = unit.as_deref();
                    self.variable(channel, name, each, unit, *scale, &port.at, &mut cells)?;
                }
            }
        }
        Ok(cells)
    }

    #[allow(clippy::too_many_arguments, reason = "what a port says, and where")]
    fn variable(
        &mut self,
        channel: &'static Channel,
        name: &str,
        elements: usize,
        unit: Option<&str>,
        scale: f64,
        at: &EntryPlace,
        cells: &mut Vec<Loose>,
    ) -> Result<(), Problem> {
        let Some(found) = find(self.description, name, elements) else {
            let could = |variable: &Variable| {
                allowed(variable, self.way).is_ok() && fits(variable, channel).is_ok()
            };
            let could_at_all = |variable: &Variable| allowed(variable, self.way).is_ok();
            let any = self.description.variables.iter().any(could);
            let message = if any {
                unknown(self.description, name, could)
            } else {
                unknown(self.description, name, could_at_all)
            };
            return Err(at.problem(message.to_string()));
        };
        let FoundElements { elements: all, negated } = found;
        if all.len() != elements {
            let (variable, _) = all[0];
            return Err(at.problem(format!(
                "{} has {} elements, expected {elements}",
                described(variable),
                all.len()
            )));
        }
        let scale = if negated { -scale } else { scale };
        for (variable, element) in all {
            let fits = || {
                allowed(variable, self.way).map_err(|error| error.to_string())?;
                conversion(self.description, variable, channel, unit, scale)
                    .map_err(|error| error.to_string())
            };
            let conversion = fits().map_err(|message| at.problem(message))?;
            let cell = self
                .place(channel, variable, element, conversion)
                .map_err(|message| at.problem(message))?;
            cells.push(cell);
        }
        Ok(())
    }

    fn place(
        &mut self,
        channel: &'static Channel,
        variable: &'a Variable,
        element: usize,
        conversion: ChannelConversion,
    ) -> Result<Loose, String> {
        let known = self.variables.iter().position(|other| std::ptr::eq(*other, variable));
        let variable_number = known.unwrap_or_else(|| {
            self.variables.push(variable);
            self.variables.len() - 1
        });
        if self.way == ValueWay::In {
            let taken = self.taken.iter().find(|(v, e, _)| (*v, *e) == (variable_number, element));
            if let Some((.., other)) = taken {
                return Err(format!("{} is set by {other} already", variable.name));
            }
            self.taken.push((variable_number, element, channel.name));
        }
        Ok(Loose::At { variable: variable_number, element, conversion })
    }

    /// Returns the numbers of all bound channels, with the table that converts their handles into
    /// cells.
    ///
    /// # Errors
    /// If there were problems, all of them; or if the variables can't be read or set together.
    pub fn finish(self) -> Result<Bound, BindError> {
        if !self.problems.is_empty() {
            return Err(BindError::Mapping(self.problems));
        }
        let plan =
            AccessPlan::new(self.description, &self.variables).map_err(BindError::Instance)?;
        let mut numbers = vec![0.0; plan.elements];
        for (variable, place) in self.variables.iter().zip(&plan.places) {
            start(variable, &mut numbers[place.clone()]);
        }
        let cell = |loose: &Loose| match *loose {
            Loose::Constant(value) => ChannelCell::Constant(value),
            Loose::At { variable, element, conversion } => {
                ChannelCell::At(plan.places[variable].start + element, conversion)
            }
        };
        let channels = self.loose.iter().map(|cells| cells.iter().map(cell).collect()).collect();
        Ok(Bound { plan, numbers, channels })
    }
}

/// Reasons why channels can't be bound.
#[derive(Debug)]
pub enum BindError {
    /// The mapping of the scenario doesn't fit the FMU.
    Mapping(Vec<Problem>),
    /// The FMU can't be used with these variables.
    Instance(InstanceError),
}

/// Bound channels of one direction.
#[derive(Clone, Debug)]
pub struct Bound {
    /// Groups, with the count of their numbers.
    pub plan: AccessPlan,
    /// Start values of the numbers.
    pub numbers: Vec<f64>,
    channels: Vec<Vec<ChannelCell>>,
}

impl Bound {
    /// Returns the cells of a channel; empty if there is no channel.
    #[must_use]
    pub fn channel(&self, handle: Option<Handle>) -> &[ChannelCell] {
        handle.and_then(|handle| self.channels.get(handle.0)).map_or(&[], Vec::as_slice)
    }

    /// Returns the cells of a channel of `N` elements.
    #[must_use]
    pub fn cells<const N: usize>(&self, handle: Option<Handle>) -> Option<Cells<N>> {
        let cells = self.channels.get(handle?.0)?;
        Some(Cells(cells.as_slice().try_into().ok()?))
    }

    /// Returns the cell of a channel of one element.
    #[must_use]
    pub fn cell(&self, handle: Option<Handle>) -> Option<ChannelCell> {
        self.cells::<1>(handle).map(|cells| cells.0[0])
    }
}

/// Fills in the start values of a variable: an element of an array that no channel sets keeps its
/// own.
pub fn start(variable: &Variable, numbers: &mut [f64]) {
    for (index, number) in numbers.iter_mut().enumerate() {
        let text = variable.start.get(index).or(variable.start.first());
        *number = text.map_or(0.0, |text| match text.trim() {
            "true" => 1.0,
            "false" => 0.0,
            text => text.parse().unwrap_or(0.0),
        });
    }
}

/// Fills in the start values as [`start`] does, whole numbers of 64 bits as their bits.
pub fn start_exactly(variable: &Variable, numbers: &mut [f64]) {
    start(variable, numbers);
    if !whole::is_wide(variable.kind) {
        return;
    }
    for (index, number) in numbers.iter_mut().enumerate() {
        let text = variable.start.get(index).or(variable.start.first());
        let found = text.and_then(|text| whole::parse(text)).unwrap_or(0);
        *number = whole::to_bits(variable.kind, found).unwrap_or(0.0);
    }
}
