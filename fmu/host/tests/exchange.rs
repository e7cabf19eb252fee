//! Model exchange compared with closed forms, and with another method.

use super::foreign;
use octant_fmu_host::instance::{
    Instance, InstanceError, OpenOptions, ProcessPlace, StepOutcome, VariableGroup,
};

fn open(name: &str) -> Box<dyn Instance> {
    let options = OpenOptions { place: ProcessPlace::ThisProcess, ..OpenOptions::default() };
    octant_fmu_host::open(&foreign::fmu(name), &options).unwrap()
}

fn group(instance: &dyn Instance, name: &str) -> VariableGroup {
    let description = instance.description();
    VariableGroup::of(description, description.variable(name).unwrap()).unwrap()
}

fn set(instance: &mut dyn Instance, name: &str, value: f64) {
    let group = group(instance, name);
    instance.set(&group, &[value]).unwrap();
}

fn get(instance: &mut dyn Instance, name: &str) -> f64 {
    let group = group(instance, name);
    let mut value = [f64::NAN];
    instance.get(&group, &mut value).unwrap();
    value[0]
}

fn start(instance: &mut dyn Instance, tolerance: f64) {
    instance.enter_initialization(0.0, None, Some(tolerance)).unwrap();
    assert!(!instance.exit_initialization().unwrap());
}

/// Returns height and number of bounces of a ball that falls from 1 m, until it rests.
fn ball(time_s: f64) -> (f64, f64) {
    let (g, e, speed_min) = (9.81f64, 0.7, 0.1);
    let mut speed = (2.0 * g).sqrt();
    let mut landing_s = speed / g;
    if time_s < landing_s {
        return (1.0 - 0.5 * g * time_s * time_s, 0.0);
    }
    for bounces in 1.. {
        speed *= e;
        let bounces = f64::from(bounces);
        if speed < speed_min {
            return (0.0, bounces);
        }
        let flight_s = 2.0 * speed / g;
        let since_s = time_s - landing_s;
        if since_s < flight_s {
            return (since_s * (speed - 0.5 * g * since_s), bounces);
        }
        landing_s += flight_s;
    }
    unreachable!()
}

#[test]
fn a_ball_bounces_where_it_should() {
    for name in ["ball_fmi2", "ball_fmi3"] {
        // A step that divides no interval, one that contains many bounces, and a long one.
        for step_s in [0.007, 0.3, 3.0] {
            let mut ball_fmu = open(name);
            let fmu = &mut *ball_fmu;
            start(fmu, 1e-9);
            let mut time_s = 0.0;
            while time_s < 3.5 {
                let stepped = fmu.step(time_s, step_s).unwrap();
                assert_eq!(stepped.outcome, StepOutcome::Done);
                time_s = stepped.time_s;
                let (height, bounces) = ball(time_s);
                let found = get(fmu, "h");
                // The solver's allowed error per step, summed over the earlier bounces.
                assert!((found - height).abs() < 1e-8, "{name} {time_s}: {found} {height}");
                assert_eq!(get(fmu, "bounces"), bounces, "{name} {time_s}");
            }
            assert_eq!(get(fmu, "h"), 0.0, "it lies");
        }
    }
}

/// The times of the bounces, from the speeds just after: found within one step each.
#[test]
fn bounces_are_found_to_rounding() {
    let mut ball_fmu = open("ball_fmi3");
    let fmu = &mut *ball_fmu;
    start(fmu, 1e-10);
    let g = 9.81f64;
    let mut landing_s = (2.0 / g).sqrt();
    let mut speed = (2.0 * g).sqrt();
    let mut time_s = 0.0;
    for bounce in 1..=6 {
        // Just after the bounce: the speed gives its time.
        let to_s = landing_s + 1e-3;
        fmu.step(time_s, to_s - time_s).unwrap();
        time_s = to_s;
        speed *= 0.7;
        assert_eq!(get(fmu, "bounces"), f64::from(bounce));
        let found_s = time_s - (speed - get(fmu, "v")) / g;
        assert!((found_s - landing_s).abs() < 1e-11, "{bounce}: {found_s} {landing_s}");
        landing_s += 2.0 * speed / g;
    }
}

