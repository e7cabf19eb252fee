//! Coverage of the intervals over streams of known noise.

use crate::synthetic::{Coefficients, stream};
use octant_characterise::deviations::Deviations;
use octant_characterise::fit::{NoiseFit, NoiseFitter};

const DT: f64 = 0.01;

/// Fits of six channels of a stream.
fn fits(fitter: &mut NoiseFitter, seed: u64, of: &Coefficients, samples: u64) -> Vec<NoiseFit> {
    let mut deviations = Deviations::new(DT);
    stream(seed, of, DT, samples, |rate| deviations.push(rate));
    deviations.end_stretch();
    let all = deviations.variances();
    let octaves: Vec<_> =
        all.iter().filter(|v| v.samples.is_power_of_two() && v.hadamard.is_some()).collect();
    assert_eq!(octaves.iter().map(|v| v.samples).collect::<Vec<_>>(), fitter.octaves());
    (0..6)
        .filter_map(|c| {
            fitter.fit(&octaves.iter().map(|v| v.hadamard.unwrap()[c]).collect::<Vec<_>>())
        })
        .collect()
}

/// Counts by term: streams that show it, those whose interval or limit has the truth.
fn counted(
    name: &str,
    of: &Coefficients,
    (streams, samples): (u64, u64),
) -> Vec<(&'static str, usize, usize, usize)> {
    let mut fitter = NoiseFitter::new(DT, &[samples]);
    let truths = [
        ("quantization", of.quantization),
        ("random_walk", of.random_walk),
        ("bias_instability", of.bias_instability),
        ("rate_random_walk", of.rate_random_walk),
        ("gauss_markov", of.gauss_markov.map_or(0.0, |(sigma, _)| sigma)),
    ];
    let mut all: Vec<NoiseFit> = Vec::new();
    for seed in 0..streams.div_ceil(6) {
        all.extend(fits(&mut fitter, 1000 + seed, of, samples));
    }
    let mut counts = Vec::new();
    for (term, truth) in truths {
        let found: Vec<_> =
            all.iter().filter_map(|fit| fit.terms.iter().find(|t| t.term.name() == term)).collect();
        let shown = found.iter().filter(|t| t.value.is_some()).count();
        let covered =
            found.iter().filter(|t| t.interval[0] <= truth && truth <= t.interval[1]).count();
        println!(
            "{name} {term}: shown {shown} of {}, covered {covered} of {}",
            all.len(),
            found.len()
        );
        counts.push((term, shown, covered, found.len()));
    }
    if let Some((_, time_s)) = of.gauss_markov {
        let times: Vec<_> = all.iter().filter_map(|fit| fit.correlation_time).collect();
        let covered =
            times.iter().filter(|t| t.interval_s[0] <= time_s && time_s <= t.interval_s[1]).count();
        println!("{name} correlation time: covered {covered} of {}", times.len());
        counts.push(("correlation_time", times.len(), covered, times.len()));
    }
    let poor = all.iter().filter(|fit| fit.probability < 0.01).count();
    println!("{name} misfits below 1 %: {poor} of {}", all.len());
    counts
}

fn instruments() -> Vec<(&'static str, Coefficients)> {
    let none = Coefficients::default();
    vec![
        ("white", Coefficients { random_walk: 3e-5, ..none }),
        ("white and counts", Coefficients { random_walk: 3e-5, quantization: 5e-6, ..none }),
        ("white and walk", Coefficients { random_walk: 3e-5, rate_random_walk: 3e-5, ..none }),
        ("white and flicker", Coefficients { random_walk: 3e-5, bias_instability: 4e-5, ..none }),
        (
            "all",
            Coefficients {
                random_walk: 3e-5,
                quantization: 5e-6,
                bias_instability: 4e-5,
                rate_random_walk: 3e-5,
                ..none
            },
        ),
        (
            "white and Gauss-Markov",
            Coefficients { random_walk: 3e-5, gauss_markov: Some((5e-5, 3.0)), ..none },
        ),
    ]
}

#[test]
fn intervals_cover_in_a_short_version() {
    for (name, of) in instruments() {
        counted(name, &of, (std::env::var("STREAMS").map_or(60, |n| n.parse().unwrap()), 1 << 15));
    }
}
