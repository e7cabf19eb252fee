//! Properties of a host that matter to a bench: limits, clocks, processors, ports; with advice.

use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// Grade of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    /// Good, or for information only.
    Good,
    /// Runs work, but less punctually than they could.
    Advice,
    /// Something isn't possible on this host.
    Missing,
}

/// Finding about one property of the host.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostFinding {
    /// Property examined.
    pub subject: String,
    /// Grade.
    pub grade: Grade,
    /// Result.
    pub found: String,
    /// Advice, if something should be changed.
    pub advice: Option<String>,
}

impl HostFinding {
    fn new(subject: &str, grade: Grade, found: impl Into<String>) -> Self {
        Self { subject: subject.to_owned(), grade, found: found.into(), advice: None }
    }

    fn advice(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(advice.into());
        self
    }
}

/// Examines the host.
#[must_use]
pub fn look() -> Vec<HostFinding> {
    let mut findings = limits::look();
    findings.extend(Tree::of("/").look());
    findings
}

/// Files in which a Linux kernel describes itself, under some root.
#[derive(Clone, Debug)]
pub struct Tree {
    root: PathBuf,
}

impl Tree {
    /// Makes the tree under a root; `/` is the host's own.
    #[must_use]
    pub fn of(root: impl AsRef<Path>) -> Self {
        Self { root: root.as_ref().to_owned() }
    }

    fn read(&self, path: &str) -> Option<String> {
        fs::read_to_string(self.root.join(path)).ok().map(|text| text.trim().to_owned())
    }

