//! Styles and rows of the dashboard.

use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

/// Style of names.
pub(super) const SOFT: Style = Style::new().fg(Color::DarkGray);
/// Style of alerts.
pub(super) const ALERT: Style = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);
/// Style of active faults.
pub(super) const ACTS: Style = Style::new().fg(Color::Yellow);
/// Style of a passed run and of values within limits.
pub(super) const GOOD: Style = Style::new().fg(Color::Green);
/// Style of titles.
pub(super) const STRONG: Style = Style::new().add_modifier(Modifier::BOLD);

/// Renders a name and its value.
pub(super) fn row<'a>(name: &'a str, value: impl Into<Span<'a>>) -> Line<'a> {
    Line::from(vec![Span::styled(format!("{name:10}"), SOFT), value.into()])
}
