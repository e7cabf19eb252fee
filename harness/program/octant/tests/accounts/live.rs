//! A unit that sends as the run goes on: SBG over TCP, whole and damaged.

use super::logs::reading;
use super::rest::{RATE_HZ, readings, scenario};
use super::table::{Case, Counts, Ends, Part};
use octant_instruments::{AnyEncoder, Protocol};
use octant_sample::Status;
use std::io::Write;
use std::net::TcpListener;
use std::time::{Duration, Instant};

/// Seconds of a run, and the readings in them.
const SECONDS: u64 = 5;
const COUNT: u64 = SECONDS * RATE_HZ as u64;

/// What a unit sends for one reading: number and frame in, bytes out.
type Sent<'a> = &'a (dyn Fn(u64, &[u8]) -> Vec<u8> + Sync);
/// Stamp of a number and the true time, s.
type Stamps<'a> = &'a (dyn Fn(u64, f64) -> f64 + Sync);

/// Sends readings in real time from the connection on, until the run ends.
fn unit(server: &TcpListener, stamp_s: Stamps<'_>, sent: Sent<'_>, silent_from: u64) {
    let (mut line, _) = server.accept().unwrap();
    let mut encoder = AnyEncoder::new(Protocol::Sbg);
    let begun = Instant::now();
    for (row, k) in readings(RATE_HZ, 4 * COUNT).into_iter().zip(0..) {
        let due = begun + Duration::from_secs_f64(k as f64 / RATE_HZ);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if k >= silent_from {
            continue;
        }
        let stamp_ns = (stamp_s(k, row.time_s) * 1e9).round() as u64;
        let frame = encoder.encode(&reading(&row, stamp_ns, k + 1, Status::empty())).unwrap();
        if line.write_all(&sent(k, frame)).is_err() {
            return;
        }
    }
}

struct Live {
    part: Part,
}

impl Live {
    fn row(
        &mut self,
        holds: &str,
        stamp_s: Stamps<'_>,
        sent: Sent<'_>,
        counts: Counts,
        ends: Ends,
    ) {
        self.until(holds, stamp_s, sent, u64::MAX, counts, ends);
    }

    fn until(
        &mut self,
        holds: &str,
        stamp_s: Stamps<'_>,
        sent: Sent<'_>,
        silent_from: u64,
        counts: Counts,
        ends: Ends,
    ) {
        let server = TcpListener::bind("127.0.0.1:0").unwrap();
        let uri = format!("tcp:{}", server.local_addr().unwrap());
        let live = format!("uri = \"{uri}\"\n[source.live]\nprotocol = \"sbg\"\nsilence = \"2 s\"");
        let scenario = scenario(&live);
        let set = format!("procedure.calibration.duration=\"{SECONDS} s\"");
        let counts: &[_] = if matches!(ends, Ends::Broken(_)) { &[] } else { &[(&*uri, counts)] };
        self.part.hidden = Some((uri.clone(), "tcp:HOST:PORT"));
        std::thread::scope(|scope| {
            scope.spawn(|| unit(&server, stamp_s, sent, silent_from));
            self.part.run(&Case {
                input: "sbg, live",
                holds,
                files: &[("s.toml", scenario.as_bytes())],
                set: &[&set],
                counts,
                ends,
            });
            // The unit's thread ends with the connection, if there was one.
            drop(std::net::TcpStream::connect(server.local_addr().unwrap()));
        });
    }
}

#[test]
fn live_units() {
    let mut live = Live { part: Part::new("live") };
    let used = Counts::used;
    let right = |_: u64, t: f64| t;
    let whole = |_: u64, frame: &[u8]| frame.to_vec();
    let marked = |k: u64| k % 50 == 25;
    live.row("regular", &right, &whole, used(COUNT), Ends::Pass);
    let lost = |k: u64, frame: &[u8]| if marked(k) { Vec::new() } else { frame.to_vec() };
    live.row("one frame in 50 lost", &right, &lost, used(COUNT - 5).missing(5), Ends::Pass);
    let twice = |k: u64, frame: &[u8]| if marked(k) { frame.repeat(2) } else { frame.to_vec() };
    live.row("one frame in 50 twice", &right, &twice, used(COUNT).left_out(5), Ends::Pass);
    let noisy = |k: u64, frame: &[u8]| {
        if marked(k) { [&[0x55; 40], frame].concat() } else { frame.to_vec() }
    };
    live.row("40 bytes of noise before one frame in 50", &right, &noisy, used(COUNT), Ends::Pass);
    let bad = |k: u64, frame: &[u8]| {
        let mut frame = frame.to_vec();
        frame[10] ^= if k == 25 { 4 } else { 0 };
        frame
    };
    live.row("a bit flipped in one frame", &right, &bad, used(COUNT - 1).missing(1), Ends::Pass);
    let restarts = |k: u64, t: f64| if k < 100 { t } else { t - 11.0 };
    live.row(
        "the unit restarts after 2 s",
        &restarts,
        &whole,
        used(100),
        Ends::Broken("the unit was restarted"),
    );
    let slow = |k: u64, t: f64| t + 0.02 * k as f64;
    live.row("stamps of 25 Hz", &slow, &whole, used(0), Ends::Broken("expected 50 Hz"));
    live.until(
        "silent from 2 s on",
        &right,
        &whole,
        100,
        used(100),
        Ends::Broken("no reading for 2 s"),
    );
    live.part.finish(8);
}
