//! Shows the state of a run on a terminal.

mod curves;
mod overview;
mod parameters;
mod stage;
mod style;

use super::follow::Follow;
use super::plain;
use octant_base::number::fixed;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, LineGauge, Paragraph};
use stage::stage;
use style::{SOFT, STRONG};

/// Page of the dashboard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Page {
    /// Present state.
    #[default]
    Overview,
    /// History.
    Curves,
    /// Events.
    Log,
}

impl Page {
    /// Returns the page of a key.
    #[must_use]
    pub const fn of_key(key: char) -> Option<Self> {
        match key {
            '1' => Some(Self::Overview),
            '2' => Some(Self::Curves),
            '3' => Some(Self::Log),
            _ => None,
        }
    }

    /// Returns the page after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Overview => Self::Curves,
            Self::Curves => Self::Log,
            Self::Log => Self::Overview,
        }
    }
}

/// Draws a page.
pub fn draw(frame: &mut Frame<'_>, follow: &Follow, page: Page) {
    let [head, gauge, body, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(1),
        Constraint::Min(0),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    draw_head(frame, head, follow);
    draw_gauge(frame, gauge, follow);
    match page {
        Page::Overview => overview::draw(frame, body, follow),
        Page::Curves => curves::draw(frame, body, &follow.state),
        Page::Log => draw_log(frame, body, follow),
    }
    draw_foot(frame, foot, page);
}

fn draw_head(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let about = &follow.state.about;
    let title = if about.title.is_empty() { "–" } else { &about.title };
    let place = follow.place.folder().display().to_string();
    let right = u16::try_from(place.chars().count() + 2).unwrap_or(u16::MAX).min(area.width / 2);
    let [left, right] =
        Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
    let method = match &about.unread {
        Some(reason) => format!(" scenario can't be read: {}", reason.replace('\n', " ")),
        None if about.method.is_empty() => String::new(),
        None => format!("  {}, seed {}", about.method, about.seed),
    };
    let line = Line::from(vec![Span::styled(title, STRONG), Span::styled(method, SOFT)]);
    frame.render_widget(line, left);
    frame.render_widget(Line::styled(place, SOFT).right_aligned(), right);
}

fn draw_gauge(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let (text, style) = stage(follow);
    let state = &follow.state;
    let mut label = plain::time(state.time_ns);
    if let (Some(done), Some(length_ns)) = (state.done(), state.about.length_ns) {
        label = format!("{label} of {}, {} %", plain::time(length_ns), fixed(done * 100.0, 1));
    }
    let label = Line::from(vec![Span::raw(label), Span::raw("  "), Span::styled(text, style)]);
    let gauge = LineGauge::default()
        .ratio(state.done().unwrap_or(0.0).clamp(0.0, 1.0))
        .label(label)
        .filled_symbol("━")
        .unfilled_symbol("─")
        .filled_style(Style::new().fg(Color::Cyan))
        .unfilled_style(SOFT);
    frame.render_widget(gauge, area);
}

fn draw_log(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let block = Block::bordered().title(" What happened ");
    let rows = usize::from(area.height.saturating_sub(2));
    let end = plain::end(follow);
    let ending: Vec<Line<'_>> = end.lines().map(|line| Line::styled(line, STRONG)).collect();
    let log = &follow.state.log;
    let first = log.len().saturating_sub(rows.saturating_sub(ending.len()));
    let lines = log.iter().skip(first).map(|(ns, text)| {
        Line::from(vec![
            Span::styled(format!("{:>12}  ", plain::time(*ns)), SOFT),
            Span::raw(text.as_str()),
        ])
    });
    let lines: Vec<Line<'_>> = lines.chain(ending).collect();
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

fn draw_foot(frame: &mut Frame<'_>, area: Rect, page: Page) {
    let one = |key: &'static str, name: &'static str, of: Page| {
        let style = if of == page { STRONG } else { SOFT };
        [Span::styled(format!(" {key} "), style), Span::styled(format!("{name}  "), style)]
    };
    let mut spans = Vec::new();
    spans.extend(one("1", "overview", Page::Overview));
    spans.extend(one("2", "curves", Page::Curves));
    spans.extend(one("3", "log", Page::Log));
    spans.push(Span::styled(" q leave; the run goes on", SOFT));
    frame.render_widget(Line::from(spans), area);
}
