//! Power and false alarms of the test whether a navigation followed its samples.
//!
//! `cargo run --release -p octant-followed --example power -- [HONEST [ADAPTIVE [SEED]]]` scores navigations of 4 h at the
//! noise of Table 1, made as [`simulate`] has them, with the function that scores runs, and prints a table.
//! `-- --export FILE` writes one navigation as numbers in rows, for programs that compute the slope themselves.
#![allow(clippy::print_stdout)]

mod simulate;
mod units;

use octant_followed::{Followed, FollowedScore};
use simulate::{Course, scored, trial};
use std::fmt::Write as _;
use units::{ADAPTIVE, GOOD, HONEST, Way, adaptive, honest};

/// Results of one kind of unit.
#[derive(Default)]
struct Tally {
    name: &'static str,
    verdicts: [u64; 3],
    slopes: Vec<f64>,
}

impl Tally {
    fn take(&mut self, way: &Way, score: &FollowedScore) {
        self.name = way.name;
        self.verdicts[score.verdict as usize] += 1;
        let tested = [score.attitude, score.velocity].into_iter().flatten();
        let tested = tested.filter(|channel| channel.verdict != Followed::NotTested);
        self.slopes.extend(tested.map(|channel| channel.slope));
    }

    fn line(&self) -> String {
        let [followed, not_followed, not_tested] = self.verdicts;
        let (low, high) = self
            .slopes
            .iter()
            .fold((f64::NAN, f64::NAN), |(low, high), slope| (slope.min(low), slope.max(high)));
        let trials = followed + not_followed + not_tested;
        let name = self.name;
        format!(
            "| {name} | {trials} | {followed} | {not_followed} | {not_tested} | {low:.3} to {high:.3} |"
        )
    }
}

/// Scores trials, one after the other over the kinds.
fn study(
    course: &Course,
    trials: u64,
    seed: u64,
    kinds: usize,
    unit: fn(usize, u64) -> Way,
) -> Vec<Tally> {
    let mut tallies: Vec<Tally> = (0..kinds).map(|_| Tally::default()).collect();
    for trial in 0..trials {
        let kind = (trial % kinds as u64) as usize;
        let seed = seed.wrapping_mul(1 << 32).wrapping_add(trial);
        let way = unit(kind, seed);
        tallies[kind].take(&way, &scored(course, &way, seed));
    }
    tallies
}

fn table(title: &str, tallies: &[Tally]) {
    println!(
        "\n| {title} | trials | followed | not followed | not tested | slopes |\n|---|---|---|---|---|---|"
    );
    tallies.iter().for_each(|tally| println!("{}", tally.line()));
    let sum = |index: usize| tallies.iter().map(|tally| tally.verdicts[index]).sum::<u64>();
    println!("| all | {} | {} | {} | {} | |", sum(0) + sum(1) + sum(2), sum(0), sum(1), sum(2));
}

/// Writes a navigation as rows: time, truth (attitude), answer (attitude, velocity, latitude, longitude), noise (gyros,
/// accelerometers).
fn rows(course: &Course, way: &Way, seed: u64) -> String {
    let mut text = String::from("t,qw,qx,qy,qz,aw,ax,ay,az,vn,ve,lat,lon,gx,gy,gz,fx,fy,fz\n");
    trial(course, way, seed, |second, line| {
        let a = &line.answer;
        let numbers = line.truth.q_nb.iter().chain(&a.q_nb).chain(&a.velocity_mps[..2]);
        let numbers = numbers.chain([&a.latitude_rad, &a.longitude_rad]);
        let noise = line.noise.delta_theta_rad.iter().chain(&line.noise.delta_velocity_mps);
        text += &second.to_string();
        for number in numbers.chain(noise) {
            // Writing to a String can't fail.
            let _ = write!(text, ",{number:e}");
        }
        text.push('\n');
    });
    text
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let course = Course::new(4.0);
    if let [export, file, more @ ..] = arguments.as_slice()
        && export == "--export"
    {
        let seed = more.first().and_then(|seed| seed.parse().ok()).unwrap_or(1);
        let followed = scored(&course, &GOOD, seed);
        if let Err(error) = std::fs::write(file, rows(&course, &GOOD, seed)) {
            println!("write {file}: {error}");
            std::process::exit(4);
        }
        println!("{}", serde_json::to_string(&followed).unwrap_or_default());
        return;
    }
    let number = |index: usize, default: u64| {
        arguments.get(index).and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let (follows, ignores, seed) = (number(0, 3000), number(1, 1000), number(2, 1));
    println!("seed {seed}, navigations of 4 h at the noise of Table 1");
    table("unit that follows", &study(&course, follows, seed, HONEST, honest));
    table("unit that doesn't", &study(&course, ignores, seed + 1, ADAPTIVE, adaptive));
}
