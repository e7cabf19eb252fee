//! Objects under an address: read, listed and written, with the asynchronous client hidden.

use super::address::{StorageAddress, StoragePlace};
use super::error::StorageError;
use super::layout::BUNDLE;
use futures_util::TryStreamExt;
use futures_util::future::{Either, join_all, select};
use object_store::aws::{AmazonS3, AmazonS3Builder, Checksum};
use object_store::list::{PaginatedListOptions, PaginatedListStore};
use object_store::local::LocalFileSystem;
use object_store::memory::InMemory;
use object_store::path::Path as ObjectPath;
use object_store::{
    BackoffConfig, ClientOptions, Error, ObjectMeta, ObjectStore, ObjectStoreExt, PutMode,
    PutPayload, RetryConfig,
};
use std::collections::{BTreeMap, BTreeSet};
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tokio::runtime::{Builder, Runtime};

/// Variable of the environment with the time for which a request is tried again, s.
pub const RETRY_VARIABLE: &str = "OCTANT_STORAGE_RETRY_S";
/// Time for which a request that fails is tried again.
const RETRY: Duration = Duration::from_secs(180);
/// Longest time of a request: an object of 5 GB at 10 MB/s.
const REQUEST: Duration = Duration::from_secs(500);
/// Longest time in which nothing of an answer comes.
const SILENCE: Duration = Duration::from_secs(30);
/// Longest time in which an object that was written has to be there.
const READ_BACK: Duration = Duration::from_secs(10);
/// Objects that are read at a time.
const AT_A_TIME: usize = 8;

/// Settings of an access.
#[derive(Clone, Copy, Debug)]
pub struct StorageOptions {
    /// Time for which a request is tried again that can't reach the storage, or that the storage refuses for the
    /// moment.
    pub retry: Duration,
    /// Flag that ends reading.
    pub cancel: Option<&'static AtomicBool>,
}

impl StorageOptions {
    /// Returns the settings that the environment asks for: [`RETRY_VARIABLE`].
    ///
    /// # Errors
    /// If the variable is no number of seconds.
    pub fn from_environment(cancel: &'static AtomicBool) -> Result<Self, StorageError> {
        let retry = match std::env::var(RETRY_VARIABLE) {
            Err(_) => RETRY,
            Ok(text) => {
                let seconds = text.trim().parse().ok().filter(|seconds| *seconds >= 0.0);
                let retry = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
                retry.ok_or_else(|| StorageError::Environment {
                    variable: RETRY_VARIABLE,
                    reason: format!("found {text:?}, expected a number of seconds"),
                })?
            }
        };
        Ok(Self { retry, cancel: Some(cancel) })
    }
}

/// Outcome of writing an object that isn't to replace another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PutOutcome {
    /// The object was written.
    New,
    /// An object with the same bytes was there.
    Same,
    /// Another object has the name: its bytes.
    Other(Vec<u8>),
}

/// Objects under an address.
#[derive(Debug)]
pub struct Storage {
    address: StorageAddress,
    store: Arc<dyn ObjectStore>,
    /// The same, where lists come in pages.
    in_pages: Option<AmazonS3>,
    prefix: ObjectPath,
    options: StorageOptions,
    runtime: Runtime,
}

impl Storage {
    /// Opens the storage of an address. Endpoint, region and credentials are those of the `AWS_*` variables of the
    /// environment. Nothing is asked yet.
    ///
    /// # Errors
    /// If the environment describes no storage, or the folder isn't there.
    pub fn open(address: &StorageAddress, options: StorageOptions) -> Result<Self, StorageError> {
        let mut in_pages = None;
        let (store, prefix): (Arc<dyn ObjectStore>, ObjectPath) = match &address.place {
            StoragePlace::S3 { bucket, prefix } => {
                let store = s3(address, bucket, options.retry)?;
                in_pages = Some(store.clone());
                (Arc::new(store), prefix.clone())
            }
            StoragePlace::Folder(folder) => {
                let store = LocalFileSystem::new_with_prefix(folder)
                    .map_err(|_| StorageError::Absent { object: address.of(BUNDLE) })?;
                (Arc::new(store.with_fsync(true)), ObjectPath::default())
            }
        };
        Ok(Self { in_pages, ..Self::with(address, store, prefix, options)? })
    }

