//! The `octant` program: a thin entry point, with all functions in the library.

#[global_allocator]
static ALLOCATOR: octant_base::memory::Allocator = octant_base::memory::Allocator;

fn main() -> std::process::ExitCode {
    octant::main()
}
