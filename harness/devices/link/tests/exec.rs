//! Programs as devices that don't behave: those that close a pipe and live on, that don't read, that shout.

use octant_link::port::{self, Bytes, Port};
use octant_link::{PortError, Uri};
use octant_wire::EndRole;
use std::fs;
use std::path::Path;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Limit that ends a test which hangs.
const PATIENCE: Duration = Duration::from_secs(300);

fn open(script: &Path) -> Box<dyn Bytes> {
    let uri: Uri = format!("exec:sh {}", script.display()).parse().unwrap();
    match port::open(&uri, EndRole::Harness).unwrap() {
        Port::Bytes(port) => port,
        Port::Frames(_) => unreachable!(),
    }
}

/// Starts a shell script as the device, and does something with it on a thread that may hang.
fn with<T: Send + 'static>(
    body: &str,
    act: impl FnOnce(&mut dyn Bytes) -> T + Send + 'static,
) -> T {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("device");
    fs::write(&script, body).unwrap();
    let (done, over) = channel();
    std::thread::spawn(move || {
        let mut port = open(&script);
        let found = act(&mut *port);
        drop(port);
        done.send(found).unwrap();
    });
    over.recv_timeout(PATIENCE).unwrap()
}

fn receives_until_gone(port: &mut dyn Bytes) -> PortError {
    loop {
        if let Err(error) = port.receive(&mut [0; 64], Duration::from_millis(10)) {
            return error;
        }
    }
}

#[test]
fn a_program_that_closes_a_pipe_and_goes_on_is_gone() {
    let gone = with("exec >&-; exec sleep 1000", receives_until_gone);
    assert!(gone.to_string().contains("closed its standard output and goes on"), "{gone}");
    let gone = with("exec <&-; exec sleep 1000", |port| {
        loop {
            if let Err(error) = port.send(b"frame", Duration::from_millis(10)) {
                return error;
            }
        }
    });
    assert!(gone.to_string().contains("closed its standard input and goes on"), "{gone}");
    let gone = with("exit 3", receives_until_gone);
    assert!(gone.to_string().contains("the program ended: exit status: 3"), "{gone}");
}

#[test]
fn a_program_that_does_not_read_holds_up_nothing_and_gets_whole_frames() {
    // It reads only once it sees the file.
    let folder = tempfile::tempdir().unwrap();
    let go = folder.path().join("go");
    let body = format!("while [ ! -e '{}' ]; do sleep 0.01; done; exec cat", go.display());
    let wait = Duration::from_millis(10);
    let (sent, heard) = with(&body, move |port| {
        let mut sent = Vec::new();
        let send = |port: &mut dyn Bytes, sent: &mut Vec<u8>| {
            let frame = [(sent.len() / 1000) as u8; 1000];
            let taken = port.send(&frame, wait).unwrap();
            if taken {
                sent.extend_from_slice(&frame);
            }
            taken
        };
        while send(port, &mut sent) {}
        fs::write(go, "").unwrap();
        let mut heard = Vec::new();
        while heard.len() < sent.len() {
            let mut buffer = [0; 4096];
            let count = port.receive(&mut buffer, wait).unwrap();
            heard.extend_from_slice(&buffer[..count]);
            if count == 0 {
                // The rest of a frame that was taken goes before the next one.
                send(port, &mut sent);
            }
        }
        (sent, heard)
    });
    assert!(sent.len() > 4096 && sent == heard);
}

#[test]
fn the_page_has_the_limits_of_the_program() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/endpoints.md");
    let page = fs::read_to_string(page).unwrap();
    let limit = port::ERROR_OUTPUT;
    let words = format!(
        "{} KiB are shown at once and {} KiB more for each further second",
        limit.bytes >> 10,
        limit.bytes_per_s >> 10
    );
    assert!(page.contains(&words), "{words}");
}
