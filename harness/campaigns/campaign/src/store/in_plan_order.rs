//! Reads results on all processors, and gives them out in the order of the plan.

use octant_base::pool::{each_in_order, processors};

/// Number of cases of which a thread reads the facts at a time.
pub(crate) const FACTS_AT_ONCE: usize = 256;
/// Number of cases of which a thread reads the results at a time: some of them are 100 kB in memory.
pub(crate) const RESULTS_AT_ONCE: usize = 8;

/// Reads something of each of `count` cases, `at_once` of them on one thread, and gives all of it to `take` in their
/// order. No more than some hundreds are in memory. A case of which nothing is read is passed over.
///
/// # Errors
/// The first one in this order, of `read` or of `take`.
pub(crate) fn read_in_order<T: Send, E: Send>(
    count: usize,
    at_once: usize,
    read: impl Fn(usize) -> Result<Option<T>, E> + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let some = |(): &mut (), task: usize| {
        let from = task * at_once;
        let mut all = Vec::new();
        for index in from..count.min(from + at_once) {
            match read(index) {
                Ok(found) => all.extend(found.map(|found| (index, found))),
                // Those before it are still given out.
                Err(error) => return Ok((all, Some(error))),
            }
        }
        Ok((all, None))
    };
    each_in_order(
        processors(),
        count.div_ceil(at_once),
        || (),
        some,
        |(all, error)| {
            all.into_iter().try_for_each(|(index, found)| take(index, found))?;
            error.map_or(Ok(()), Err)
        },
    )
}
