//! Number of random cases.

/// Returns how many cases a test draws: all, or fewer where many changes wait for it (`CI=true`). The fewer are the
/// first of all.
pub fn draws<T>(all: T, in_ci: T) -> T {
    if std::env::var("CI").is_ok_and(|ci| ci == "true") { in_ci } else { all }
}
