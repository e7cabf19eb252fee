//! Compiles the only function that Rust can't define: a callback with variable arguments.

fn main() {
    cc::Build::new()
        .file("src/instance/logger.c")
        .extra_warnings(true)
        .compile("octant_fmi2_logger");
}
