//! Present state of a run.

use super::parameters;
use super::stage::stage;
use super::style::{ACTS, ALERT, GOOD, SOFT, row};
use crate::follow::{Follow, Stage};
use crate::plain;
use crate::state::{RunState, SolutionError};
use octant_base::number::fixed;
use octant_sample::Mode;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph, Wrap};

/// NIS on three axes whose exceedance has a probability of one in a million.
const NIS_ALERT: f64 = 30.0;

pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let state = &follow.state;
    let [top, middle, bottom] =
        Layout::vertical([Constraint::Length(9), Constraint::Length(12), Constraint::Min(4)])
            .areas(area);
    let [core, position] =
        Layout::horizontal([Constraint::Percentage(46), Constraint::Min(0)]).areas(top);
    draw_core(frame, core, state);
    draw_position(frame, position, state);
    parameters::draw(frame, middle, state);
    let paced = state.about.by_clock || state.pace.is_some();
    let has_verdict = matches!(follow.stage, Stage::Ended(_));
    let widths: &[u16] = match (paced, has_verdict) {
        (true, true) => &[34, 27, 39],
        (true, false) => &[60, 40],
        (false, _) => &[50, 50],
    };
    let places =
        Layout::horizontal(widths.iter().map(|w| Constraint::Percentage(*w))).split(bottom);
    draw_faults(frame, places[0], state);
    if paced {
        draw_pace(frame, places[1], state);
    }
    match (paced, has_verdict) {
        (true, false) => {}
        (false, false) => draw_last(frame, places[1], follow),
        (_, true) => draw_end(frame, places[places.len() - 1], follow),
    }
}

fn draw_core(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let mut lines = vec![row("mode", plain::mode(state))];
    let since = state.time_ns.saturating_sub(state.mode_since_ns);
    lines.push(row("for", state.mode().map_or_else(|| "–".to_owned(), |_| plain::time(since))));
    let angles = |gimbals: Option<_>| gimbals.map_or_else(|| "–".to_owned(), plain::angles);
    lines.push(row("gimbals", angles(state.gimbals)));
    lines.push(row("command", angles(state.output.map(|o| o.gimbal_command.target))));
    lines.push(match state.nis {
        Some(nis) => {
            let style = if nis.last > NIS_ALERT { ALERT } else { Style::new() };
            let mean = format!(", mean {} (expected 3)", fixed(nis.mean(), 2));
            let mut line = row("NIS", Span::styled(fixed(nis.last, 2), style));
            line.push_span(Span::raw(mean));
            line
        }
        None => row("NIS", "–"),
    });
    let health = plain::health(state);
    let style = if health == "good" { GOOD } else { ALERT };
    lines.push(row("health", Span::styled(health, style)));
    let before = state.causes.iter().max_by_key(|cause| cause.last_ns);
    lines.push(row(
        "last",
        before.map_or_else(
            || "nothing reported".to_owned(),
            |cause| format!("{}, {}", cause.name(), plain::time(cause.last_ns)),
        ),
    ));
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(" Core ")), area);
}

fn draw_position(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let mut lines = Vec::new();
    match &state.output {
        Some(output) => {
            let navigation = &output.navigation;
            let degrees = |rad: f64| format!("{}°", fixed(rad.to_degrees(), 6));
            lines.push(row(
                "position",
                format!(
                    "{}  {}  {} m",
                    degrees(navigation.latitude_rad),
                    degrees(navigation.longitude_rad),
                    fixed(navigation.height_m, 1)
                ),
            ));
            let [north, east, down] = navigation.velocity_mps.map(|v| fixed(v, 4));
            lines.push(row("velocity", format!("{north}  {east}  {down} m/s")));
        }
        None => lines.push(row("position", "–")),
    }
    lines.push(Line::default());
    match state.drift {
        Some(drift) => lines.extend(drift_table(drift, state)),
        None => lines.push(Line::styled("no truth is recorded: the drift isn't known", SOFT)),
    }
    let block = Block::bordered().title(" Position and drift ");
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

fn drift_table(drift: SolutionError, state: &RunState) -> [Line<'static>; 4] {
    let mode = state.largest_while.map_or("", Mode::name);
    let head = format!("{:10}{:>10}{:>25}", "error", "now", format!("largest, {mode}"));
    let one = |name: &str, now: f64, largest: f64, unit: &str| {
        row_owned(name, format!("{:>10}{:>25} {unit}", fixed(now, 4), fixed(largest, 4)))
    };
    let largest = state.largest;
    [
        Line::styled(head, SOFT),
        one("latitude", drift.latitude_arcmin, largest.latitude_arcmin, "arcmin"),
        one("longitude", drift.longitude_arcmin, largest.longitude_arcmin, "arcmin"),
        one("radial", drift.radial_nmi, largest.radial_nmi, "nmi"),
    ]
}

fn row_owned(name: &str, value: String) -> Line<'static> {
    Line::from(vec![Span::styled(format!("{name:10}"), SOFT), Span::raw(value)])
}

