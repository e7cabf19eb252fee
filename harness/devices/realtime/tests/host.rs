//! Real-time facilities of a host, read from a tree of files.

use octant_realtime::host::{Grade, HostFinding, Tree, look};
use std::fs;
use std::path::PathBuf;

/// Makes a tree with these files.
fn tree(files: &[(&str, &str)]) -> (PathBuf, Tree) {
    use std::sync::atomic::{AtomicU32, Ordering};
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let name =
        format!("octant-host-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
    let root = std::env::temp_dir().join(name);
    for (path, text) in files {
        let path = root.join(path);
        fs::create_dir_all(path.parent().unwrap_or(&root)).unwrap_or_else(|e| panic!("{e}"));
        fs::write(&path, text).unwrap_or_else(|e| panic!("{e}"));
    }
    let tree = Tree::of(&root);
    (root, tree)
}

fn found(files: &[(&str, &str)], subject: &str) -> HostFinding {
    let (root, tree) = tree(files);
    let finding = tree.look().into_iter().find(|finding| finding.subject == subject);
    let _ = fs::remove_dir_all(root);
    finding.unwrap_or_else(|| panic!("nothing about {subject}"))
}

#[test]
fn a_bench_as_it_should_be_has_nothing_to_change() {
    let files = [
        ("proc/sys/kernel/osrelease", "6.1.0-rt\n"),
        ("sys/kernel/realtime", "1\n"),
        ("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n"),
        ("proc/sys/kernel/sched_rt_runtime_us", "-1\n"),
        ("proc/sys/kernel/sched_rt_period_us", "1000000\n"),
        ("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n"),
        ("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n"),
        ("sys/devices/system/cpu/isolated", "1\n"),
        ("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu tsc\nprocessor\t: 1\nflags\t\t: fpu\n"),
        ("sys/class/tty/ttyUSB0/device/driver", ""),
        ("sys/class/tty/ttyS0/active", ""),
        ("dev/ttyUSB0", ""),
        ("sys/class/net/can0/type", "280\n"),
        ("sys/class/net/can0/flags", "0x40081\n"),
        ("sys/class/net/eth0/type", "1\n"),
    ];
    let (root, tree) = tree(&files);
    let findings = tree.look();
    let _ = fs::remove_dir_all(root);
    assert!(findings.iter().all(|f| f.grade == Grade::Good && f.advice.is_none()), "{findings:#?}");
    let text = |subject: &str| {
        findings.iter().find(|f| f.subject == subject).map_or("", |finding| finding.found.as_str())
    };
    assert_eq!(text("kernel"), "6.1.0-rt, PREEMPT_RT");
    assert_eq!(text("machine"), "2 processors, isolated 1");
    assert_eq!(text("serial ports"), "/dev/ttyUSB0");
    assert_eq!(text("CAN interfaces"), "can0 up");
}

#[test]
fn what_could_be_better_says_how() {
    let governor = "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor";
    for (file, text, subject, expected, advice) in [
        (governor, "powersave", "processor frequency", "governor powersave", "cpupower"),
        ("proc/sys/kernel/osrelease", "6.1.0", "kernel", "6.1.0, not PREEMPT_RT", "PREEMPT_RT"),
        (
            "sys/devices/system/clocksource/clocksource0/current_clocksource",
            "hpet",
            "clock source",
            "hpet",
            "system call",
        ),
        (
            "proc/cpuinfo",
            "processor : 0\nflags : fpu hypervisor\n",
            "machine",
            "virtual, 1 processor",
            "physical machine",
        ),
        ("sys/class/net/eth0/type", "1", "CAN interfaces", "none", "modprobe vcan"),
        ("sys/class/tty/ttyS0/active", "", "serial ports", "none", "dmesg"),
    ] {
        let finding = found(&[(file, text)], subject);
        assert_eq!((finding.grade, finding.found.as_str()), (Grade::Advice, expected));
        assert!(finding.advice.as_ref().is_some_and(|text| text.contains(advice)), "{finding:?}");
    }
}

#[test]
fn a_can_interface_that_is_down_is_named() {
    let files = [
        ("sys/class/net/can0/type", "280"),
        ("sys/class/net/can0/flags", "0x1"),
        ("sys/class/net/can1/type", "280"),
        ("sys/class/net/can1/flags", "0x40080"),
    ];
    let finding = found(&files, "CAN interfaces");
    assert_eq!(finding.found, "can0 up, can1 down");
    assert!(finding.advice.is_some_and(|advice| advice.contains("ip link set can1 up")));
}

#[test]
fn nothing_is_needed_of_a_tree() {
    let (_, tree) = tree(&[]);
    assert!(!tree.look().is_empty());
    // Findings of the real host, whatever they are.
    for finding in look() {
        assert!(
            !finding.found.is_empty()
                && (finding.grade != Grade::Missing || finding.advice.is_some())
        );
    }
}
