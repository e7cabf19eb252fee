//! Working folders: made from objects, used again, and put back.

use super::bench::{bundle, fetched, put, shard, stored};
use octant_campaign::execute::Shard;
use octant_campaign::plan::Plan;
use octant_campaign::store::CampaignResults;
use octant_dispatch::storage::{
    SegmentUploads, Storage, StorageError, UploadLimits, WorkFolder, WorkScope,
};

fn uploaded(storage: &Storage, work: &WorkFolder, shard: Shard) -> (usize, usize) {
    let mut uploads = SegmentUploads::of(storage, work, shard, UploadLimits::default()).unwrap();
    uploads.upload().unwrap();
    uploads.uploaded()
}

#[test]
fn a_given_folder_goes_on_with_what_was_not_uploaded() {
    let (storage, ids) = stored(4);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/work");
    let scope = WorkScope::Shard(Shard::WHOLE);
    let work = WorkFolder::fetch(&storage, Some(&path), scope).unwrap();
    assert_eq!(work.path(), path);
    put(&path, Shard::WHOLE, &ids[0], 100);
    assert_eq!(uploaded(&storage, &work, Shard::WHOLE), (1, 1));
    put(&path, Shard::WHOLE, &ids[1], 100);
    drop(work);
    let again = WorkFolder::fetch(&storage, Some(&path), scope).unwrap();
    assert_eq!(CampaignResults::open(&path).unwrap().len(), 2);
    // The first result is on the storage already, and isn't uploaded again.
    assert_eq!(uploaded(&storage, &again, Shard::WHOLE), (1, 1));
    drop(again);
    let again = WorkFolder::fetch(&storage, Some(&path), scope).unwrap();
    assert_eq!(uploaded(&storage, &again, Shard::WHOLE), (0, 0));
    drop(again);
    assert!(path.exists());
    let (other, _) = stored(5);
    let error = WorkFolder::fetch(&other, Some(&path), scope).unwrap_err();
    assert!(matches!(error, StorageError::Work { .. }), "{error}");
    let full = folder.path().join("full");
    std::fs::create_dir(&full).unwrap();
    std::fs::write(full.join("mine"), "").unwrap();
    let error = WorkFolder::fetch(&storage, Some(&full), scope).unwrap_err().to_string();
    assert!(error.contains("isn't empty"), "{error}");
}

#[test]
fn segments_that_are_gone_from_the_storage_go_from_the_folder() {
    let (storage, ids) = stored(2);
    let first = fetched(&storage, Shard::WHOLE);
    put(first.path(), Shard::WHOLE, &ids[0], 100);
    uploaded(&storage, &first, Shard::WHOLE);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work");
    let scope = WorkScope::Shard(shard(1, 2));
    drop(WorkFolder::fetch(&storage, Some(&path), scope).unwrap());
    assert_eq!(CampaignResults::open(&path).unwrap().len(), 1);
    // The same campaign, begun anew elsewhere.
    let (anew, _) = stored(2);
    drop(WorkFolder::fetch(&anew, Some(&path), scope).unwrap());
    assert!(CampaignResults::open(&path).unwrap().is_empty());
}

#[test]
fn a_temporary_folder_goes_unless_it_is_kept() {
    let (storage, _) = stored(1);
    let work = fetched(&storage, Shard::WHOLE);
    let path = work.path().to_owned();
    Plan::read(&path.join("plan.json")).unwrap();
    drop(work);
    assert!(!path.exists());
    let mut work = fetched(&storage, Shard::WHOLE);
    let path = work.keep().to_owned();
    drop(work);
    assert!(path.exists());
    std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
}

#[test]
fn what_is_put_back_comes_back_to_the_byte() {
    let (storage, ids) = stored(2);
    let work = fetched(&storage, Shard::WHOLE);
    put(work.path(), Shard::WHOLE, &ids[0], 100);
    uploaded(&storage, &work, Shard::WHOLE);
    let work = WorkFolder::fetch(&storage, None, WorkScope::All).unwrap();
    let files =
        [("cases.parquet", "rows"), ("inputs/a b ü#1.toml", "schema = 1"), ("report.html", "")];
    for (name, text) in files {
        let path = work.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    std::fs::write(work.path().join(".octant-remains.new"), "of a kill").unwrap();
    let put = work.put_back(&storage).unwrap();
    assert_eq!(put.len(), files.len(), "{put:?}");
    assert!(put.contains(&"s3://memory/campaign/cases.parquet".to_owned()));
    let results = WorkFolder::fetch(&storage, None, WorkScope::Results).unwrap();
    assert!(!results.path().join("cases.parquet").exists());
    let all = WorkFolder::fetch(&storage, None, WorkScope::All).unwrap();
    for (name, text) in files {
        assert_eq!(std::fs::read_to_string(all.path().join(name)).unwrap(), text);
    }
    assert_eq!(CampaignResults::open(all.path()).unwrap().len(), 1);
    // Once more, over what is there.
    assert_eq!(all.put_back(&storage).unwrap().len(), files.len());
}

#[test]
fn objects_that_no_command_writes_are_refused() {
    for name in ["results/notes.txt", "results/1-of-1/1.octres", "plan.json", "below/bundle.zip"] {
        let (storage, _) = stored(1);
        storage.put(name, vec![0]).unwrap();
        let error = WorkFolder::fetch(&storage, None, WorkScope::All).unwrap_err().to_string();
        assert!(error.contains(&format!("read s3://memory/campaign/{name}: ")), "{error}");
    }
}

#[test]
fn a_storage_without_a_whole_campaign_is_refused() {
    let empty = Storage::in_memory().unwrap();
    let error = WorkFolder::fetch(&empty, None, WorkScope::Plan).unwrap_err();
    assert!(
        matches!(&error, StorageError::Absent { object } if object.ends_with("/bundle.zip")),
        "{error}"
    );
    let (mut bytes, _) = bundle(1);
    bytes.truncate(bytes.len() / 2);
    empty.put("bundle.zip", bytes).unwrap();
    let error = WorkFolder::fetch(&empty, None, WorkScope::Plan).unwrap_err();
    assert!(
        matches!(&error, StorageError::Form { object, .. } if object.ends_with("/bundle.zip")),
        "{error}"
    );
}
