//! Renders `sweep.html`, the heat map of a sweep as `sweep.svg`, and its plain text and CSV.

use maud::{Markup, PreEscaped, html};
use octant_base::number;
use octant_campaign::sweep::{Sweep, SweepAxis, SweepCell, indices};
use octant_report::page::page;

/// Width and height of a cell of the map, px.
const CELL: [f64; 2] = [112.0, 46.0];
/// Space for the labels on the left, px; `TOP` is that above.
const LEFT: f64 = 150.0;
const TOP: f64 = 44.0;
/// Shift of full colour, σ; the scale begins at a thousandth of it.
const FULL_SIGMA: f64 = 100.0;

/// Renders the value of a cell.
fn value(cell: &SweepCell) -> String {
    match (&cell.refused, cell.worst_shift_sigma, cell.fired) {
        (_, _, false) => "not fired".to_owned(),
        (Some(_), ..) => "refused".to_owned(),
        (None, Some(sigma), _) => number::significant(sigma, 2),
        (None, None, _) => "–".to_owned(),
    }
}

/// Names the first detection, in a word.
fn notice(cell: &SweepCell) -> &str {
    cell.noticed_by.as_deref().unwrap_or(if cell.fired { "unnoticed" } else { "" })
}

/// Lists the panels: the first two axes span a map, every combination of the others has its own.
fn panels(sweep: &Sweep) -> Vec<(String, Vec<&SweepCell>)> {
    let others = sweep.axes.get(2..).unwrap_or(&[]);
    let count = octant_campaign::sweep::cells_of(others);
    (0..count)
        .map(|panel| {
            let at = indices(others, panel);
            let name: Vec<String> = others
                .iter()
                .zip(&at)
                .map(|(axis, i)| format!("{} = {}", axis.key, axis.values[*i]))
                .collect();
            let cells = sweep.cells.iter().filter(|c| c.at.get(2..).unwrap_or(&[]) == at).collect();
            (name.join(", "), cells)
        })
        .collect()
}

/// Renders the sweep as one HTML file.
#[must_use]
pub fn render(sweep: &Sweep, rerun: &str) -> String {
    let missed = sweep.cells.iter().filter(|c| c.missed).count();
    let unnoticed = sweep.cells.iter().filter(|c| c.fired && c.noticed_by.is_none()).count();
    let body = html! {
        header {
            div.eyebrow { "Sweep of a fault" }
            h1 { (sweep.scenario) }
            p.lead { "Fault " strong { (sweep.fault) } " of kind " (sweep.kind) ", seed " (sweep.seed) ": "
                (sweep.cells.len()) " runs, each held against the run without the fault. "
                (unnoticed) " went unnoticed, " (missed) " of them with harm." }
        }
        @for (name, cells) in panels(sweep) {
            @if !name.is_empty() { h2 { (name) } }
            (map(sweep, &cells))
        }
        p.hint { "The number is the largest shift of a parameter in posterior σ of the run without the fault. A \
            dashed frame: the core reported nothing. A heavy frame: it reported nothing and a parameter \
            moved by " (number::plain(sweep.harmful_shift_sigma, 2)) " σ or more, invisible and harmful." }
        h2 { "Every cell" }
        (table(sweep))
        h2 { "Provenance" }
        table { tbody { tr { td { "octant" } td.mono { (sweep.octant) } } } }
        p.hint { "The same sweep again:" }
        code.rerun { (rerun) }
    };
    page(&format!("{}: sweep of {}", sweep.scenario, sweep.fault), &body)
}

/// Renders the heat map of one panel as SVG.
#[must_use]
pub fn map(sweep: &Sweep, cells: &[&SweepCell]) -> Markup {
    let [width, height] = size(sweep);
    html! {
        svg.map viewBox={ "0 0 " (width) " " (height) } width=(width) role="img" aria-label="heat map of the sweep" {
            (drawing(sweep, cells))
        }
    }
}

