//! The FMU as an importer has it, and bytes on its bus.

use octant_fmi::fmi3::OK;
use octant_fmu::c::fmi3::*;
use octant_fmu::c::{ServedStandard, token};
use octant_fmu::calibrator_can::table::MODEL;
use octant_wire::can::{BusFrame, CanVersion, Segments};
use octant_wire::{EndRole, Message};
use std::ffi::{CString, c_void};
use std::ptr::{null, null_mut};

pub(crate) fn slot(name: &str) -> u32 {
    u32::try_from(MODEL.find(name).unwrap_or_else(|| panic!("no {name}")).0).unwrap()
}

/// An instance with its time.
pub(crate) struct Node {
    pub(crate) handle: *mut c_void,
    pub(crate) time_s: f64,
    /// The tick that was announced, s.
    next_s: Option<f64>,
}

impl Drop for Node {
    fn drop(&mut self) {
        // SAFETY: a handle.
        unsafe { fmi3FreeInstance(self.handle) };
    }
}

impl Node {
    pub(crate) fn instantiated() -> Self {
        let (name, token) = (
            CString::new("node").unwrap(),
            CString::new(token(&MODEL, ServedStandard::Fmi3)).unwrap(),
        );
        // SAFETY: strings, and no callbacks.
        let handle = unsafe {
            let (name, token) = (name.as_ptr(), token.as_ptr());
            fmi3InstantiateCoSimulation(
                name,
                token,
                null(),
                0,
                0,
                1,
                0,
                null(),
                0,
                null_mut(),
                None,
                None,
            )
        };
        assert!(!handle.is_null());
        Self { handle, time_s: 0.0, next_s: None }
    }

    /// In event mode after the initialization, with these Booleans set.
    pub(crate) fn new(settings: &[&str]) -> Self {
        let mut node = Self::instantiated();
        for name in settings {
            // SAFETY: one reference, one value.
            unsafe { assert_eq!(fmi3SetBoolean(node.handle, &slot(name), 1, &1, 1), OK) };
        }
        // SAFETY: a handle.
        unsafe {
            assert_eq!(fmi3EnterInitializationMode(node.handle, 0, 0.0, 0.0, 0, 0.0), OK);
            assert_eq!(fmi3ExitInitializationMode(node.handle), OK);
        }
        node.end_event();
        node
    }

    /// Updates, and asks when it wants to send.
    pub(crate) fn end_event(&mut self) {
        let [mut a, mut b, mut c, mut d, mut defined] = [9; 5];
        let mut time = f64::NAN;
        // SAFETY: places.
        unsafe {
            let status = fmi3UpdateDiscreteStates(
                self.handle,
                &mut a,
                &mut b,
                &mut c,
                &mut d,
                &mut defined,
                &mut time,
            );
            assert_eq!((status, a, b, c, d, defined), (OK, 0, 0, 0, 0, 0));
        }
        let (interval_s, qualifier) = self.interval();
        match qualifier {
            0 => self.next_s = None,
            1 => assert!(self.next_s.is_some(), "unchanged, and never said"),
            _ => self.next_s = Some(self.time_s + interval_s),
        }
    }

    pub(crate) fn interval(&self) -> (f64, i32) {
        let (mut interval_s, mut qualifier) = (f64::NAN, 9);
        // SAFETY: one reference, one place for each.
        unsafe {
            let clock = slot("can.Tx_Clock");
            let status =
                fmi3GetIntervalDecimal(self.handle, &clock, 1, &mut interval_s, &mut qualifier);
            assert_eq!(status, OK);
        }
        assert!(interval_s >= 0.0);
        (interval_s, qualifier)
    }

    /// Bytes come, in event mode.
    pub(crate) fn receive(&mut self, bytes: &[u8]) {
        // SAFETY: one reference, one value.
        unsafe {
            assert_eq!(fmi3SetClock(self.handle, &slot("can.Rx_Clock"), 1, &1), OK);
            let (size, at) = (bytes.len(), bytes.as_ptr());
            assert_eq!(fmi3SetBinary(self.handle, &slot("can.Rx_Data"), 1, &size, &at, 1), OK);
        }
        self.end_event();
    }

    /// Lets the clock tick, and takes what is sent.
    pub(crate) fn tick(&mut self) -> Vec<u8> {
        // SAFETY: one reference, one value.
        unsafe { assert_eq!(fmi3SetClock(self.handle, &slot("can.Tx_Clock"), 1, &1), OK) };
        let bytes = self.sent();
        assert_eq!(self.sent(), bytes, "asked twice");
        self.end_event();
        assert!(self.sent().is_empty(), "nothing is handed on twice");
        bytes
    }

    pub(crate) fn sent(&self) -> Vec<u8> {
        let (mut size, mut at) = (usize::MAX, null());
        // SAFETY: one reference, one place for each; the bytes are there until the next call.
        unsafe {
            let data = slot("can.Tx_Data");
            assert_eq!(fmi3GetBinary(self.handle, &data, 1, &mut size, &mut at, 1), OK);
            if size == 0 { Vec::new() } else { std::slice::from_raw_parts(at, size).to_vec() }
        }
    }

    /// Everything that it sends now.
    pub(crate) fn all_sent(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        while self.next_s.is_some_and(|next_s| next_s <= self.time_s) {
            bytes.extend(self.tick());
        }
        bytes
    }

    /// Everything that it sends until a time, stepping to each announced tick.
    pub(crate) fn run_to(&mut self, end_s: f64) -> Vec<(f64, Vec<u8>)> {
        let mut all = Vec::new();
        loop {
            let now = self.all_sent();
            if !now.is_empty() {
                all.push((self.time_s, now));
            }
            if self.time_s >= end_s {
                return all;
            }
            let to_s = self.next_s.map_or(end_s, |next_s| next_s.min(end_s));
            self.step_to(to_s);
        }
    }

