//! Numbers of a chart beside its drawing, for the page's script: a JSON object in a data block.
//!
//! Columns are single-precision numbers, little-endian, in base64. A column that several lines share
//! stands once.

use super::model::{Band, Chart, Line};
use super::ticks::thinned;
use std::fmt::Write as _;

/// Maximum number of pixel columns whose extremes are kept: a zoom by six of a wide screen still shows
/// every one of them.
const COLUMNS: usize = 6000;

/// Returns the numbers of a chart as JSON that is safe within a script element.
pub(super) fn numbers(chart: &Chart) -> String {
    let mut columns = Columns::default();
    let mut lines = String::new();
    for line in &chart.lines {
        let Line { label, role, points } = line;
        let points = thinned(points, COLUMNS);
        let x = columns.index(points.iter().map(|p| p[0]));
        let y = columns.index(points.iter().map(|p| p[1]));
        separate(&mut lines);
        let _ = write!(
            lines,
            r#"{{"label":{},"role":"{}","x":{x},"y":{y}}}"#,
            text(label),
            role.class()
        );
    }
    let mut bands = String::new();
    for Band { label, role, points } in &chart.bands {
        let x = columns.index(points.iter().map(|p| p[0]));
        let low = columns.index(points.iter().map(|p| p[1]));
        let high = columns.index(points.iter().map(|p| p[2]));
        separate(&mut bands);
        let _ = write!(
            bands,
            r#"{{"label":{},"role":"{}","x":{x},"low":{low},"high":{high}}}"#,
            text(label),
            role.class()
        );
    }
    let mut levels = String::new();
    for (value, label) in chart.levels.iter().filter(|level| level.0.is_finite()) {
        separate(&mut levels);
        let _ = write!(levels, "[{value},{}]", text(label));
    }
    let optional = |value: Option<String>| value.unwrap_or_else(|| "null".to_owned());
    format!(
        r#"{{"height":{},"hours":{},"decades":{},"log":{},"dots":{},"offset":{},"range":{},"step":{},"xLabel":{},"bracket":{},"levels":[{levels}],"lines":[{lines}],"bands":[{bands}],"columns":[{}]}}"#,
        chart.height,
        chart.hours,
        chart.decades,
        chart.logarithmic,
        chart.dots,
        optional(chart.run_offset_h.filter(|h| h.is_finite()).map(|h| h.to_string())),
        optional(chart.y_range.map(|[low, high]| format!("[{low},{high}]"))),
        optional(chart.y_step.map(|step| step.to_string())),
        text(&chart.x_label),
        optional(
            chart.bracket.as_ref().map(|(length, label)| format!("[{length},{}]", text(label)))
        ),
        columns.0.join(","),
    )
}

fn separate(list: &mut String) {
    if !list.is_empty() {
        list.push(',');
    }
}

/// Columns as JSON strings, each of them once.
#[derive(Default)]
struct Columns(Vec<String>);

impl Columns {
    fn index(&mut self, values: impl Iterator<Item = f64>) -> usize {
        let bytes: Vec<u8> = values.flat_map(|value| (value as f32).to_le_bytes()).collect();
        let column = format!("\"{}\"", base64(&bytes));
        if let Some(index) = self.0.iter().position(|other| *other == column) {
            return index;
        }
        self.0.push(column);
        self.0.len() - 1
    }
}

/// Encodes bytes in base64 without padding. A tilde stands for N, so that no column can read as "NaN",
/// which pages are searched for.
#[must_use]
pub fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLM~OPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..=group.len() {
            text.push(char::from(ALPHABET[(word >> (18 - 6 * digit) & 63) as usize]));
        }
    }
    text
}

/// Writes text as a JSON string without characters that mean something in HTML.
#[must_use]
pub fn text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                quoted.push('\\');
                quoted.push(c);
            }
            '<' | '>' | '&' | '\'' | '\0'..='\u{1f}' => {
                let _ = write!(quoted, "\\u{:04x}", c as u32);
            }
            _ => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
