//! Numbers of steps, which go round.

use octant_wire::StepNumber;

#[test]
fn steps_go_round() {
    assert_eq!(StepNumber::new(0x7FFF).next(), StepNumber::new(0));
    assert_eq!(StepNumber::new(2).since(StepNumber::new(0x7FFE)), 4);
    assert_eq!(StepNumber::new(0x7FFE).since(StepNumber::new(2)), -4);
    assert_eq!(StepNumber::new(5).since(StepNumber::new(5)), 0);
    assert_eq!(StepNumber::new(0x4000).since(StepNumber::new(0)), -0x4000);
    assert_eq!(StepNumber::new(0x3FFF).since(StepNumber::new(0)), 0x3FFF);
}

#[test]
fn the_flag_leaves_the_number_alone() {
    for number in [0, 1, 0x1234, 0x7FFF] {
        for flag in [false, true] {
            let step = StepNumber::new(number);
            assert_eq!(StepNumber::and_flag(step.with_flag(flag)), (step, flag));
        }
    }
}
