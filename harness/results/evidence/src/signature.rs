//! Signatures of manifests, in the format of minisign (Ed25519 over BLAKE2b), interchangeable with
//! the tool `minisign`.
//!
//! The secret key stays in its owner's file: it is named by the environment, never by a scenario,
//! and no part of it is written.

pub use super::error::SignatureError;
pub use super::files::{SECOND, SIGNATURE as FILE_NAME};
pub use octant_base::child::{KEY, PASSWORD};

use super::files;
use ct_codecs::{Base64, Decoder};
use minisign::{PublicKey, SecretKey, SecretKeyBox, SignatureBox};
use std::path::Path;

/// Untrusted comment of a signature, which no signature covers: it is always this one.
const UNTRUSTED: &str = "signature from octant";
/// Trusted comment that is signed with the manifest.
const TRUSTED: &str = "manifest of an octant evidence folder";

/// Builds the trusted comment that the second person signs with the dispositions: it names campaign
/// and results, so that the signature isn't valid for others.
fn disposed(plan: &str, results_blake3: &str) -> String {
    format!("dispositions of octant campaign {plan} with results {results_blake3}")
}

/// Checks that no other account of this host can read the file of a key.
#[cfg(unix)]
fn refuse_readable(path: &Path) -> Result<(), String> {
    use std::os::unix::fs::PermissionsExt;
    let metadata = std::fs::metadata(path).map_err(|error| error.to_string())?;
    let mode = metadata.permissions().mode() & 0o777;
    if mode & 0o077 == 0 {
        return Ok(());
    }
    Err(format!(
        "others can use it: its mode is {mode:03o}, expected 600 (chmod 600 {})",
        path.display()
    ))
}

#[cfg(not(unix))]
fn refuse_readable(_: &Path) -> Result<(), String> {
    Ok(())
}

/// Signing key.
pub struct SigningKey {
    secret: SecretKey,
}

impl std::fmt::Debug for SigningKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Key({})", self.id())
    }
}

impl SigningKey {
    /// Reads the key that the environment names; `None` if it names none.
    ///
    /// # Errors
    /// If it names one that can't be used.
    pub fn of_environment() -> Result<Option<Self>, SignatureError> {
        let Some(path) = std::env::var_os(KEY).filter(|path| !path.is_empty()) else {
            return Ok(None);
        };
        Self::read(Path::new(&path), std::env::var(PASSWORD).ok()).map(Some)
    }

    /// Reads the secret key from a file that minisign made.
    ///
    /// # Errors
    /// If there is none, others can read it, or the password is wrong.
    pub fn read(path: &Path, password: Option<String>) -> Result<Self, SignatureError> {
        let wrong = |reason: String| SignatureError::Key { path: path.to_owned(), reason };
        refuse_readable(path).map_err(wrong)?;
        let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
        let parsed = || {
            SecretKeyBox::from_string(&text)
                .map_err(|_| wrong("expected a secret key of minisign".to_owned()))
        };
        let secret = match password {
            // With an empty password the library would ask on a terminal.
            Some(password) => parsed()?.into_secret_key(Some(password)),
            None => match unchecked(&text) {
                Some(secret) => Ok(secret),
                None => parsed()?.into_unencrypted_secret_key(),
            },
        };
        let secret = secret.map_err(|error| {
            wrong(format!(
                "{error}; expected a secret key of minisign, and its password, if it has one, in \
                 {PASSWORD}"
            ))
        })?;
        if secret.is_encrypted() {
            return Err(wrong(format!("it is encrypted: its password is expected in {PASSWORD}")));
        }
        Ok(Self { secret })
    }

    /// Returns the id of the key, as minisign shows it.
    #[must_use]
    pub fn id(&self) -> String {
        id_of(self.secret.keynum())
    }

    /// Signs the manifest of a folder.
    ///
    /// # Errors
    /// If the manifest can't be read, or the signature can't be written.
    pub fn sign(&self, manifest: &Path) -> Result<(), SignatureError> {
        self.sign_as(manifest, FILE_NAME, TRUSTED)
    }

    /// Signs the dispositions of a campaign, as the second person.
    ///
    /// # Errors
    /// If this key signed the manifest too, the dispositions can't be read, or the signature can't
    /// be written.
    pub fn sign_dispositions(
        &self,
        dispositions: &Path,
        plan: &str,
        results_blake3: &str,
    ) -> Result<(), SignatureError> {
        let failed =
            |reason: String| SignatureError::Sign { path: dispositions.to_owned(), reason };
        let own = PublicKey::from_secret_key(&self.secret).map_err(|e| failed(e.to_string()))?;
        let manifest = dispositions.with_file_name(files::MANIFEST);
        // Compared by the key itself, not by its id, which its owner can choose.
        if verify(&manifest, &own.to_base64()).is_ok() {
            return Err(failed(format!(
                "key {} signed the manifest too: two persons are two keys",
                self.id()
            )));
        }
        self.sign_as(dispositions, SECOND, &disposed(plan, results_blake3))
    }