    /// Makes a storage in the memory of this process, for tests.
    ///
    /// # Errors
    /// If the operating system refuses the client's thread of events.
    pub fn in_memory() -> Result<Self, StorageError> {
        let address = StorageAddress::parse("s3://memory/campaign")?;
        let prefix = ObjectPath::from("campaign");
        let options = StorageOptions { retry: Duration::ZERO, cancel: None };
        Self::with(&address, Arc::new(InMemory::new()), prefix, options)
    }

    fn with(
        address: &StorageAddress,
        store: Arc<dyn ObjectStore>,
        prefix: ObjectPath,
        options: StorageOptions,
    ) -> Result<Self, StorageError> {
        let runtime = Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| StorageError::Failed {
            action: "open",
            object: address.to_string(),
            reason: error.to_string(),
        })?;
        Ok(Self { address: address.clone(), store, in_pages: None, prefix, options, runtime })
    }

    /// Returns the address.
    #[must_use]
    pub fn address(&self) -> &StorageAddress {
        &self.address
    }

    /// Reads an object; `None` if there is none of this name.
    ///
    /// # Errors
    /// If the storage refuses or can't be reached.
    pub fn get(&self, name: &str) -> Result<Option<Vec<u8>>, StorageError> {
        let path = self.path(name)?;
        self.wait("read", name, true, read(&*self.store, &path))
    }

    /// Reads objects, several at a time, and calls `each` with every one in the order of the names.
    ///
    /// # Errors
    /// If one isn't there, the storage refuses or can't be reached, or `each` fails.
    pub fn get_all(
        &self,
        names: &[String],
        mut each: impl FnMut(&str, Vec<u8>) -> Result<(), StorageError>,
    ) -> Result<(), StorageError> {
        for some in names.chunks(AT_A_TIME) {
            let paths = some.iter().map(|name| self.path(name)).collect::<Result<Vec<_>, _>>()?;
            let all = join_all(paths.iter().map(|path| read(&*self.store, path)));
            let all = self.wait("read", &some[0], true, async { Ok(all.await) })?;
            for (name, found) in some.iter().zip(all) {
                let found = found.map_err(|error| self.failed("read", name, &error))?;
                let absent = || StorageError::Absent { object: self.address.of(name) };
                each(name, found.ok_or_else(absent)?)?;
            }
        }
        Ok(())
    }

    /// Lists the objects whose names begin with a folder, or all with an empty text, with their lengths.
    ///
    /// # Errors
    /// If the storage refuses or can't be reached, or the list doesn't end.
    pub fn list(&self, under: &str) -> Result<BTreeMap<String, u64>, StorageError> {
        let path = self.path(under)?;
        let path = Some(&path).filter(|path| !path.as_ref().is_empty());
        let list = async {
            match &self.in_pages {
                Some(store) => pages(store, path.map(|path| format!("{path}/")).as_deref()).await,
                None => self.store.list(path).try_collect::<Vec<_>>().await.map(Ok),
            }
        };
        let found = self.wait("list", under, true, list)?.map_err(|reason| {
            StorageError::Failed { action: "list", object: self.address.of(under), reason }
        })?;
        let name = |path: &ObjectPath| {
            let rest = path.as_ref().strip_prefix(self.prefix.as_ref())?;
            Some(rest.trim_start_matches('/').to_owned())
        };
        let found = found.iter().filter_map(|meta| Some((name(&meta.location)?, meta.size)));
        Ok(found.collect())
    }

    /// Writes an object, over another of the same name if there is one, and reads it back.
    ///
    /// # Errors
    /// If the storage refuses or can't be reached, or hasn't kept the object.
    pub fn put(&self, name: &str, bytes: Vec<u8>) -> Result<(), StorageError> {
        let path = self.path(name)?;
        let payload = PutPayload::from(bytes.clone());
        let put = async { self.store.put(&path, payload).await };
        self.wait("write", name, false, put)?;
        self.is_kept(name, &path, &bytes)
    }

    /// Writes an object only if there is none of this name, and reads it back: two writers never replace each other's.
    ///
    /// A request whose answer is lost may have written the object: it is tried again, and finds its own bytes.
    ///
    /// # Errors
    /// If the storage refuses or can't be reached, or hasn't kept the object.
    pub fn put_new(&self, name: &str, bytes: &[u8]) -> Result<PutOutcome, StorageError> {
        let path = self.path(name)?;
        let payload = PutPayload::from(bytes.to_vec());
        let begun = Instant::now();
        let mut pause = Duration::from_millis(100);
        loop {
            let put = self.store.put_opts(&path, payload.clone(), PutMode::Create.into());
            let tried = self.runtime.block_on(put);
            let error = match tried {
                Ok(_) => return self.is_kept(name, &path, bytes).map(|()| PutOutcome::New),
                // Some services answer so too while another request for the name is under way.
                Err(error @ Error::AlreadyExists { .. }) => match self.there(name, &path)? {
                    Some(there) if there == bytes => return Ok(PutOutcome::Same),
                    Some(there) => return Ok(PutOutcome::Other(there)),
                    None => error,
                },
                Err(error) => error,
            };
            // The client doesn't repeat a conditional request whose answer was lost.
            let may_pass = matches!(error, Error::Generic { .. } | Error::AlreadyExists { .. });
            if !may_pass || begun.elapsed() >= self.options.retry {
                return Err(self.failed("write", name, &error));
            }
            std::thread::sleep(pause);
            pause = (2 * pause).min(Duration::from_secs(10));
        }
    }

    /// Checks that an object which the storage has confirmed is there with its bytes. A storage of many hosts may have it a
    /// moment later.
    fn is_kept(&self, name: &str, path: &ObjectPath, bytes: &[u8]) -> Result<(), StorageError> {
        let begun = Instant::now();
        let mut pause = Duration::from_millis(100);
        loop {
            let found = self.there(name, path)?;
            if found.as_deref() == Some(bytes) {
                return Ok(());
            }
            if begun.elapsed() >= self.options.retry.min(READ_BACK) {
                let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex();
                let found = found.map_or_else(
                    || "found nothing".to_owned(),
                    |found| format!("found {} bytes with BLAKE3 {}", found.len(), hash(&found)),
                );
                return Err(StorageError::NotKept {
                    object: self.address.of(name),
                    reason: format!(
                        "{found}, expected {} bytes with BLAKE3 {}",
                        bytes.len(),
                        hash(bytes)
                    ),
                });
            }
            std::thread::sleep(pause);
            pause *= 2;
        }
    }

    /// Reads what has a name that is to be written, although an interrupt may have come.
    fn there(&self, name: &str, path: &ObjectPath) -> Result<Option<Vec<u8>>, StorageError> {
        self.wait("read", name, false, read(&*self.store, path))
    }

    /// Returns the path of an object.
    fn path(&self, name: &str) -> Result<ObjectPath, StorageError> {
        let whole = format!("{}/{name}", self.prefix.as_ref());
        ObjectPath::parse(&whole).map_err(|error| StorageError::Form {
            object: self.address.of(name),
            reason: one_line(&error.to_string()),
        })
    }

    /// Waits for a request; for one that only reads an interrupt ends the wait.
    fn wait<T>(
        &self,
        action: &'static str,
        name: &str,
        is_reading: bool,
        request: impl Future<Output = Result<T, Error>>,
    ) -> Result<T, StorageError> {
        let cancel = self.options.cancel.filter(|_| is_reading);
        let interrupted = async {
            while !cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                tokio::time::sleep(Duration::from_millis(50)).await;
            }
        };
        let outcome = self.runtime.block_on(async {
            match select(pin!(request), pin!(interrupted)).await {
                Either::Left((outcome, _)) => Some(outcome),
                Either::Right(_) => None,
            }
        });
        match outcome {
            Some(outcome) => outcome.map_err(|error| self.failed(action, name, &error)),
            None => Err(StorageError::Interrupted { action, object: self.address.of(name) }),
        }
    }

    fn failed(&self, action: &'static str, name: &str, error: &Error) -> StorageError {
        let reason = match error {
            Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => format!(
                "the credentials in the environment don't allow it: {}",
                one_line(&innermost(error))
            ),
            _ => one_line(&error.to_string()),
        };
        StorageError::Failed { action, object: self.address.of(name), reason }
    }
}

