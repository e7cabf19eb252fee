//! Text in the columns that there are: lines break between words, and a word is never cut.

use super::style::SOFT;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

/// Longest unit that stays on the line of its number, characters.
const UNIT_CHARS: usize = 6;

/// Breaks a text into lines of at most `width` characters: after a comma or a double space where the
/// line is at least half full, else at a space, else within a path or a dotted name after its mark. A
/// number keeps its unit. Only a longer piece without any of these is cut.
#[must_use]
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines = Vec::new();
    let mut rest: Vec<char> = text.trim_end().chars().collect();
    while rest.len() > width {
        let end = break_at(&rest, width);
        let line: String = rest[..end].iter().collect();
        lines.push(line.trim_end().to_owned());
        let next = rest[end..].iter().position(|c| *c != ' ').map_or(rest.len(), |n| end + n);
        rest.drain(..next);
    }
    if !rest.is_empty() || lines.is_empty() {
        lines.push(rest.into_iter().collect());
    }
    lines
}

/// Number of characters of the first line; the text is longer than it.
fn break_at(text: &[char], width: usize) -> usize {
    let (mut clause, mut word, mut part) = (None, None, None);
    for end in 1..=width {
        let (before, after) = (text[end - 1], text[end]);
        if after == ' ' && before != ' ' {
            let of_clause = matches!(before, ',' | ';') || text.get(end + 1) == Some(&' ');
            if of_clause && 2 * end >= width {
                clause = Some(end);
            }
            if of_clause || !before.is_ascii_digit() || !is_unit(&text[end + 1..]) {
                word = Some(end);
            }
        } else if matches!(before, '.' | '_' | '/' | '-') && after.is_alphanumeric() {
            part = Some(end);
        }
    }
    clause.or(word).or(part).unwrap_or(width)
}

/// True if a text begins with a word as short as a unit.
fn is_unit(text: &[char]) -> bool {
    let length = text.iter().take_while(|c| **c != ' ').count();
    (1..=UNIT_CHARS).contains(&length) && !text[0].is_ascii_digit()
}

/// Leaves out the last words of a text that is longer than `width`, for `…`.
#[must_use]
pub fn elide(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    let first = wrap(text, width.saturating_sub(2)).swap_remove(0);
    format!("{} …", first.trim_end_matches([',', ';', ':']))
}

/// Leaves out the first folders of a path that is longer than `width`, for `…`.
#[must_use]
pub fn elide_path(path: &str, width: usize) -> String {
    if path.chars().count() <= width {
        return path.to_owned();
    }
    let mut tails = path.match_indices(['/', '\\']).map(|(at, _)| format!("…{}", &path[at..]));
    let fits = |tail: &String| tail.chars().count() <= width;
    tails.find(fits).unwrap_or_else(|| "…".to_owned())
}

/// Rows of names and values in a panel.
pub(super) struct PanelRows {
    /// The lines so far.
    pub(super) lines: Vec<Line<'static>>,
    width: usize,
    name_width: usize,
}

impl PanelRows {
    /// Creates rows for a panel of this width between its borders, with names of this width.
    pub(super) fn new(width: usize, name_width: usize) -> Self {
        Self { lines: Vec::new(), width, name_width }
    }

    /// Adds a name with its value, on as many lines as the value needs.
    pub(super) fn put(&mut self, name: &str, value: &str, style: Style) {
        let width = self.width.saturating_sub(self.name_width);
        for (k, part) in wrap(value, width).into_iter().enumerate() {
            let name = format!("{:1$}", if k == 0 { name } else { "" }, self.name_width);
            self.lines.push(Line::from(vec![Span::styled(name, SOFT), Span::styled(part, style)]));
        }
    }
}

/// Breaks text whose parts have styles: the lines after the first are indented by two columns.
#[must_use]
pub fn wrap_styled(parts: &[(&str, Style)], width: usize) -> Vec<Line<'static>> {
    let text: String = parts.iter().map(|(text, _)| *text).collect();
    let mut lines = Vec::new();
    let first = wrap(&text, width).swap_remove(0);
    let rest = text[first.len()..].trim_start();
    lines.push((first.clone(), 0));
    if !rest.is_empty() {
        lines.extend(wrap(rest, width.saturating_sub(2)).into_iter().map(|line| (line, 2)));
    }
    // Styles by the place in the whole text, which the lines go through in order.
    let mut at = 0;
    lines
        .into_iter()
        .map(|(line, indent)| {
            let begin = text[at..].find(line.as_str()).map_or(at, |n| at + n);
            at = begin + line.len();
            let mut spans = vec![Span::raw(" ".repeat(indent))];
            let mut from = 0;
            for (part, style) in parts {
                let to = from + part.len();
                let (low, high) = (from.max(begin), to.min(at));
                if low < high {
                    spans.push(Span::styled(text[low..high].to_owned(), *style));
                }
                from = to;
            }
            Line::from(spans)
        })
        .collect()
}
