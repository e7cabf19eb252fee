//! The `octant` program: a thin entry point, with all functions in the library.

fn main() -> std::process::ExitCode {
    octant::main()
}
