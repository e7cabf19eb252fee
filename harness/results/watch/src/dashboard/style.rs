//! Styles of the dashboard.

use ratatui::style::{Color, Modifier, Style};

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
