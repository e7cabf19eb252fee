//! Present state of a run.

use super::fit::{PanelRows, wrap, wrap_styled};
use super::parameters;
use super::style::{ACTS, ALERT, GOOD, SOFT};
use crate::follow::{Follow, Stage};
use crate::plain;
use crate::state::{FaultState, RunState, SolutionError};
use octant_base::number::{fixed, significant};
use octant_sample::Mode;
use octant_verdict::Verdict;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph};

/// NIS on three axes whose exceedance has a probability of one in a million.
const NIS_ALERT: f64 = 30.0;

/// Size of the body from which the overview has everything side by side: 100 columns, and 25 lines of
/// panels with 4 for the faults.
const FULL: (u16, u16) = (100, 26);

/// Arrangement of the panels.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Arrangement {
    /// All panels.
    Full,
    /// A terminal of 80 columns and 24 lines: the parameters have their own page.
    Small,
}

pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let state = &follow.state;
    let full = area.width >= FULL.0 && area.height >= FULL.1;
    let arrangement = if full { Arrangement::Full } else { Arrangement::Small };
    let heights: &[Constraint] = match arrangement {
        Arrangement::Full => &[Constraint::Length(10), Constraint::Length(12), Constraint::Min(4)],
        Arrangement::Small => &[Constraint::Length(12), Constraint::Length(0), Constraint::Min(4)],
    };
    let rows = Layout::vertical(heights).split(area);
    let core = if full { 46 } else { 50 };
    let top = Layout::horizontal([Constraint::Percentage(core), Constraint::Min(0)]).split(rows[0]);
    draw_core(frame, top[0], state);
    draw_position(frame, top[1], state, arrangement);
    if full {
        parameters::draw(frame, rows[1], state);
    }
    let paced = state.about.by_clock || state.pace.is_some();
    let has_verdict = matches!(follow.stage, Stage::Ended(_));
    let widths: &[u16] = match (paced, has_verdict, arrangement) {
        (true, true, Arrangement::Full) => &[34, 27, 39],
        (true, true, Arrangement::Small) => &[34, 26, 40],
        (true, false, Arrangement::Full) => &[60, 40],
        (true, false, Arrangement::Small) => &[68, 32],
        (false, ..) => &[50, 50],
    };
    let places =
        Layout::horizontal(widths.iter().map(|w| Constraint::Percentage(*w))).split(rows[2]);
    draw_faults(frame, places[0], state);
    if paced {
        draw_pace(frame, places[1], state, arrangement);
    }
    match (paced, has_verdict) {
        (true, false) => {}
        (false, false) => draw_last(frame, places[1], follow),
        (_, true) => draw_end(frame, places[places.len() - 1], follow),
    }
}

/// Width and height of a panel between its borders.
fn inside(area: Rect) -> (usize, usize) {
    (area.width.saturating_sub(2).into(), area.height.saturating_sub(2).into())
}

fn draw_core(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let (width, _) = inside(area);
    let mut rows = PanelRows::new(width, if width < 44 { 8 } else { 10 });
    let usual = Style::new();
    let mut mode = state.mode().map_or("no output yet", Mode::name).to_owned();
    if state.output.is_some_and(|output| output.moving) {
        mode += ", moving";
    }
    rows.put("mode", &mode, usual);
    let stop = state.output.filter(|o| matches!(o.mode, Mode::Calibrating | Mode::Navigating));
    let stop = stop.map(|output| plain::stop(&output, state.about.stops.as_ref()));
    rows.put("stop", stop.as_deref().unwrap_or("–"), usual);
    let since = state.time_ns.saturating_sub(state.mode_since_ns);
    rows.put("for", &state.mode().map_or_else(|| "–".to_owned(), |_| plain::time(since)), usual);
    let angles = |gimbals: Option<_>| gimbals.map_or_else(|| "–".to_owned(), plain::angles);
    rows.put("gimbals", &angles(state.gimbals), usual);
    rows.put("command", &angles(state.output.map(|o| o.gimbal_command.target)), usual);
    match state.nis {
        Some(nis) => {
            let style = if nis.last > NIS_ALERT { ALERT } else { usual };
            let text =
                format!("{}, mean {} (expected 3)", fixed(nis.last, 2), fixed(nis.mean(), 2));
            rows.put("NIS", &text, style);
        }
        None => rows.put("NIS", "–", usual),
    }
    let health = plain::health(state);
    let style = if health == "good" { GOOD } else { ALERT };
    rows.put("health", &health, style);
    let before = state.causes.iter().max_by_key(|cause| cause.last_ns);
    let last = before.map_or_else(
        || "nothing reported".to_owned(),
        |cause| format!("{}, {}", cause.name(), plain::time(cause.last_ns)),
    );
    rows.put("last", &last, usual);
    let block = Block::bordered().title(" Core ");
    frame.render_widget(Paragraph::new(rows.lines).block(block), area);
}

