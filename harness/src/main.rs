//! The `octant` program. Everything it does is in the library; this is its front door.

fn main() -> std::process::ExitCode {
    octant::cli::main()
}
