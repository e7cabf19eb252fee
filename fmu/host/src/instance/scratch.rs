//! Buffers through which numbers of other types than f64 are got and set.

use super::number::Truth;
use octant_fmi::fmi3_types;

/// `fmi3Boolean`, in which any number but zero is true.
type Boolean = Truth<u8>;

macro_rules! buffers {
    ($($kind:ident $value:ident: $get:ident $set:ident;)*) => {
        /// Buffers for numbers of the types of FMI 3.0.
        #[derive(Default)]
        #[allow(non_snake_case, reason = "names of the standard")]
        pub(super) struct Scratch3 {
            $(pub(super) $kind: Vec<$value>,)*
        }
    };
}
fmi3_types!(buffers);

/// Buffers for numbers of the types of FMI 2.0.
#[derive(Default)]
#[allow(non_snake_case, reason = "names of the standard")]
pub(super) struct Scratch2 {
    pub(super) Integer: Vec<i32>,
    pub(super) Boolean: Vec<Truth<i32>>,
}

/// Gets numbers into a buffer of their type and from there into `values`; with `len` the function
/// takes their number.
macro_rules! get_through {
    ($unit:ident.$kind:ident, $group:ident, $values:ident, $get:ident $(, $len:ident)?) => {{
        let mut scratch = std::mem::take(&mut $unit.scratch.$kind);
        scratch.clear();
        scratch.resize_with($values.len(), Default::default);
        let (references, count) = ($group.references.as_ptr(), $group.references.len());
        let to = scratch.as_mut_ptr().cast();
        let done = call!($unit.$get(references, count, to $(, scratch.$len())?))
            .and_then(|()| group::numbers_to_f64(&$unit.base, $group, &scratch, $values));
        $unit.scratch.$kind = scratch;
        done
    }};
}
pub(super) use get_through;

/// Sets numbers from `values` through a buffer of their type; `len` as in [`get_through!`].
macro_rules! set_through {
    ($unit:ident.$kind:ident, $group:ident, $values:ident, $set:ident $(, $len:ident)?) => {{
        let mut scratch = std::mem::take(&mut $unit.scratch.$kind);
        group::numbers_from_f64(&$unit.base, $group, $values, &mut scratch)?;
        let (references, count) = ($group.references.as_ptr(), $group.references.len());
        let from = scratch.as_ptr().cast();
        let done = call!($unit.$set(references, count, from $(, scratch.$len())?));
        $unit.scratch.$kind = scratch;
        done
    }};
}
pub(super) use set_through;