fn draw_faults(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let fired = state.faults.iter().filter(|fault| fault.firings > 0).count();
    let title = match state.faults.len() {
        0 => " Faults ".to_owned(),
        armed => format!(" Faults: {fired} of {armed} fired "),
    };
    let rows = usize::from(area.height.saturating_sub(2));
    let mut lines: Vec<Line<'_>> = Vec::new();
    if state.faults.is_empty() {
        lines.push(Line::styled("none in this scenario", SOFT));
    }
    // If there isn't room for all, active faults come first, then those that fired.
    let mut faults: Vec<_> = state.faults.iter().collect();
    if faults.len() > rows {
        faults.sort_by_key(|fault| (!fault.acts, fault.firings == 0));
    }
    for fault in faults.iter().take(rows) {
        let style = if fault.acts { ACTS } else { Style::new() };
        let mut line = Line::from(vec![Span::raw(format!("{} ", fault.id))]);
        line.push_span(Span::styled(format!("({}) ", fault.kind), SOFT));
        line.push_span(Span::styled(plain::fault(fault), style));
        lines.push(line);
    }
    if faults.len() > rows && rows > 0 {
        lines.truncate(rows - 1);
        let more = faults.len() - lines.len();
        lines.push(Line::styled(format!("and {more} more"), SOFT));
    }
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(title)), area);
}

fn draw_pace(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let mut lines = Vec::new();
    let count = |n: u64| Span::styled(n.to_string(), if n > 0 { ALERT } else { Style::new() });
    if let Some(pace) = state.pace {
        let late = plain::lateness(pace.latest_us);
        lines.push(row("late", format!("{late} in 1 s")));
        lines.push(row("so far", format!("{} at most", plain::lateness(state.latest_us))));
        let mut overruns = row("overruns", count(pace.overruns));
        if let Some(limit_us) = state.about.overrun_us {
            overruns.push_span(Span::raw(format!(" above {}", plain::lateness(limit_us))));
        }
        lines.push(overruns);
        let mut answers = row("answers", count(pace.late_answers));
        answers.push_span(Span::raw(" too late"));
        lines.push(answers);
        lines.push(row("samples", pace.frames.to_string()));
    } else {
        lines.push(Line::styled("nothing told yet", SOFT));
    }
    if let Some(pacing) = &state.pacing {
        let of = &pacing.lateness_us;
        for (name, value) in [("median", of.p50), ("99 %", of.p99), ("99.9 %", of.p999)] {
            lines.push(row(name, plain::lateness(value)));
        }
    }
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(" Lateness ")), area);
}

fn draw_last(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let rows = usize::from(area.height.saturating_sub(2));
    let log = &follow.state.log;
    let lines = log.iter().skip(log.len().saturating_sub(rows)).map(|(ns, text)| {
        Line::from(vec![
            Span::styled(format!("{} ", plain::time(*ns)), SOFT),
            Span::raw(text.as_str()),
        ])
    });
    let block = Block::bordered().title(" What happened ");
    frame.render_widget(Paragraph::new(lines.collect::<Vec<_>>()).block(block), area);
}

fn draw_end(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let (_, style) = stage(follow);
    let mut lines = vec![Line::styled(plain::stage(follow), style)];
    let end = plain::end(follow);
    lines.extend(end.lines().skip(1).map(|line| Line::raw(line.trim())));
    let block = Block::bordered().title(" Verdict ");
    let text = Paragraph::new(lines).wrap(Wrap { trim: true }).block(block);
    frame.render_widget(text, area);
}
