//! Numbers of a drawing: ticks, rounding, thinning to extremes.

/// Keeps the extremes of every pixel column: at most four points for each.
pub fn thinned(points: &[[f64; 2]], columns: usize) -> Vec<[f64; 2]> {
    if points.len() <= 3 * columns.max(1) {
        return points.to_vec();
    }
    let chunk = points.len().div_ceil(columns.max(1));
    let mut kept = Vec::with_capacity(4 * columns);
    for part in points.chunks(chunk) {
        let mut indices = [0, 0, 0, part.len() - 1];
        for (i, point) in part.iter().enumerate() {
            if point[1] < part[indices[1]][1] {
                indices[1] = i;
            }
            if point[1] > part[indices[2]][1] {
                indices[2] = i;
            }
        }
        indices.sort_unstable();
        let mut last = None;
        for i in indices {
            if last != Some(i) {
                kept.push(part[i]);
                last = Some(i);
            }
        }
    }
    kept
}

/// Rounds to a tenth of a pixel, which is enough and keeps the file small.
pub fn round(px: f64) -> f64 {
    libm::round(px * 10.0) / 10.0
}

/// Returns whether a number is a whole multiple of a step.
pub fn multiples_of(number: f64, step: f64) -> bool {
    let ratio = number / step;
    (ratio - libm::round(ratio)).abs() < 1e-6
}

pub(super) fn is_round(step: f64) -> bool {
    let mantissa = step / libm::pow(10.0, libm::floor(libm::log10(step) + 1e-9));
    (mantissa - libm::round(mantissa)).abs() < 1e-6
}

/// Smallest and largest of some values; `None` of no values.
pub fn span(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range, v| {
        Some(range.map_or([v, v], |[low, high]: [f64; 2]| [low.min(v), high.max(v)]))
    })
}

/// Chooses multiples of 1, 2 or 5 times a power of ten within the range, about `count` of them.
pub fn nice_ticks(range: [f64; 2], count: u32, step: Option<f64>) -> Vec<f64> {
    let raw = (range[1] - range[0]) / f64::from(count);
    let power = libm::pow(10.0, libm::floor(libm::log10(raw)));
    let nice = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|m| m * power >= raw).unwrap_or(10.0);
    multiples(range, step.unwrap_or(nice * power))
}

/// Chooses whole numbers as ticks of an axis that counts.
pub(super) fn whole_ticks(range: [f64; 2]) -> Vec<f64> {
    let raw = (range[1] - range[0]) / 10.0;
    let step = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]
        .into_iter()
        .find(|step| *step >= raw)
        .unwrap_or(libm::ceil(raw));
    multiples(range, step)
}

/// Chooses ticks of an axis in hours.
pub fn hour_ticks(range: [f64; 2], count: f64) -> Vec<f64> {
    let raw = (range[1] - range[0]) / count;
    let step = [1.0 / 6.0, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 48.0, 96.0]
        .into_iter()
        .find(|step| *step >= raw)
        .unwrap_or(raw);
    multiples(range, step)
}

fn multiples(range: [f64; 2], step: f64) -> Vec<f64> {
    let first = libm::ceil(range[0] / step - 1e-9);
    let count = libm::floor(range[1] / step + 1e-9) - first;
    if !(0.0..=200.0).contains(&count) {
        return Vec::new();
    }
    (0..=count as u32).map(|k| (first + f64::from(k)) * step + 0.0).collect()
}

/// Chooses whole decades around a range, with one tick each.
pub fn decades(range: [f64; 2]) -> ([f64; 2], Vec<f64>) {
    let low = libm::floor(libm::log10(range[0]) + 1e-9);
    let high = libm::ceil(libm::log10(range[1]) - 1e-9).max(low + 1.0);
    let ticks = (0..=(high - low) as u32).map(|k| libm::pow(10.0, low + f64::from(k))).collect();
    ([libm::pow(10.0, low), libm::pow(10.0, high)], ticks)
}

/// Chooses the exponents of the powers of ten within a range of exponents.
pub fn exponents(range: [f64; 2]) -> Vec<f64> {
    multiples(range, 1.0)
}
