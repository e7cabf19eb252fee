//! Values that fit a type, and values rounded to it.

use octant_cosim::values::{fits, rounded};
use octant_fmu_host::description::VariableType;

#[test]
fn a_value_fits_a_type_or_does_not() {
    for (value, kind, expected) in [
        (127.0, VariableType::Int8, true),
        (128.0, VariableType::Int8, false),
        (0.5, VariableType::Int32, false),
        (-1.0, VariableType::UInt64, false),
        (9007199254740992.0, VariableType::UInt64, true),
        (f64::NAN, VariableType::Int32, false),
        (f64::NAN, VariableType::Float64, true),
        (1.0, VariableType::Boolean, true),
        (2.0, VariableType::Boolean, false),
        (1.0, VariableType::String, false),
    ] {
        assert_eq!(fits(value, kind), expected, "{value} {kind:?}");
    }
    assert_eq!(rounded(0.1, VariableType::Float32), f64::from(0.1f32));
    assert_eq!(rounded(0.1, VariableType::Float64), 0.1);
}
