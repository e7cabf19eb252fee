//! Addresses, and names of objects.

use super::bench::shard;
use octant_dispatch::storage::StorageAddress;
use octant_dispatch::storage::layout::{SegmentName, may_share};

#[test]
fn addresses_name_a_bucket_or_a_folder() {
    let address = |text: &str| StorageAddress::parse(text).map_err(|error| error.to_string());
    let deep = address("s3://bucket/a/b c/").unwrap();
    assert_eq!(deep.to_string(), "s3://bucket/a/b c");
    assert_eq!(deep.of("bundle.zip"), "s3://bucket/a/b c/bundle.zip");
    assert_eq!(deep.folder(), None);
    assert_eq!(address("s3://bucket").unwrap().of("x"), "s3://bucket/x");
    let folder = address("file:///data/cert").unwrap();
    assert_eq!(folder.folder().unwrap().to_str(), Some("/data/cert"));
    for (wrong, expected) in [
        ("s3://", "found the bucket \"\""),
        ("s3://a b/c", "found the bucket \"a b\""),
        ("s3://bucket/a//b", "expected"),
        ("s3://bucket/a/../b", ".."),
        ("file://data", "an absolute folder"),
        ("gs://bucket/a", "found the scheme \"gs\", expected s3://BUCKET/PREFIX"),
        ("cert", "expected s3://BUCKET/PREFIX or file:///FOLDER"),
    ] {
        let said = address(wrong).unwrap_err();
        let is_told = said.contains(expected) || expected == "expected" && said.contains(wrong);
        assert!(is_told && said.starts_with("read the address"), "{wrong}: {said}");
    }
}

#[test]
fn a_segment_has_one_name() {
    let name = SegmentName { shard: shard(3, 16), number: 12 };
    assert_eq!(name.object(), "results/3-of-16/00000012.octres");
    assert_eq!(name.file(), "3-of-16.s00000012.octres");
    assert_eq!(SegmentName::parse(&name.object()), Some(name));
    assert!(SegmentName::is_file(&name.file()));
    // The part files of workers are none.
    for file in ["3-of-16.1.octres", "3-of-16.12345678.octres", "kept.1.octres", "s00000012.octres"]
    {
        assert!(!SegmentName::is_file(file), "{file}");
    }
    for other in [
        "results/3-of-16/12.octres",
        "results/3-of-16/00000000.octres",
        "results/03-of-16/00000012.octres",
        "results/17-of-16/00000012.octres",
        "results/00000012.octres",
        "result/3-of-16/00000012.octres",
        "results/3-of-16/00000012.octres.new",
    ] {
        assert_eq!(SegmentName::parse(other), None, "{other}");
    }
}

#[test]
fn shards_of_another_number_can_share_cases() {
    for (one, other) in
        [(shard(1, 3), shard(2, 2)), (shard(2, 4), shard(2, 4)), (shard(1, 1), shard(2, 5))]
    {
        assert!(may_share(one, other));
    }
    assert!(!may_share(shard(1, 3), shard(2, 3)));
    // Of shards that can't share, none has a case of the other.
    for of in 1..7 {
        for (a, b) in (1..=of).flat_map(|a| (1..=of).map(move |b| (shard(a, of), shard(b, of)))) {
            let shared = (0..60).any(|index| a.has(index) && b.has(index));
            assert_eq!(shared, may_share(a, b));
        }
    }
}
