//! Instances by handle.

use super::registry::{INSTANCES_MAX, NoInstance, PLACE_BITS, Registry};
use core::ptr::{null_mut, without_provenance_mut};

#[test]
fn a_handle_is_good_for_its_instance_alone() {
    let registry = Registry::new();
    let handles: Vec<_> = (0..200).map(|i| registry.insert(Box::new(i)).unwrap()).collect();
    for (i, handle) in handles.iter().enumerate() {
        assert_eq!(registry.with(*handle, |found| *found), Ok(i));
    }
    assert_eq!(*registry.remove(handles[7]).unwrap(), 7);
    assert_eq!(registry.with(handles[7], |_| ()), Err(NoInstance::Unknown));
    assert_eq!(registry.remove(handles[7]), Err(NoInstance::Unknown));
    // The place is used again, but the old handle is not valid for it.
    let next = registry.insert(Box::new(1000)).unwrap();
    assert_eq!(next.addr() & 0xFFFF, handles[7].addr() & 0xFFFF);
    assert_eq!(registry.with(handles[7], |_| ()), Err(NoInstance::Unknown));
    assert_eq!(registry.with(next, |found| *found), Ok(1000));
}

#[test]
fn what_is_no_handle_is_answered() {
    let registry = Registry::new();
    assert_eq!(registry.with(null_mut(), |_: &mut i32| ()), Err(NoInstance::Unknown));
    let handle = registry.insert(Box::new(1)).unwrap();
    let local = 5;
    let foreign = [
        null_mut(),
        core::ptr::from_ref(&local).cast_mut().cast(),
        without_provenance_mut(usize::MAX),
        without_provenance_mut(handle.addr() + 1),
        without_provenance_mut(handle.addr() & 0xFFFF),
        without_provenance_mut(handle.addr() + (1 << PLACE_BITS)),
    ];
    for pointer in foreign {
        assert_eq!(registry.with(pointer, |_| ()), Err(NoInstance::Unknown), "{pointer:?}");
    }
}

#[test]
fn an_instance_in_use_is_not_entered_again() {
    let registry = Registry::new();
    let handle = registry.insert(Box::new(1)).unwrap();
    registry
        .with(handle, |_| {
            assert_eq!(registry.with(handle, |_| ()), Err(NoInstance::InUse));
            assert_eq!(registry.remove(handle), Err(NoInstance::InUse));
        })
        .unwrap();
    assert_eq!(registry.with(handle, |found| *found), Ok(1));
}

#[test]
fn a_panic_gives_the_instance_free() {
    let registry = Registry::new();
    let handle = registry.insert(Box::new(1)).unwrap();
    let unwound = std::panic::catch_unwind(core::panic::AssertUnwindSafe(|| {
        let _ = registry.with(handle, |_| panic!("in the test"));
    }));
    assert!(unwound.is_err());
    assert_eq!(registry.with(handle, |found| *found), Ok(1));
}

#[test]
fn there_is_an_end_to_instances() {
    let registry = Registry::new();
    let handles: Vec<_> = (0..INSTANCES_MAX).map(|_| registry.insert(Box::new(()))).collect();
    assert!(handles.iter().all(Option::is_some));
    assert_eq!(registry.insert(Box::new(())), None);
    registry.remove(handles[INSTANCES_MAX - 1].unwrap()).unwrap();
    assert!(registry.insert(Box::new(())).is_some());
}

#[test]
fn threads_meet_each_instance_one_at_a_time() {
    static REGISTRY: Registry<u64> = Registry::new();
    let handles: Vec<usize> =
        (0..4).map(|_| REGISTRY.insert(Box::new(0)).unwrap().addr()).collect();
    let done: u64 = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|_| {
                scope.spawn(|| {
                    let mut done = 0;
                    for i in 0..20_000 {
                        let handle = without_provenance_mut(handles[i % handles.len()]);
                        match REGISTRY.with(handle, |count| *count += 1) {
                            Ok(()) => done += 1,
                            Err(error) => assert_eq!(error, NoInstance::InUse),
                        }
                    }
                    done
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).sum()
    });
    let counted: u64 = handles
        .iter()
        .map(|handle| *REGISTRY.remove(without_provenance_mut(*handle)).unwrap())
        .sum();
    assert_eq!(counted, done);
}
