//! Files for schedulers.

use crate::planned::planned;
use octant_dispatch::emit::{EmitError, KubernetesVolume, SchedulerJob, kubernetes};
use std::path::Path;

/// A job of six cases.
fn job(folder: &str) -> SchedulerJob {
    let files = tempfile::tempdir().unwrap();
    let plan = planned(files.path(), "two words", 6);
    SchedulerJob::new(&plan, Path::new(folder), 3, 2).unwrap()
}

#[test]
fn pods_have_the_campaign_from_object_storage_or_from_a_volume() {
    let objects = |secret| KubernetesVolume::Objects { secret };
    let stored = job("s3://bucket/two words");
    let with = kubernetes(&stored, "registry/octant:1", objects(Some("storage"))).unwrap();
    for expected in [
        "# 6 cases of two words in 3 parts.",
        "command: [\"octant\", \"campaign\", \"run\", \"s3://bucket/two words\", \"--jobs\", \"2\", \"--any-verdict\"]",
        "            - secretRef:\n                name: \"storage\"\n",
        "limits: { memory: 4352Mi }",
    ] {
        assert!(with.contains(expected), "{expected}: {with}");
    }
    assert!(!with.contains("volume"), "{with}");
    let without = kubernetes(&stored, "i", objects(None)).unwrap();
    assert!(!without.contains("envFrom") && without.ends_with("memory: 4352Mi }\n"), "{without}");
    let refused = kubernetes(&stored, "i", objects(Some("a_b"))).unwrap_err();
    assert_eq!(refused, EmitError::KubernetesName { found: "a_b".to_owned() });
    let volume = KubernetesVolume::Claim("data");
    assert!(kubernetes(&job("data/cert"), "i", volume).is_err());
    let claimed = kubernetes(&job("/data/cert"), "i", volume).unwrap();
    assert!(claimed.contains("mountPath: \"/data/cert\"\n"), "{claimed}");
    assert!(claimed.ends_with("claimName: \"data\"\n"), "{claimed}");
}
