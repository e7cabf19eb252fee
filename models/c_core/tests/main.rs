//! The core from C: the header is the library's, a program in C gives the core's bits, and wrong calls change nothing.
#![allow(clippy::unwrap_used, unsafe_code, reason = "tests; C functions are called")]

use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::positions::{EIGHT, SIX};
use octant_core::config::{config, in_c};
use octant_core::functions::*;
use octant_core::status;
use octant_core::types::{CAiding, CConfig, COutput, CSample, layout};
use octant_sample::{Aiding, Output, Reference, Sample};
use octant_test_loop::instrument::{InstrumentCase, dockside};
use octant_test_loop::plant_and_core::ClosedLoop;
use octant_test_processes::command;
use std::ffi::{CStr, c_void};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The library that was built with this test, or the one that a rig names.
fn library() -> PathBuf {
    if let Some(named) = std::env::var_os("OCTANT_CORE_LIBRARY") {
        return named.into();
    }
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let is_library = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("liboctant_core-") && name.ends_with(".a")
    };
    let all = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let newest =
        all.filter(is_library).max_by_key(|path| path.metadata().unwrap().modified().unwrap());
    newest.unwrap_or_else(|| panic!("there is no library in {}", folder.display()))
}

/// Compiles a program; `None`: there is no C compiler here.
fn compile(source: &Path, program: &Path, links: bool) -> Option<()> {
    let mut gcc = command("gcc");
    gcc.args(["-std=c11", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"]);
    gcc.arg(here("include")).arg("-o").arg(program).arg(source);
    if links {
        gcc.arg(library()).args(["-lm", "-lpthread", "-ldl"]);
    }
    match gcc.output() {
        Ok(output) => {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Some(())
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: there is no gcc here");
            None
        }
        Err(error) => panic!("run gcc: {error}"),
    }
}

fn said(program: &Path, arguments: &[&Path]) -> String {
    let output = command(program).args(arguments).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {errors}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// A compiler for C says where the fields of the header lie, and the compiler of the library where its own do.
#[test]
fn header_and_library_agree() {
    let folder = tempfile::tempdir().unwrap();
    let (mut source, mut expected) = (String::new(), String::new());
    source += "#include <stdio.h>\n#include \"octant_core.h\"\nint main(void) {\n";
    for (structure, size, fields) in layout() {
        let _ = writeln!(source, "printf(\"{structure} %zu\\n\", sizeof({structure}));");
        let _ = writeln!(expected, "{structure} {size}");
        for (field, place) in fields {
            let _ = writeln!(source, "printf(\"{field} %zu\\n\", offsetof({structure}, {field}));");
            let _ = writeln!(expected, "{field} {place}");
        }
    }
    for (name, code) in status::ALL {
        let _ = writeln!(source, "printf(\"{name} %d\\n\", {name});");
        let _ = writeln!(expected, "{name} {code}");
    }
    source += "return 0; }\n";
    std::fs::write(folder.path().join("layout.c"), source).unwrap();
    let program = folder.path().join("layout");
    let Some(()) = compile(&folder.path().join("layout.c"), &program, false) else { return };
    assert_eq!(said(&program, &[]), expected);
    // Fields that the library doesn't know would lie between these, or at the end.
    for (structure, size, fields) in layout() {
        assert!(fields.windows(2).all(|two| two[0].1 < two[1].1), "{structure}");
        assert_eq!(size % 8, 0, "{structure}");
    }
}

/// # Safety
/// A structure without padding.
unsafe fn bytes_of<T>(value: &T) -> &[u8] {
    // SAFETY: as many bytes as it has.
    unsafe { std::slice::from_raw_parts(std::ptr::from_ref(value).cast(), size_of::<T>()) }
}

fn sample_in_c(sample: &Sample) -> CSample {
    CSample {
        sequence: sample.sequence,
        device_time_ns: sample.device_time.ns,
        delta_theta: sample.delta_theta,
        delta_velocity: sample.delta_velocity,
        azimuth: sample.gimbal.azimuth,
        roll: sample.gimbal.roll,
        status: sample.status.bits().into(),
        reserved: 0,
    }
}

fn aiding_in_c(aiding: &Aiding) -> CAiding {
    let (kind, value) = match aiding.reference {
        Reference::Velocity(velocity) => (0, velocity),
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            (1, [latitude_rad, longitude_rad, height_m])
        }
    };
    CAiding { value, device_time_ns: aiding.device_time.ns, kind, reserved: 0 }
}

fn output_in_c(output: &Output) -> COutput {
    COutput {
        latitude_rad: output.navigation.latitude_rad,
        longitude_rad: output.navigation.longitude_rad,
        height_m: output.navigation.height_m,
        velocity_mps: output.navigation.velocity_mps,
        q_nb: output.navigation.q_nb,
        nis: output.nis,
        sequence: output.sequence,
        device_time_ns: output.device_time.ns,
        mode: output.mode as i32,
        command_azimuth: output.gimbal_command.target.azimuth,
        command_roll: output.gimbal_command.target.roll,
        moving: output.moving.into(),
        stop: output.stop.into(),
        health: output.health.bits(),
        parameters_revision: output.parameters_revision,
        reserved: 0,
    }
}

fn case() -> InstrumentCase {
    InstrumentCase { calibration_h: 0.12, navigation_h: 0.03, ..InstrumentCase::table_1(3, EIGHT) }
}

#[test]
fn a_program_in_c_gives_the_bits_of_the_core() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("replay");
    let Some(()) = compile(&here("example/replay.c"), &program, true) else { return };
    let moored = InstrumentCase { positions: SIX, ..case() };
    for (plant, core) in [(case().plant(), case().core()), dockside(&moored)] {
        let mut bench = ClosedLoop::new(&plant, &core);
        let (mut samples, mut expected): (Vec<u8>, Vec<u8>) = Default::default();
        for _ in 0..100_000 {
            let output = bench
                .step_altered(|sample, aiding| {
                    let given = aiding.unwrap_or(Aiding {
                        device_time: sample.device_time,
                        reference: Reference::Velocity([0.0; 3]),
                    });
                    // SAFETY: structures without padding.
                    unsafe {
                        samples.extend(bytes_of(&sample_in_c(&sample)));
                        samples.extend(bytes_of(&aiding_in_c(&given)));
                        samples.extend(bytes_of(&u64::from(aiding.is_some())));
                    }
                    Some((sample, aiding))
                })
                .unwrap();
            // SAFETY: as above.
            unsafe { expected.extend(bytes_of(&output_in_c(&output))) };
        }
        let end = bench.core.end_of_stream();
        // SAFETY: as above.
        unsafe {
            expected.extend(bytes_of(&output_in_c(&end)));
            expected.extend(bytes_of(&bench.core.parameters().to_array()));
            expected.extend(bytes_of(bench.core.sigma()));
        }
        let path = |name: &str| folder.path().join(name);
        let config = in_c(&core).unwrap();
        // SAFETY: as above.
        std::fs::write(path("config"), unsafe { bytes_of(&config) }).unwrap();
        std::fs::write(path("samples"), &samples).unwrap();
        let told = said(&program, &[&path("config"), &path("samples"), &path("answers")]);
        assert!(told.starts_with(&format!("100000 samples, mode {}", end.mode as i32)), "{told}");
        assert!(end.parameters_revision > 300, "it measured: {}", end.parameters_revision);
        assert!(std::fs::read(path("answers")).unwrap() == expected, "other bits");
    }
}

#[test]
fn every_configuration_survives() {
    let mut all = vec![case().core(), dockside(&case()).1];
    let mut coarse = case().core();
    coarse.alignment = Alignment::Coarse { duration_s: 10.0 };
    coarse.navigation = None;
    coarse.screening = Screening::gated(Recovery::Reset {
        attitude_rad: 1e-3,
        velocity_mps: 2.0,
        position_m: 3.0,
    });
    let mut bare = case().core();
    bare.alignment = Alignment::Inertial { duration_s: 20.0 };
    bare.screening =
        Screening { resolution: (1e-9, 2e-9), vibration: (3e-9, 4e-9), ..Screening::none() };
    bare.initial_parameters.g_dependent[4] = 1e-9;
    bare.navigation.as_mut().unwrap().duration_s = None;
    let mut navigating = case().core();
    navigating.calibration = None;
    all.extend([coarse, bare, navigating]);
    for original in &all {
        assert_eq!(&config(&in_c(original).unwrap()).unwrap(), original);
    }
    let mut other = case().core();
    let reference = ExternalTurntable {
        q_nc: octant_earth::UnitQuaternion::identity(),
        encoder_sigma_rad: 1e-6,
    };
    other.calibration.as_mut().unwrap().estimator = Estimator::ExternalTurntable(reference);
    assert_eq!(in_c(&other), None);
}

/// Memory for a core, as a caller has it.
struct Memory(Vec<u64>);

impl Memory {
    fn new() -> Self {
        assert!(octant_core_align() <= 8);
        Self(vec![0; octant_core_size().div_ceil(8)])
    }

    fn at(&mut self) -> *mut c_void {
        self.0.as_mut_ptr().cast()
    }
}

fn make(memory: &mut Memory, config: &CConfig) -> (i32, *mut CoreInC, String) {
    let (mut core, mut why) = (null_mut(), [0x55_u8; 120]);
    // SAFETY: memory, places and a buffer.
    let code = unsafe {
        octant_core_make(
            memory.at(),
            octant_core_size(),
            config,
            &mut core,
            why.as_mut_ptr().cast(),
            why.len(),
        )
    };
    let why = CStr::from_bytes_until_nul(&why)
        .map_or(String::new(), |why| why.to_str().unwrap().to_owned());
    (code, core, why)
}

#[test]
fn a_wrong_call_is_answered_and_changes_nothing() {
    let good = in_c(&case().core()).unwrap();
    let mut memory = Memory::new();
    let (code, core, _) = make(&mut memory, &good);
    assert_eq!(code, status::OK);
    let size = octant_core_size();
    let (sample, mut output) = (sample_in_c(&Sample::default()), output_in_c(&Output::default()));
    let aiding = CAiding { value: [0.0; 3], device_time_ns: 0, kind: 7, reserved: 0 };
    let mut other = Memory::new();
    let mut copy = null_mut();
    let mut text = [0 as std::ffi::c_char; 4];
    // SAFETY: null, or memory and places.
    unsafe {
        assert_eq!(octant_core_step(null_mut(), &sample, null(), &mut output), status::NULL);
        assert_eq!(octant_core_step(core, null(), null(), &mut output), status::NULL);
        assert_eq!(octant_core_step(core, &sample, null(), null_mut()), status::NULL);
        assert_eq!(octant_core_step(core, &sample, &aiding, &mut output), status::NO_ITEM);
        assert_eq!(
            octant_core_step(other.at().cast(), &sample, null(), &mut output),
            status::NO_CORE
        );
        assert_eq!(octant_core_end(core, null_mut()), status::NULL);
        assert_eq!(octant_core_parameters(core, null_mut(), null_mut()), status::NULL);
        assert_eq!(octant_core_copy(core, other.at(), size - 1, &mut copy), status::MEMORY);
        assert_eq!(octant_core_copy(core, other.at().byte_add(1), size, &mut copy), status::MEMORY);
        assert_eq!(octant_core_copy(core, core.cast(), size, &mut copy), status::MEMORY);
        assert_eq!(octant_core_copy(core, null_mut(), size, &mut copy), status::NULL);
        assert_eq!(octant_core_refusal(core, text.as_mut_ptr(), 0), status::ROOM);
        assert_eq!(octant_core_refusal(core, text.as_mut_ptr(), text.len()), status::OK);
        assert_eq!(text[0], 0);
        assert_eq!(
            octant_core_make(other.at(), size, null(), &mut copy, null_mut(), 0),
            status::NULL
        );
    }
    assert!(copy.is_null());
    // The core is as it was: it answers as one that nobody called wrongly.
    let mut twin = Core::new(&case().core()).unwrap();
    let mut bench = ClosedLoop::new(&case().plant(), &case().core());
    for _ in 0..500 {
        bench.step_altered(|sample, aiding| {
            let given = aiding.map(|aiding| aiding_in_c(&aiding));
            let pointer = given.as_ref().map_or(null(), std::ptr::from_ref);
            // SAFETY: a core, and structures.
            let code =
                unsafe { octant_core_step(core, &sample_in_c(&sample), pointer, &mut output) };
            assert_eq!(code, status::OK);
            let expected = output_in_c(&twin.step(&sample, aiding.as_ref()));
            // SAFETY: structures without padding.
            unsafe { assert_eq!(bytes_of(&output), bytes_of(&expected)) };
            Some((sample, aiding))
        });
    }
    type Change = fn(&mut CConfig);
    let wrong: [(i32, &str, Change); 9] = [
        (status::NO_ITEM, "", |c| c.jumps = 2),
        (status::NO_ITEM, "", |c| c.alignment = -1),
        (status::NO_ITEM, "", |c| c.estimated[6] = 9),
        (status::SEQUENCE, "", |c| c.calibration_stops.count = 65),
        (status::SEQUENCE, "", |c| c.calibration_stops.count = 0),
        (status::SEQUENCE, "", |c| c.navigation_stops.roll_rad[1] = f64::NAN),
        (status::CONFIG, "", |c| c.alignment_q_nb = [1.0, 1.0, 0.0, 0.0]),
        (status::CONFIG, "aiding sigma is NaN, a positive number is expected", |c| {
            c.aiding_sigma = f64::NAN
        }),
        (status::CONFIG, "latitude is 2 rad, within ±1.56 (±89.4 deg) is expected", |c| {
            c.latitude_rad = 2.0
        }),
    ];
    for (expected, said, change) in wrong {
        let mut config = good;
        change(&mut config);
        let (code, made, why) = make(&mut other, &config);
        assert_eq!((code, made.is_null()), (expected, true));
        assert!(why == said || said.is_empty(), "{why}");
        // SAFETY: a core and a configuration.
        let code = unsafe { octant_core_tune(core, &config, null_mut(), 0) };
        assert_eq!(code, expected);
    }
    let mut tuned = good;
    tuned.gate_nis = 20.0;
    let mut fixed = good;
    fixed.height_m += 1.0;
    let mut why = [0x55_u8; 30];
    // SAFETY: a core, configurations and a buffer.
    unsafe {
        assert_eq!(octant_core_tune(core, &tuned, null_mut(), 0), status::OK);
        let code = octant_core_tune(core, &fixed, why.as_mut_ptr().cast(), why.len());
        assert_eq!(code, status::CONFIG);
        // Cut off where the buffer ends.
        let text = CStr::from_bytes_until_nul(&why).unwrap().to_str().unwrap();
        assert_eq!(text, "the site differs from the con");
    }
}

#[test]
fn codes_have_texts() {
    for (_, code) in status::ALL {
        assert_ne!(status::text(*code), status::text(-1));
    }
    // SAFETY: a text of the library.
    let text = unsafe { CStr::from_ptr(octant_status_text(status::ROOM)) };
    assert_eq!(text, c"the buffer is too small");
}

#[cfg(feature = "state")]
#[test]
fn a_state_as_bytes_goes_on_bit_for_bit() {
    let mut memory = Memory::new();
    let (_, core, _) = make(&mut memory, &in_c(&case().core()).unwrap());
    let mut bench = ClosedLoop::new(&case().plant(), &case().core());
    let mut output = output_in_c(&Output::default());
    let mut other = Memory::new();
    let (mut loaded, mut bytes) = (null_mut(), Vec::new());
    for k in 0..3000 {
        bench.step_altered(|sample, aiding| {
            let given = aiding.map(|aiding| aiding_in_c(&aiding));
            let pointer = given.as_ref().map_or(null(), std::ptr::from_ref);
            // SAFETY: cores, and structures.
            unsafe {
                assert_eq!(
                    octant_core_step(core, &sample_in_c(&sample), pointer, &mut output),
                    status::OK
                );
                if k > 1500 {
                    let mut again = output_in_c(&Output::default());
                    let code = octant_core_step(loaded, &sample_in_c(&sample), pointer, &mut again);
                    assert_eq!(code, status::OK);
                    assert_eq!(bytes_of(&again), bytes_of(&output));
                }
            }
            Some((sample, aiding))
        });
        if k == 1500 {
            let mut length = 0;
            let size = octant_core_size();
            // SAFETY: a core, memory and places.
            unsafe {
                assert_eq!(octant_core_save(core, null_mut(), 0, &mut length), status::OK);
                bytes = vec![0_u8; length];
                let to = bytes.as_mut_ptr();
                assert_eq!(octant_core_save(core, to, length - 1, &mut length), status::ROOM);
                assert_eq!(octant_core_save(core, to, length, &mut length), status::OK);
                let load = octant_core_load;
                for end in [0, 1, 20, length - 1] {
                    assert_eq!(
                        load(other.at(), size, bytes.as_ptr(), end, &mut loaded),
                        status::STATE
                    );
                }
                bytes[length / 2] ^= 1;
                assert_eq!(
                    load(other.at(), size, bytes.as_ptr(), length, &mut loaded),
                    status::STATE
                );
                bytes[length / 2] ^= 1;
                assert_eq!(load(other.at(), size, bytes.as_ptr(), length, &mut loaded), status::OK);
            }
        }
    }
    assert!(!bytes.is_empty());
}