/// Renders all panels as one self-contained SVG, with its own colours.
#[must_use]
pub fn figure(sweep: &Sweep) -> String {
    const HEAD: f64 = 30.0;
    const FOOT: f64 = 24.0;
    let panels = panels(sweep);
    let [width, panel] = size(sweep);
    let width = width.max(640.0);
    let above = |name: &str| if name.is_empty() { 0.0 } else { 22.0 };
    let height: f64 = HEAD + FOOT + panels.iter().map(|(name, _)| above(name) + panel).sum::<f64>();
    let mut top = HEAD;
    let drawn: Vec<(f64, f64, &str, Markup)> = panels
        .iter()
        .map(|(name, cells)| {
            let at = top + above(name);
            top = at + panel;
            (at, at - 8.0, name.as_str(), drawing(sweep, cells))
        })
        .collect();
    let svg = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (width) " " (height) } width=(width) height=(height)
            role="img" aria-label={ "sweep of " (sweep.fault) } {
            style { (PreEscaped(STYLE)) }
            rect class="paper" width=(width) height=(height) {}
            text class="title" x="4" y="18" { (sweep.kind) ": largest shift of a parameter, in σ of the run without the fault" }
            @for (at, name_at, name, body) in &drawn {
                @if !name.is_empty() { text class="title" x="4" y=(name_at) { (name) } }
                g transform={ "translate(0 " (at) ")" } { (body) }
            }
            text class="tick" x="4" y=(height - 8.0) {
                "dashed: the core reported nothing; heavy: it reported nothing, and a parameter moved by "
                (number::plain(sweep.harmful_shift_sigma, 2)) " σ or more"
            }
        }
    };
    octant_base::printable::printable(&svg.0).into_owned()
}

/// Colours of a self-contained figure: those of the page.
const STYLE: &str = "\
svg{font:12px Inter,'Segoe UI','Helvetica Neue','Liberation Sans',Arial,sans-serif}\
.paper{fill:#fff}.tick{font-size:11.5px;fill:#5b6470}.tick.x{text-anchor:middle}\
.title{fill:#1b1f24;font-size:13.5px;font-weight:600}.heat{fill:#c4500a}.frame{fill:none;stroke:none}\
.unnoticed{stroke:#1b1f24;stroke-width:1.2;stroke-dasharray:4 3}.missed{stroke:#1b1f24;stroke-width:3}\
.heat-value,.heat-note{text-anchor:middle;fill:#1b1f24;font-size:12.5px}.heat-note{font-size:9.5px}\
@media(prefers-color-scheme:dark){.paper{fill:#14181d}.tick{fill:#9aa4af}.title{fill:#e4e8ec}\
.heat{fill:#f0a04b}.unnoticed,.missed{stroke:#e4e8ec}.heat-value,.heat-note{fill:#e4e8ec}}";

/// Returns width and height of a panel, px.
fn size(sweep: &Sweep) -> [f64; 2] {
    let count = |axis: usize| sweep.axes.get(axis).map_or(1, |axis| axis.values.len()) as f64;
    [LEFT + CELL[0] * count(1) + 10.0, TOP + CELL[1] * count(0) + 10.0]
}

fn drawing(sweep: &Sweep, cells: &[&SweepCell]) -> Markup {
    let empty = SweepAxis { key: String::new(), values: vec![String::new()] };
    let down = sweep.axes.first().unwrap_or(&empty);
    let across = sweep.axes.get(1).unwrap_or(&empty);
    let x = |i: usize| LEFT + CELL[0] * i as f64;
    let y = |i: usize| TOP + CELL[1] * i as f64;
    html! {
        text class="tick" x=(LEFT) y="14" { (across.key) }
        text class="tick" x="4" y=(TOP - 8.0) { (down.key) }
        @for (i, label) in across.values.iter().enumerate() {
            text class="tick x" x=(x(i) + 0.5 * CELL[0]) y=(TOP - 8.0) { (label) }
        }
        @for (i, label) in down.values.iter().enumerate() {
            text class="tick" x="4" y=(y(i) + 0.5 * CELL[1] + 4.0) { (label) }
        }
        @for cell in cells {
            @let (i, j) = (cell.at.first().copied().unwrap_or(0), cell.at.get(1).copied().unwrap_or(0));
            g {
                rect class="heat" x=(x(j) + 1.0) y=(y(i) + 1.0) width=(CELL[0] - 2.0) height=(CELL[1] - 2.0)
                    fill-opacity=(number::fixed(heat(cell), 3)) {}
                rect class=(frame(cell)) x=(x(j) + 2.5) y=(y(i) + 2.5) width=(CELL[0] - 5.0) height=(CELL[1] - 5.0) {}
                text class="heat-value" x=(x(j) + 0.5 * CELL[0]) y=(y(i) + 0.5 * CELL[1]) { (value(cell)) }
                text class="heat-note" x=(x(j) + 0.5 * CELL[0]) y=(y(i) + 0.5 * CELL[1] + 14.0) { (short(notice(cell))) }
                title { (value(cell)) ", " (notice(cell)) }
            }
        }
    }
}

/// Shortens a text to the letters that fit into a cell.
fn short(text: &str) -> String {
    const LETTERS: usize = 20;
    if text.chars().count() <= LETTERS {
        text.to_owned()
    } else {
        text.chars().take(LETTERS - 1).chain(['…']).collect()
    }
}