#[test]
fn decay_is_exponential_and_follows_its_input() {
    for tolerance in [1e-4, 1e-7, 1e-10] {
        let mut fmu = open("dahlquist_fmi3");
        let fmu = &mut *fmu;
        set(fmu, "k", 3.0);
        start(fmu, tolerance);
        let mut exact = 1.0f64;
        for k in 0..50 {
            // A staircase of inputs, which a solver that ignores the steps would smear.
            let u = if k % 7 < 3 { 2.0 } else { -1.0 };
            set(fmu, "u", u);
            fmu.step(0.1 * f64::from(k), 0.1).unwrap();
            exact = u / 3.0 + (exact - u / 3.0) * (-0.3f64).exp();
            let found = get(fmu, "x");
            assert!((found - exact).abs() < 10.0 * tolerance, "{k} {tolerance}: {found} {exact}");
        }
    }
}

#[test]
fn what_is_asked_for_is_what_it_costs() {
    // Without inputs over a long time: the tolerance has an effect, so it isn't fixed.
    let error = |tolerance: f64| {
        let mut fmu = open("dahlquist_fmi3");
        start(&mut *fmu, tolerance);
        fmu.step(0.0, 20.0).unwrap();
        (get(&mut *fmu, "x") - (-20.0f64).exp()).abs()
    };
    let (wide, tight) = (error(1e-3), error(1e-12));
    assert!(tight < 1e-14, "{tight}");
    assert!(wide < 1e-4 && wide > 100.0 * tight, "{wide} {tight}");
}

