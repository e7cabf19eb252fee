//! Real-time scheduling of a thread: a real-time priority, locked memory, a processor of its own. A
//! host may refuse each; then the run continues without it, and its manifest says so.

use serde::{Deserialize, Serialize};

/// Scheduling that a thread requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wish {
    /// Priority of SCHED_FIFO, 1 to 99; `None`: no request.
    pub priority: Option<u8>,
    /// True to lock all memory of the process.
    pub lock_memory: bool,
    /// Processor that the thread is pinned to, from 0.
    pub cpu: Option<u16>,
}

/// Outcome of one request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "outcome")]
pub enum RequestOutcome {
    /// The property wasn't requested.
    NotAsked,
    /// The request was granted.
    Granted {
        /// Property granted.
        what: String,
    },
    /// The request was refused.
    Refused {
        /// Property requested.
        what: String,
        /// Reason of the refusal, and the remedy.
        why: String,
    },
}

impl RequestOutcome {
    /// True if the request was granted.
    #[must_use]
    pub fn is_granted(&self) -> bool {
        matches!(self, Self::Granted { .. })
    }

    /// Text of one line.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::NotAsked => "not requested".to_owned(),
            Self::Granted { what } => what.clone(),
            Self::Refused { what, why } => format!("no {what}: {why}"),
        }
    }
}

/// Outcome of all requests of a thread.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Granted {
    /// Real-time priority.
    pub scheduling: RequestOutcome,
    /// Locked memory.
    pub memory: RequestOutcome,
    /// Processor.
    pub cpu: RequestOutcome,
}

impl Granted {
    /// True if the thread has a real-time priority: only then does spinning help.
    #[must_use]
    pub fn is_realtime(&self) -> bool {
        self.scheduling.is_granted()
    }
}

/// Requests scheduling for the calling thread. A refusal is reported, not an error. Priority and
/// processor belong to the thread, locked memory to the process; all last until the thread, or the
/// process, ends.
#[must_use]
pub fn apply(wish: &Wish) -> Granted {
    system::prepare();
    Granted {
        // Memory comes first, so that page faults happen before the thread has a real-time priority.
        memory: if wish.lock_memory { system::lock_memory() } else { RequestOutcome::NotAsked },
        cpu: wish.cpu.map_or(RequestOutcome::NotAsked, system::pin),
        scheduling: wish.priority.map_or(RequestOutcome::NotAsked, system::fifo),
    }
}

/// Processors that the calling thread may use: on many hosts not all of them (`taskset`, a container).
/// If the system doesn't say which, as many as are available, from 0 on.
#[must_use]
pub fn processors() -> Vec<u16> {
    system::processors().unwrap_or_else(|| {
        let count = std::thread::available_parallelism().map_or(1, usize::from);
        (0..u16::try_from(count).unwrap_or(u16::MAX)).collect()
    })
}

/// Takes back the priority and the processor granted to the calling thread; locked memory belongs to
/// the process and stays.
pub fn release(granted: &Granted) {
    system::release(granted);
}

#[cfg(target_os = "linux")]
mod system {
    use super::RequestOutcome;
    use rustix::mm::{MlockAllFlags, mlockall};
    use rustix::process::{Resource, getrlimit};
    use rustix::thread::{
        CapabilitySet, CpuSet, capabilities, sched_getaffinity, sched_setaffinity,
        set_current_timer_slack,
    };
    use std::cell::Cell;
    use std::num::NonZeroU64;
    use thread_priority::{
        Error, NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadPriority,
        ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
    };

    thread_local! {
        /// Processors of this thread before it was pinned.
        static BEFORE: Cell<Option<CpuSet>> = const { Cell::new(None) };
    }

    /// Switches off the timer slack of the thread: without a real-time priority, the kernel otherwise
    /// delays wake-ups by up to 50 µs to combine them.
    pub(super) fn prepare() {
        // A refusal shows in the lateness.
        let _ = set_current_timer_slack(NonZeroU64::new(1));
    }

    pub(super) fn processors() -> Option<Vec<u16>> {
        let set = sched_getaffinity(None).ok()?;
        let mine = (0..CpuSet::MAX_CPU).filter(|cpu| set.is_set(*cpu));
        let mine: Vec<u16> = mine.filter_map(|cpu| u16::try_from(cpu).ok()).collect();
        (!mine.is_empty()).then_some(mine)
    }

