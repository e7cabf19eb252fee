//! Object storage that confirms what it doesn't keep, and lists that never end.

use crate::common::program::{ended, octant_in, program};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::Output;
use std::sync::{Arc, Mutex, PoisonError};
use tempfile::TempDir;

/// Peculiarities of a service. Each is what a broken gateway, cache or disk behind a real one does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Service {
    /// Keeps what it confirms.
    Honest,
    /// Confirms, and keeps nothing of what isn't the bundle.
    Forgets,
    /// Confirms, and keeps all but the last byte.
    Cuts,
    /// Lists one page for ever, with the same token.
    SameToken,
    /// Lists empty pages for ever, with two tokens in turn.
    TwoTokens,
}

type Objects = Arc<Mutex<BTreeMap<String, Vec<u8>>>>;

/// A service of S3 on a port of this host.
struct Server {
    port: u16,
    objects: Objects,
}

impl Server {
    fn start(service: Service) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let objects = Objects::default();
        let kept = Arc::clone(&objects);
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let kept = Arc::clone(&kept);
                std::thread::spawn(move || while answer(&stream, service, &kept).is_some() {});
            }
        });
        Self { port, objects }
    }

    /// Runs the program with this service in its environment.
    fn says(&self, folder: &Path, arguments: &[&str]) -> Output {
        let mut command = program(arguments);
        command
            .current_dir(folder)
            .env("TMPDIR", folder)
            .env("AWS_ENDPOINT_URL", format!("http://127.0.0.1:{}", self.port))
            .env("NO_PROXY", "127.0.0.1")
            .env("OCTANT_STORAGE_RETRY_S", "0");
        for (name, value) in [
            ("AWS_ALLOW_HTTP", "true"),
            ("AWS_REGION", "us-east-1"),
            ("AWS_ACCESS_KEY_ID", "test"),
            ("AWS_SECRET_ACCESS_KEY", "secret"),
        ] {
            command.env(name, value);
        }
        command.output().unwrap()
    }

    fn names(&self) -> Vec<String> {
        self.objects.lock().unwrap_or_else(PoisonError::into_inner).keys().cloned().collect()
    }
}

/// Answers one request; `None`: the connection is closed.
fn answer(stream: &TcpStream, service: Service, objects: &Objects) -> Option<()> {
    let mut reader = BufReader::new(stream.try_clone().ok()?);
    let mut first = String::new();
    reader.read_line(&mut first).ok().filter(|bytes| *bytes > 0)?;
    let mut words = first.split(' ');
    let (method, path) = (words.next()?.to_owned(), words.next()?.to_owned());
    let (mut length, mut is_new) = (0, false);
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).ok().filter(|bytes| *bytes > 0)?;
        let Some((name, value)) = line.trim().split_once(": ") else { break };
        match name.to_ascii_lowercase().as_str() {
            "content-length" => length = value.parse().ok()?,
            "if-none-match" => is_new = true,
            _ => {}
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    let mut all = objects.lock().unwrap_or_else(PoisonError::into_inner);
    let (name, query) = path.split_once('?').unwrap_or((&path, ""));
    let (status, content) = match method.as_str() {
        "PUT" if is_new && all.contains_key(name) => ("412 Precondition Failed", Vec::new()),
        "PUT" => {
            let is_bundle = name.ends_with("bundle.zip");
            if service == Service::Cuts && !is_bundle {
                body.pop();
            }
            if service != Service::Forgets || is_bundle {
                all.insert(name.to_owned(), body);
            }
            ("200 OK", Vec::new())
        }
        "GET" if query.contains("list-type") => ("200 OK", listed(service, query, &all)),
        "GET" => match all.get(name) {
            Some(bytes) => ("200 OK", bytes.clone()),
            None => ("404 Not Found", b"<Error><Code>NoSuchKey</Code></Error>".to_vec()),
        },
        _ => ("501 Not Implemented", Vec::new()),
    };
    drop(all);
    let head = format!(
        "HTTP/1.1 {status}\r\ncontent-length: {}\r\netag: \"0\"\r\n\
         last-modified: Thu, 01 Jan 2026 00:00:00 GMT\r\n\r\n",
        content.len()
    );
    let mut to = stream;
    to.write_all(head.as_bytes()).and_then(|()| to.write_all(&content)).ok()
}

