//! A small importer on the functions of both standards.

use core::ffi::{CStr, c_char, c_void};
use octant_fmi::fmi2::OK;
use octant_fmu::c::fmi2::*;
use octant_fmu::c::fmi3::*;
use octant_fmu::c::{ServedStandard, fnv_1a, token};
use octant_fmu::table::Model;
use std::ffi::CString;
use std::ptr::{null, null_mut};
use std::sync::Mutex;

/// Start of a hash of outputs.
pub(super) const HASH: u128 = 0;

/// Adds numbers to a hash of outputs.
pub(super) fn add(hash: &mut u128, values: &[f64]) {
    for value in values {
        let mut bytes = hash.to_le_bytes().to_vec();
        bytes.extend(value.to_bits().to_le_bytes());
        *hash = fnv_1a(&bytes);
    }
}

type Heard = Mutex<Vec<String>>;

unsafe extern "C" fn hear(environment: *mut c_void, _: i32, _: *const c_char, text: *const c_char) {
    // SAFETY: the list that the instance was made with, and a string.
    let (heard, text) = unsafe { (&*environment.cast::<Heard>(), CStr::from_ptr(text)) };
    heard.lock().unwrap().push(text.to_string_lossy().into_owned());
}

/// An instance after its initialization, with its time and the hash of its increments.
pub(super) struct Importer {
    handle: *mut c_void,
    model: &'static Model,
    standard: ServedStandard,
    events: bool,
    steps: u64,
    pub(super) hash: u128,
    heard: Box<Heard>,
}

impl Drop for Importer {
    fn drop(&mut self) {
        // SAFETY: a handle.
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2FreeInstance(self.handle),
                ServedStandard::Fmi3 => fmi3FreeInstance(self.handle),
            }
        }
    }
}

impl Importer {
    pub(super) fn new(model: &'static Model, standard: ServedStandard, events: bool) -> Self {
        let name = CString::new("tuned").unwrap();
        let token = CString::new(token(model, standard)).unwrap();
        let heard = Box::new(Heard::default());
        let environment: *mut c_void = core::ptr::from_ref(&*heard).cast_mut().cast();
        // SAFETY: strings and places, and the list lives as long as the instance.
        let handle = unsafe {
            match standard {
                ServedStandard::Fmi2 => {
                    fmi2Instantiate(name.as_ptr(), 1, token.as_ptr(), null(), null(), 0, 0)
                }
                ServedStandard::Fmi3 => fmi3InstantiateCoSimulation(
                    name.as_ptr(),
                    token.as_ptr(),
                    null(),
                    0,
                    1,
                    u8::from(events),
                    0,
                    null(),
                    0,
                    environment,
                    Some(hear),
                    None,
                ),
            }
        };
        assert!(!handle.is_null());
        let this = Self { handle, model, standard, events, steps: 0, hash: HASH, heard };
        this.initialize();
        this
    }

