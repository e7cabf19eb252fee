//! Measures of heading type tests.
