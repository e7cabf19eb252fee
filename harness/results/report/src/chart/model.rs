//! Content of a chart: lines, bands, levels, and how they are laid out.

/// Meaning of a line or band: the style sheet assigns colour and dash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The method under test.
    Primary,
    /// Method of comparison.
    Baseline,
    /// A second quantity of the same method.
    Second,
    /// Expected value.
    Reference,
}

impl Role {
    /// True if the points of a line with dots are marked: those that were found, not the expected ones.
    pub(super) const fn has_dots(self) -> bool {
        matches!(self, Self::Primary | Self::Baseline)
    }

    pub(super) const fn class(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Baseline => "baseline",
            Self::Second => "second",
            Self::Reference => "reference",
        }
    }
}

/// A line.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name in the legend.
    pub label: String,
    /// Meaning, which sets colour and dash.
    pub role: Role,
    /// Points in order of x; NaN breaks the line.
    pub points: Vec<[f64; 2]>,
}

/// An area between two lines.
#[derive(Clone, Debug)]
pub struct Band {
    /// Name in the legend.
    pub label: String,
    /// Meaning, which sets colour and dash.
    pub role: Role,
    /// x, lower, upper.
    pub points: Vec<[f64; 3]>,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title, also as the text alternative.
    pub title: String,
    /// Label below the x axis.
    pub x_label: String,
    /// Label above the y axis, with unit.
    pub y_label: String,
    /// Width of the drawing in px; the page scales it.
    pub width: f64,
    /// Height of the drawing in px.
    pub height: f64,
    /// True if x is in hours, with ticks at 1, 2, 3, 6, 12, 24 h; else x counts.
    pub hours: bool,
    /// True if x is the decimal logarithm of what the axis shows: ticks are at 0.1, 1, 10. Zoom and
    /// cursor work as on any axis.
    pub decades: bool,
    /// True if y is logarithmic: values that aren't positive are left out.
    pub logarithmic: bool,
    /// Limits of y; `None`: chosen from the lines.
    pub y_range: Option<[f64; 2]>,
    /// Ticks of y; `None`: chosen automatically.
    pub y_step: Option<f64>,
    /// Bands, drawn first.
    pub bands: Vec<Band>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Horizontal lines with a label.
    pub levels: Vec<(f64, String)>,
    /// Length of a bracket on the x axis with its label: a reference period.
    pub bracket: Option<(f64, String)>,
    /// True if a legend is shown above.
    pub legend: bool,
    /// True if points of all lines with the same x belong together: dots, joined across the lines.
    pub paired: bool,
    /// Time of the run at which x is zero, h, for charts over time: they share zoom, cursor and
    /// markers. `None`: the chart stands alone.
    pub run_offset_h: Option<f64>,
    /// True if a point of a primary or baseline line is marked by a dot, for lines of few points.
    pub dots: bool,
}

impl Chart {
    /// Creates an empty chart.
    #[must_use]
    pub fn new(title: &str, x_label: &str, y_label: &str) -> Self {
        Self {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            width: 960.0,
            height: 250.0,
            hours: true,
            decades: false,
            logarithmic: false,
            y_range: None,
            y_step: None,
            bands: Vec::new(),
            lines: Vec::new(),
            levels: Vec::new(),
            bracket: None,
            legend: true,
            paired: false,
            run_offset_h: None,
            dots: false,
        }
    }
}