fn draw_position(frame: &mut Frame<'_>, area: Rect, state: &RunState, arrangement: Arrangement) {
    let (width, _) = inside(area);
    let mut rows = PanelRows::new(width, 10);
    match &state.output {
        Some(output) => {
            let navigation = &output.navigation;
            let degrees = |rad: f64| format!("{}°", fixed(rad.to_degrees(), 6));
            let text = format!(
                "{}  {}  {} m",
                degrees(navigation.latitude_rad),
                degrees(navigation.longitude_rad),
                fixed(navigation.height_m, 1)
            );
            rows.put("position", &text, Style::new());
            let [north, east, down] = navigation.velocity_mps.map(|v| fixed(v, 4));
            rows.put("velocity", &format!("{north}  {east}  {down} m/s"), Style::new());
        }
        None => rows.put("position", "–", Style::new()),
    }
    let mut lines = rows.lines;
    lines.push(Line::default());
    match state.drift {
        Some(drift) if arrangement == Arrangement::Full => lines.extend(drift_table(drift, state)),
        Some(drift) => lines.extend(small_drift_table(drift, state)),
        None => {
            let text = "no truth is recorded: the drift isn't known";
            lines.extend(wrap(text, width).into_iter().map(|line| Line::styled(line, SOFT)));
        }
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

/// The drift in thirty-eight columns.
fn small_drift_table(drift: SolutionError, state: &RunState) -> [Line<'static>; 4] {
    let mode = state.largest_while.map_or("", Mode::name);
    let head = format!("{:10}{:>8}{:>20}", "error", "now", format!("largest {mode}"));
    let one = |name: &str, now: f64, largest: f64, unit: &str| {
        let decimals = |value: f64| if value.abs() < 1e3 { 3 } else { 1 };
        let (now, largest) = (fixed(now, decimals(now)), fixed(largest, decimals(largest)));
        row_owned(name, format!("{now:>8}{largest:>13} {unit}"))
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
    let (width, rows) = inside(area);
    let describe = |fault: &FaultState| {
        let style = if fault.acts { ACTS } else { Style::new() };
        let (id, kind) = (format!("{} ", fault.id), format!("({}) ", fault.kind));
        let text = plain::fault(fault);
        let parts = [(id.as_str(), Style::new()), (kind.as_str(), SOFT), (text.as_str(), style)];
        wrap_styled(&parts, width)
    };
    let mut faults: Vec<_> = state.faults.iter().collect();
    let all: usize = faults.iter().map(|fault| describe(fault).len()).sum();
    let mut lines: Vec<Line<'_>> = Vec::new();
    if state.faults.is_empty() {
        lines.push(Line::styled("none in this scenario", SOFT));
    }
    // If there isn't room for all, active faults come first, then those that fired.
    let is_full = all > rows;
    if is_full {
        faults.sort_by_key(|fault| (!fault.acts, fault.firings == 0));
    }
    for (shown, fault) in faults.iter().enumerate() {
        let of_fault = describe(fault);
        if is_full && lines.len() + of_fault.len() + 1 > rows {
            lines.push(Line::styled(format!("and {} more", faults.len() - shown), SOFT));
            break;
        }
        lines.extend(of_fault);
    }
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(title)), area);
}

fn draw_pace(frame: &mut Frame<'_>, area: Rect, state: &RunState, arrangement: Arrangement) {
    let (width, _) = inside(area);
    let small = arrangement == Arrangement::Small;
    let mut rows = PanelRows::new(width, if small { 9 } else { 10 });
    let counted = |n: u64| if n > 0 { ALERT } else { Style::new() };
    if let Some(pace) = state.pace {
        let late = plain::lateness(pace.latest_us);
        let so_far = plain::lateness(state.latest_us);
        let overruns = pace.overruns.to_string();
        let answers = pace.late_answers;
        if small {
            // After the end the quantiles take the place of the last second and of the samples.
            if state.pacing.is_none() {
                rows.put("last 1 s", &late, Style::new());
                rows.put("samples", &pace.frames.to_string(), Style::new());
            }
            rows.put("largest", &so_far, Style::new());
            rows.put("overruns", &overruns, counted(pace.overruns));
            if let Some(limit_us) = state.about.overrun_us {
                rows.put("limit", &plain::lateness(limit_us), Style::new());
            }
            rows.put("answers", &format!("{answers} late"), counted(answers));
        } else {
            rows.put("late", &format!("{late} in 1 s"), Style::new());
            rows.put("so far", &format!("{so_far} at most"), Style::new());
            let limit = state.about.overrun_us.map_or_else(String::new, |limit_us| {
                format!(" above {}", plain::lateness(limit_us))
            });
            rows.put("overruns", &(overruns + &limit), counted(pace.overruns));
            rows.put("answers", &format!("{answers} too late"), counted(answers));
            rows.put("samples", &pace.frames.to_string(), Style::new());
        }
    } else {
        rows.put("", "nothing told yet", SOFT);
    }
    if let Some(pacing) = &state.pacing {
        let of = &pacing.lateness_us;
        for (name, value) in [("median", of.p50), ("99 %", of.p99), ("99.9 %", of.p999)] {
            rows.put(name, &plain::lateness(value), Style::new());
        }
    }
    let block = Block::bordered().title(" Lateness ");
    frame.render_widget(Paragraph::new(rows.lines).block(block), area);
}

fn draw_last(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let (width, rows) = inside(area);
    let lines = last_lines(follow, width, rows);
    let block = Block::bordered().title(" What happened ");
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

/// The last events of the log that have room, each whole.
pub(super) fn last_lines(follow: &Follow, width: usize, rows: usize) -> Vec<Line<'static>> {
    let mut events = Vec::new();
    let mut free = rows;
    for (ns, text) in follow.state.log.iter().rev() {
        let time = format!("{} ", plain::time(*ns));
        let lines = wrap_styled(&[(time.as_str(), SOFT), (text.as_str(), Style::new())], width);
        // The newest event alone is shown as far as it goes.
        if lines.len() > free && !events.is_empty() {
            break;
        }
        free = free.saturating_sub(lines.len());
        events.push(lines);
    }
    events.into_iter().rev().flatten().collect()
}

fn draw_end(frame: &mut Frame<'_>, area: Rect, follow: &Follow) {
    let (width, _) = inside(area);
    let (_, style) = stage(follow);
    let mut lines = vec![Line::styled(plain::stage(follow), style)];
    for text in plain::end(follow).lines().skip(1) {
        lines.extend(wrap_styled(&[(text.trim(), Style::new())], width));
    }
    let block = Block::bordered().title(" Verdict ");
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

/// Describes the progress of the run, with its speed or its verdict.
pub(super) fn stage(follow: &Follow) -> (String, Style) {
    let text = plain::stage(follow);
    match &follow.stage {
        Stage::Ended(summary) => {
            let style = match summary.verdict {
                Verdict::None => Style::new(),
                Verdict::Pass => GOOD,
                Verdict::Inconclusive => ACTS,
                Verdict::Fail | Verdict::Error => ALERT,
            };
            (text, style.add_modifier(Modifier::BOLD))
        }
        Stage::BrokenOff => (text, ALERT),
        Stage::Running => {
            let speed = match follow.speed() {
                _ if follow.state.about.by_clock => ", by the clock".to_owned(),
                Some(speed) => format!(", {} times real time", significant(speed, 2)),
                None => String::new(),
            };
            let left = follow.left_s().map_or_else(String::new, |left_s| {
                format!(", {} left", plain::time((left_s * 1e9) as u64))
            });
            (format!("{text}{speed}{left}"), Style::new())
        }
        Stage::Starting | Stage::Recorded | Stage::Unjudged => (text, ACTS),
    }
}
