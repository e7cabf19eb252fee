//! Definition of variables. A model's table makes its descriptions, value references and
//! documentation.
//!
//! Every variable has as many consecutive *slots* as it has elements; slot 0 is time. In FMI 2.0
//! every element is a scalar variable `name[1]`, `name[2]`, …, whose value reference is its slot;
//! in FMI 3.0 the variable is an array whose value reference is its first slot.

/// Type of a variable's elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementType {
    /// Float64; Real in FMI 2.0.
    Real,
    /// Int32; Integer in FMI 2.0.
    Integer,
    /// UInt64; in FMI 2.0 a Real that holds a whole number, exact up to 2⁵³.
    Count,
    /// Boolean.
    Boolean,
    /// One of some named values: Enumeration in both.
    Enumeration(&'static DeclaredEnumeration),
    /// Bytes that belong to a clock; FMI 3.0 only.
    Binary(&'static ClockedBinary),
    /// A clock; FMI 3.0 only.
    Clock(Ticks),
}

/// Bytes that belong to a clock.
#[derive(Debug, PartialEq)]
pub struct ClockedBinary {
    /// MIME type of the bytes.
    pub mime_type: &'static str,
    /// Largest number of bytes at a tick.
    pub max_bytes: usize,
    /// Name of the clock.
    pub clock: &'static str,
}

/// Time of a clock's ticks. Clocks are inputs: the importer activates them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ticks {
    /// When data comes from outside.
    Triggered,
    /// Once after each interval that the model has requested.
    Countdown,
}

/// A type with named values.
#[derive(Debug, PartialEq)]
pub struct DeclaredEnumeration {
    /// Name of the type.
    pub name: &'static str,
    /// Description of the type.
    pub description: &'static str,
    /// Value, name and description of each item.
    pub items: &'static [(i32, &'static str, &'static str)],
}

/// Declares types with named values: the name and description of each, and its items with value, name
/// and description.
macro_rules! enumerations {
    ($(
        $(#[$doc:meta])*
        $vis:vis $type:ident $name:literal $description:literal {
            $($value:literal $item:ident $says:literal;)*
        }
    )*) => {$(
        $(#[$doc])*
        $vis static $type: $crate::table::DeclaredEnumeration = $crate::table::DeclaredEnumeration {
            name: $name,
            description: $description,
            items: &[$(($value, stringify!($item), $says)),*],
        };
    )*};
}
pub(crate) use enumerations;

/// Role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclaredCausality {
    /// Set before the start.
    Parameter,
    /// Computed from parameters.
    CalculatedParameter,
    /// Provided from outside.
    Input,
    /// Provided to the outside.
    Output,
    /// For information.
    Local,
}

/// Times at which a variable changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclaredVariability {
    /// Never after initialization.
    Fixed,
    /// Between steps, by the importer.
    Tunable,
    /// At samples only: it is not interpolated.
    Discrete,
}

/// A unit with its factors: value in SI base units = factor · value.
#[derive(Debug, PartialEq)]
pub struct DeclaredUnit {
    /// Name, as written in descriptions: `rad/s`.
    pub name: &'static str,
    /// Exponents of kg, m, s, A, K, mol, cd, rad; `None` if they aren't whole numbers, as for a
    /// random walk.
    pub exponents: Option<[i8; 8]>,
    /// SI value of one unit.
    pub factor: f64,
    /// Units for display: name, and the number of them in one of this unit.
    pub display: &'static [(&'static str, f64)],
}

/// A quantity: a unit, and the display unit among those of the unit.
#[derive(Debug, PartialEq)]
pub struct DeclaredQuantity {
    /// Name of the type in descriptions: `AngularRate`.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static DeclaredUnit,
    /// Display unit, if it isn't the unit itself.
    pub display: Option<&'static str>,
}

