//! The HTML page: one file without network access.

use super::analysis::{ChannelAnalysis, SpectrumBand};
use super::fit::variance_of;
use super::kernel::{DifferenceOrder, RandomTerm};
use super::result::Characterisation;
use super::text::{estimate, rate_unit, title, unit};
use maud::{Markup, html};
use octant_base::number::{plain, significant};
use octant_report::chart::{Band, Chart, Line, Role};
use octant_report::inputs::input;
use octant_report::page::{Section, page, sections};
use octant_scenario::file_names::FileNames;

mod temperature;

/// Renders the page; `command` is the one that makes it again.
#[must_use]
pub fn render(result: &Characterisation, command: &str) -> String {
    let all = [
        Section::new("terms", "Noise terms", terms(result)),
        Section::new("allan", "Deviations", deviations(result)),
        Section::new("spectrum", "Spectral density", spectra(result)),
        Section::new("lines", "Spectral lines", lines(result)),
        Section::new("earth", "Earth's rate", earth(result)),
        Section::new(
            "temperature",
            "Temperature",
            temperature::section(
                &result.temperature,
                &result.analysis.channels,
                &result.names_in_file,
            ),
        ),
        Section::new("twin", "Simulated twin", twin(result)),
        Section::new("imu", "Instrument of a scenario", instrument(result)),
        Section::new(
            "provenance",
            "Provenance",
            html! {
                @for account in &result.inputs { (input(account)) }
                table { tbody { tr { td { "octant" } td.mono { (result.octant) } } } }
                p.hint { "The same page again:" }
                code.rerun { (command) }
            },
        ),
    ];
    let body = html! {
        header {
            div.eyebrow { "Instrument at rest" }
            h1 { (result.recording) }
            p.lead { (plain(result.duration_s, 6)) " s at " (plain(result.rate_hz, 6)) " Hz, "
                (plain(result.rest_s, 6)) " s at rest in "
                (octant_base::number::counted(result.analysis.stretches.len() as u64, "stretch", "stretches")) "."
                @if result.gaps > 0 { " Gaps: " (result.gaps) "." }
                @if result.invalid > 0 { " Invalid or saturated samples: " (result.invalid) "." }
                @if let Some(cut) = &result.cut_short { " Cut short: " (cut) "." }
                @if let Some(time) = &result.assumed_time { " The recording has " (time) "." }
            }
        }
        (sections(&all))
    };
    page(&format!("{}: instrument at rest", result.recording), &body)
}

fn triads(result: &Characterisation) -> impl Iterator<Item = (&'static str, &[ChannelAnalysis])> {
    ["Gyro", "Accelerometer"].into_iter().zip(result.analysis.channels.chunks(3))
}

/// Header of a table with a column for each axis of a triad: the body's axis, and the file's name of it.
fn axes(names: &FileNames, triad: usize) -> Markup {
    html! { @for axis in 0..3 { th.n { (names.axis(triad, axis)) } } }
}

fn terms(result: &Characterisation) -> Markup {
    html! {
        p.hint { "Coefficients of IEEE Std 952 with their intervals of 95 %. A term that the recording doesn't show has the \
            upper end of its interval as a limit. A term is shown if the deviance of the fit rises by more than 6.63 without it, the Gauss-Markov \
            term if it lowers it by more than 13.8." }
        @for (triad, channels) in triads(result) {
            @let is_gyro = triad == "Gyro";
            table {
                thead { tr { th { (triad) } (axes(&result.names_in_file, usize::from(!is_gyro))) } }
                tbody {
                    @for term in RandomTerm::ALL {
                        @let (name, size) = unit(Some(term), is_gyro);
                        tr {
                            td { (title(term)) " " span.soft { (name) } }
                            @for channel in channels { td.n {
                                @match channel.noise.as_ref().map(|noise| noise.term(term)) {
                                    None => "not told",
                                    Some(None) => "not seen",
                                    Some(Some(t)) => (estimate(t.value, t.interval, size)),
                                }
                            } }
                        }
                    }
                    tr {
                        td { "correlation time " span.soft { "s" } }
                        @for channel in channels { td.n {
                            @match channel.noise.as_ref().and_then(|noise| noise.correlation_time) {
                                None => "–",
                                Some(t) => (estimate(Some(t.value_s), t.interval_s, 1.0)),
                            }
                        } }
                    }
                    @let (name, size) = unit(None, is_gyro);
                    tr {
                        td { "rate ramp R " span.soft { (name) } }
                        @for channel in channels { td.n {
                            @match channel.ramp { None => "not told", Some(r) => (estimate(r.value, r.interval, size)) }
                        } }
                    }
                    tr {
                        td { "probability of a worse fit" }
                        @for channel in channels { td.n {
                            @match &channel.noise { None => "–", Some(noise) => (significant(noise.probability, 2)) }
                        } }
                    }
                }
            }
        }
    }
}

