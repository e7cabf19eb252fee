//! Requests for real-time scheduling.

use octant_realtime::schedule::{Granted, RequestOutcome, Wish, apply, processors, release};

/// Applies a request on a thread of its own, so that the test program's thread stays unchanged.
fn applied(wish: Wish) -> Granted {
    std::thread::spawn(move || apply(&wish)).join().unwrap_or_else(|_| panic!("it panicked"))
}

const NOTHING: Wish = Wish { priority: None, lock_memory: false, cpu: None };

#[test]
fn what_is_not_asked_for_is_not_done() {
    let granted = applied(NOTHING);
    assert_eq!(granted.scheduling, RequestOutcome::NotAsked);
    assert_eq!(granted.memory, RequestOutcome::NotAsked);
    assert_eq!(granted.cpu, RequestOutcome::NotAsked);
    assert!(!granted.is_realtime());
}

#[test]
fn what_can_not_be_is_refused_with_a_reason() {
    for cpu in [1023, u16::MAX] {
        let granted = applied(Wish { cpu: Some(cpu), ..NOTHING });
        assert!(
            granted.cpu.text().starts_with(&format!("no processor {cpu} alone: ")),
            "{:?}",
            granted.cpu
        );
    }
    for priority in [0, 101] {
        let granted = applied(Wish { priority: Some(priority), ..NOTHING });
        assert!(matches!(granted.scheduling, RequestOutcome::Refused { .. }), "{granted:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn processors_are_those_of_the_thread() {
    let all = processors();
    let last = all.last().copied();
    let of_one = std::thread::spawn(move || {
        let granted = apply(&Wish { cpu: last, ..NOTHING });
        (granted.cpu.is_granted(), processors())
    });
    let (pinned, found) = of_one.join().unwrap_or_else(|_| panic!("the thread panicked"));
    assert!(pinned, "one of {all:?}");
    assert_eq!(found, Vec::from_iter(last));
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_granted_is_so() {
    std::thread::spawn(|| {
        let granted = apply(&Wish { priority: Some(10), lock_memory: false, cpu: Some(0) });
        let status = std::fs::read_to_string("/proc/thread-self/stat").unwrap_or_default();
        // Fields 40 and 41 of proc_pid_stat(5), counted after the name in parentheses.
        let fields: Vec<&str> = status.rsplit(") ").next().unwrap_or("").split(' ').collect();
        let (priority, policy) = (fields[37], fields[38]);
        if granted.is_realtime() {
            assert_eq!((priority, policy), ("10", "1"), "{status}");
        } else {
            assert_eq!((priority, policy), ("0", "0"), "{status}");
            assert!(granted.scheduling.text().contains("ulimit -r"), "{granted:?}");
        }
        if granted.cpu.is_granted() {
            let status = std::fs::read_to_string("/proc/thread-self/status").unwrap_or_default();
            assert!(status.contains("Cpus_allowed_list:\t0\n"), "{status}");
        }
        release(&granted);
        let status = std::fs::read_to_string("/proc/thread-self/stat").unwrap_or_default();
        let fields: Vec<&str> = status.rsplit(") ").next().unwrap_or("").split(' ').collect();
        assert_eq!((fields[37], fields[38]), ("0", "0"), "{status}");
        let status = std::fs::read_to_string("/proc/thread-self/status").unwrap_or_default();
        let of_all = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let list = |text: &str| {
            text.lines().find(|l| l.starts_with("Cpus_allowed_list")).map(str::to_owned)
        };
        assert_eq!(list(&status), list(&of_all));
    })
    .join()
    .unwrap_or_else(|_| panic!("the thread panicked"));
}
