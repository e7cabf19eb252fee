//! Biases against temperature on the page.

use crate::analysis::ChannelAnalysis;
use crate::temperature::TemperatureDependence;
use crate::text::{per_k, steadiness, unit, unit_per_k};
use maud::{Markup, html};
use octant_base::number::{plain, significant};
use octant_report::chart::{Chart, Line, Role};
use octant_scenario::file_names::FileNames;

/// Renders coefficients and plots, or the reason why there are none.
pub(super) fn section(
    found: &TemperatureDependence,
    channels: &[ChannelAnalysis],
    names: &FileNames,
) -> Markup {
    html! {
        @if let Some(reason) = &found.reason { p { "Not told: " (reason) "." } }
        @if !found.channels.is_empty() {
            p.hint { "Bias per kelvin with its interval of 95 %, from " (found.differences) " differences of means over "
                (plain(found.block_s, 4)) " s. An interval alone has zero: the recording shows no coefficient. What a coefficient explains \
                is taken off before deviations, spectra and noise terms." }
            @if let Some(words) = steadiness(found) { p { (words) "." } }
            table {
                thead { tr { th { "Bias per kelvin" } @for axis in ["x", "y", "z"] { th.n { (axis) } } } }
                tbody { @for (triad, fits) in ["gyro", "accelerometer"].iter().zip(found.channels.chunks(3)) {
                    @let (name, size) = unit_per_k(*triad == "gyro");
                    @let of = usize::from(*triad != "gyro");
                    tr { td { (triad) " " span.soft { (name) } } @for (axis, fit) in fits.iter().enumerate() { td.n {
                        (per_k(fit, size))
                        @if let Some(column) = names.column(of, axis) { " " span.soft { (column) } }
                    } } }
                } }
            }
        }
        @if let (Some([low, high]), Some(noise)) = (found.range_c, found.noise_k) {
            p.hint { "Temperatures at rest from " (plain(low, 4)) " to " (plain(high, 4)) " °C; the thermometer's noise in a mean is "
                (significant(noise, 2)) " K. Plots: means without the offset of their stretch; dotted: the coefficient." }
            @for triad in channels.chunks(3) {
                div.multiples { @for channel in triad { (chart(found, channels, channel, names).render()) } }
            }
        }
    }
}

fn chart(
    found: &TemperatureDependence,
    channels: &[ChannelAnalysis],
    channel: &ChannelAnalysis,
    names: &FileNames,
) -> Chart {
    let index = channels.iter().position(|other| other.name == channel.name).unwrap_or(0);
    let is_gyro = index < 3;
    // In the unit of a bias.
    let (name, size) = unit(Some(crate::kernel::RandomTerm::BiasInstability), is_gyro);
    let triad = ["gyro", "accelerometer"][usize::from(!is_gyro)];
    let title = format!("{triad} {}, {name}", names.axis(index / 3, index % 3));
    let mut chart = Chart::new(&title, "temperature, °C", &title);
    (chart.width, chart.height) = (360.0, 230.0);
    (chart.hours, chart.legend, chart.dots) = (false, false, true);
    let mut means: Vec<[f64; 2]> =
        found.means.iter().map(|mean| [mean.temperature_c, mean.residuals[index] / size]).collect();
    means.sort_by(|a, b| a[0].total_cmp(&b[0]));
    if let (Some(per_k), Some(reference), Some(range)) =
        (found.channels.get(index).and_then(|fit| fit.per_k), found.reference_c, found.range_c)
    {
        let points = range.map(|t| [t, per_k * (t - reference) / size]).to_vec();
        chart.lines.push(Line { label: "coefficient".to_owned(), role: Role::Second, points });
    }
    // A gap after each: dots without a line between them.
    let points = means.into_iter().flat_map(|point| [point, [point[0], f64::NAN]]).collect();
    chart.lines.push(Line { label: "means".to_owned(), role: Role::Primary, points });
    chart
}
