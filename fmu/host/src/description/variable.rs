//! Variables of a description.

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[allow(missing_docs, reason = "named as in FMI 3.0")]
pub enum VariableType {
    Float64,
    Float32,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Boolean,
    String,
    Binary,
    Enumeration,
    Clock,
}

impl VariableType {
    /// Name in FMI 3.0.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Float64 => "Float64",
            Self::Float32 => "Float32",
            Self::Int8 => "Int8",
            Self::UInt8 => "UInt8",
            Self::Int16 => "Int16",
            Self::UInt16 => "UInt16",
            Self::Int32 => "Int32",
            Self::UInt32 => "UInt32",
            Self::Int64 => "Int64",
            Self::UInt64 => "UInt64",
            Self::Boolean => "Boolean",
            Self::String => "String",
            Self::Binary => "Binary",
            Self::Enumeration => "Enumeration",
            Self::Clock => "Clock",
        }
    }

    /// All types.
    pub const ALL: [Self; 15] = [
        Self::Float64,
        Self::Float32,
        Self::Int8,
        Self::UInt8,
        Self::Int16,
        Self::UInt16,
        Self::Int32,
        Self::UInt32,
        Self::Int64,
        Self::UInt64,
        Self::Boolean,
        Self::String,
        Self::Binary,
        Self::Enumeration,
        Self::Clock,
    ];

    /// Returns whether the type is a floating-point number.
    #[must_use]
    pub const fn is_float(self) -> bool {
        matches!(self, Self::Float64 | Self::Float32)
    }
}

/// Role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Causality {
    StructuralParameter,
    Parameter,
    CalculatedParameter,
    Input,
    Output,
    Local,
    Independent,
}

/// Times at which a variable changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Variability {
    Constant,
    Fixed,
    Tunable,
    Discrete,
    Continuous,
}

/// Origin of a variable's first value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Initial {
    Exact,
    Approx,
    Calculated,
}

/// One dimension of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayDimension {
    /// A fixed size.
    Fixed(u64),
    /// The value of the structural parameter with this value reference.
    Of(u32),
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name of the variable.
    pub name: String,
    /// `valueReference`.
    pub reference: u32,
    /// `description`, empty if missing.
    pub description: String,
    /// Type.
    pub kind: VariableType,
    /// Name of the enumeration type, if it has one.
    pub enumeration: Option<String>,
    /// Causality; the default of the standard if missing in the file.
    pub causality: Causality,
    /// Variability; the default of the standard if missing in the file.
    pub variability: Variability,
    /// `initial` as written, or by the standard's table.
    pub initial: Option<Initial>,
    /// Dimensions; none: a scalar.
    pub dimensions: Vec<ArrayDimension>,
    /// Start values as written, one for each element (only one: the same for all).
    pub start: Vec<String>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Usual size.
    pub nominal: Option<f64>,
    /// Name of the unit, the variable's own or its type's.
    pub unit: Option<String>,
    /// Name of the display unit.
    pub display_unit: Option<String>,
    /// `relativeQuantity`: a difference, for which offsets of units don't count.
    pub relative_quantity: bool,
    /// `declaredType`.
    pub declared_type: Option<String>,
    /// Other names (FMI 3.0).
    pub aliases: Vec<Alias>,
    /// Value reference of the variable whose derivative this is (an index in the file of FMI 2.0).
    pub derivative_of: Option<u32>,
    /// Value references of the clocks (FMI 3.0).
    pub clocks: Vec<u32>,
    /// Value reference of the variable that holds this variable's value of the last event (FMI
    /// 3.0).
    pub previous: Option<u32>,
    /// Further properties of a clock (FMI 3.0).
    pub clock: Option<ClockProperties>,
    /// `mimeType` of a Binary.
    pub mime_type: Option<String>,
    /// Line of the file.
    pub line: u32,
}

impl Variable {
    /// Returns whether the variable has an alias of this name (FMI 3.0).
    #[must_use]
    pub fn has_alias(&self, name: &str) -> bool {
        self.aliases.iter().any(|alias| alias.name == name)
    }
}

/// Another name of a variable (FMI 3.0).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alias {
    /// Other name.
    pub name: String,
    /// `description`, empty if missing.
    pub description: String,
    /// Name of the display unit.
    pub display_unit: Option<String>,
}

/// Properties of a clock (FMI 3.0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockProperties {
    /// `intervalVariability`.
    pub interval_variability: IntervalVariability,
    /// `intervalDecimal`, s.
    pub interval_s: Option<f64>,
    /// `shiftDecimal`, s.
    pub shift_s: f64,
    /// `supportsFraction`.
    pub supports_fraction: bool,
    /// `resolution`: counts per second.
    pub resolution: Option<u64>,
    /// `intervalCounter`.
    pub interval_counter: Option<u64>,
    /// `shiftCounter`.
    pub shift_counter: u64,
    /// `priority`.
    pub priority: Option<u32>,
    /// `canBeDeactivated`.
    pub can_be_deactivated: bool,
}

/// Variability of a clock's interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in FMI 3.0")]
pub enum IntervalVariability {
    Constant,
    Fixed,
    Tunable,
    Changing,
    Countdown,
    Triggered,
}
