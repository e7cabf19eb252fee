//! Account of the readings of a unit, from a log or a live port.

use octant_account::{Account, AccountEntry, ClockAccount, OutsideClock, Weight};
use octant_base::number::{counted, plain};
use octant_instruments::timeline::SHIFTED;
use octant_instruments::{ReadingCounters, Sampler};

/// Returns the account of readings that became samples. `frames` are the counts of the bytes around them, `increments` is
/// true where readings are increments.
pub(super) fn account(
    name: &str,
    sampler: &Sampler,
    frames: Option<&ReadingCounters>,
    outside: Option<OutsideClock>,
) -> Account {
    let (counters, tally) = (sampler.counters(), sampler.timeline().tally());
    let period_ms = 1e3 / sampler.rate_hz();
    let shifted = AccountEntry::new(
        tally.shifted - counters.flagged_shifted,
        format!(
            "readings with stamps off the fitted time by more than {} ms, and given that time",
            plain(SHIFTED * period_ms, 3)
        ),
    )
    .first(format!("reading {}", tally.first_shifted));
    let behind = AccountEntry::new(counters.behind, "readings that are there twice, or late");
    let missing = AccountEntry::new(
        tally.missing,
        format!(
            "readings in {}, the longest {} s",
            counted(tally.gaps, "gap", "gaps"),
            plain(tally.longest_s, 4)
        ),
    )
    .first(format!("before reading {}; the core bridges it", tally.first_gap));
    let disagreeing = AccountEntry::new(
        tally.disagreeing,
        "readings whose stamps and counters disagree by more than half a period",
    );
    let rate = sampler.timeline().rate();
    let clock = ClockAccount {
        configured_hz: sampler.rate_hz(),
        measured_hz: rate.map(|rate| rate.hz),
        rate_ppm: rate.map(|rate| rate.ppm),
        rate_sigma_ppm: rate.map(|rate| rate.sigma_ppm),
        scatter_s: rate.map(|rate| rate.scatter_s),
        scatter_max_s: rate.map(|rate| rate.scatter_max_s),
        increments: sampler.has_increments(),
        outside,
    };
    let flagged = AccountEntry::new(
        counters.flagged,
        "readings that the unit calls invalid or out of range; the core bridges them",
    );
    let believed = counters.samples - counters.flagged;
    let account = Account::new(name, ["reading", "readings"])
        .used(believed - (tally.shifted - counters.flagged_shifted))
        .repaired(shifted)
        .left_out(behind)
        .left_out(flagged)
        .left_out(AccountEntry::new(counters.incomplete, "readings without rotation or velocity"))
        .missing(missing)
        .note(disagreeing.weight(Weight::Doubt))
        .clock(Some(clock));
    let blind = AccountEntry::fact(
        sampler.timeline().is_blind(),
        "the stamps scatter so much that a missing reading can't be seen",
    );
    let account = account.note(blind.weight(Weight::Doubt));
    let Some(frames) = frames else { return account };
    let damaged = frames.checksum + frames.malformed;
    // Neither stamps nor counters show how many readings were in them.
    let unseen = rate.is_none() && !sampler.has_counters();
    account
        .note(
            AccountEntry::new(damaged, "damaged frames, which hold no reading")
                .weight(Weight::doubt_if(unseen && damaged > 0)),
        )
        .note(AccountEntry::new(frames.unknown, "intact frames that can't be read"))
        .note(AccountEntry::new(frames.other, "other frames of the protocol"))
        .note(AccountEntry::new(frames.bytes_lost, "bytes that belong to no intact frame"))
}
