//! Steps FMUs with an importer of others over the reference inputs that they carry, and compares every output with the
//! reference result, bit for bit.
//!
//! Usage: importer fmi|fmi-rs FMU...

mod fmi_crate;
mod fmi_rs_crate;
mod reference;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

type Anything<T> = Result<T, Box<dyn Error>>;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let check = match arguments.next().as_deref() {
        Some("fmi") => fmi_crate::check,
        Some("fmi-rs") => fmi_rs_crate::check,
        _ => {
            eprintln!("usage: importer fmi|fmi-rs FMU...");
            return ExitCode::from(2);
        }
    };
    let paths: Vec<String> = arguments.collect();
    let mut failed = paths.is_empty();
    for path in paths {
        match check(Path::new(&path)) {
            Ok(compared) => println!("ok   {path}: {compared}"),
            Err(error) => {
                println!("FAIL {path}: {error}");
                failed = true;
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn map<A: Copy, B>(values: &[A], to: impl Fn(A) -> B) -> Vec<B> {
    values.iter().map(|value| to(*value)).collect()
}
