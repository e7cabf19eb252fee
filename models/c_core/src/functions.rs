//! The functions of the header.
//!
//! Every function checks its pointers for null, the memory for size and alignment, and a core for the mark that
//! [`octant_core_make`] leaves in it. What a pointer leads to otherwise is the caller's word, as everywhere in C.

#![allow(unsafe_code, reason = "memory of the caller is read and written")]

use super::status::{self, CONFIG, MEMORY, NO_CORE, NO_ITEM, NULL, OK};
use super::types::{CAiding, CConfig, COutput, CSample};
use core::ffi::{c_char, c_void};
use core::fmt::Write;
use octant_calibration::Core;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Aiding, DeviceTime, GimbalAngles, Output, Reference, Sample, Status};

/// Mark of a core that was made: "OCTANTCO".
const MARK: u64 = 0x4F43_5441_4E54_434F;

/// A core in memory of the caller.
#[repr(C)]
#[derive(Debug)]
pub struct CoreInC {
    mark: u64,
    core: Core,
}

/// The core that a pointer leads to.
///
/// # Safety
/// The pointer is null or leads to memory of a core's size that was written once.
unsafe fn core<'a>(pointer: *mut CoreInC) -> Result<&'a mut Core, i32> {
    if pointer.is_null() {
        return Err(NULL);
    }
    if !pointer.is_aligned() {
        return Err(NO_CORE);
    }
    // SAFETY: it isn't null, and the caller vouches for the rest; the mark is read before it is taken for a core.
    unsafe {
        if (&raw const (*pointer).mark).read() != MARK {
            return Err(NO_CORE);
        }
        Ok(&mut (*pointer).core)
    }
}

/// Puts a core into memory.
///
/// # Safety
/// The memory has the size that it is said to have, and `to` is a place for a pointer.
unsafe fn place(memory: *mut c_void, size: usize, core: Core, to: *mut *mut CoreInC) {
    debug_assert!(size >= size_of::<CoreInC>());
    let made: *mut CoreInC = memory.cast();
    // SAFETY: `fitting` has seen size and alignment, and the caller vouches for the memory.
    unsafe {
        made.write(CoreInC { mark: MARK, core });
        to.write(made);
    }
}

fn fitting(memory: *mut c_void, size: usize, to: *mut *mut CoreInC) -> Result<(), i32> {
    if memory.is_null() || to.is_null() {
        return Err(NULL);
    }
    if size < size_of::<CoreInC>() || !memory.cast::<CoreInC>().is_aligned() {
        return Err(MEMORY);
    }
    Ok(())
}

fn code(result: Result<(), i32>) -> i32 {
    result.err().unwrap_or(OK)
}

fn put(output: &Output, to: *mut COutput) {
    let Output {
        sequence,
        device_time,
        mode,
        stop,
        moving,
        gimbal_command,
        navigation,
        health,
        nis,
        parameters_revision,
    } = output;
    let made = COutput {
        latitude_rad: navigation.latitude_rad,
        longitude_rad: navigation.longitude_rad,
        height_m: navigation.height_m,
        velocity_mps: navigation.velocity_mps,
        q_nb: navigation.q_nb,
        nis: *nis,
        sequence: *sequence,
        device_time_ns: device_time.ns,
        mode: *mode as i32,
        command_azimuth: gimbal_command.target.azimuth,
        command_roll: gimbal_command.target.roll,
        moving: (*moving).into(),
        stop: (*stop).into(),
        health: health.bits(),
        parameters_revision: *parameters_revision,
        reserved: 0,
    };
    // SAFETY: the callers have seen that it isn't null.
    unsafe { to.write(made) };
}

/// Number of bytes of a core.
#[unsafe(no_mangle)]
pub extern "C" fn octant_core_size() -> usize {
    size_of::<CoreInC>()
}

/// Alignment of a core.
#[unsafe(no_mangle)]
pub extern "C" fn octant_core_align() -> usize {
    align_of::<CoreInC>()
}

