//! Segments: what a worker has stored is uploaded once, and two workers of a shard keep each other's.

use super::bench::{fetched, put, put_text, shard, stored};
use octant_campaign::execute::Shard;
use octant_campaign::store::CampaignResults;
use octant_dispatch::storage::{
    SegmentUploads, Storage, StorageAddress, StorageError, StorageOptions, UploadLimits,
    WorkFolder, WorkScope,
};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn uploads<'a>(storage: &'a Storage, work: &WorkFolder, shard: Shard) -> SegmentUploads<'a> {
    SegmentUploads::of(storage, work, shard, UploadLimits::default()).unwrap()
}

fn objects(storage: &Storage) -> Vec<String> {
    storage.list("results").unwrap().into_keys().collect()
}

fn results(work: &WorkFolder) -> CampaignResults {
    CampaignResults::open(work.path()).unwrap()
}

#[test]
fn a_restarted_worker_has_what_was_uploaded() {
    let (storage, ids) = stored(8);
    let mine = shard(1, 2);
    let first = fetched(&storage, mine);
    let mut uploading = uploads(&storage, &first, mine);
    uploading.upload().unwrap();
    assert_eq!(objects(&storage), [""; 0], "nothing is no segment");
    put(first.path(), mine, &ids[0], 100);
    put(first.path(), mine, &ids[2], 100);
    uploading.upload().unwrap();
    uploading.upload().unwrap();
    put(first.path(), mine, &ids[4], 100);
    uploading.upload().unwrap();
    let expected = ["results/1-of-2/00000001.octres", "results/1-of-2/00000002.octres"];
    assert_eq!(objects(&storage), expected);
    assert_eq!(uploading.uploaded(), (3, 2));
    // Killed with one result that was never uploaded.
    put(first.path(), mine, &ids[6], 100);
    let again = fetched(&storage, mine);
    let there = results(&again);
    assert_eq!([0, 2, 4, 6].map(|k| there.has(&ids[k])), [true, true, true, false]);
    put(again.path(), mine, &ids[6], 100);
    let mut uploading = uploads(&storage, &again, mine);
    uploading.upload().unwrap();
    assert_eq!(objects(&storage).last().unwrap(), "results/1-of-2/00000003.octres");
    assert_eq!(uploading.uploaded(), (1, 1));
    // The worker of another shard of two doesn't need them, one of three does.
    assert!(results(&fetched(&storage, shard(2, 2))).is_empty());
    assert_eq!(results(&fetched(&storage, shard(1, 3))).len(), 4);
    let all = WorkFolder::fetch(&storage, None, WorkScope::Results).unwrap();
    for id in [0, 2, 4, 6].map(|k| &ids[k]) {
        assert!(results(&all).bytes(id).unwrap().is_some());
    }
}

#[test]
fn results_that_a_worker_of_another_shard_left_in_the_folder_are_uploaded_once() {
    let (storage, ids) = stored(6);
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path().join("work");
    let fetch = |shard| WorkFolder::fetch(&storage, Some(&at), WorkScope::Shard(shard)).unwrap();
    let first = fetch(shard(1, 3));
    put(first.path(), shard(1, 3), &ids[0], 100);
    uploads(&storage, &first, shard(1, 3)).upload().unwrap();
    // Never uploaded.
    put(first.path(), shard(1, 3), &ids[3], 100);
    let other = fetch(shard(2, 3));
    put(other.path(), shard(2, 3), &ids[1], 100);
    let mut uploading = uploads(&storage, &other, shard(2, 3));
    uploading.upload().unwrap();
    assert_eq!(uploading.uploaded().0, 2, "ids 1 and 3");
    let all = results(&WorkFolder::fetch(&storage, None, WorkScope::Results).unwrap());
    assert_eq!([0, 1, 3].map(|k| all.known(&ids[k]).unwrap().len()), [1; 3]);
    assert_eq!(all.len(), 3);
}

#[test]
fn two_workers_of_a_shard_never_replace_each_others_results() {
    let (storage, ids) = stored(3);
    let (one, other) = (fetched(&storage, Shard::WHOLE), fetched(&storage, Shard::WHOLE));
    let mut uploading =
        [uploads(&storage, &one, Shard::WHOLE), uploads(&storage, &other, Shard::WHOLE)];
    put(one.path(), Shard::WHOLE, &ids[0], 10);
    put(one.path(), Shard::WHOLE, &ids[1], 10);
    put(other.path(), Shard::WHOLE, &ids[1], 10);
    put_text(other.path(), Shard::WHOLE, &ids[0], "another result");
    put(other.path(), Shard::WHOLE, &ids[2], 10);
    uploading[0].upload().unwrap();
    uploading[1].upload().unwrap();
    assert_eq!(objects(&storage).len(), 2);
    assert!(results(&other).has(&ids[1]));
    let all = fetched(&storage, Shard::WHOLE);
    let all = results(&all);
    assert_eq!(all.len(), 3);
    // The same bytes count once; others are told.
    assert_eq!(all.known(&ids[1]).unwrap().len(), 2);
    assert_eq!(all.differing(&ids[1]).unwrap(), None);
    assert!(all.differing(&ids[0]).unwrap().is_some());
}

