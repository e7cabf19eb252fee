//! Tests of accounts.

use octant_account::{Account, AccountEntry, ClockAccount, OutsideClock, Weight};
use proptest::prelude::*;

fn example() -> Account {
    Account::new("rows.csv", ["row", "rows"])
        .used(139_000)
        .repaired(AccountEntry::new(900, "stamps off their fit").first("in line 12"))
        .left_out(AccountEntry::new(0, "rows that are empty"))
        .left_out(AccountEntry::new(100, "repeated rows"))
        .missing(AccountEntry::new(60, "rows in 1 gap").weight(Weight::Doubt))
        .note(AccountEntry::fact(true, "the run ended before the file"))
        .note(AccountEntry::fact(false, "the stamps scatter"))
}

#[test]
fn lines_say_what_became_of_the_units() {
    let account = example();
    assert_eq!(
        account.lines(),
        [
            "rows.csv: 140000 rows read, 139900 used, 900 repaired, 100 left out, 60 missing",
            "repaired: 900 stamps off their fit, the first in line 12",
            "left out: 100 repeated rows",
            "missing: 60 rows in 1 gap",
            "note: the run ended before the file",
        ]
    );
    assert_eq!(account.doubts(), ["rows.csv: missing: 60 rows in 1 gap"]);
    let plain = Account::new("a", ["row", "rows"]).used(1);
    assert_eq!(plain.headline(), "a: 1 row read, all used");
    assert!(plain.is_plain() && plain.doubts().is_empty());
    assert_eq!(Account::new("a", ["row", "rows"]).headline(), "a: 0 rows read, 0 used");
}

#[test]
fn entries_of_one_kind_are_one_and_keep_the_first_place_and_every_doubt() {
    let account = Account::new("a", ["row", "rows"])
        .left_out(AccountEntry::new(2, "late"))
        .left_out(AccountEntry::new(3, "late").first("in line 7").weight(Weight::Doubt))
        .left_out(AccountEntry::new(1, "late").first("in line 9"));
    assert_eq!(account.doubts(), ["a: left out: 6 late, the first in line 7"]);
}

#[test]
fn a_clock_is_told_with_its_uncertainty() {
    let mut clock = ClockAccount {
        configured_hz: 200.0,
        measured_hz: Some(200.02),
        rate_ppm: Some(100.0),
        rate_sigma_ppm: Some(0.25),
        scatter_s: Some(3e-4),
        scatter_max_s: Some(1e-3),
        increments: false,
        outside: Some(OutsideClock {
            name: "pulses".into(),
            fast_ppm: -12.5,
            sigma_ppm: Some(0.5),
        }),
    };
    assert_eq!(
        clock.to_string(),
        "200.02 Hz, +100 ± 0.25 ppm from the configured 200 Hz; stamps scatter by 0.3 ms (1 sigma), 1 ms at most; \
         −12.5 ± 0.5 ppm against pulses"
    );
    assert!(clock.is_off());
    clock = ClockAccount {
        measured_hz: None,
        scatter_s: None,
        outside: None,
        increments: true,
        ..clock
    };
    assert_eq!(
        clock.to_string(),
        "no stamps; 200 Hz is taken from the scenario; no clock outside shows the error of this one; of \
         increments 1 ppm of it is 1 ug of accelerometer bias along gravity"
    );
    let near = ClockAccount { rate_ppm: Some(-15.0), ..clock };
    assert!(!near.is_off());
}

proptest! {
    /// The sum holds whatever is added, and is stored.
    #[test]
    fn every_unit_is_in_exactly_one_place(steps in proptest::collection::vec((0..3u8, 0..5u8, 0..1000u64), 0..40)) {
        let mut account = Account::new("a", ["row", "rows"]);
        let mut read = 0;
        for (place, kind, count) in steps {
            read += count;
            let entry = AccountEntry::new(count, format!("kind {kind}"));
            account = match place {
                0 => account.used(count),
                1 => account.repaired(entry),
                _ => account.left_out(entry),
            };
        }
        prop_assert_eq!(account.read(), read);
        prop_assert_eq!(account.used_count() + account.left_out_count(), read);
        let text = serde_json::to_string(&account).unwrap();
        prop_assert_eq!(&serde_json::from_str::<Account>(&text).unwrap(), &account);
        let wrong = text.replace(&format!("\"read\":{read}"), &format!("\"read\":{}", read + 1));
        let error = serde_json::from_str::<Account>(&wrong).unwrap_err().to_string();
        prop_assert!(error.contains("the sum of used, repaired and left_out"), "{}", error);
    }
}
