//! Accounts of what a unit sent over its wire.

use octant_account::Account;
use octant_recorder::event::LinkRecord;
use octant_run::BenchEnd;

fn account_of(link: LinkRecord) -> Account {
    BenchEnd { link: Some(Box::new(link)), ..BenchEnd::default() }.accounts().remove(0)
}

fn link() -> LinkRecord {
    LinkRecord {
        arbitration_lost: 0,
        away_s: 0.0,
        bus_load: None,
        bus_off: 0,
        configuration_compared: true,
        damaged: 0,
        device: "core".into(),
        doubled: 0,
        error_frames: 0,
        error_passive: 0,
        firmware: "1".into(),
        lost: 0,
        missing: 0,
        not_sent: 0,
        out_of_order: 0,
        pacing: "lockstep".into(),
        port: "udp:127.0.0.1:4".into(),
        received: 100,
        reconnected: 0,
        repeated: 0,
        restarted: 0,
        sent: 100,
        unreadable: 0,
        wall_s: 1.0,
    }
}

#[test]
fn a_clean_wire_is_one_line() {
    let account = account_of(link());
    assert!(account.is_plain());
    assert_eq!(account.lines(), ["wire udp:127.0.0.1:4: 100 messages read, all used"]);
}

#[test]
fn every_loss_of_a_wire_is_counted_once() {
    let worn = LinkRecord {
        damaged: 3,
        doubled: 2,
        lost: 40,
        missing: 5,
        out_of_order: 1,
        repeated: 6,
        unreadable: 4,
        ..link()
    };
    let account = account_of(worn.clone());
    assert_eq!((account.read(), account.used_count(), account.left_out_count()), (107, 98, 9));
    assert_eq!(
        account.lines(),
        [
            "wire udp:127.0.0.1:4: 107 messages read, 98 used, 9 left out, 5 missing",
            "left out: 2 answers that came a second time",
            "left out: 3 damaged messages",
            "left out: 4 whole messages that this version doesn't know",
            "missing: 5 frames by their sequence numbers",
            "note: 1 messages after later ones",
            "note: 40 bytes that belong to no message",
            "note: 6 requests sent again",
        ]
    );
    assert!(account.doubts().is_empty());
    let on_a_bus = account_of(LinkRecord { bus_load: Some(0.2), ..worn });
    assert!(on_a_bus.lines().contains(&"note: 40 CAN frames that belong to no message".into()));
}

proptest::proptest! {
    /// Every message that came is in one place, however it came.
    #[test]
    fn the_sum_is_what_came(
        received in 0..1_000_000_u64,
        doubled in 0..1000_u64,
        damaged in 0..1000_u64,
        unreadable in 0..1000_u64,
        missing in 0..1000_u64,
    ) {
        // An answer that came again came before.
        let doubled = doubled.min(received);
        let account = account_of(LinkRecord { received, doubled, damaged, unreadable, missing, ..link() });
        proptest::prop_assert_eq!(account.read(), received + damaged + unreadable);
        proptest::prop_assert_eq!(account.used_count(), received - doubled);
        proptest::prop_assert_eq!(account.missing_count(), missing);
    }
}