/// One variable of a model.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredVariable {
    /// Structured name: `gyro.delta_theta`.
    pub name: &'static str,
    /// Description, with frame, sign and order of elements.
    pub description: &'static str,
    /// Type of its elements.
    pub kind: ElementType,
    /// Number of elements; 0: a scalar.
    pub elements: usize,
    /// Role.
    pub causality: DeclaredCausality,
    /// Times of change.
    pub variability: DeclaredVariability,
    /// Unit; `None`: a number.
    pub quantity: Option<&'static DeclaredQuantity>,
    /// Smallest legal value of an element.
    pub min: Option<f64>,
    /// Largest legal value of an element.
    pub max: Option<f64>,
    /// Usual size.
    pub nominal: Option<f64>,
    /// Start value of each element (one value: of all elements), if the variable has one; numbers,
    /// and 0 or 1 for Booleans.
    pub start: &'static [f64],
    /// True for an input whose values needn't be finite: the model handles NaN and infinities
    /// itself.
    pub non_finite: bool,
    /// Names of the inputs on which an output depends directly (in FMI's sense: within one instant);
    /// outputs that change at the end of a step only have none.
    pub depends_on: &'static [&'static str],
}

impl DeclaredVariable {
    const fn new(name: &'static str, kind: ElementType, causality: DeclaredCausality) -> Self {
        Self {
            name,
            description: "",
            kind,
            elements: 0,
            causality,
            variability: match causality {
                DeclaredCausality::Parameter | DeclaredCausality::CalculatedParameter => {
                    DeclaredVariability::Fixed
                }
                DeclaredCausality::Input | DeclaredCausality::Output | DeclaredCausality::Local => {
                    DeclaredVariability::Discrete
                }
            },
            quantity: None,
            min: None,
            max: None,
            nominal: None,
            start: match causality {
                // Inputs and parameters need a start value.
                DeclaredCausality::Parameter | DeclaredCausality::Input => &[0.0],
                _ => &[],
            },
            non_finite: false,
            depends_on: &[],
        }
    }

    /// Makes a discrete scalar input that starts at zero.
    #[must_use]
    pub const fn input(name: &'static str, kind: ElementType) -> Self {
        Self::new(name, kind, DeclaredCausality::Input)
    }

    /// Makes a discrete scalar output.
    #[must_use]
    pub const fn output(name: &'static str, kind: ElementType) -> Self {
        Self::new(name, kind, DeclaredCausality::Output)
    }

    /// Makes a fixed scalar parameter that starts at zero.
    #[must_use]
    pub const fn parameter(name: &'static str, kind: ElementType) -> Self {
        Self::new(name, kind, DeclaredCausality::Parameter)
    }

    /// Makes a scalar parameter that starts at zero, and that the importer may change between steps.
    #[must_use]
    pub const fn tunable_parameter(name: &'static str, kind: ElementType) -> Self {
        let mut parameter = Self::parameter(name, kind);
        parameter.variability = DeclaredVariability::Tunable;
        parameter
    }

    /// Sets the description.
    #[must_use]
    pub const fn described(mut self, description: &'static str) -> Self {
        self.description = description;
        self
    }

    /// Makes the variable an array with a number of elements.
    #[must_use]
    pub const fn elements(mut self, elements: usize) -> Self {
        self.elements = elements;
        self
    }

    /// Sets the quantity.
    #[must_use]
    pub const fn of(mut self, quantity: &'static DeclaredQuantity) -> Self {
        self.quantity = Some(quantity);
        self
    }

    /// Limits the values to `min` and above.
    #[must_use]
    pub const fn min(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    /// Limits the values to the range from `min` to `max`.
    #[must_use]
    pub const fn within(mut self, min: f64, max: f64) -> Self {
        self.min = Some(min);
        self.max = Some(max);
        self
    }

    /// Sets the usual size.
    #[must_use]
    pub const fn nominal(mut self, nominal: f64) -> Self {
        self.nominal = Some(nominal);
        self
    }

    /// Sets the start values: one for each element, or one for all of them.
    #[must_use]
    pub const fn start(mut self, start: &'static [f64]) -> Self {
        self.start = start;
        self
    }

    /// Passes NaN and infinities to the model.
    #[must_use]
    pub const fn non_finite(mut self) -> Self {
        self.non_finite = true;
        self
    }

    /// Returns whether the variable has a value only at the ticks of a clock, or is a clock.
    #[must_use]
    pub const fn is_clocked(&self) -> bool {
        matches!(self.kind, ElementType::Binary(_) | ElementType::Clock(_))
    }

    /// Number of its slots.
    #[must_use]
    pub const fn slots(&self) -> usize {
        if self.elements == 0 { 1 } else { self.elements }
    }

    /// Start value of an element, if the variable has one.
    #[must_use]
    pub fn start_of(&self, element: usize) -> Option<f64> {
        self.start.get(element).or(self.start.first()).copied()
    }
}

/// Makes an array of variables. Each row has the constructor of [`DeclaredVariable`], its other properties,
/// and the description: `input("gyro.delta_theta", Real) elements(3): "Increments.";`.
macro_rules! variables {
    ($($role:ident($name:expr, $kind:expr) $($property:ident($($value:expr),*))*: $text:expr;)*) => {
        [$($crate::table::DeclaredVariable::$role($name, $kind)
            $(.$property($($value),*))*
            .described($text)),*]
    };
}
pub(crate) use variables;

/// A model: its name, and its variables.
#[derive(Debug)]
pub struct Model {
    /// Name: `Calibrator`.
    pub name: &'static str,
    /// Stem of the model identifier: `calibrator` gives `calibrator_fmi2` and `calibrator_fmi3`.
    pub stem: &'static str,
    /// Description.
    pub description: &'static str,
    /// Variables, in the order of their slots, from slot 1 on.
    pub variables: &'static [DeclaredVariable],
    /// Smallest and largest number of sample periods in a communication step; or
    /// [`Model::ANY_STEP`].
    pub periods_per_step: (u64, u64),
    /// True if the outputs of a communication step of several periods are sums over all of them, so that
    /// the step doesn't end early at an event within.
    pub sums_periods: bool,
}

impl Model {
    /// Steps of any length, for models that act only at events. An empty range marks it.
    pub const ANY_STEP: (u64, u64) = (1, 0);

