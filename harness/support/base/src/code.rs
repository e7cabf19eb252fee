//! The file that this code is in: the program, or a library that another program has loaded.

use std::path::PathBuf;

/// Path of the file that this code is in.
///
/// # Errors
/// If the program doesn't find its own file.
pub fn file() -> std::io::Result<PathBuf> {
    // The kernel knows which file lies at an address; elsewhere than on Linux the code is the program's.
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    match file_at(&maps, file as fn() -> std::io::Result<PathBuf> as usize) {
        Some(path) => Ok(path),
        None => std::env::current_exe(),
    }
}

/// File that is mapped at an address, of lines such as `7f00-7f80 r-xp 00001000 08:01 42   /usr/bin/octant`.
fn file_at(maps: &str, address: usize) -> Option<PathBuf> {
    maps.lines().find_map(|line| {
        let mut words = line.splitn(6, ' ');
        let (from, to) = words.next()?.split_once('-')?;
        let number = |text| usize::from_str_radix(text, 16).ok();
        let path = words.nth(4)?.trim_start();
        let is_there = (number(from)?..number(to)?).contains(&address) && path.starts_with('/');
        // A file that was replaced while it runs is no longer there under its name.
        (is_there && !path.ends_with(" (deleted)")).then(|| PathBuf::from(path))
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn the_code_of_a_program_is_in_the_program() {
        let (code, program) = (file().unwrap(), std::env::current_exe().unwrap());
        assert_eq!(code.canonicalize().unwrap(), program.canonicalize().unwrap());
    }

    #[test]
    fn a_file_is_found_by_an_address_in_it() {
        let maps = "1000-2000 r--p 00000000 08:01 42                 /usr/bin/python3\n\
                    3000-4000 rw-p 00000000 00:00 0 \n\
                    5000-6000 r-xp 00001000 08:01 43                 /opt/my lib/_octant.abi3.so\n\
                    7000-8000 r-xp 00001000 08:01 44                 /opt/gone.so (deleted)\n\
                    9000-a000 r-xp 00000000 00:00 0                  [vdso]\n";
        assert_eq!(file_at(maps, 0x1fff), Some("/usr/bin/python3".into()));
        assert_eq!(file_at(maps, 0x5000), Some("/opt/my lib/_octant.abi3.so".into()));
        for nowhere in [0x2000, 0x3000, 0x7000, 0x9000] {
            assert_eq!(file_at(maps, nowhere), None);
        }
    }
}
