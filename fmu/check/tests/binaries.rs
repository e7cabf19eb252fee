//! Folders of binaries, and libraries that every system has.

use object::BinaryFormat;
use octant_fmu_check::binaries::{is_usual, platform};
use octant_fmu_host::description::Standard;

#[test]
fn folders_have_the_names_of_their_standard() {
    let name = |folder, standard| match platform(folder, standard) {
        Ok(platform) => format!("{:?} {:?}", platform.format, platform.architecture),
        Err(Some(_)) => "other".into(),
        Err(None) => "none".into(),
    };
    for (folder, fmi2, fmi3) in [
        ("linux64", "Elf X86_64", "other"),
        ("win32", "Pe I386", "other"),
        ("darwin64", "MachO X86_64", "other"),
        ("x86_64-linux", "other", "Elf X86_64"),
        ("x86-windows", "other", "Pe I386"),
        ("x86_64-windows-msvc140mt", "other", "Pe X86_64"),
        ("aarch64-linux", "Elf Aarch64", "Elf Aarch64"),
        ("aarch64-darwin", "MachO Aarch64", "MachO Aarch64"),
        ("linux", "none", "none"),
        ("sparc-solaris", "none", "none"),
        ("x86_64-", "none", "none"),
    ] {
        assert_eq!(name(folder, Standard::Fmi2), fmi2, "{folder}");
        assert_eq!(name(folder, Standard::Fmi3), fmi3, "{folder}");
    }
}

#[test]
fn usual_libraries_are_told_from_others() {
    for (format, usual, unusual) in [
        (
            BinaryFormat::Elf,
            &["libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2", "libgcc_s.so.1"][..],
            &["libfoo.so", "libpython3.11.so.1.0", "libcrypto.so.3"][..],
        ),
        (
            BinaryFormat::Pe,
            &["KERNEL32.dll", "api-ms-win-crt-math-l1-1-0.dll", "MSVCRT.dll"],
            &["VCRUNTIME140.dll", "libgcc_s_seh-1.dll"],
        ),
        (BinaryFormat::MachO, &["/usr/lib/libSystem.B.dylib"], &["@rpath/libfoo.dylib"]),
    ] {
        assert!(usual.iter().all(|name| is_usual(format, name)));
        assert!(!unusual.iter().any(|name| is_usual(format, name)));
    }
}
