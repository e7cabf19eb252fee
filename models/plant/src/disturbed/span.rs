//! Time of a disturbance.

/// Onset and end of a disturbance.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Span {
    pub(super) handle: u32,
    pub(super) from_ns: u64,
    pub(super) ended_ns: Option<u64>,
}

impl Span {
    pub(super) fn from(handle: u32, from_ns: u64) -> Self {
        Self { handle, from_ns, ended_ns: None }
    }

    /// Seconds from the onset to a time `at_s` after `start_ns`.
    pub(super) fn since_s(&self, start_ns: u64, at_s: f64) -> f64 {
        seconds_between(self.from_ns, start_ns) + at_s
    }

    /// Seconds since the end; `None` before it.
    pub(super) fn since_end_s(&self, start_ns: u64, at_s: f64) -> Option<f64> {
        self.ended_ns.map(|ended_ns| seconds_between(ended_ns, start_ns) + at_s)
    }

    /// Ends the disturbance if it has this handle and has not ended.
    pub(super) fn end(&mut self, handle: u32, now_ns: u64) {
        if self.handle == handle && self.ended_ns.is_none() {
            self.ended_ns = Some(now_ns);
        }
    }
}

/// Seconds from one time to another.
pub(super) fn seconds_between(from_ns: u64, to_ns: u64) -> f64 {
    if to_ns >= from_ns {
        (to_ns - from_ns) as f64 * 1e-9
    } else {
        -((from_ns - to_ns) as f64 * 1e-9)
    }
}