/// Text of a code.
#[unsafe(no_mangle)]
pub extern "C" fn octant_status_text(code: i32) -> *const c_char {
    status::text(code).as_ptr()
}

/// Makes a core; `why` gets the reason where the configuration contradicts itself.
///
/// # Safety
/// Pointers are null, or lead to what the header says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_make(
    memory: *mut c_void,
    size: usize,
    config: *const CConfig,
    core: *mut *mut CoreInC,
    why: *mut c_char,
    why_size: usize,
) -> i32 {
    if config.is_null() {
        return NULL;
    }
    // SAFETY: as above.
    code(unsafe {
        fitting(memory, size, core).and_then(|()| {
            let config = super::config::config(&*config)?;
            match Core::new(&config) {
                Ok(made) => {
                    place(memory, size, made, core);
                    Ok(())
                }
                Err(error) => {
                    tell(&error, why, why_size);
                    Err(CONFIG)
                }
            }
        })
    })
}

/// Writes a reason into the caller's buffer, as far as there is room.
///
/// # Safety
/// The buffer is null or has the size that it is said to have.
unsafe fn tell(reason: &dyn core::fmt::Display, to: *mut c_char, size: usize) {
    if to.is_null() || size == 0 {
        return;
    }
    // SAFETY: it isn't null, and the caller vouches for its size.
    let bytes = unsafe { core::slice::from_raw_parts_mut(to.cast::<u8>(), size) };
    // What doesn't fit is cut off.
    let _ = write!(Buffer::new(bytes), "{reason}");
}

/// Changes what can change in a core that runs.
///
/// # Safety
/// As [`octant_core_make`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_tune(
    pointer: *mut CoreInC,
    config: *const CConfig,
    why: *mut c_char,
    why_size: usize,
) -> i32 {
    if config.is_null() {
        return NULL;
    }
    // SAFETY: as said.
    code(unsafe {
        core(pointer).and_then(|core| {
            let config = super::config::config(&*config)?;
            core.tune(&config).map_err(|error| {
                tell(&error, why, why_size);
                CONFIG
            })
        })
    })
}

/// Takes a sample, and a reference or null, and answers.
///
/// # Safety
/// As [`octant_core_make`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_step(
    pointer: *mut CoreInC,
    sample: *const CSample,
    aiding: *const CAiding,
    output: *mut COutput,
) -> i32 {
    if sample.is_null() || output.is_null() {
        return NULL;
    }
    // SAFETY: as said.
    code(unsafe {
        core(pointer).and_then(|core| {
            let CSample {
                sequence,
                device_time_ns,
                delta_theta,
                delta_velocity,
                azimuth,
                roll,
                status,
                reserved: _,
            } = *sample;
            let sample = Sample {
                sequence,
                device_time: DeviceTime::from_ns(device_time_ns),
                delta_theta,
                delta_velocity,
                gimbal: GimbalAngles { azimuth, roll },
                status: Status::from_bits_retain(status as u16),
            };
            let aiding = match aiding.is_null() {
                true => None,
                false => Some(reference(&*aiding)?),
            };
            put(&core.step(&sample, aiding.as_ref()), output);
            Ok(())
        })
    })
}

fn reference(aiding: &CAiding) -> Result<Aiding, i32> {
    let CAiding { value, device_time_ns, kind, reserved: _ } = *aiding;
    let [latitude_rad, longitude_rad, height_m] = value;
    let reference = match kind {
        0 => Reference::Velocity(value),
        1 => Reference::Position { latitude_rad, longitude_rad, height_m },
        _ => return Err(NO_ITEM),
    };
    Ok(Aiding { device_time: DeviceTime::from_ns(device_time_ns), reference })
}

/// Ends the samples: a calibration that runs is concluded.
///
/// # Safety
/// As [`octant_core_make`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_end(pointer: *mut CoreInC, output: *mut COutput) -> i32 {
    if output.is_null() {
        return NULL;
    }
    // SAFETY: as said.
    code(unsafe { core(pointer).map(|core| put(&core.end_of_stream(), output)) })
}