/// Returns the strength of the colour: the logarithm of the shift. A refused calibration does no
/// harm.
fn heat(cell: &SweepCell) -> f64 {
    if cell.refused.is_some() {
        return 0.0;
    }
    let sigma = cell.worst_shift_sigma.unwrap_or(0.0);
    ((sigma / FULL_SIGMA).max(1e-3).log10() / 3.0 + 1.0).clamp(0.0, 1.0) * 0.85
}

fn frame(cell: &SweepCell) -> &'static str {
    match (cell.missed, cell.fired && cell.noticed_by.is_none() && cell.refused.is_none()) {
        (true, _) => "frame missed",
        (false, true) => "frame unnoticed",
        (false, false) => "frame",
    }
}

fn table(sweep: &Sweep) -> Markup {
    html! {
        table {
            thead { tr {
                @for axis in &sweep.axes { th { (axis.key) } }
                th.n { "Shift, σ" } th style="padding-left:14px" { "Parameter" } th.n { "Drift, nmi" }
                th style="padding-left:14px" { "Noticed as" } th.n { "After, s" } th style="padding-left:14px" { "Refused" }
            } }
            tbody { @for cell in &sweep.cells { tr {
                @for (axis, i) in sweep.axes.iter().zip(&cell.at) { td style="white-space:nowrap" { (axis.values[*i]) } }
                td.n { (cell.worst_shift_sigma.map_or_else(|| "–".to_owned(), |s| number::significant(s, 3))) }
                td.mono style="padding-left:14px" { (cell.worst_parameter.as_deref().unwrap_or("–")) }
                td.n { (cell.radial_max_nmi.map_or_else(|| "–".to_owned(), |r| number::significant(r, 3))) }
                td style="padding-left:14px;white-space:nowrap" { (notice(cell)) }
                td.n { (cell.delay_s.map_or_else(|| "–".to_owned(), |s| number::fixed(s, 3))) }
                td style="padding-left:14px" { (cell.refused.as_deref().unwrap_or("")) }
            } } }
        }
    }
}

/// Renders one line per cell, comma-separated, with a header; texts in quotation marks.
#[must_use]
pub fn csv(sweep: &Sweep) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:e}"));
    let mut lines: Vec<String> = Vec::with_capacity(sweep.cells.len() + 1);
    let columns =
        "fired,worst_parameter,worst_shift_sigma,radial_max_nmi,noticed_by,delay_s,refused,missed";
    lines.push(
        sweep
            .axes
            .iter()
            .map(|a| quoted(&a.key))
            .chain([columns.to_owned()])
            .collect::<Vec<_>>()
            .join(","),
    );
    for cell in &sweep.cells {
        let at = sweep.axes.iter().zip(&cell.at).map(|(axis, i)| quoted(&axis.values[*i]));
        let rest = [
            cell.fired.to_string(),
            quoted(cell.worst_parameter.as_deref().unwrap_or("")),
            number(cell.worst_shift_sigma),
            number(cell.radial_max_nmi),
            quoted(cell.noticed_by.as_deref().unwrap_or("")),
            number(cell.delay_s),
            quoted(cell.refused.as_deref().unwrap_or("")),
            cell.missed.to_string(),
        ];
        lines.push(at.chain(rest).collect::<Vec<_>>().join(","));
    }
    lines.join("\n") + "\n"
}

/// Renders the sweep for a terminal.
#[must_use]
pub fn text(sweep: &Sweep) -> String {
    let mut out = format!(
        "{}: fault {} ({}), seed {}; largest shift of a parameter in posterior σ\n",
        sweep.scenario, sweep.fault, sweep.kind, sweep.seed
    );
    for (name, cells) in panels(sweep) {
        if !name.is_empty() {
            out += &format!("{name}\n");
        }
        let label = |axis: usize, i: usize| {
            sweep.axes.get(axis).map_or("", |a| a.values[i].as_str()).to_owned()
        };
        let mut row = usize::MAX;
        for cell in cells {
            let i = cell.at.first().copied().unwrap_or(0);
            if i != row {
                row = i;
                out += &format!(
                    "  {} {}\n",
                    sweep.axes.first().map_or("", |a| a.key.as_str()),
                    label(0, i)
                );
            }
            let across = cell.at.get(1).map_or(String::new(), |j| label(1, *j));
            let mark = if cell.missed { "  HARMFUL AND UNNOTICED" } else { "" };
            out += &format!("    {across:<16} {:>10}  {}{mark}\n", value(cell), notice(cell));
        }
    }
    out
}