/// Integrates Van der Pol's oscillator by the classic method of order 4, with steps so small that
/// halving them changes nothing relevant.
fn van_der_pol(mu: f64, to_s: f64, steps: u32) -> [f64; 2] {
    let f = |[x, v]: [f64; 2]| [v, mu * (1.0 - x * x) * v - x];
    let h = to_s / f64::from(steps);
    let along = |[x, v]: [f64; 2], [dx, dv]: [f64; 2], h: f64| [x + h * dx, v + h * dv];
    let mut y = [2.0, 0.0];
    for _ in 0..steps {
        let a = f(y);
        let b = f(along(y, a, 0.5 * h));
        let c = f(along(y, b, 0.5 * h));
        let d = f(along(y, c, h));
        for i in 0..2 {
            y[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        }
    }
    y
}

#[test]
fn an_oscillator_agrees_with_another_method() {
    for (mu, to_s, steps) in [(1.0, 20.0, 200_000), (30.0, 60.0, 2_000_000)] {
        let reference = van_der_pol(mu, to_s, steps);
        let coarse = van_der_pol(mu, to_s, steps / 2);
        let doubt = (reference[0] - coarse[0]).abs() + (reference[1] - coarse[1]).abs();
        assert!(doubt < 1e-9, "the reference isn't one: {doubt}");
        for name in ["vanderpol_fmi2", "vanderpol_fmi3"] {
            let mut fmu = open(name);
            let fmu = &mut *fmu;
            set(fmu, "mu", mu);
            start(fmu, 1e-11);
            for k in 0..20 {
                fmu.step(f64::from(k) * to_s / 20.0, to_s / 20.0).unwrap();
            }
            for (variable, expected) in ["x0", "x1"].into_iter().zip(reference) {
                let found = get(fmu, variable);
                assert!((found - expected).abs() < 1e-7, "{name} {mu}: {found} {expected}");
            }
        }
    }
}

#[test]
fn a_stiff_model_is_integrated_all_the_same() {
    // Relaxation: on its slow branch x0' = x0 / (mu (1 - x0^2)), whose solution is implicit: ln x0
    // - x0^2/2 falls by t / mu.
    let mut fmu = open("vanderpol_fmi3");
    let fmu = &mut *fmu;
    set(fmu, "mu", 1000.0);
    start(fmu, 1e-6);
    for k in 0..4 {
        fmu.step(25.0 * f64::from(k), 25.0).unwrap();
    }
    let x = get(fmu, "x0");
    let invariant = |x: f64| x.ln() - 0.5 * x * x;
    let slow = (invariant(x) - invariant(2.0)) * 1000.0;
    // The branch is followed to the order of 1/mu^2.
    assert!((slow - 100.0).abs() < 0.01, "{slow}");
}

#[test]
fn time_events_come_on_time() {
    let mut fmu = open("stair_fmi3");
    let fmu = &mut *fmu;
    start(fmu, 1e-6);
    let mut time_s = 0.0;
    for _ in 0..33 {
        let stepped = fmu.step(time_s, 0.3).unwrap();
        time_s = stepped.time_s;
        // 0.3 isn't exact: an event within rounding of the end may be on either side.
        let count = get(fmu, "counter");
        assert_eq!(count, (time_s + 1e-9).floor(), "{time_s}");
        if count > 0.0 {
            assert!((get(fmu, "last") - count).abs() < 1e-9);
        }
    }
    // The simulation ends at the tenth event.
    let stepped = fmu.step(time_s, 0.3).unwrap();
    assert!(stepped.terminate && stepped.outcome == StepOutcome::Early);
    assert!((stepped.time_s - 10.0).abs() < 1e-9);
    fmu.terminate().unwrap();
}

#[test]
fn outputs_follow_their_inputs_at_once() {
    let mut fmu = open("feedthrough_fmi3");
    let fmu = &mut *fmu;
    start(fmu, 1e-6);
    for (k, u) in [0.5, -2.0, 7.0].into_iter().enumerate() {
        let time_s = k as f64;
        set(fmu, "u", u);
        set(fmu, "n", time_s);
        assert_eq!(get(fmu, "y"), 2.0 * u, "before the step");
        fmu.step(time_s, 1.0).unwrap();
        assert_eq!(get(fmu, "y"), 2.0 * u);
        assert_eq!(get(fmu, "n_out"), time_s, "discrete equations follow at an event");
    }
}

#[test]
fn kept_states_go_on_as_they_would_have() {
    let mut fmu = open("ball_fmi3");
    let fmu = &mut *fmu;
    start(fmu, 1e-9);
    fmu.step(0.0, 0.4).unwrap();
    let kept = fmu.keep_state().unwrap();
    fmu.step(0.4, 0.8).unwrap();
    let expected = get(fmu, "h");
    let bounces = get(fmu, "bounces");
    assert!(bounces >= 1.0);

    fmu.restore_state(kept).unwrap();
    assert_eq!(get(fmu, "bounces"), 0.0);
    fmu.step(0.4, 0.8).unwrap();
    assert!((get(fmu, "h") - expected).abs() < 1e-9);
    assert_eq!(get(fmu, "bounces"), bounces);

    let bytes = fmu.state_to_bytes(kept).unwrap();
    let mut other = open("ball_fmi3");
    let state = other.state_from_bytes(&bytes).unwrap();
    other.restore_state(state).unwrap();
    other.step(0.4, 0.8).unwrap();
    assert!((get(&mut *other, "h") - expected).abs() < 1e-9);

    // The time belongs to the state.
    fmu.restore_state(kept).unwrap();
    let error = fmu.step(0.5, 0.1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "ball_fmi3.fmu can't step from 0.5 s by 0.1 s: its time is 0.4 s, and a step has a \
         positive length"
    );
}

#[test]
fn steps_that_are_none_are_refused() {
    let mut fmu = open("ball_fmi2");
    assert!(matches!(fmu.step(0.0, 0.1), Err(InstanceError::Order { .. })));
    start(&mut *fmu, 1e-6);
    for step_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(fmu.step(0.0, step_s), Err(InstanceError::Unsupported { .. })),
            "{step_s}"
        );
    }
    fmu.step(0.0, 0.1).unwrap();
    fmu.reset().unwrap();
    start(&mut *fmu, 1e-6);
    fmu.step(0.0, 0.1).unwrap();
    assert!((get(&mut *fmu, "h") - ball(0.1).0).abs() < 1e-8);
}