/// Gets the estimated parameters and their standard deviations.
///
/// # Safety
/// As [`octant_core_make`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_parameters(
    pointer: *mut CoreInC,
    value: *mut [f64; PARAMETER_COUNT],
    sigma: *mut [f64; PARAMETER_COUNT],
) -> i32 {
    if value.is_null() || sigma.is_null() {
        return NULL;
    }
    // SAFETY: as said.
    code(unsafe {
        core(pointer).map(|core| {
            value.write(core.parameters().to_array());
            sigma.write(*core.sigma());
        })
    })
}

/// Writes why the calibration was refused; an empty text: it wasn't.
///
/// # Safety
/// As [`octant_core_make`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_refusal(
    pointer: *mut CoreInC,
    text: *mut c_char,
    size: usize,
) -> i32 {
    if text.is_null() {
        return NULL;
    }
    if size == 0 {
        return status::ROOM;
    }
    // SAFETY: as said.
    code(unsafe {
        core(pointer).map(|core| {
            text.write(0);
            if let Some(refusal) = core.refusal() {
                tell(refusal, text, size);
            }
        })
    })
}

/// Copies a core into other memory; the copy continues as the original.
///
/// # Safety
/// As [`octant_core_make`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_copy(
    pointer: *mut CoreInC,
    memory: *mut c_void,
    size: usize,
    copy: *mut *mut CoreInC,
) -> i32 {
    // SAFETY: as said.
    code(unsafe {
        fitting(memory, size, copy).and_then(|()| core(pointer)).and_then(|core| {
            if memory.cast() == pointer {
                return Err(MEMORY);
            }
            place(memory, size, core.clone(), copy);
            Ok(())
        })
    })
}

/// Writes the state as bytes, and their number; with `room` 0 the number alone.
///
/// # Safety
/// As [`octant_core_make`].
#[cfg(feature = "state")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_save(
    pointer: *mut CoreInC,
    bytes: *mut u8,
    room: usize,
    length: *mut usize,
) -> i32 {
    if length.is_null() || bytes.is_null() && room > 0 {
        return NULL;
    }
    // SAFETY: as said.
    code(unsafe {
        core(pointer).and_then(|core| {
            let mut saved = Vec::new();
            core.save(&mut saved);
            length.write(saved.len());
            if room == 0 {
                return Ok(());
            }
            if room < saved.len() {
                return Err(status::ROOM);
            }
            bytes.copy_from_nonoverlapping(saved.as_ptr(), saved.len());
            Ok(())
        })
    })
}

/// Makes a core from the bytes of a state.
///
/// # Safety
/// As [`octant_core_make`].
#[cfg(feature = "state")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn octant_core_load(
    memory: *mut c_void,
    size: usize,
    bytes: *const u8,
    length: usize,
    core: *mut *mut CoreInC,
) -> i32 {
    if bytes.is_null() || length > isize::MAX as usize {
        return NULL;
    }
    // SAFETY: as said.
    code(unsafe {
        fitting(memory, size, core).and_then(|()| {
            let bytes = core::slice::from_raw_parts(bytes, length);
            let loaded = Core::load(bytes).map_err(|_| status::STATE)?;
            place(memory, size, loaded, core);
            Ok(())
        })
    })
}

/// Writes into a buffer, cuts off what doesn't fit, and ends with zero.
pub(crate) struct Buffer<'a> {
    bytes: &'a mut [u8],
    length: usize,
}

impl<'a> Buffer<'a> {
    /// An empty text; the buffer has at least one byte.
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        bytes[0] = 0;
        Self { bytes, length: 0 }
    }
}

impl Write for Buffer<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let room = self.bytes.len() - 1 - self.length;
        let mut end = text.len().min(room);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        self.bytes[self.length..self.length + end].copy_from_slice(&text.as_bytes()[..end]);
        self.length += end;
        self.bytes[self.length] = 0;
        if end == text.len() { Ok(()) } else { Err(core::fmt::Error) }
    }
}