#[test]
fn a_segment_is_no_longer_than_the_limit_or_one_result() {
    let (storage, ids) = stored(6);
    let work = fetched(&storage, Shard::WHOLE);
    for (id, bytes) in ids.iter().zip([3000, 3000, 40_000, 3000, 3000, 3000]) {
        put(work.path(), Shard::WHOLE, id, bytes);
    }
    let limits = UploadLimits { bytes: 12_000, ..UploadLimits::default() };
    SegmentUploads::of(&storage, &work, Shard::WHOLE, limits).unwrap().upload().unwrap();
    let lengths: Vec<u64> = storage.list("results").unwrap().into_values().collect();
    assert!(lengths.len() >= 3 && lengths.len() <= 5, "{lengths:?}");
    assert_eq!(lengths.iter().filter(|bytes| **bytes > 12_000).count(), 1, "{lengths:?}");
    assert_eq!(results(&fetched(&storage, Shard::WHOLE)).len(), 6);
}

#[test]
fn a_damaged_segment_is_told_with_its_object() {
    let (storage, ids) = stored(2);
    let work = fetched(&storage, Shard::WHOLE);
    put(work.path(), Shard::WHOLE, &ids[0], 100);
    put(work.path(), Shard::WHOLE, &ids[1], 100);
    uploads(&storage, &work, Shard::WHOLE).upload().unwrap();
    let name = objects(&storage).remove(0);
    let whole = storage.get(&name).unwrap().unwrap();
    let mut ends = vec![0, 3, 15, whole.len() / 2, whole.len() - 1];
    ends.retain(|end| *end < whole.len());
    for end in ends {
        storage.put(&name, whole[..end].to_vec()).unwrap();
        let work = fetched(&storage, Shard::WHOLE);
        let error =
            SegmentUploads::of(&storage, &work, Shard::WHOLE, UploadLimits::default()).unwrap_err();
        let StorageError::Form { object, .. } = &error else { panic!("{end}: {error}") };
        assert!(object.ends_with("results/1-of-1/00000001.octres"), "{error}");
    }
}

#[test]
fn results_are_uploaded_while_a_worker_runs_and_at_its_end() {
    let (storage, ids) = stored(2);
    let work = fetched(&storage, Shard::WHOLE);
    // Every result is enough.
    let limits = UploadLimits { bytes: 1, every: Duration::from_secs(3600) };
    let mut uploading = SegmentUploads::of(&storage, &work, Shard::WHOLE, limits).unwrap();
    let is_done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let follow = scope.spawn(|| uploading.follow(&is_done, || panic!("it failed")));
        put(work.path(), Shard::WHOLE, &ids[0], 100);
        while objects(&storage).is_empty() {
            std::thread::sleep(Duration::from_millis(10));
        }
        is_done.store(true, Ordering::Relaxed);
        put(work.path(), Shard::WHOLE, &ids[1], 100);
        follow.join().unwrap().unwrap();
    });
    uploading.upload().unwrap();
    assert_eq!(objects(&storage).len(), 2);
}

#[test]
fn a_worker_whose_results_cannot_be_uploaded_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let address = StorageAddress::parse(&format!("file://{}", folder.path().display())).unwrap();
    let options = StorageOptions { retry: Duration::ZERO, cancel: None };
    let storage = Storage::open(&address, options).unwrap();
    let (bundle, ids) = super::bench::bundle(1);
    storage.put_new("bundle.zip", &bundle).unwrap();
    let work = fetched(&storage, Shard::WHOLE);
    put(work.path(), Shard::WHOLE, &ids[0], 100);
    std::fs::write(folder.path().join("results"), "in the way").unwrap();
    let limits = UploadLimits { bytes: 1, every: Duration::from_secs(3600) };
    let mut uploading = SegmentUploads::of(&storage, &work, Shard::WHOLE, limits).unwrap();
    let is_stopped = AtomicBool::new(false);
    // The work goes on until it is stopped.
    let error =
        uploading.follow(&AtomicBool::new(false), || is_stopped.store(true, Ordering::Relaxed));
    let error = error.unwrap_err().to_string();
    assert!(is_stopped.load(Ordering::Relaxed));
    assert!(error.contains("/results/1-of-1/00000001.octres: "), "{error}");
}
