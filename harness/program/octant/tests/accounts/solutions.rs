//! Solutions and references.
