//! Condition of a heading test, as a certificate names it.

use super::motion::{DocksideSpec, MOTIONS, MotionSpec};
use super::scenario::Scenario;
use super::source::SourceSpec;
use crate::trajectory::SolutionReference;
use octant_base::number;

/// Condition of a heading test: place, mean heading and motion of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadingCondition {
    /// Latitude of the site, deg.
    pub latitude_deg: f64,
    /// Mean heading of the case in words: `heading 40°`; of a solution that of its reference.
    pub heading: String,
    /// Motion: `at rest`, or its angles and periods with their time.
    pub motion: String,
}

impl HeadingCondition {
    /// Condition of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            latitude_deg: scenario.site.latitude_rad.to_degrees(),
            heading: heading_words(scenario),
            motion: match &scenario.motion {
                MotionSpec::Static(_) => "at rest".to_owned(),
                MotionSpec::Dockside(ship) => motion_words(ship),
            },
        }
    }

    /// Text `latitude 45°, heading 40°, at rest`.
    #[must_use]
    pub fn words(&self) -> String {
        let degrees = |angle: f64| number::plain(angle, 6);
        format!("latitude {}°, {}, {}", degrees(self.latitude_deg), self.heading, self.motion)
    }
}

/// Text `heading 40°`, `heading 0°, 90°, 180°, 270°` of run-ups on a table, or where it comes from.
fn heading_words(scenario: &Scenario) -> String {
    let degrees = |rad: f64| format!("{}°", number::plain(rad.to_degrees().rem_euclid(360.0), 6));
    let SourceSpec::Solution(spec) = &scenario.source else {
        return format!(
            "heading {}°",
            number::plain(scenario.motion.heading_rad().to_degrees(), 6)
        );
    };
    match &spec.reference {
        SolutionReference::File(_) => "heading of the reference".to_owned(),
        SolutionReference::Unknown => "no true heading".to_owned(),
        SolutionReference::Heading { heading_rad, .. } => {
            let azimuths = &spec.run_ups.azimuths_rad;
            let turned = azimuths.iter().map(|azimuth_rad| degrees(heading_rad + azimuth_rad));
            let all: Vec<String> =
                if azimuths.is_empty() { vec![degrees(*heading_rad)] } else { turned.collect() };
            format!("heading {}", all.join(", "))
        }
    }
}

/// Text `roll 5°/15 s, pitch 5°/6 s, from 0 h for 6 h`: turns of a table alone.
fn motion_words(ship: &DocksideSpec) -> String {
    let turns = MOTIONS.iter().zip(&ship.components).take(3);
    let mut words: Vec<String> = turns
        .flat_map(|(name, components)| {
            components.iter().map(move |one| {
                let amplitude = number::plain(one.amplitude.to_degrees(), 4);
                format!("{name} {amplitude}°/{} s", number::plain(one.period_s, 4))
            })
        })
        .collect();
    if ship.spectrum.is_some() {
        words.push("spectrum of a ship".to_owned());
    }
    if words.is_empty() {
        return "no turn".to_owned();
    }
    let hours = |time_s: f64| number::plain(time_s / 3600.0, 3);
    if let Some(span) = &ship.span {
        let lasts =
            span.duration_s.map_or_else(String::new, |full_s| format!(" for {} h", hours(full_s)));
        words.push(format!("from {} h{lasts}", hours(span.from_s)));
    }
    words.join(", ")
}