    /// Names in a folder, sorted.
    fn names(&self, path: &str) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.root.join(path)) else { return Vec::new() };
        let mut names: Vec<String> =
            entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
        names.sort();
        names
    }

    /// Examines everything that the tree describes.
    #[must_use]
    pub fn look(&self) -> Vec<HostFinding> {
        let mut findings = vec![self.kernel(), self.clock_source()];
        findings.extend(self.throttling());
        findings.push(self.governor());
        findings.push(self.machine());
        findings.push(self.serial_ports());
        findings.push(self.can_interfaces());
        findings
    }

    fn kernel(&self) -> HostFinding {
        let release = self.read("proc/sys/kernel/osrelease").unwrap_or_else(|| "unknown".into());
        if self.read("sys/kernel/realtime").as_deref() == Some("1") {
            return HostFinding::new("kernel", Grade::Good, format!("{release}, PREEMPT_RT"));
        }
        HostFinding::new("kernel", Grade::Advice, format!("{release}, not PREEMPT_RT"))
            .advice("a PREEMPT_RT kernel bounds the largest lateness; p99 is good without one")
    }

    fn clock_source(&self) -> HostFinding {
        let path = "sys/devices/system/clocksource/clocksource0/current_clocksource";
        match self.read(path) {
            None => HostFinding::new("clock source", Grade::Advice, "not reported by this system"),
            Some(source) if matches!(&*source, "tsc" | "kvm-clock" | "arch_sys_counter") => {
                HostFinding::new("clock source", Grade::Good, source)
            }
            Some(source) => HostFinding::new("clock source", Grade::Advice, source).advice(
                "every reading of this clock is a system call, or slow: see dmesg for why the \
                 processor's own counter isn't used",
            ),
        }
    }

    /// Finding about throttling: after a share of each period, the kernel stops real-time threads.
    fn throttling(&self) -> Option<HostFinding> {
        let runtime: i64 = self.read("proc/sys/kernel/sched_rt_runtime_us")?.parse().ok()?;
        let period: i64 = self.read("proc/sys/kernel/sched_rt_period_us")?.parse().ok()?;
        let share = format!("{runtime} of {period} us");
        Some(if runtime < 0 || runtime >= period {
            HostFinding::new("real-time throttling", Grade::Good, "off")
        } else {
            // A thread that sleeps for most of its period never reaches the limit.
            HostFinding::new("real-time throttling", Grade::Good, format!("{share}, enough"))
        })
    }

    fn governor(&self) -> HostFinding {
        let mut governors: Vec<String> = self
            .names("sys/devices/system/cpu")
            .iter()
            .filter_map(|cpu| {
                self.read(&format!("sys/devices/system/cpu/{cpu}/cpufreq/scaling_governor"))
            })
            .collect();
        governors.sort();
        governors.dedup();
        let subject = "processor frequency";
        if governors.is_empty() {
            return HostFinding::new(subject, Grade::Good, "not governed by this system");
        }
        let found = format!("governor {}", governors.join(", "));
        if governors == ["performance"] {
            return HostFinding::new(subject, Grade::Good, found);
        }
        HostFinding::new(subject, Grade::Advice, found)
            .advice("cpupower frequency-set -g performance: a slow processor wakes late")
    }

    fn machine(&self) -> HostFinding {
        let info = self.read("proc/cpuinfo").unwrap_or_default();
        let processors = info.lines().filter(|line| line.starts_with("processor")).count();
        let isolated = self.read("sys/devices/system/cpu/isolated").filter(|list| !list.is_empty());
        let is_virtual = info
            .lines()
            .any(|line| line.starts_with("flags") && line.split(' ').any(|f| f == "hypervisor"));
        let mut found = match processors {
            0 => "number of processors unknown".to_owned(),
            1 => "1 processor".to_owned(),
            n => format!("{n} processors"),
        };
        if let Some(list) = &isolated {
            found += &format!(", isolated {list}");
        }
        if is_virtual {
            return HostFinding::new("machine", Grade::Advice, format!("virtual, {found}")).advice(
                "the host of a virtual machine may stop it at any time: certify on a physical machine",
            );
        }
        if processors == 1 {
            return HostFinding::new("machine", Grade::Advice, found)
                .advice("the recorder and everything else share the processor with the bench");
        }
        HostFinding::new("machine", Grade::Good, found)
    }

    fn serial_ports(&self) -> HostFinding {
        // Only ports with a driver count: the kernel makes ttyS0 to ttyS3 even without a chip.
        let real = |name: &String| {
            name.starts_with("tty")
                && fs::exists(self.root.join(format!("sys/class/tty/{name}/device/driver")))
                    .unwrap_or(false)
        };
        let ports: Vec<String> = self.names("sys/class/tty").into_iter().filter(real).collect();
        let subject = "serial ports";
        if ports.is_empty() {
            return HostFinding::new(subject, Grade::Advice, "none").advice(
                "plug the device in and look at dmesg; pseudo terminals and UDP work without it",
            );
        }
        let closed: Vec<&str> = ports
            .iter()
            .filter(|name| limits::is_closed(&self.root.join("dev").join(name)))
            .map(String::as_str)
            .collect();
        let list = ports.iter().map(|name| format!("/dev/{name}")).collect::<Vec<_>>().join(" ");
        if closed.is_empty() {
            return HostFinding::new(subject, Grade::Good, list);
        }
        HostFinding::new(
            subject,
            Grade::Missing,
            format!("{list}; no permission for {}", closed.join(" ")),
        )
        .advice("add the user to the group that the ports belong to (often dialout), log in anew")
    }

    fn can_interfaces(&self) -> HostFinding {
        /// ARPHRD_CAN of the kernel's if_arp.h.
        const CAN: &str = "280";
        let interfaces: Vec<String> = self
            .names("sys/class/net")
            .into_iter()
            .filter(|name| self.read(&format!("sys/class/net/{name}/type")).as_deref() == Some(CAN))
            .collect();
        let subject = "CAN interfaces";
        if interfaces.is_empty() {
            return HostFinding::new(subject, Grade::Advice, "none").advice(
                "load the adapter's driver, or vcan for trials: modprobe vcan; ip link add vcan0 \
                 type vcan; ip link set vcan0 up",
            );
        }
        let state = |name: &String| {
            let up = self
                .read(&format!("sys/class/net/{name}/flags"))
                .and_then(|flags| u32::from_str_radix(flags.trim_start_matches("0x"), 16).ok())
                .is_some_and(|flags| flags & 1 != 0);
            (name.clone(), up)
        };
        let states: Vec<(String, bool)> = interfaces.iter().map(state).collect();
        let list = states
            .iter()
            .map(|(name, up)| format!("{name} {}", if *up { "up" } else { "down" }))
            .collect::<Vec<_>>()
            .join(", ");
        match states.iter().find(|(_, up)| !up) {
            None => HostFinding::new(subject, Grade::Good, list),
            Some((name, _)) => HostFinding::new(subject, Grade::Advice, list).advice(format!(
                "bring it up: ip link set {name} type can bitrate 1000000 restart-ms 100; ip link \
                 set {name} up"
            )),
        }
    }
}