    /// From event mode to event mode at a later time.
    pub(crate) fn step_to(&mut self, time_s: f64) {
        let (mut event, mut terminate, mut early, mut last_s) = (9, 9, 9, f64::NAN);
        // SAFETY: a handle and places.
        unsafe {
            assert_eq!(fmi3EnterStepMode(self.handle), OK);
            let step_s = time_s - self.time_s;
            let status = fmi3DoStep(
                self.handle,
                self.time_s,
                step_s,
                1,
                &mut event,
                &mut terminate,
                &mut early,
                &mut last_s,
            );
            assert_eq!((status, terminate, early), (OK, 0, 0));
            assert_eq!(fmi3EnterEventMode(self.handle), OK);
        }
        self.time_s += time_s - self.time_s;
        assert_eq!(last_s.to_bits(), self.time_s.to_bits());
        self.end_event();
    }

    pub(crate) fn count(&self, name: &str) -> u64 {
        let mut value = u64::MAX;
        // SAFETY: one reference, one value.
        unsafe { assert_eq!(fmi3GetUInt64(self.handle, &slot(name), 1, &mut value, 1), OK) };
        value
    }

    pub(crate) fn item(&self, name: &str) -> i64 {
        let mut value = i64::MAX;
        // SAFETY: one reference, one value.
        unsafe { assert_eq!(fmi3GetInt64(self.handle, &slot(name), 1, &mut value, 1), OK) };
        value
    }

    pub(crate) fn reals<const N: usize>(&self, name: &str) -> [f64; N] {
        let mut values = [f64::NAN; N];
        // SAFETY: one reference, so many values.
        unsafe {
            let status = fmi3GetFloat64(self.handle, &slot(name), 1, values.as_mut_ptr(), N);
            assert_eq!(status, OK);
        }
        values
    }

    /// Its state as bytes, in another instance.
    pub(crate) fn moved(&self) -> Self {
        let mut other = Self::instantiated();
        (other.time_s, other.next_s) = (self.time_s, self.next_s);
        let (mut state, mut size) = (null_mut(), 0);
        // SAFETY: places, and as many bytes as are said.
        unsafe {
            assert_eq!(fmi3GetFMUState(self.handle, &mut state), OK);
            assert_eq!(fmi3SerializedFMUStateSize(self.handle, state, &mut size), OK);
            let mut bytes = vec![0; size];
            assert_eq!(fmi3SerializeFMUState(self.handle, state, bytes.as_mut_ptr(), size), OK);
            let mut moved = null_mut();
            let status = fmi3DeserializeFMUState(other.handle, bytes.as_ptr(), size, &mut moved);
            assert_eq!(status, OK);
            assert_eq!(fmi3SetFMUState(other.handle, moved), OK);
            // The frame that was read equals the written one.
            assert_eq!(fmi3GetFMUState(other.handle, &mut moved), OK);
            let mut again = vec![0; size];
            assert_eq!(fmi3SerializeFMUState(other.handle, moved, again.as_mut_ptr(), size), OK);
            assert_eq!(again, bytes);
            // Half of it is refused.
            let status = fmi3DeserializeFMUState(
                Self::instantiated().handle,
                bytes.as_ptr(),
                size / 2,
                &mut moved,
            );
            assert_ne!(status, OK);
        }
        other
    }
}

/// An operation with its code and arguments.
pub(crate) fn operation(code: u32, arguments: &[&[u8]]) -> Vec<u8> {
    let arguments = arguments.concat();
    let length = 8 + u32::try_from(arguments.len()).unwrap();
    [&code.to_le_bytes()[..], &length.to_le_bytes(), &arguments].concat()
}

pub(crate) fn transmit(frame: &BusFrame) -> Vec<u8> {
    let (id, size) = (u32::from(frame.id()).to_le_bytes(), frame.data().len() as u16);
    let size = size.to_le_bytes();
    match frame.format() {
        CanVersion::Classic => operation(0x10, &[&id, &[0, 0], &size, frame.data()]),
        CanVersion::Fd => operation(0x11, &[&id, &[0, 1, 0], &size, frame.data()]),
    }
}

/// A message of the harness as operations.
pub(crate) fn frames(message: &Message, format: CanVersion) -> Vec<u8> {
    let segments: Segments = octant_wire::can::segments(message, EndRole::Harness, format).unwrap();
    segments.flat_map(|frame| transmit(&frame)).collect()
}

/// The operations in bytes: code and arguments.
pub(crate) fn operations(mut bytes: &[u8]) -> Vec<(u32, Vec<u8>)> {
    let mut all = Vec::new();
    while !bytes.is_empty() {
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let (code, length) = (number(0), number(4) as usize);
        all.push((code, bytes[8..length].to_vec()));
        bytes = &bytes[length..];
    }
    all
}

/// The frames in operations; other operations are left out.
pub(crate) fn frames_of(bytes: &[u8]) -> Vec<BusFrame> {
    operations(bytes).iter().filter_map(|(code, arguments)| frame_of(*code, arguments)).collect()
}

pub(crate) fn frame_of(code: u32, arguments: &[u8]) -> Option<BusFrame> {
    let id = u16::from_le_bytes([arguments[0], *arguments.get(1)?]);
    match code {
        0x10 => {
            assert_eq!(arguments[4..6], [0, 0], "not extended, not remote");
            BusFrame::new(id, CanVersion::Classic, &arguments[8..])
        }
        0x11 => {
            assert_eq!(arguments[4..6], [0, 1], "not extended, with a switch of the bit rate");
            BusFrame::new(id, CanVersion::Fd, &arguments[9..])
        }
        _ => None,
    }
}
