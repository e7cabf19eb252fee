//! Two persons sign the dispositions of a campaign: never one of them twice, never other content.

use super::bench::{Bench, CAMPAIGN, check};
use std::path::{Path, PathBuf};

/// Makes a secret key in a folder, and returns its path and its public part.
fn key(folder: &Path, name: &str) -> (PathBuf, String) {
    let pair = minisign::KeyPair::generate_unencrypted_keypair().unwrap();
    let path = folder.join(name);
    write(&path, &pair);
    (path, pair.pk.to_base64())
}

fn write(path: &Path, pair: &minisign::KeyPair) {
    std::fs::write(path, pair.sk.to_box(None).unwrap().to_string()).unwrap();
    #[cfg(unix)]
    {
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
        std::fs::set_permissions(path, mode).unwrap();
    }
}

/// Makes a campaign with one case over its limit.
fn campaign() -> Bench {
    let small = CAMPAIGN.replace("replicates = 40", "replicates = 2");
    let (bench, _, _) = Bench::filled(&small, |index, _, result| {
        if index == 0 {
            check(result, "CAL-1", 99.0, 50.0);
        }
    });
    bench
}

struct Signed {
    bench: Bench,
    first: (PathBuf, String),
    second: (PathBuf, String),
    _keys: tempfile::TempDir,
}

impl Signed {
    fn of(bench: Bench) -> Self {
        let keys = tempfile::tempdir().unwrap();
        let [first, second] = ["first", "second"].map(|name| key(keys.path(), name));
        Self { bench, first, second, _keys: keys }
    }

    fn report(&self) {
        let key = ("OCTANT_SIGNING_KEY", self.first.0.as_path());
        self.bench.octant_with(&["campaign", "report", "out"], &[key]);
    }

    /// Countersigns; returns the status and the output.
    fn countersign(&self, key: Option<&Path>) -> (i32, String) {
        let key = key.map(|path| ("OCTANT_SIGNING_KEY", path));
        let output = self.bench.octant_with(&["campaign", "countersign", "out"], key.as_slice());
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    }

    fn verify(&self, first: &str, second: &str) -> (i32, String) {
        let words = ["verify", "out", "--key", first, "--second-key", second];
        let output = self.bench.octant(&words);
        let said = String::from_utf8(output.stdout).unwrap();
        (output.status.code().unwrap(), said + &String::from_utf8(output.stderr).unwrap())
    }

    fn dispose(&self) {
        let text = self.bench.read("dispositions.toml");
        let text = text
            .replace("disposition = \"\"", "disposition = \"The limit is an old one.\"")
            .replace("by = \"\"", "by = \"A. Reviewer\"");
        std::fs::write(self.bench.at("out/dispositions.toml"), text).unwrap();
    }
}

