//! Angles about a circle, deg.

/// Difference of two angles, within ±180°.
#[must_use]
pub fn difference(angle_deg: f64, from_deg: f64) -> f64 {
    let turned = libm::fmod(angle_deg - from_deg, 360.0);
    if turned > 180.0 {
        turned - 360.0
    } else if turned <= -180.0 {
        turned + 360.0
    } else {
        turned
    }
}

/// An angle as a heading: from 0° to below 360°.
#[must_use]
pub fn heading(angle_deg: f64) -> f64 {
    let turned = libm::fmod(angle_deg, 360.0);
    let turned = if turned < 0.0 { turned + 360.0 } else { turned };
    // A tiny negative angle rounds to 360°.
    if turned >= 360.0 { 0.0 } else { turned }
}

/// Mean of angles within half a turn, as a heading; `None` without one.
///
/// It is the first one and the mean of the differences from it: headings on both sides of north have a mean at north.
#[must_use]
pub fn mean(angles_deg: &[f64]) -> Option<f64> {
    let first = *angles_deg.first()?;
    let sum: f64 = angles_deg.iter().map(|angle| difference(*angle, first)).sum();
    Some(heading(first + sum / angles_deg.len() as f64))
}

/// Width of the band that holds angles within half a turn; `None` without one.
#[must_use]
pub fn band(angles_deg: &[f64]) -> Option<f64> {
    let first = *angles_deg.first()?;
    let (mut least, mut most) = (0.0f64, 0.0f64);
    for angle in angles_deg {
        let from_first = difference(*angle, first);
        (least, most) = (least.min(from_first), most.max(from_first));
    }
    Some(most - least)
}

/// An angle rounded to a multiple of a step, as a heading; as it is with a step of 0.
#[must_use]
pub fn rounded(angle_deg: f64, step_deg: f64) -> f64 {
    let steps = angle_deg / step_deg;
    heading(if step_deg > 0.0 { libm::round(steps) * step_deg } else { angle_deg })
}
