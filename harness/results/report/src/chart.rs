//! Line charts as inline SVG. Colours are classes of the page's style sheet, so that a chart adapts
//! to light, dark and print; without the style sheet only the colour is lost.
//!
//! The drawing is complete without a script. Beside it stand the numbers themselves, from which the
//! page's script draws the chart again for the reader's width and the range of interest.

mod frame;
mod model;
mod numbers;
mod ticks;

pub use model::{Band, Chart, Line, Role};
pub use numbers::{base64, text as json_text};
pub use ticks::{decades, exponents, hour_ticks, multiples_of, nice_ticks, round, span, thinned};

use frame::Frame;
use maud::{Markup, PreEscaped, html};

impl Chart {
    /// Renders the chart as HTML: legend and SVG. A chart without points says so.
    #[must_use]
    pub fn render(&self) -> Markup {
        let Some(frame) = Frame::of(self) else {
            return html! { p.empty { (self.title) ": no data" } };
        };
        html! {
            div.chart {
                div.caption {
                    span.ylabel { (self.y_label) }
                    @if self.legend { (self.keys()) }
                }
                svg viewBox={ "0 0 " (self.width) " " (self.height) } role="img"
                    aria-label=(self.title) {
                    (frame.grid(self))
                    @for band in &self.bands {
                        path class={ "band " (band.role.class()) } d=(frame.area(band)) {}
                    }
                    @for (value, label) in &self.levels { (frame.level(*value, label)) }
                    @if self.paired { (frame.pairs(&self.lines)) } @else {
                        @for line in &self.lines {
                            path class={ "line " (line.role.class()) } d=(frame.path(&line.points)) {}
                            @if self.dots && line.role.has_dots() { (frame.dots(line)) }
                        }
                    }
                    @if let Some((length, label)) = &self.bracket { (frame.bracket(*length, label)) }
                }
                @if !self.paired {
                    script type="application/json" { (PreEscaped(numbers::numbers(self))) }
                }
            }
        }
    }

    /// Renders the legend alone, for small charts that share one.
    #[must_use]
    pub fn keys(&self) -> Markup {
        // The main line is drawn last, on top, and named first.
        html! {
            span.legend {
                @for line in self.lines.iter().rev() {
                    span.key {
                        svg.swatch viewBox="0 0 24 8" aria-hidden="true" {
                            @if self.paired { circle class={ "dot " (line.role.class()) } cx="12" cy="4" r="4" {} }
                            @else { path class={ "line " (line.role.class()) } d="M1 4H23" {} }
                        }
                        (line.label)
                    }
                }
                @for band in &self.bands {
                    span.key {
                        svg.swatch viewBox="0 0 24 8" aria-hidden="true" {
                            path class={ "band " (band.role.class()) } d="M1 0H23V8H1Z" {}
                        }
                        (band.label)
                    }
                }
            }
        }
    }
}