#[test]
fn two_keys_sign_and_one_key_never_does_for_two() {
    let signed = Signed::of(campaign());
    let (first, second) = (signed.first.clone(), signed.second.clone());
    // The required order: signed by the first person, with dispositions, whole.
    let refused = |key: Option<&Path>, told: &str| {
        let (status, said) = signed.countersign(key);
        assert!(status == 2 && said.contains(told), "{told}: {status} {said}");
        assert!(!signed.bench.at("out/dispositions.toml.minisig").exists());
    };
    signed.bench.octant(&["campaign", "report", "out"]);
    refused(Some(&second.0), "found an unsigned manifest");
    signed.report();
    refused(Some(&second.0), "disposition of");
    refused(None, "names no key");
    signed.dispose();
    refused(Some(&second.0), "dispositions.toml was changed");
    signed.report();
    refused(Some(&first.0), "expected the key of a second person");
    // The same key under another id, which its owner can choose.
    let text = std::fs::read_to_string(&first.0).unwrap();
    let secret = minisign::SecretKeyBox::from_string(&text).unwrap();
    let secret = secret.into_unencrypted_secret_key().unwrap();
    let mut bytes = secret.to_bytes();
    // The id follows two bytes each of three algorithms and 48 of the key derivation.
    for byte in &mut bytes[54..62] {
        *byte ^= 0xff;
    }
    let forged = minisign::SecretKey::from_bytes(&bytes).unwrap();
    let public = minisign::PublicKey::from_secret_key(&forged).unwrap();
    assert_ne!(public.keynum(), minisign::PublicKey::from_base64(&first.1).unwrap().keynum());
    let (status, said) = signed.verify(&first.1, &public.to_base64());
    assert!(status == 1 && said.contains("two persons are two keys"), "{said}");

    // With a second key given, a missing second signature is a difference; without one, the folder
    // is whole.
    let (status, said) = signed.verify(&first.1, &second.1);
    assert!(status == 1 && said.contains("dispositions.toml.minisig"), "{said}");
    assert_eq!(signed.bench.octant(&["verify", "out", "--key", &first.1]).status.code(), Some(0));
    assert_eq!(signed.countersign(Some(&second.0)).0, 0);
    let (status, said) = signed.verify(&first.1, &second.1);
    assert!(status == 0 && said.contains("signed by a second person"), "{said}");
    // The first signature stays valid, and the second is reported where no key is given for it.
    let output = signed.bench.octant(&["verify", "out", "--key", &first.1]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && said.contains("second signature not checked"), "{said}");
    let (status, said) = signed.verify(&first.1, &first.1);
    assert!(status == 1 && said.contains("two persons are two keys"), "{said}");
    let (third, _keys) = {
        let keys = tempfile::tempdir().unwrap();
        (key(keys.path(), "third"), keys)
    };
    assert_eq!(signed.verify(&first.1, &third.1).0, 1);
    // The option alone is refused.
    let output = signed.bench.octant(&["verify", "out", "--second-key", &second.1]);
    assert_eq!(output.status.code(), Some(2));

    // Every bit of both signatures counts, also with the manifest made again and signed again by
    // the first person.
    let path = signed.bench.at("out/dispositions.toml.minisig");
    let whole = std::fs::read(&path).unwrap();
    for place in (0..whole.len()).step_by(7) {
        let mut changed = whole.clone();
        changed[place] ^= 1;
        std::fs::write(&path, changed).unwrap();
        assert_eq!(signed.verify(&first.1, &second.1).0, 1, "byte {place}");
    }
    std::fs::write(&path, &whole).unwrap();
    let text = signed.bench.read("dispositions.toml");
    let edited = text.replace("an old one", "another one");
    std::fs::write(signed.bench.at("out/dispositions.toml"), edited).unwrap();
    signed.report();
    assert_eq!(signed.bench.octant(&["verify", "out", "--key", &first.1]).status.code(), Some(0));
    let (status, said) = signed.verify(&first.1, &second.1);
    assert!(status == 1 && said.contains("dispositions.toml.minisig"), "{said}");
}

#[test]
fn a_second_signature_of_other_results_is_refused() {
    let signed = Signed::of(campaign());
    signed.report();
    signed.dispose();
    signed.report();
    assert_eq!(signed.countersign(Some(&signed.second.0)).0, 0);
    assert_eq!(signed.verify(&signed.first.1, &signed.second.1).0, 0);
    // The same discrepancy with the same text, but other numbers.
    let (first, second) = (signed.first.1.clone(), signed.second.1.clone());
    let plan = signed.bench.plan();
    let mut result = crate::common::results::value(&signed.bench.at("out"), &plan.cases[1].id);
    result["summary"]["navigation"]["latitude_error_arcmin"]["rms"] = 0.001.into();
    super::bench::put(&signed.bench.at("out"), &plan.cases[1], &result);
    signed.report();
    assert_eq!(signed.bench.octant(&["verify", "out", "--key", &first]).status.code(), Some(0));
    let (status, said) = signed.verify(&first, &second);
    assert!(status == 1 && said.contains("made for something else"), "{said}");
    // A second signature in the folder of a run, or without anything to sign, counts as added.
    let run = crate::chain::run("");
    let folder = run.path().join("run");
    std::fs::copy(
        signed.bench.at("out/dispositions.toml.minisig"),
        folder.join("dispositions.toml.minisig"),
    )
    .unwrap();
    let output = signed.bench.octant(&["verify", folder.to_str().unwrap()]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.code() == Some(1) && said.contains("was added"), "{said}");
}