#[cfg(target_os = "linux")]
mod limits {
    use super::{Grade, HostFinding};
    use crate::clock::resolution_ns;
    use rustix::fs::{Access, access};
    use rustix::process::{Resource, getrlimit};
    use rustix::thread::{CapabilitySet, capabilities};
    use std::path::Path;

    fn has(capability: CapabilitySet) -> bool {
        capabilities(None).is_ok_and(|sets| sets.effective.contains(capability))
    }

    pub(super) fn look() -> Vec<HostFinding> {
        let resolution = resolution_ns();
        let grade = if resolution <= 1000 { Grade::Good } else { Grade::Missing };
        let mut timer = HostFinding::new("timer", grade, format!("resolution {resolution} ns"));
        if grade == Grade::Missing {
            timer =
                timer.advice("the kernel has no high-resolution timers (CONFIG_HIGH_RES_TIMERS)");
        }
        vec![timer, priority(), memory()]
    }

    fn priority() -> HostFinding {
        let subject = "real-time priority";
        if has(CapabilitySet::SYS_NICE) {
            return HostFinding::new(subject, Grade::Good, "up to 99, by CAP_SYS_NICE");
        }
        match getrlimit(Resource::Rtprio).current {
            None => HostFinding::new(subject, Grade::Good, "up to 99"),
            Some(0) => HostFinding::new(subject, Grade::Missing, "not permitted").advice(
                "put the user into a group realtime, \"@realtime - rtprio 99\" into \
                 /etc/security/limits.conf, and log in anew",
            ),
            Some(limit) => HostFinding::new(subject, Grade::Good, format!("up to {limit}")),
        }
    }

    fn memory() -> HostFinding {
        let subject = "locked memory";
        if has(CapabilitySet::IPC_LOCK) {
            return HostFinding::new(subject, Grade::Good, "unlimited, by CAP_IPC_LOCK");
        }
        match getrlimit(Resource::Memlock).current {
            None => HostFinding::new(subject, Grade::Good, "unlimited"),
            Some(bytes) => HostFinding::new(
                subject,
                Grade::Missing,
                format!("{} KiB", bytes / 1024),
            )
            .advice(
                "\"@realtime - memlock unlimited\" in /etc/security/limits.conf, and log in anew",
            ),
        }
    }

    /// True for a device that exists but may not be read and written by this user.
    pub(super) fn is_closed(path: &Path) -> bool {
        path.exists() && access(path, Access::READ_OK | Access::WRITE_OK).is_err()
    }
}

#[cfg(not(target_os = "linux"))]
mod limits {
    use super::{Grade, HostFinding};
    use std::path::Path;

    pub(super) fn look() -> Vec<HostFinding> {
        vec![
            HostFinding::new("system", Grade::Missing, std::env::consts::OS)
                .advice("real-time scheduling, locked memory and SocketCAN exist on Linux only"),
        ]
    }

    pub(super) fn is_closed(_path: &Path) -> bool {
        false
    }
}
