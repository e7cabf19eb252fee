//! `octant capture`: what an instrument sends, byte for byte.

use crate::arguments::seconds;
use crate::failure::Failure;
use crate::terminal::{note, print};
use clap::Args;
use octant_base::interrupt;
use octant_link::Uri;
use octant_link::capture::{ArrivalStamp, LineCapture};
use octant_link::port::{self, Port};
use octant_verdict::Verdict;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct CaptureArguments {
    #[arg(value_name = "URI", help = octant_link::uri::instrument_help())]
    uri: String,
    /// New file for the bytes.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Ends this long after the first byte; by default at Ctrl-C.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    duration: Option<String>,
    /// Ends as an error when nothing comes for so long; 0: never.
    #[arg(long, value_name = "TIME", default_value = "10 s", allow_negative_numbers = true)]
    silence: String,
    /// Write a TAG block with the time of arrival before each line that begins with $ or !: for sentences without a time.
    #[arg(long)]
    stamp: bool,
}

/// Longest wait in one poll of the port, which bounds the reaction to Ctrl-C.
const WAIT: Duration = Duration::from_millis(50);
/// Longest time on the command line, s.
const TIME_MAX_S: f64 = 1e8;

pub(super) fn command(arguments: &CaptureArguments) -> Result<Verdict, Failure> {
    let CaptureArguments { uri, out, duration, silence, stamp } = arguments;
    let uri: Uri = (uri.parse())
        .map_err(|error| Failure::input(format!("failed to read the port: {error}")))?;
    let time = |name: &str, text: &str| {
        let found = seconds(name, text)?;
        let is_sound = (0.0..=TIME_MAX_S).contains(&found);
        is_sound.then(|| Duration::from_secs_f64(found)).ok_or_else(|| {
            Failure::input(format!("{name}: found {text:?}, expected 0 to {TIME_MAX_S:.0} s"))
        })
    };
    let duration = duration.as_ref().map(|text| time("--duration", text)).transpose()?;
    if duration.is_some_and(|duration| duration.is_zero()) {
        return Err(Failure::input("--duration: found 0 s, expected more"));
    }
    let silence = Some(time("--silence", silence)?).filter(|time| !time.is_zero());
    if matches!(&uri, Uri::Udp(udp) if udp.secret.is_some()) {
        let message =
            format!("found {uri}, expected no secret: an instrument's datagrams have no seal");
        return Err(Failure::input(message));
    }
    let Port::Bytes(port) = port::open_instrument(&uri)
        .map_err(|error| Failure::bench(format!("failed to {error}")))?
    else {
        return Err(Failure::input(format!("found {uri}, expected a serial line, UDP or TCP")));
    };
    let stamp = stamp.then_some(ArrivalStamp::TagBlock);
    let mut capture = LineCapture::new(port, out, stamp).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::input(format!(
            "{}: found a file, expected a new name: what was captured is never overwritten",
            out.display()
        )),
        _ => Failure::bench(format!("failed to create {}: {error}", out.display())),
    })?;
    interrupt::watch(|| {})
        .map_err(|error| Failure::bench(format!("failed to wait for Ctrl-C: {error}")))?;
    let does =
        if matches!(&uri, Uri::Tcp(tcp) if !tcp.listen) { "connected to" } else { "listening on" };
    note!("octant: {does} {}", capture.reached_at());
    let ended = receive(&mut capture, duration, silence);
    capture
        .write()
        .map_err(|error| Failure::bench(format!("failed to write {}: {error}", out.display())))?;
    print(&summary(&capture))?;
    ended
}

/// Takes what comes until the end.
fn receive(
    capture: &mut LineCapture,
    duration: Option<Duration>,
    silence: Option<Duration>,
) -> Result<Verdict, Failure> {
    let unwritten = |path: &Path, error: &std::io::Error| {
        Failure::bench(format!("failed to write {}: {error}", path.display()))
    };
    loop {
        if let Err(error) = capture.receive(WAIT) {
            return Err(Failure::bench(format!("{error}; {}", kept(capture))));
        }
        capture.write_if_due().map_err(|error| unwritten(capture.path(), &error))?;
        if let (Some(first), Some(duration)) = (capture.first(), duration)
            && first.elapsed() >= duration
        {
            return Ok(Verdict::Pass);
        }
        if interrupt::seen() {
            // Without a duration that is how it ends.
            let is_whole = duration.is_none() && capture.counts().bytes > 0;
            return Ok(if is_whole { Verdict::Pass } else { Verdict::Inconclusive });
        }
        let silent = capture.silent_for();
        if silence.is_some_and(|silence| silent >= silence) {
            return Err(Failure::bench(format!(
                "nothing came for {:.1} s; {}",
                silent.as_secs_f64(),
                kept(capture)
            )));
        }
    }
}

fn kept(capture: &LineCapture) -> String {
    format!("{} bytes are kept in {}", capture.counts().bytes, capture.path().display())
}

fn summary(capture: &LineCapture) -> String {
    let (path, counts) = (capture.path().display(), capture.counts());
    if counts.bytes == 0 {
        return format!("{path}: nothing came\n");
    }
    format!(
        "{path}: {} bytes in {:.1} s, longest silence {:.2} s\n",
        counts.bytes,
        counts.lasted.as_secs_f64(),
        counts.longest_silence.as_secs_f64()
    )
}
