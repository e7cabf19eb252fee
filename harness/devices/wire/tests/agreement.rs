//! Agreement of two hellos, and the bye to an end that doesn't fit.

use octant_wire::message::{
    Agreement, Capabilities, EndLimits, EndRole, Hello, Reason, SessionRefusal, StepPacing, agree,
};

fn harness() -> Hello {
    Hello {
        role: EndRole::Harness,
        session: 0x1234_5678,
        sample_period_ns: 5_000_000,
        configuration: [7; 32],
        ..Hello::default()
    }
}

fn device() -> Hello {
    Hello { role: EndRole::Device, capabilities: Capabilities::LOCK_STEP, ..harness() }
}

fn refusal(harness: &Hello, device: &Hello) -> SessionRefusal {
    let refusal = agree(harness, device).unwrap_err();
    assert!(agree(device, harness).is_err(), "both ends see it");
    refusal
}

#[test]
fn two_that_fit_agree() {
    let expected = Agreement {
        session: 0x1234_5678,
        pacing: StepPacing::LockStep,
        configuration_compared: true,
    };
    assert_eq!(agree(&harness(), &device()), Ok(expected));
    assert_eq!(agree(&device(), &harness()), Ok(expected));
    let unknown = Hello { configuration: [0; 32], ..device() };
    let agreement = agree(&harness(), &unknown).unwrap();
    assert!(!agreement.configuration_compared, "said, so that a manifest can say it");
}

#[test]
fn two_that_do_not_fit_hear_why() {
    let echo = refusal(&harness(), &harness());
    assert_eq!(echo.to_string(), "harness talks to harness: one of the two has to be the harness");
    assert_eq!(echo.bye().reason, Reason::ROLE);

    let old = refusal(&harness(), &Hello { session: 1, ..device() });
    assert_eq!(old.to_string(), "the answer is of session 0x00000001, this is session 0x12345678");

    let fast = Hello { pacing: StepPacing::RealTime, ..harness() };
    let slow = Hello { pacing: StepPacing::RealTime, ..device() };
    let refused = refusal(&fast, &slow);
    assert_eq!(
        refused.to_string(),
        "the harness asks for real-time steps, which the device doesn't do"
    );

    let period = refusal(&harness(), &Hello { sample_period_ns: 10_000_000, ..device() });
    assert_eq!(
        period.to_string(),
        "the harness is configured for a sample period of 5000000 ns, the other end for 10000000 ns"
    );

    let able = Capabilities::LOCK_STEP | Capabilities::REAL_TIME;
    let limits = EndLimits { shortest_period_ns: 6_000_000, ..EndLimits::default() };
    let rate = refusal(&fast, &Hello { capabilities: able, limits, ..slow });
    assert_eq!(
        rate.to_string(),
        "samples come every 5000000 ns, the other end keeps up with one every 6000000 ns"
    );

    let other = refusal(&harness(), &Hello { configuration: [9; 32], ..device() });
    assert_eq!(
        other.to_string(),
        "the harness expects a core of configuration 0707070707070707…, the other end has \
         0909090909090909…: give both the same scenario"
    );
    assert_eq!(other.bye().reason.name(), "configuration");
    assert_eq!(other.bye().text.as_str(), "the configuration is another one");
}