fn small(title: &str, x_label: &str, y_label: &str) -> Chart {
    let mut chart = Chart::new(title, x_label, y_label);
    (chart.width, chart.height) = (360.0, 230.0);
    (chart.hours, chart.decades, chart.logarithmic, chart.legend) = (false, true, true, false);
    chart
}

fn line(label: &str, role: Role, points: Vec<[f64; 2]>) -> Line {
    Line { label: label.to_owned(), role, points }
}

/// Legend of the small charts below it: that of the channel with most to show.
fn shared_legend(result: &Characterisation, chart: impl Fn(&ChannelAnalysis) -> Chart) -> Markup {
    let charts = result.analysis.channels.iter().map(chart);
    let fullest = charts.max_by_key(|chart| chart.lines.len());
    html! { @if let Some(chart) = fullest { div.chart { div.caption { (chart.keys()) } } } }
}

fn deviations(result: &Characterisation) -> Markup {
    html! {
        p.hint { "Overlapping Allan deviation with its interval of 95 %. Modified Allan and Hadamard deviations are in the JSON." }
        (shared_legend(result, |channel| deviation_chart("", channel, result)))
        @for (triad, channels) in triads(result) {
            div.multiples { @for channel in channels {
                @let title = format!("{triad} {}, {}", axis(result, channel), rate_unit(channel).0);
                (deviation_chart(&title, channel, result).render())
            } }
        }
    }
}

/// Axis of a channel with the file's name.
fn axis(result: &Characterisation, channel: &ChannelAnalysis) -> String {
    let index = result.analysis.channels.iter().position(|other| other.name == channel.name);
    let index = index.unwrap_or_default();
    result.names_in_file.axis(index / 3, index % 3)
}

fn deviation_chart(title: &str, channel: &ChannelAnalysis, result: &Characterisation) -> Chart {
    let mut chart = small(title, "averaging time, s", title);
    let (_, size) = rate_unit(channel);
    chart.dots = true;
    let rows = || {
        channel
            .deviations
            .iter()
            .filter(|row| row.allan.deviation > 0.0 && row.allan.freedom >= 1.0)
    };
    chart.bands.push(Band {
        label: "interval of 95 %".to_owned(),
        role: Role::Primary,
        points: rows()
            .map(|row| {
                let [low, high] = row.allan.interval.map(|deviation| deviation / size);
                [libm::log10(row.tau_s), low, high]
            })
            .collect(),
    });
    let of_twin = result
        .twin
        .iter()
        .flat_map(|twin| &twin.analysis.channels)
        .find(|twin| twin.name == channel.name);
    if let Some(twin) = of_twin {
        let points = twin
            .deviations
            .iter()
            .map(|row| [libm::log10(row.tau_s), row.allan.deviation / size])
            .collect();
        chart.lines.push(line("simulated twin", Role::Reference, points));
    }
    if let Some(noise) = &channel.noise {
        let (kernel, squares) = (noise.kernel(1.0 / result.rate_hz), noise.squares());
        let fitted =
            |tau_s: f64| libm::sqrt(variance_of(&kernel, &squares, DifferenceOrder::Second, tau_s));
        let points = rows().map(|row| [libm::log10(row.tau_s), fitted(row.tau_s) / size]).collect();
        chart.lines.push(line("sum of the terms", Role::Second, points));
    }
    let points = rows().map(|row| [libm::log10(row.tau_s), row.allan.deviation / size]).collect();
    chart.lines.push(line("Allan deviation", Role::Primary, points));
    chart
}

fn spectra(result: &Characterisation) -> Markup {
    html! {
        @if result.analysis.segments == 0 { p { "Not told: no stretch at rest has a whole segment." } }
        @else { p.hint { "Square root of the one-sided density, means over thirds of an octave, "
            (result.analysis.segments) " segments of " (plain(1.0 / result.analysis.bin_hz, 4)) " s." } }
        (shared_legend(result, |channel| spectrum_chart("", channel, result)))
        @for (triad, channels) in triads(result) {
            div.multiples { @for channel in channels {
                @let title = format!("{triad} {}, {}/√Hz", axis(result, channel), rate_unit(channel).0);
                (spectrum_chart(&title, channel, result).render())
            } }
        }
    }
}

