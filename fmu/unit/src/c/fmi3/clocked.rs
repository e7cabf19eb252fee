//! Clocks, and variables that have a value only at their ticks.

use super::entry::enter;
use super::unsupported::CLOCKS;
use crate::c::call::ok;
use octant_fmi::fmi3::{Binary, Boolean, Instance as Handle, Status, ValueReference, signature};

export! {
    /// Gets binary variables; the bytes stay valid until the next call.
    fn fmi3GetBinary(
        i: Handle,
        references: *const ValueReference,
        count: usize,
        sizes: *mut usize,
        values: *mut Binary,
        value_count: usize,
    ) -> Status {
        enter(i, "fmi3GetBinary", |instance| {
            ok(instance.get_binaries(references, count, sizes, values, value_count))
        })
    }

    /// Sets binary variables whose clocks tick.
    fn fmi3SetBinary(
        i: Handle,
        references: *const ValueReference,
        count: usize,
        sizes: *const usize,
        values: *const Binary,
        value_count: usize,
    ) -> Status {
        enter(i, "fmi3SetBinary", |instance| {
            ok(instance.set_binaries(references, count, sizes, values, value_count))
        })
    }

    /// Returns which clocks tick.
    fn fmi3GetClock(
        i: Handle, references: *const ValueReference, count: usize, values: *mut Boolean,
    ) -> Status {
        enter(i, "fmi3GetClock", |instance| {
            ok(instance.get_clocks(CLOCKS, references, count, values))
        })
    }

    /// Lets clocks tick until the end of the event.
    fn fmi3SetClock(
        i: Handle, references: *const ValueReference, count: usize, values: *const Boolean,
    ) -> Status {
        enter(i, "fmi3SetClock", |instance| {
            ok(instance.set_clocks(CLOCKS, references, count, values))
        })
    }

    /// Returns the time until countdown clocks are to tick.
    fn fmi3GetIntervalDecimal(
        i: Handle,
        references: *const ValueReference,
        count: usize,
        intervals: *mut f64,
        qualifiers: *mut i32,
    ) -> Status {
        enter(i, "fmi3GetIntervalDecimal", |instance| {
            ok(instance.get_intervals(CLOCKS, references, count, intervals, qualifiers))
        })
    }
}
