//! Signatures of manifests.

use minisign::KeyPair;
use octant_evidence::signature::{FILE_NAME, SigningKey, verify};
use std::path::Path;

/// Makes a folder with a signed manifest, and returns the public key.
fn signed() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let pair = KeyPair::generate_unencrypted_keypair().unwrap();
    let path = folder.path().join("key");
    make_private(&path);
    std::fs::write(&path, pair.sk.to_box(None).unwrap().to_string()).unwrap();
    let key = SigningKey::read(&path, None).unwrap();
    let manifest = folder.path().join("manifest.json");
    std::fs::write(&manifest, "{\"schema\": 1}\n").unwrap();
    key.sign(&manifest).unwrap();
    let public = pair.pk.to_base64();
    assert_eq!(verify(&manifest, &public).unwrap(), key.id());
    (folder, public)
}

#[test]
fn every_bit_of_manifest_and_signature_counts() {
    let (folder, public) = signed();
    let manifest = folder.path().join("manifest.json");
    for name in ["manifest.json", FILE_NAME] {
        let path = folder.path().join(name);
        let whole = std::fs::read(&path).unwrap();
        for bit in 0..8 * whole.len() {
            let mut changed = whole.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, &changed).unwrap();
            assert!(verify(&manifest, &public).is_err(), "bit {bit} of {name}");
        }
        std::fs::write(&path, &whole).unwrap();
        assert!(verify(&manifest, &public).is_ok());
    }
}

/// The key was made by minisign 0.11 with `-G -W`, for this test alone.
#[test]
fn a_key_of_the_stock_tool_without_a_password_signs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("key");
    make_private(&path);
    let secret = "untrusted comment: minisign encrypted secret key\nRWQAAEIyAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAGGJejVhEWMtXozaAVo8D+2wN2PE7YWyElsXM4PcvXS1lbGnvT2wBClem2MIozcVtChEQeclEDPNjZCh+b3hwAwE7eVEg1H7jAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\n";
    std::fs::write(&path, secret).unwrap();
    let key = SigningKey::read(&path, None).unwrap();
    assert_eq!(key.id(), "CB5844588D5E6218");
    let manifest = folder.path().join("manifest.json");
    std::fs::write(&manifest, "{}\n").unwrap();
    key.sign(&manifest).unwrap();
    assert_eq!(
        verify(&manifest, "RWQYYl6NWERYy1em2MIozcVtChEQeclEDPNjZCh+b3hwAwE7eVEg1H7j").unwrap(),
        key.id()
    );
    // A damaged key is refused before it signs anything.
    let mut lines = secret.lines();
    let damaged = format!(
        "{}\n{}\n",
        lines.next().unwrap(),
        lines.next().unwrap().replacen("YWyElsXM", "MXslEyWY", 1)
    );
    std::fs::write(&path, damaged).unwrap();
    let error = SigningKey::read(&path, None).unwrap().sign(&manifest).unwrap_err().to_string();
    assert!(error.starts_with("sign "), "{error}");
}

#[test]
fn another_key_and_no_key_are_told() {
    let (folder, _) = signed();
    let manifest = folder.path().join("manifest.json");
    let other = KeyPair::generate_unencrypted_keypair().unwrap().pk.to_base64();
    let error = verify(&manifest, &other).unwrap_err().to_string();
    assert!(error.contains("different from public key"), "{error}");
    let error = verify(&manifest, "no/such/file").unwrap_err().to_string();
    assert!(error.starts_with("read the key no/such/file"), "{error}");
    let none = folder.path().join("none");
    make_private(&none);
    let error = SigningKey::read(&none, None).unwrap_err().to_string();
    assert!(error.contains("expected a secret key of minisign"), "{error}");
}

/// Makes a file that only its owner can use.
fn make_private(path: &Path) {
    let mut options = std::fs::File::options();
    options.create(true).truncate(true).write(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path).unwrap();
}

#[cfg(unix)]
#[test]
fn a_key_that_others_can_use_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let pair = KeyPair::generate_unencrypted_keypair().unwrap();
    let path = folder.path().join("key");
    std::fs::write(&path, pair.sk.to_box(None).unwrap().to_string()).unwrap();
    for (mode, is_good) in [
        (0o600, true),
        (0o400, true),
        (0o640, false),
        (0o604, false),
        (0o620, false),
        (0o601, false),
        (0o777, false),
    ] {
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
        match SigningKey::read(&path, None) {
            Ok(_) => assert!(is_good, "{mode:o}"),
            Err(error) => {
                let told = error.to_string();
                assert!(!is_good && told.contains(&format!("{mode:03o}")), "{told}");
            }
        }
    }
}