    /// Returns whether the model acts only at events.
    #[must_use]
    pub const fn is_event_driven(&self) -> bool {
        self.periods_per_step.0 > self.periods_per_step.1
    }

    /// Returns whether the model needs clocks, which FMI 2.0 doesn't have.
    #[must_use]
    pub fn needs_clocks(&self) -> bool {
        self.variables.iter().any(DeclaredVariable::is_clocked)
    }

    /// Number of slots, time included.
    #[must_use]
    pub const fn slots(&self) -> usize {
        let (mut slots, mut i) = (1, 0);
        while i < self.variables.len() {
            slots += self.variables[i].slots();
            i += 1;
        }
        slots
    }

    /// First slot of a variable. For constants: a missing name doesn't compile.
    ///
    /// # Panics
    /// If there is no variable of this name.
    #[must_use]
    pub const fn slot(&self, name: &str) -> usize {
        let (mut slot, mut i) = (1, 0);
        while i < self.variables.len() {
            if same(self.variables[i].name, name) {
                return slot;
            }
            slot += self.variables[i].slots();
            i += 1;
        }
        panic!("no variable of this name")
    }

    /// Iterates over the variables with their first slots.
    pub fn with_slots(&self) -> impl Iterator<Item = (usize, &'static DeclaredVariable)> + use<> {
        self.variables.iter().scan(1, |next, variable| {
            let slot = *next;
            *next += variable.slots();
            Some((slot, variable))
        })
    }

    /// Name of the variable to which a slot belongs, for messages.
    #[must_use]
    pub fn label(&self, slot: usize) -> &'static str {
        self.with_slots()
            .take_while(|(first, _)| *first <= slot)
            .last()
            .map_or("time", |(_, variable)| variable.name)
    }

    /// Finds a variable and its first slot by name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<(usize, &'static DeclaredVariable)> {
        self.with_slots().find(|(_, variable)| variable.name == name)
    }
}

/// Concatenates parts of a table.
///
/// # Panics
/// If `N` isn't their number of variables.
#[must_use]
pub const fn concatenated<const N: usize>(parts: &[&[DeclaredVariable]]) -> [DeclaredVariable; N] {
    let mut all = [DeclaredVariable::parameter("", ElementType::Real); N];
    let (mut n, mut part) = (0, 0);
    while part < parts.len() {
        let mut i = 0;
        while i < parts[part].len() {
            all[n] = parts[part][i];
            n += 1;
            i += 1;
        }
        part += 1;
    }
    assert!(n == N, "N is the number of variables");
    all
}

/// Number of variables of parts of a table.
pub(crate) const fn count(parts: &[&[DeclaredVariable]]) -> usize {
    let (mut count, mut part) = (0, 0);
    while part < parts.len() {
        count += parts[part].len();
        part += 1;
    }
    count
}

/// Compares names at compile time.
pub(crate) const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut same = a.len() == b.len();
    let mut i = 0;
    while same && i < a.len() {
        same = a[i] == b[i];
        i += 1;
    }
    same
}
