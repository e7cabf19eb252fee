//! Sources that are named on the command line.

use crate::failure::Failure;

/// Makes the file of a source absolute: a name on the command line is relative to the current
/// folder, one in a scenario to the scenario's.
///
/// # Errors
/// If the current folder can't be found.
pub fn from_here(uri: &str) -> Result<String, Failure> {
    match uri.split_once(':') {
        // A solution that comes from a port.
        Some(("solution", port)) if octant_link::Uri::is_one(port) => Ok(uri.to_owned()),
        Some((kind @ ("replay" | "text" | "log" | "fmu" | "solution"), file))
            if !file.is_empty() && !file.starts_with("${") =>
        {
            let file = std::path::absolute(file)
                .map_err(|error| Failure::input(format!("failed to find {file}: {error}")))?;
            Ok(format!("{kind}:{}", file.display()))
        }
        _ => Ok(uri.to_owned()),
    }
}
