//! Checks of the names of entries in an archive.

use std::collections::BTreeMap;

/// Longest name of an entry, bytes, for which Windows and every other file system have room below a
/// temporary folder.
pub const NAME_BYTES_MAX: usize = 1024;

/// Longest part of a name between two slashes, bytes: the limit of ext4, NTFS and APFS.
pub const PART_BYTES_MAX: usize = 255;

/// Deepest nesting of folders, far beyond that of any tool.
pub const DEPTH_MAX: usize = 64;

/// Problem of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameProblem {
    /// Name, made printable.
    pub name: String,
    /// Problem found.
    pub found: String,
    /// Form expected.
    pub expected: &'static str,
}

/// Checks that a name is a path inside the folder on every platform, and returns it.
///
/// # Errors
/// If it isn't, with its problem.
pub fn check(raw: &[u8]) -> Result<&str, NameProblem> {
    let problem =
        |found: String, expected| Err(NameProblem { name: printable(raw), found, expected });
    let Ok(name) = std::str::from_utf8(raw) else {
        return problem("isn't UTF-8".into(), "a name in UTF-8");
    };
    if name.is_empty() {
        return problem("is empty".into(), "a name");
    }
    if name.len() > NAME_BYTES_MAX {
        return problem(format!("has {} bytes", name.len()), "at most 1024 bytes");
    }
    if let Some(c) = name.chars().find(|c| c.is_control()) {
        return problem(format!("has the control character U+{:04X}", c as u32), "printable text");
    }
    if name.contains('\\') {
        return problem("has a backslash".into(), "forward slashes between folders");
    }
    if name.starts_with('/') {
        return problem("is an absolute path".into(), "a path relative to the archive");
    }
    let bytes = name.as_bytes();
    if bytes.len() >= 2 && bytes[0].is_ascii_alphabetic() && bytes[1] == b':' {
        return problem("has a drive letter".into(), "a path relative to the archive");
    }
    let parts: Vec<&str> = name.strip_suffix('/').unwrap_or(name).split('/').collect();
    if parts.len() > DEPTH_MAX {
        return problem(format!("is {} folders deep", parts.len()), "at most 64");
    }
    for part in parts {
        if part == ".." {
            return problem(
                "leaves the folder".into(),
                "a path inside the archive, without \"..\"",
            );
        }
        if part.is_empty() || part == "." {
            return problem(format!("has the part {part:?}"), "a plain path");
        }
        if part.len() > PART_BYTES_MAX {
            return problem(format!("has a part of {} bytes", part.len()), "at most 255 bytes");
        }
    }
    Ok(name)
}

/// Checks a name that [`check`] has passed for Windows; other systems accept it.
///
/// # Errors
/// If Windows doesn't accept it.
pub fn check_for_windows(name: &str) -> Result<(), NameProblem> {
    let problem = |found: String, expected| {
        Err(NameProblem { name: printable(name.as_bytes()), found, expected })
    };
    if let Some(c) = name.chars().find(|c| matches!(c, ':' | '*' | '?' | '"' | '<' | '>' | '|')) {
        return problem(format!("has the character {c:?}"), "a name that Windows can hold as well");
    }
    for part in name.split('/') {
        if part.ends_with(['.', ' ']) {
            return problem(
                format!("has the part {part:?}, whose end Windows drops"),
                "no dot or blank at the end of a part",
            );
        }
        if is_device(part) {
            return problem(
                format!("has the part {part:?}, a device on Windows"),
                "a name that Windows can hold as well",
            );
        }
    }
    Ok(())
}

/// Returns whether a name opens a device on Windows, with any extension.
fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or(part).trim_end().to_ascii_uppercase();
    match stem.as_str() {
        "CON" | "PRN" | "AUX" | "NUL" | "CONIN$" | "CONOUT$" => true,
        _ => {
            let number = stem.strip_prefix("COM").or_else(|| stem.strip_prefix("LPT"));
            number.is_some_and(|n| n.len() == 1 && n.as_bytes()[0].is_ascii_digit() && n != "0")
        }
    }
}

/// Converts bytes to text for a message: unprintable characters are escaped, and a long text is
/// cut.
#[must_use]
pub fn printable(raw: &[u8]) -> String {
    let mut text: String = raw
        .iter()
        .take(120)
        .flat_map(|&byte| std::ascii::escape_default(byte))
        .map(char::from)
        .collect();
    if let Ok(plain) = std::str::from_utf8(raw)
        && raw.len() <= 120
        && !plain.chars().any(char::is_control)
    {
        plain.clone_into(&mut text);
    }
    if raw.len() > 120 {
        text.push('…');
    }
    text
}

