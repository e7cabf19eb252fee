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

    /// Sets the scheduling policy of the calling thread, which rustix has no function for.
    #[allow(unsafe_code, reason = "a function of C is called")]
    fn set_policy(policy: libc::c_int, priority: u8) -> std::io::Result<()> {
        // SAFETY: all fields are numbers; musl has more of them than `sched_priority`.
        let mut parameters: libc::sched_param = unsafe { std::mem::zeroed() };
        parameters.sched_priority = priority.into();
        // SAFETY: the thread is the calling one, and the pointer is valid during the call, which
        // writes nothing.
        let refused = unsafe {
            libc::pthread_setschedparam(libc::pthread_self(), policy, &raw const parameters)
        };
        match refused {
            0 => Ok(()),
            number => Err(std::io::Error::from_raw_os_error(number)),
        }
    }

    pub(super) fn fifo(priority: u8) -> RequestOutcome {
        let what = format!("SCHED_FIFO with priority {priority}");
        let range = 1..=99;
        if !range.contains(&priority) {
            let why = format!("priorities are from {} to {}", range.start(), range.end());
            return RequestOutcome::Refused { what, why };
        }
        let why = match set_policy(libc::SCHED_FIFO, priority) {
            Ok(()) => return RequestOutcome::Granted { what },
            Err(error) if error.raw_os_error() == Some(libc::EPERM) => {
                let limit = getrlimit(Resource::Rtprio).current.unwrap_or(99);
                format!(
                    "the limit of real-time priorities is {limit} (`ulimit -r`) and the process \
                     has no CAP_SYS_NICE; \"@realtime - rtprio 99\" in \
                     /etc/security/limits.conf raises it for a group"
                )
            }
            Err(error) => error.to_string(),
        };
        RequestOutcome::Refused { what, why }
    }

    pub(super) fn release(granted: &super::Granted) {
        if granted.scheduling.is_granted() {
            // Returning from a real-time policy is always permitted.
            let _ = set_policy(libc::SCHED_OTHER, 0);
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
