//! The `octant` program: a thin entry point, with all functions in the library.

#[global_allocator]
static ALLOCATOR: octant::memory::Allocator = octant::memory::Allocator;

fn main() -> std::process::ExitCode {
    octant::main()
}
