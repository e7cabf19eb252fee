//! The account of what a unit sent over its wire.

use octant_account::{Account, AccountEntry};
use octant_recorder::event::LinkRecord;

/// Makes the account of the messages that came from a unit over its wire.
///
/// A lost or damaged answer is asked for again, so that no entry can have changed a value: a run whose answers stay
/// away has broken off.
#[must_use]
pub(super) fn wire_account(link: &LinkRecord) -> Account {
    let LinkRecord { received, doubled, damaged, unreadable, missing, out_of_order, lost, .. } =
        *link;
    let [what_is_lost, what_is_missing] = match link.bus_load {
        Some(_) => ["CAN frames that belong to no message", "segments by their sequence numbers"],
        None => ["bytes that belong to no message", "frames by their sequence numbers"],
    };
    Account::new(format!("wire {}", link.port), ["message", "messages"])
        .used(received.saturating_sub(doubled))
        .left_out(AccountEntry::new(doubled, "answers that came a second time"))
        .left_out(AccountEntry::new(damaged, "damaged messages"))
        .left_out(AccountEntry::new(unreadable, "whole messages that this version doesn't know"))
        .missing(AccountEntry::new(missing, what_is_missing))
        .note(AccountEntry::new(out_of_order, "messages after later ones"))
        .note(AccountEntry::new(lost, what_is_lost))
        .note(AccountEntry::new(link.repeated, "requests sent again"))
}
