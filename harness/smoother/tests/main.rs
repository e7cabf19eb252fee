//! Tests of the smoother, in one program.
