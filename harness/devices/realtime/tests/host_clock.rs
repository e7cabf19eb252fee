//! Clocks of the host that somebody sets.

#[cfg(target_os = "linux")]
#[test]
fn the_kernel_tells_its_state() {
    use octant_realtime::kernel_clock::KernelClock;
    let clock = KernelClock::read().unwrap();
    assert!(clock.tai_offset_s < 1000, "{clock:?}");
}

#[test]
fn a_file_that_is_no_clock_is_told() {
    use octant_realtime::hardware_clock::HardwareClock;
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let error = HardwareClock::open(std::path::Path::new(file)).unwrap_err().to_string();
    assert!(error.starts_with(file), "{error}");
    #[cfg(target_os = "linux")]
    assert!(error.contains("found no clock, expected one of PTP"), "{error}");
    let error = HardwareClock::open(std::path::Path::new("/dev/ptp-none")).unwrap_err().to_string();
    assert!(error.starts_with("/dev/ptp-none: "), "{error}");
}
