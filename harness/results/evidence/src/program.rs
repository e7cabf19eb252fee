//! This program, and the person who runs it.

/// Computes the SHA-256 of the file that this code is in, hexadecimal; `None` if it can't be read. It is the
/// program, or the library that another program has loaded.
pub fn program_sha256() -> Option<String> {
    // Computed once: the file is large, and stays the same while the program runs.
    static HASH: std::sync::OnceLock<Option<String>> = std::sync::OnceLock::new();
    let hash = || octant_base::hash::sha256(&octant_base::code::file().ok()?).ok();
    HASH.get_or_init(hash).clone()
}

/// Returns the operator's name.
pub fn operator() -> Option<String> {
    let variable = |name: &str| std::env::var(name).ok().filter(|name| !name.trim().is_empty());
    ["OCTANT_OPERATOR", "USER", "LOGNAME", "USERNAME"].into_iter().find_map(variable)
}