    fn initialize(&self) {
        // SAFETY: a handle.
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    assert_eq!(fmi2SetupExperiment(self.handle, 0, 0.0, 0.0, 0, 0.0), OK);
                    assert_eq!(fmi2EnterInitializationMode(self.handle), OK);
                    assert_eq!(fmi2ExitInitializationMode(self.handle), OK);
                }
                ServedStandard::Fmi3 => {
                    assert_eq!(fmi3EnterInitializationMode(self.handle, 0, 0.0, 0.0, 0, 0.0), OK);
                    assert_eq!(fmi3ExitInitializationMode(self.handle), OK);
                }
            }
        }
        self.leave_event();
    }

    /// Parameters are set in event mode where the importer has it.
    fn enter_event(&self) {
        if self.events {
            // SAFETY: a handle.
            unsafe { assert_eq!(fmi3EnterEventMode(self.handle), OK) };
        }
    }

    fn leave_event(&self) {
        if !self.events {
            return;
        }
        let ([mut a, mut b, mut c, mut d, mut e], mut next_s) = ([9; 5], f64::NAN);
        let update = fmi3UpdateDiscreteStates;
        // SAFETY: a handle and places.
        unsafe {
            let status = update(self.handle, &mut a, &mut b, &mut c, &mut d, &mut e, &mut next_s);
            assert_eq!((status, a, b), (OK, 0, 0));
            assert_eq!(fmi3EnterStepMode(self.handle), OK);
        }
    }

    fn at_event(&self, expected: i32, set: impl FnOnce() -> i32) {
        self.enter_event();
        assert_eq!(set(), expected, "{:?}", self.heard());
        if expected != octant_fmi::fmi2::ERROR {
            self.leave_event();
        }
    }

    fn slot(&self, name: &str) -> (u32, usize) {
        let (slot, variable) = self.model.find(name).unwrap_or_else(|| panic!("no {name}"));
        (slot as u32, variable.slots())
    }

    /// All elements in one call: all of them, or none.
    pub(super) fn set_real(&mut self, name: &str, values: &[f64], expected: i32) {
        let (slot, elements) = self.slot(name);
        assert_eq!(values.len(), elements);
        self.at_event(expected, || {
            let references: Vec<u32> = (slot..).take(elements).collect();
            // SAFETY: as many references and values as said.
            unsafe {
                match self.standard {
                    ServedStandard::Fmi2 => {
                        fmi2SetReal(self.handle, references.as_ptr(), elements, values.as_ptr())
                    }
                    ServedStandard::Fmi3 => {
                        fmi3SetFloat64(self.handle, &slot, 1, values.as_ptr(), elements)
                    }
                }
            }
        });
    }

    pub(super) fn set_boolean(&mut self, name: &str, value: bool, expected: i32) {
        let (slot, _) = self.slot(name);
        self.at_event(expected, || {
            // SAFETY: one reference, one value.
            unsafe {
                match self.standard {
                    ServedStandard::Fmi2 => {
                        fmi2SetBoolean(self.handle, &slot, 1, &i32::from(value))
                    }
                    ServedStandard::Fmi3 => {
                        fmi3SetBoolean(self.handle, &slot, 1, &u8::from(value), 1)
                    }
                }
            }
        });
    }

    pub(super) fn real(&self, name: &str) -> Vec<f64> {
        let (slot, elements) = self.slot(name);
        let mut values = vec![f64::NAN; elements];
        let references: Vec<u32> = (slot..).take(elements).collect();
        // SAFETY: as many references and places as said.
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    fmi2GetReal(self.handle, references.as_ptr(), elements, values.as_mut_ptr())
                }
                ServedStandard::Fmi3 => {
                    fmi3GetFloat64(self.handle, &slot, 1, values.as_mut_ptr(), elements)
                }
            }
        };
        assert_eq!(status, OK);
        values
    }

    pub(super) fn steps(&mut self, count: u64) {
        for _ in 0..count {
            let time_s = self.steps as f64 * super::PERIOD_S;
            let (mut event, mut terminate, mut early, mut last_s) = (9, 9, 9, f64::NAN);
            // SAFETY: a handle and places.
            let status = unsafe {
                match self.standard {
                    ServedStandard::Fmi2 => fmi2DoStep(self.handle, time_s, super::PERIOD_S, 1),
                    ServedStandard::Fmi3 => fmi3DoStep(
                        self.handle,
                        time_s,
                        super::PERIOD_S,
                        0,
                        &mut event,
                        &mut terminate,
                        &mut early,
                        &mut last_s,
                    ),
                }
            };
            assert_eq!(status, OK);
            self.steps += 1;
            for name in ["gyro.delta_theta", "accelerometer.delta_velocity"] {
                let values = self.real(name);
                add(&mut self.hash, &values);
            }
        }
    }

    pub(super) fn keep(&mut self) -> (*mut c_void, u64) {
        let mut state = null_mut();
        // SAFETY: a handle and a place.
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2GetFMUstate(self.handle, &mut state),
                ServedStandard::Fmi3 => fmi3GetFMUState(self.handle, &mut state),
            }
        };
        assert_eq!(status, OK);
        (state, self.steps)
    }

    pub(super) fn restore(&mut self, (state, steps): (*mut c_void, u64)) {
        // SAFETY: a handle and a state.
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2SetFMUstate(self.handle, state),
                ServedStandard::Fmi3 => fmi3SetFMUState(self.handle, state),
            }
        };
        assert_eq!(status, OK);
        self.steps = steps;
    }

    pub(super) fn bytes(&mut self, (state, steps): (*mut c_void, u64)) -> (Vec<u8>, u64) {
        let mut size = 0;
        // SAFETY: a handle, a state and places.
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    assert_eq!(fmi2SerializedFMUstateSize(self.handle, state, &mut size), OK);
                    let mut bytes = vec![0u8; size];
                    let to = bytes.as_mut_ptr().cast();
                    assert_eq!(fmi2SerializeFMUstate(self.handle, state, to, size), OK);
                    (bytes, steps)
                }
                ServedStandard::Fmi3 => {
                    assert_eq!(fmi3SerializedFMUStateSize(self.handle, state, &mut size), OK);
                    let mut bytes = vec![0u8; size];
                    let to = bytes.as_mut_ptr();
                    assert_eq!(fmi3SerializeFMUState(self.handle, state, to, size), OK);
                    (bytes, steps)
                }
            }
        }
    }

    pub(super) fn keep_bytes(&mut self, (bytes, steps): &(Vec<u8>, u64)) -> (*mut c_void, u64) {
        let mut state = null_mut();
        let size = bytes.len();
        // SAFETY: a handle, bytes and a place.
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    fmi2DeSerializeFMUstate(self.handle, bytes.as_ptr().cast(), size, &mut state)
                }
                ServedStandard::Fmi3 => {
                    fmi3DeserializeFMUState(self.handle, bytes.as_ptr(), size, &mut state)
                }
            }
        };
        assert_eq!(status, OK);
        (state, *steps)
    }

    pub(super) fn reset(&mut self) {
        // SAFETY: a handle.
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => assert_eq!(fmi2Reset(self.handle), OK),
                ServedStandard::Fmi3 => assert_eq!(fmi3Reset(self.handle), OK),
            }
        }
        self.initialize();
    }

    pub(super) fn heard(&self) -> Vec<String> {
        self.heard.lock().unwrap().clone()
    }

    /// Returns whether a message had these words; FMI 2.0's callback takes a list that Rust can't read, and
    /// isn't asked.
    pub(super) fn said(&self, words: &str) -> bool {
        self.standard == ServedStandard::Fmi2
            || self.heard().iter().any(|text| text.contains(words))
    }
}