    fn has(capability: CapabilitySet) -> bool {
        capabilities(None).is_ok_and(|sets| sets.effective.contains(capability))
    }

    pub(super) fn fifo(priority: u8) -> RequestOutcome {
        let what = format!("SCHED_FIFO with priority {priority}");
        let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        let why = match ThreadPriority::try_from(priority) {
            Err(reason) => reason.to_owned(),
            Ok(asked) => match set_thread_priority_and_policy(thread_native_id(), asked, policy) {
                Ok(()) => return RequestOutcome::Granted { what },
                Err(Error::OS(number)) if number == rustix::io::Errno::PERM.raw_os_error() => {
                    let limit = getrlimit(Resource::Rtprio).current.unwrap_or(99);
                    format!(
                        "the limit of real-time priorities is {limit} (`ulimit -r`) and the \
                         process has no CAP_SYS_NICE; \"@realtime - rtprio 99\" in \
                         /etc/security/limits.conf raises it for a group"
                    )
                }
                Err(Error::OS(number)) => std::io::Error::from_raw_os_error(number).to_string(),
                Err(error) => error.to_string(),
            },
        };
        RequestOutcome::Refused { what, why }
    }

    pub(super) fn release(granted: &super::Granted) {
        if granted.scheduling.is_granted() {
            let policy = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other);
            // Returning from a real-time policy is always permitted.
            let _ = set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy);
        }
        if granted.cpu.is_granted() {
            // The former set may be less than all processors: `taskset`, a container.
            if let Some(before) = BEFORE.take() {
                let _ = sched_setaffinity(None, &before);
            }
        }
    }

    pub(super) fn lock_memory() -> RequestOutcome {
        let what = "all memory locked".to_owned();
        let refused = |why| RequestOutcome::Refused { what: "locked memory".to_owned(), why };
        // Under a limit the lock may succeed now, and an allocation fail an hour later.
        let limit = getrlimit(Resource::Memlock).current;
        if let Some(bytes) = limit
            && !has(CapabilitySet::IPC_LOCK)
        {
            return refused(format!(
                "{} KiB may be locked (`ulimit -l`) and unlimited is needed; \"@realtime - memlock \
                 unlimited\" in /etc/security/limits.conf raises it for a group",
                bytes / 1024
            ));
        }
        match mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE) {
            Ok(()) => RequestOutcome::Granted { what },
            Err(error) => refused(error.to_string()),
        }
    }

    pub(super) fn pin(cpu: u16) -> RequestOutcome {
        let what = format!("processor {cpu} alone");
        if usize::from(cpu) >= CpuSet::MAX_CPU {
            let why = format!("processors are numbered from 0 to {}", CpuSet::MAX_CPU - 1);
            return RequestOutcome::Refused { what, why };
        }
        let mut set = CpuSet::new();
        set.set(usize::from(cpu));
        let before = sched_getaffinity(None).ok();
        match sched_setaffinity(None, &set) {
            Ok(()) => {
                BEFORE.set(before);
                RequestOutcome::Granted { what }
            }
            Err(rustix::io::Errno::INVAL) => RequestOutcome::Refused {
                why: "there is no such processor, or this process may not use it".to_owned(),
                what,
            },
            Err(error) => RequestOutcome::Refused { what, why: error.to_string() },
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::RequestOutcome;

    pub(super) fn prepare() {}

    pub(super) fn processors() -> Option<Vec<u16>> {
        None
    }

    pub(super) fn release(_granted: &super::Granted) {}

    fn not_here(what: String) -> RequestOutcome {
        RequestOutcome::Refused { what, why: "Octant does this on Linux only".to_owned() }
    }

    pub(super) fn fifo(priority: u8) -> RequestOutcome {
        not_here(format!("real-time priority {priority}"))
    }

    pub(super) fn lock_memory() -> RequestOutcome {
        not_here("locked memory".to_owned())
    }

    pub(super) fn pin(cpu: u16) -> RequestOutcome {
        not_here(format!("processor {cpu} alone"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                let status =
                    std::fs::read_to_string("/proc/thread-self/status").unwrap_or_default();
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
}