/// Names that can't exist side by side: the same twice, the same except for upper and lower case,
/// or a file that another name uses as a folder.
#[derive(Debug, Default)]
pub struct Names {
    /// By name in lower case: the name as written, and whether it is a folder (perhaps only as part
    /// of the path of a file).
    seen: BTreeMap<String, (String, bool)>,
}

impl Names {
    /// Adds a name that [`check`] has passed.
    ///
    /// # Errors
    /// If the name collides with an earlier one.
    pub fn add(&mut self, name: &str) -> Result<(), NameProblem> {
        let problem = |found: String, expected| {
            Err(NameProblem { name: printable(name.as_bytes()), found, expected })
        };
        let is_folder = name.ends_with('/');
        let path = name.strip_suffix('/').unwrap_or(name);
        let ends = path.match_indices('/').map(|(at, _)| at).chain([path.len()]);
        for end in ends {
            let prefix = &path[..end];
            let folder = end < path.len() || is_folder;
            match self.seen.get(&prefix.to_lowercase()) {
                None => {
                    self.seen.insert(prefix.to_lowercase(), (prefix.to_owned(), folder));
                }
                Some((other, _)) if other != prefix => {
                    return problem(
                        format!(
                            "differs from {:?} in upper and lower case alone",
                            printable(other.as_bytes())
                        ),
                        "names that differ on every file system",
                    );
                }
                Some((_, true)) if folder => {}
                Some((_, false)) if !folder => {
                    return problem("is there twice".into(), "one entry of a name");
                }
                Some(_) => {
                    return problem(
                        format!("makes {:?} a file and a folder", printable(prefix.as_bytes())),
                        "one of both",
                    );
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_pass() {
        for name in [
            "modelDescription.xml",
            "binaries/",
            "binaries/x86_64-linux/model.so",
            "resources/Größe.txt",
            "resources/..hidden",
            "resources/com0.txt",
            "a b/c-d_e+f",
        ] {
            assert_eq!(check(name.as_bytes()), Ok(name));
        }
    }

    #[test]
    fn every_way_out_of_the_folder_is_named() {
        let long = "a/".repeat(65) + "b";
        let part = "a".repeat(256);
        let name = "a/".repeat(40) + &"b".repeat(1000);
        for (name, found) in [
            (&b"../x"[..], "leaves the folder"),
            (b"a/../../x", "leaves the folder"),
            (b"a/..", "leaves the folder"),
            (b"/etc/passwd", "absolute"),
            (b"//host/share", "absolute"),
            (b"a\\b", "backslash"),
            (b"..\\x", "backslash"),
            (b"C:/x", "drive letter"),
            (b"c:x", "drive letter"),
            (b"a//b", "part \"\""),
            (b"./a", "part \".\""),
            (b"", "empty"),
            (b"/", "absolute"),
            (b"a\0b", "U+0000"),
            (b"a\nb", "U+000A"),
            (b"a\xff", "UTF-8"),
            (long.as_bytes(), "66 folders deep"),
            (part.as_bytes(), "256 bytes"),
            (name.as_bytes(), "1080 bytes"),
        ] {
            let problem = check(name).expect_err("a hostile name passes");
            assert!(problem.found.contains(found), "{problem:?}, expected {found}");
        }
    }

    #[test]
    fn what_windows_can_not_hold_is_named() {
        for name in ["binaries/", "binaries/x86_64-linux/model.so", "a/com0.txt", "a/.b", "nulls"] {
            assert_eq!(check_for_windows(name), Ok(()), "{name}");
        }
        for (name, found) in [
            ("a/b:stream", "character ':'"),
            ("a?", "character '?'"),
            ("a./b", "Windows drops"),
            ("a /b", "Windows drops"),
            ("x/nul", "device"),
            ("x/Com1.txt", "device"),
            ("AUX", "device"),
        ] {
            assert_eq!(check(name.as_bytes()), Ok(name));
            let problem = check_for_windows(name).expect_err("Windows can't hold it");
            assert!(problem.found.contains(found), "{problem:?}, expected {found}");
        }
    }

    #[test]
    fn names_that_collide_are_named() {
        let add = |names: &[&str]| {
            let mut seen = Names::default();
            names.iter().try_for_each(|name| seen.add(name)).map_err(|problem| problem.found)
        };
        assert_eq!(add(&["a/", "a/b", "a/c/", "a/c/d", "a/"]), Ok(()));
        assert!(add(&["a", "a"]).expect_err("twice").contains("twice"));
        assert!(add(&["a/b", "a/B"]).expect_err("case").contains("upper and lower case"));
        assert!(add(&["A/b", "a/c"]).expect_err("case of a folder").contains("upper and lower"));
        assert!(add(&["Ä", "ä"]).expect_err("case").contains("upper and lower case"));
        assert!(add(&["a", "a/b"]).expect_err("both").contains("a file and a folder"));
        assert!(add(&["a/b", "a"]).expect_err("both").contains("a file and a folder"));
    }
}