    fn sign_as(&self, path: &Path, name: &str, trusted: &str) -> Result<(), SignatureError> {
        let failed = |reason: String| SignatureError::Sign { path: path.to_owned(), reason };
        let bytes = files::read(path).map_err(|error| failed(error.to_string()))?;
        // Verified at once: a damaged key would make invalid signatures.
        let public =
            PublicKey::from_secret_key(&self.secret).map_err(|error| failed(error.to_string()))?;
        let signature = minisign::sign(
            Some(&public),
            &self.secret,
            bytes.as_slice(),
            Some(trusted),
            Some(UNTRUSTED),
        )
        .map_err(|error| failed(error.to_string()))?;
        std::fs::write(path.with_file_name(name), signature.to_string())
            .map_err(|error| failed(error.to_string()))
    }
}

/// Verifies the signature of a manifest with a public key: a file of minisign, or the key itself in
/// base64. Returns the id of the key.
///
/// # Errors
/// If the key isn't valid, or the signature isn't one of this key on this manifest, to the last
/// bit.
pub fn verify(manifest: &Path, key: &str) -> Result<String, SignatureError> {
    verify_as(manifest, FILE_NAME, &public(key)?, TRUSTED)
}

/// Verifies the second person's signature of the dispositions of a campaign, as [`verify`] does
/// that of a manifest.
///
/// # Errors
/// If the key isn't valid or is that of the first person, or the signature isn't one of it on these
/// dispositions of this campaign.
pub fn verify_dispositions(
    dispositions: &Path,
    (plan, results_blake3): (&str, &str),
    first: &str,
    second: &str,
) -> Result<String, SignatureError> {
    let (first, second) = (public(first)?, public(second)?);
    // The key proper follows the algorithm and the id, which its owner can choose.
    let itself = |key: &PublicKey| key.to_bytes().split_off(ID_END);
    if itself(&first) == itself(&second) {
        return Err(SignatureError::Signature {
            path: dispositions.with_file_name(SECOND),
            reason: format!(
                "key {} is that of the manifest too: two persons are two keys",
                id_of(second.keynum())
            ),
        });
    }
    verify_as(dispositions, SECOND, &second, &disposed(plan, results_blake3))
}

/// Bytes of a public key before the key itself: two of the algorithm, eight of the id.
const ID_END: usize = 10;

fn public(key: &str) -> Result<PublicKey, SignatureError> {
    match PublicKey::from_base64(key) {
        Ok(public) => Ok(public),
        Err(_) => PublicKey::from_file(key).map_err(|error| SignatureError::Key {
            path: key.into(),
            reason: format!("{error}; expected a public key of minisign, or its file"),
        }),
    }
}

fn verify_as(
    signed: &Path,
    name: &str,
    public: &PublicKey,
    trusted: &str,
) -> Result<String, SignatureError> {
    let path = signed.with_file_name(name);
    let wrong = |reason: String| SignatureError::Signature { path: path.clone(), reason };
    let text = files::read(&path).map_err(|error| wrong(error.to_string()))?;
    let text = String::from_utf8(text).map_err(|_| wrong("it is no text".to_owned()))?;
    let signature = SignatureBox::from_string(&text)
        .map_err(|error| wrong(format!("{error}; expected a signature of minisign")))?;
    // Base64 has unused bits, and no signature covers the first line, so the exact text is
    // required.
    let known = format!("untrusted comment: {UNTRUSTED}");
    if signature.to_string() != text || text.lines().next() != Some(known.as_str()) {
        return Err(wrong("it was changed: this is not how octant writes it".to_owned()));
    }
    let bytes = files::read(signed).map_err(|error| wrong(error.to_string()))?;
    minisign::verify(public, &signature, std::io::Cursor::new(bytes), true, false, false)
        .map_err(|error| wrong(error.to_string()))?;
    let comment = signature.trusted_comment().unwrap_or_default();
    if comment != trusted {
        return Err(wrong(format!(
            "it was made for something else: found {comment:?}, expected {trusted:?}"
        )));
    }
    Ok(id_of(public.keynum()))
}

/// Reads a key without a password as `minisign -G -W` writes it: its checksum is zero, which the
/// library reports as damage.
fn unchecked(text: &str) -> Option<SecretKey> {
    let bytes = Base64::decode_to_vec(text.lines().nth(1)?.trim(), None).ok()?;
    // Signature algorithm, key derivation and checksum algorithm, two bytes each; the checksum last.
    let (derivation, checksum) = (bytes.get(2..4)?, bytes.get(bytes.len().checked_sub(32)?..)?);
    let plain = derivation == [0; 2] && checksum == [0; 32];
    plain.then(|| SecretKey::from_bytes(&bytes).ok())?
}

/// Renders eight bytes, the last first, as minisign shows them.
fn id_of(number: &[u8]) -> String {
    number.iter().rev().map(|byte| format!("{byte:02X}")).collect()
}
