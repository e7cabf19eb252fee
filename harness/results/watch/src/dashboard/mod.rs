//! Shows the state of a run on a terminal.

mod curves;
pub mod fit;
mod overview;
mod parameters;
mod style;

use super::follow::Follow;
use super::plain;
use fit::{elide, elide_path, wrap_styled};
use octant_base::number::fixed;
use overview::stage;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, LineGauge, Paragraph};
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
    /// Estimates.
    Parameters,
}

impl Page {
    /// Returns the page of a key.
    #[must_use]
    pub const fn of_key(key: char) -> Option<Self> {
        match key {
            '1' => Some(Self::Overview),
            '2' => Some(Self::Curves),
            '3' => Some(Self::Log),
            '4' => Some(Self::Parameters),
            _ => None,
        }
    }

    /// Returns the page after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Overview => Self::Curves,
            Self::Curves => Self::Log,
            Self::Log => Self::Parameters,
            Self::Parameters => Self::Overview,
        }
    }
}

/// Draws a page.
pub fn draw(frame: &mut Frame<'_>, follow: &Follow, page: Page) {
    let titles = head_lines(follow, frame.area().width.into());
    let [head, gauge, body, foot] = Layout::vertical([
        Constraint::Length(titles.len() as u16),
        Constraint::Length(1),
        Constraint::Min(0),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    draw_head(frame, head, titles);
    draw_gauge(frame, gauge, follow);
    match page {
        Page::Overview => overview::draw(frame, body, follow),
        Page::Curves => curves::draw(frame, body, &follow.state),
        Page::Log => draw_log(frame, body, follow),
        Page::Parameters => parameters::draw(frame, body, &follow.state),
    }
    draw_foot(frame, foot, page);
}

/// The head: what is left, what is right, on one line where they fit, else on two.
fn head_lines(follow: &Follow, width: usize) -> Vec<(Line<'static>, String)> {
    let about = &follow.state.about;
    let title = if about.title.is_empty() { "–" } else { &about.title };
    let place = follow.place.folder().display().to_string();
    let method = match &about.unread {
        Some(reason) => format!("scenario can't be read: {}", reason.replace('\n', " ")),
        None if about.method.is_empty() => String::new(),
        None => format!("{}, seed {}", about.method, about.seed),
    };
    let length = |text: &str| text.chars().count();
    if length(title) + 2 + length(&method) + 2 + length(&place) <= width {
        let gap = if method.is_empty() { "" } else { "  " };
        let spans = vec![
            Span::styled(title.to_owned(), STRONG),
            Span::styled(gap.to_owned() + &method, SOFT),
        ];
        return vec![(Line::from(spans), place)];
    }
    // Beside a method the folder has what the method leaves, but a third at least.
    let right = width.saturating_sub(length(&method) + 2).max(width / 3);
    let place = elide_path(&place, right);
    let left = width.saturating_sub(length(&place) + 2);
    vec![
        (Line::styled(elide(title, width), STRONG), String::new()),
        (Line::styled(elide(&method, left), SOFT), place),
    ]
}

fn draw_head(frame: &mut Frame<'_>, area: Rect, lines: Vec<(Line<'static>, String)>) {
    for (row, (left, right)) in area.rows().zip(lines) {
        let width = u16::try_from(right.chars().count()).unwrap_or(u16::MAX);
        let [of_left, of_right] =
            Layout::horizontal([Constraint::Min(0), Constraint::Length(width)]).areas(row);
        frame.render_widget(left, of_left);
        frame.render_widget(Line::styled(right, SOFT), of_right);
    }
}

fn draw_gauge(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let (text, style) = stage(follow);
    let state = &follow.state;
    let now = plain::time(state.time_ns);
    let mut labels = Vec::new();
    if let (Some(done), Some(length_ns)) = (state.done(), state.about.length_ns) {
        let percent = fixed(done * 100.0, 1);
        labels.push(format!("{now} of {}, {percent} %", plain::time(length_ns)));
        labels.push(format!("{now}, {percent} %"));
        labels.push(format!("{percent} %"));
    } else {
        labels.push(now);
    }
    // The longest label that leaves the gauge a few columns.
    let room = usize::from(area.width).saturating_sub(text.chars().count() + 2 + 4);
    let last = labels.len() - 1;
    let fits = labels.iter().position(|label| label.chars().count() <= room).unwrap_or(last);
    let label = labels.swap_remove(fits);
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
    let width = usize::from(area.width.saturating_sub(2));
    let rows = usize::from(area.height.saturating_sub(2));
    let end = plain::end(follow);
    let ending: Vec<Line<'_>> =
        end.lines().flat_map(|line| wrap_styled(&[(line, STRONG)], width)).collect();
    let mut lines = overview::last_lines(follow, width, rows.saturating_sub(ending.len()));
    lines.extend(ending);
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
    spans.extend(one("4", "parameters", Page::Parameters));
    spans.push(Span::styled(" q leave; the run goes on", SOFT));
    frame.render_widget(Line::from(spans), area);
}