fn spectrum_chart(title: &str, channel: &ChannelAnalysis, result: &Characterisation) -> Chart {
    let mut chart = small(title, "frequency, Hz", title);
    let points = |channel: &ChannelAnalysis| {
        let (_, size) = rate_unit(channel);
        let point = |band: &SpectrumBand| [libm::log10(band.frequency_hz), band.density / size];
        channel.spectrum.iter().map(point).collect()
    };
    let of_twin = result
        .twin
        .iter()
        .flat_map(|twin| &twin.analysis.channels)
        .find(|twin| twin.name == channel.name);
    if let Some(twin) = of_twin {
        chart.lines.push(line("simulated twin", Role::Reference, points(twin)));
    }
    chart.lines.push(line("spectral density", Role::Primary, points(channel)));
    chart
}

fn lines(result: &Characterisation) -> Markup {
    let found: Vec<_> = result
        .analysis
        .channels
        .iter()
        .flat_map(|channel| channel.lines.iter().map(move |line| (channel, line)))
        .collect();
    html! {
        @if found.is_empty() && result.analysis.segments > 0 { p { "None, at a probability of a false line of 1 % a channel." } }
        @if !found.is_empty() {
            p.hint { "Noise without lines has one with a probability of 1 % a channel. Amplitudes are those in the samples. A line above \
                half of the sample rate is seen folded." }
            table {
                thead { tr { th { "Channel" } th.n { "Frequency, Hz" } th.n { "Resolution, Hz" } th.n { "Amplitude" } th { "Unit" }
                    th.n { "False alarm" } th { "Mains" } } }
                tbody { @for (channel, line) in found { tr {
                    td { (result.names_in_file.channel(channel.name)) }
                    td.n { (plain(line.frequency_hz, 6)) }
                    td.n { (significant(line.resolution_hz, 2)) }
                    td.n { (significant(line.amplitude / rate_unit(channel).1, 3)) }
                    td { (rate_unit(channel).0) }
                    td.n { (significant(line.false_alarm, 2)) }
                    td { (line.mains.as_deref().unwrap_or("–")) }
                } } }
            }
        }
    }
}

fn earth(result: &Characterisation) -> Markup {
    let check = &result.earth_rate;
    let deg = |rad: f64| format!("{:.3}", rad.to_degrees());
    html! {
        p { (check.attitudes) @if check.attitudes == 1 { " attitude." } @else { " attitudes." }
            @if let Some(reason) = &check.reason { " Latitude not told: " (reason) "." } }
        @if let (Some(latitude), Some([low, high])) = (check.latitude_rad, check.latitude_interval_rad) {
            p { "Latitude from Earth's rate along up: " (deg(latitude)) "°, interval of 95 % from " (deg(low)) "° to " (deg(high)) "°." }
            @if let Some([cosine, sigma]) = check.cosine {
                p { "Rate across up: " (significant(cosine, 4)) " ± " (significant(1.96 * sigma, 2)) " of Earth's, expected "
                    (significant(libm::cos(latitude), 4)) " at this latitude." }
            }
        }
    }
}

fn twin(result: &Characterisation) -> Markup {
    let Some(twin) = &result.twin else { return html! { p { "Not simulated." } } };
    let said = |probability: f64| if probability >= twin.level { "agrees" } else { "differs" };
    html! {
        p.hint { "The plant with the instrument below, seed " (twin.seed) ", over stretches of the same lengths. Each comparison has a level of "
            (plain(100.0 * twin.level, 2)) " % a channel: F tests of the Allan deviations at octaves and of the densities in thirds of an octave, \
            the worst for all together; Kolmogorov and Smirnov's of the increments. A scenario has one value for three axes: axes that differ \
            from each other differ from the twin." }
        table {
            thead { tr { th { "Channel" } th { "Allan deviations" } th.n { "Within intervals" } th.n { "Worst ratio" } th { "Spectrum" }
                th.n { "Worst ratio" } th { "Increments" } th.n { "Distance" } } }
            tbody { @for c in &twin.channels { tr {
                td { (result.names_in_file.channel(c.name)) }
                td { (said(c.allan_probability)) }
                td.n { (c.allan_within) " of " (c.allan_points) }
                td.n { (significant(c.allan_ratio, 3)) }
                td { (said(c.spectrum_probability)) }
                td.n { (significant(c.spectrum_ratio, 3)) }
                td { (said(c.increments_probability)) }
                td.n { (significant(c.increments_distance, 2)) }
            } } }
        }
    }
}

fn instrument(result: &Characterisation) -> Markup {
    html! {
        @if !result.left_out.is_empty() {
            p { "Not in it: " (result.left_out.join("; ")) "." }
        }
        pre { (result.imu) }
    }
}
