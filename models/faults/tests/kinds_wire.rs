//! Faults of the wire: where each happens, and its numbers.

use octant_faults::Setup;
use octant_faults::catalogue::{Acts, Takes};
use octant_faults::kinds;
use octant_faults::kinds::wire::happens_on;
use octant_faults::rule::{Context, FaultRule, SetPoints};
use octant_faults::values::{Value, Values};
use octant_faults::wire::{Medium, WireAction};
use octant_random::stream::Phase;
use octant_sample::{Epoch, Output};

#[test]
fn a_kind_happens_where_its_action_does() {
    let setup = Setup {
        seed: 1,
        sample_period_ns: 5_000_000,
        calibration_samples: 1000,
        angle_random_walk: 0.0,
        velocity_random_walk: 0.0,
        turntable_rate_radps: 0.1,
        id: "w".into(),
    };
    let mut seen: Vec<WireAction> = Vec::new();
    for kind in kinds::all().filter(|kind| matches!(kind.acts, Acts::Wire)) {
        let mut values = Values::default();
        for parameter in kind.parameters {
            let value = match parameter.takes {
                Takes::Choice(choices) => Value::Choice(choices[0].0),
                Takes::Integer(from, _) => Value::Integer(from),
                Takes::Quantity(dimensions, _) => Value::Quantity(0.5, dimensions[0]),
                _ => panic!("{}", parameter.name),
            };
            values.set(parameter.name, value);
        }
        let FaultRule::Wire(mut rule) = (kind.build)(&values, &setup).unwrap() else {
            panic!("{} is no fault of a wire", kind.name);
        };
        let (output, epoch) = (Output::default(), Epoch::default());
        let now = Context {
            epoch: 1,
            phase: Phase::Calibration,
            counter: 0,
            dt_s: 0.005,
            since_onset: 0,
            firing: 0,
            strength: 1.0,
            last: &epoch,
            output: &output,
            set_points: SetPoints::default(),
        };
        let fault = rule.begin(&now);
        for medium in [Medium::Line, Medium::Datagrams, Medium::Bus] {
            let expected = fault.action.happens_on(medium);
            assert_eq!(happens_on(kind, medium), expected, "{} {medium:?}", kind.name);
        }
        assert!(!seen.contains(&fault.action), "{}", kind.name);
        seen.push(fault.action);
        // Another onset has other numbers; the same onset has the same ones.
        let again = rule.begin(&Context { firing: 1, ..now });
        assert_ne!(fault.key, again.key);
        assert_eq!(fault.key, rule.begin(&now).key);
    }
    assert!(seen.len() > 10, "{seen:?}");
}