fn listed(service: Service, query: &str, all: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
    let next = match service {
        Service::SameToken => Some("again"),
        Service::TwoTokens if query.contains("continuation-token=one") => Some("two"),
        Service::TwoTokens => Some("one"),
        _ => None,
    };
    let mut text = "<ListBucketResult>".to_owned();
    if let Some(next) = next {
        text += &format!("<NextContinuationToken>{next}</NextContinuationToken>");
    }
    text += &format!("<IsTruncated>{}</IsTruncated>", next.is_some());
    for (name, bytes) in all.iter().filter(|_| service != Service::TwoTokens) {
        let key = name.trim_start_matches("/bucket/");
        text += &format!(
            "<Contents><Key>{key}</Key><Size>{}</Size><ETag>0</ETag>\
             <LastModified>2026-01-01T00:00:00.000Z</LastModified></Contents>",
            bytes.len()
        );
    }
    (text + "</ListBucketResult>").into_bytes()
}

const SCENARIO: &str = "schema = 1\ntitle = \"short\"\n[procedure.calibration]\nduration = \"20 s\"\n\
    stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]\n\
    [procedure.navigation]\nduration = \"5 s\"\n";
const CAMPAIGN: &str = "schema = 1\ntitle = \"stored\"\nreplicates = 2\n[[scenarios]]\nid = \"short\"\n\
    file = \"short.toml\"\n";
const ADDRESS: &str = "s3://bucket/campaign";

/// A campaign on a service.
fn stored(service: Service) -> (TempDir, Server) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.toml"), SCENARIO).unwrap();
    std::fs::write(folder.path().join("campaign.toml"), CAMPAIGN).unwrap();
    let plan = ["campaign", "plan", "campaign.toml", "--out", "alone"];
    ended(octant_in(folder.path(), &plan), 0);
    let server = Server::start(service);
    ended(server.says(folder.path(), &["campaign", "bundle", "alone", "--out", ADDRESS]), 0);
    (folder, server)
}

#[test]
fn results_that_the_storage_forgets_or_cuts_stay_here_and_are_no_success() {
    for (service, found) in
        [(Service::Forgets, "found nothing, expected"), (Service::Cuts, "bytes with BLAKE3")]
    {
        let (folder, server) = stored(service);
        let (_, error) = ended(server.says(folder.path(), &["campaign", "run", ADDRESS]), 4);
        assert!(error.contains("the storage confirmed it, and reading it back found"), "{error}");
        assert!(error.contains(found) && error.contains(".octres"), "{error}");
        // The folder that it names resumes, and no case is run again.
        let work = error.split("--work ").nth(1).unwrap().split(" goes on").next().unwrap();
        let honest = Server::start(Service::Honest);
        ended(honest.says(folder.path(), &["campaign", "bundle", "alone", "--out", ADDRESS]), 0);
        let run = honest.says(folder.path(), &["campaign", "run", ADDRESS, "--work", work]);
        let (text, error) = ended(run, 3);
        assert!(text.contains("0 cases run, 2 with a result already"), "{text}{error}");
        assert_eq!(honest.names().len(), 2, "{:?}", honest.names());
    }
}

#[test]
fn tables_that_the_storage_forgets_are_named_where_they_are() {
    let (folder, server) = stored(Service::Honest);
    ended(server.says(folder.path(), &["campaign", "run", ADDRESS]), 3);
    let forgets = Server::start(Service::Forgets);
    *forgets.objects.lock().unwrap() = server.objects.lock().unwrap().clone();
    let (_, error) = ended(forgets.says(folder.path(), &["campaign", "merge", ADDRESS]), 4);
    assert!(error.contains("reading it back found nothing"), "{error}");
    let kept = error.trim().split("its files are in ").nth(1).unwrap();
    assert!(Path::new(kept).join("cases.parquet").is_file(), "{error}");
}

#[test]
fn a_list_that_never_ends_is_an_error() {
    for service in [Service::SameToken, Service::TwoTokens] {
        let (folder, server) = stored(service);
        let (_, error) = ended(server.says(folder.path(), &["campaign", "status", ADDRESS]), 4);
        assert!(error.contains("failed to list s3://bucket/campaign/results"), "{error}");
        assert!(error.contains("back to an earlier one, expected one that ends"), "{error}");
    }
}