async fn read(store: &dyn ObjectStore, path: &ObjectPath) -> Result<Option<Vec<u8>>, Error> {
    match store.get(path).await {
        Ok(found) => Ok(Some(found.bytes().await?.to_vec())),
        Err(Error::NotFound { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Makes the client of an S3-compatible service.
fn s3(address: &StorageAddress, bucket: &str, retry: Duration) -> Result<AmazonS3, StorageError> {
    // If another part of the program has chosen a provider already, that one serves as well.
    let _ = rustls::crypto::ring::default_provider().install_default();
    plain_http("AWS_ENDPOINT_URL_S3")?;
    plain_http("AWS_ENDPOINT_URL")?;
    let is_allowed = variable("AWS_ALLOW_HTTP").is_some_and(|value| is_true(&value));
    let endpoint = variable("AWS_ENDPOINT_URL_S3").or_else(|| variable("AWS_ENDPOINT_URL"));
    let client = ClientOptions::new()
        .with_allow_http(is_allowed)
        // A small container without certificates reaches a service without them.
        .with_no_system_certificates(
            endpoint.is_some_and(|endpoint| endpoint.starts_with("http://")),
        )
        .with_timeout(REQUEST)
        .with_read_timeout(SILENCE)
        .with_connect_timeout(Duration::from_secs(5))
        // Nothing looks after connections between two requests.
        .with_pool_idle_timeout(Duration::from_secs(5));
    let backoff = BackoffConfig {
        init_backoff: Duration::from_millis(100),
        max_backoff: Duration::from_secs(10),
        base: 2.0,
    };
    let retry = RetryConfig { backoff, max_retries: 1000, retry_timeout: retry };
    AmazonS3Builder::from_env()
        .with_bucket_name(bucket)
        .with_client_options(client)
        .with_retry(retry)
        .with_checksum_algorithm(Checksum::SHA256)
        .build()
        .map_err(|error| StorageError::Failed {
            action: "open",
            object: address.to_string(),
            // That of a client without certificates says so at the bottom.
            reason: one_line(&format!("{error}: {}", innermost(&error))),
        })
}

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

fn is_true(value: &str) -> bool {
    matches!(value.to_ascii_lowercase().as_str(), "1" | "true" | "on" | "yes" | "y")
}

/// Refuses an endpoint without encryption that isn't asked for.
fn plain_http(name: &'static str) -> Result<(), StorageError> {
    let Some(endpoint) = variable(name) else { return Ok(()) };
    let is_plain = endpoint.starts_with("http://");
    let is_allowed = variable("AWS_ALLOW_HTTP").is_some_and(|value| is_true(&value));
    if (is_plain && is_allowed) || endpoint.starts_with("https://") {
        return Ok(());
    }
    let reason = if is_plain {
        format!("found {endpoint:?}, expected https://, or AWS_ALLOW_HTTP=true with it")
    } else {
        format!("found {endpoint:?}, expected an address that begins with https://")
    };
    Err(StorageError::Environment { variable: name, reason })
}

/// Words of the cause at the bottom of an error.
fn innermost(error: &dyn std::error::Error) -> String {
    error.source().map_or_else(|| error.to_string(), innermost_of)
}

fn innermost_of(error: &(dyn std::error::Error + 'static)) -> String {
    error.source().map_or_else(|| error.to_string(), innermost_of)
}

/// Puts words of others on one line of at most 400 characters.
fn one_line(words: &str) -> String {
    let line = words.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(400) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}

/// Most objects of a campaign. One worker that uploads every 20 s makes as many in 8 months.
pub(crate) const OBJECTS_MAX: usize = 1_000_000;
/// Most pages of a list. A page has up to 1000 objects.
const PAGES_MAX: usize = 10_000;

/// Reads every page of a list; the inner error says why it doesn't end.
pub(crate) async fn pages(
    store: &AmazonS3,
    prefix: Option<&str>,
) -> Result<Result<Vec<ObjectMeta>, String>, Error> {
    let mut all = Vec::new();
    let mut tokens = BTreeSet::new();
    let mut page_token = None;
    loop {
        let options = PaginatedListOptions { page_token, ..PaginatedListOptions::default() };
        let page = store.list_paginated(prefix, options).await?;
        all.extend(page.result.objects);
        let Some(next) = page.page_token else { return Ok(Ok(all)) };
        if all.len() > OBJECTS_MAX {
            return Ok(Err(format!(
                "found more than {OBJECTS_MAX} objects in the list, expected those of one campaign"
            )));
        }
        if !tokens.insert(next.clone()) {
            return Ok(Err(format!(
                "found a list that leads from page {} back to an earlier one, expected one that ends",
                tokens.len() + 1
            )));
        }
        if tokens.len() >= PAGES_MAX {
            return Ok(Err(format!(
                "found a list of more than {PAGES_MAX} pages, expected one that ends"
            )));
        }
        page_token = Some(next);
    }
}
