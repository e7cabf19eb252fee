//! Outputs: begun, cut, lowered, measured, and brought to their end state.

use crate::plan;
use octant_power::simulate::{Peculiarities, SimulatedInstrument, within};
use octant_power::{Outlet, PowerError, PowerOutlet, PowerPlan, SupplySetting, write_all_ends};
use octant_test_processes::command;
use std::time::Duration;

fn instrument() -> SimulatedInstrument {
    SimulatedInstrument::start(Peculiarities::default()).unwrap()
}

fn begun(plan: &PowerPlan) -> PowerOutlet {
    let mut outlet = PowerOutlet::open(plan).unwrap();
    outlet.begin().unwrap();
    outlet
}

#[test]
fn a_channel_is_set_switched_measured_and_left_off() {
    let instrument = instrument();
    let mut outlet = begun(&plan(&instrument));
    assert!(instrument.is_on(2) && !instrument.is_on(1));
    assert_eq!(outlet.settings().unwrap(), Some((24.0, 2.0)));
    let reading = outlet.read().unwrap();
    // 24 V at 48 Ω.
    assert_eq!((reading.on, reading.voltage_v, reading.current_a), (true, Some(24.0), Some(0.5)));
    outlet.switch(false, Some(7)).unwrap();
    assert!(!instrument.is_on(2));
    outlet.switch(true, Some(9)).unwrap();
    outlet.end().unwrap();
    assert!(!instrument.is_on(2));
    let told: Vec<_> = outlet
        .switchings()
        .iter()
        .map(|one| (one.command.as_str(), one.sample, one.before.voltage_v, one.after.voltage_v))
        .collect();
    assert_eq!(
        told,
        [
            ("OUTP ON", None, Some(0.0), Some(24.0)),
            ("OUTP OFF", Some(7), Some(24.0), Some(0.0)),
            ("OUTP ON", Some(9), Some(0.0), Some(24.0)),
            ("OUTP OFF", None, Some(24.0), Some(0.0)),
        ]
    );
    assert!(outlet.switchings().windows(2).all(|two| two[0].at <= two[1].at));
}

#[test]
fn a_supply_without_channels_is_not_asked_for_one() {
    let instrument = instrument();
    let supply =
        SupplySetting { channel: None, voltage_v: 5.0, current_limit_a: 1.0, tolerance: 0.05 };
    let plan = PowerPlan { outlet: Outlet::Supply(supply), ..plan(&instrument) };
    drop(begun(&plan));
    assert!(!instrument.heard().iter().any(|line| line.starts_with("INST")));
    assert_eq!(instrument.set_v(1), 5.0);
}

#[test]
fn the_channel_is_selected_again_before_each_line_that_is_about_it() {
    let instrument = instrument();
    let mut outlet = begun(&plan(&instrument));
    // Somebody at the front panel selects another one.
    outlet.dialogue().command("INST:NSEL 1").unwrap();
    outlet.switch(false, None).unwrap();
    assert!(!instrument.is_on(2));
}

#[test]
fn a_voltage_is_lowered_and_comes_back() {
    let instrument = instrument();
    let mut outlet = begun(&plan(&instrument));
    outlet.lower(7.5, Some(3)).unwrap();
    assert_eq!(instrument.set_v(2), 7.5);
    outlet.lower(24.0, Some(3)).unwrap();
    let last = outlet.switchings().last().unwrap();
    assert_eq!((last.before.voltage_v, last.after.voltage_v), (Some(7.5), Some(24.0)));
}

#[test]
fn a_relay_switches_and_can_do_nothing_else() {
    let instrument = instrument();
    let plan = PowerPlan { outlet: Outlet::Relay(4), ..plan(&instrument) };
    let mut outlet = begun(&plan);
    assert!(instrument.is_on(4));
    assert_eq!(outlet.read().unwrap().voltage_v, None);
    assert!(matches!(outlet.lower(5.0, None), Err(PowerError::Relay { .. })));
    outlet.switch(false, None).unwrap();
    assert!(!instrument.is_on(4));
    let heard = instrument.heard();
    assert!(heard.contains(&"ROUT:CLOS (@4)".to_owned()));
    assert!(!heard.iter().any(|line| line.starts_with("MEAS") || line.starts_with("VOLT")));
    let reply = Duration::from_secs(1);
    let error = PowerOutlet::open(&PowerPlan { outlet: Outlet::Relay(77), reply, ..plan })
        .and_then(|mut outlet| outlet.begin())
        .unwrap_err();
    assert!(error.to_string().contains("(@77)"), "{error}");
}

#[test]
fn an_output_that_stays_as_it_was_is_an_error() {
    for outlet in [plan(&instrument()).outlet, Outlet::Relay(4)] {
        let how = Peculiarities { stuck: true, words: true, ..Peculiarities::default() };
        let instrument = SimulatedInstrument::start(how).unwrap();
        let plan = PowerPlan { outlet, ..plan(&instrument) };
        let error = PowerOutlet::open(&plan).unwrap().begin().unwrap_err().to_string();
        assert!(error.contains("the output is off after `"), "{error}");
        assert!(error.contains("expected on"), "{error}");
    }
}

#[test]
fn a_voltage_that_does_not_come_or_go_is_an_error() {
    // In its current limit: 0.2 A through 48 Ω is 9.6 V.
    let instrument = instrument();
    let supply =
        SupplySetting { channel: Some(2), voltage_v: 24.0, current_limit_a: 0.2, tolerance: 0.05 };
    let settle = Duration::from_millis(100);
    let plan = PowerPlan { outlet: Outlet::Supply(supply), settle, ..plan(&instrument) };
    let error = PowerOutlet::open(&plan).unwrap().begin().unwrap_err().to_string();
    assert!(error.contains("9.600 V measured 0.1 s after `OUTP ON`"), "{error}");
    assert!(error.contains("expected 24 V within 1.200 V"), "{error}");
    assert!(!instrument.is_on(2), "it was dropped, and left off");
    // A capacitor that keeps its charge: the device isn't without power.
    let plan = PowerPlan { outlet: crate::plan(&instrument).outlet, ..plan };
    let mut outlet = begun(&plan);
    instrument.becomes(Peculiarities { time_constant_s: 1e6, ..Peculiarities::default() });
    let error = outlet.switch(false, Some(5)).unwrap_err().to_string();
    assert!(
        error.contains("V measured 0.1 s after `OUTP OFF`, expected at most 1.200 V"),
        "{error}"
    );
    // What happened is told all the same.
    assert_eq!(outlet.switchings().last().unwrap().sample, Some(5));
}

#[test]
fn a_voltage_that_comes_slowly_is_waited_for() {
    let how = Peculiarities { time_constant_s: 0.02, ..Peculiarities::default() };
    let instrument = SimulatedInstrument::start(how).unwrap();
    let mut outlet = begun(&plan(&instrument));
    let after_v = outlet.switchings().last().unwrap().after.voltage_v.unwrap();
    assert!((22.8..=25.2).contains(&after_v), "{after_v}");
    outlet.switch(false, None).unwrap();
    assert!(outlet.switchings().last().unwrap().after.voltage_v.unwrap() <= 1.2);
}

#[test]
fn a_measurement_that_is_no_number_is_an_error() {
    let how = Peculiarities { no_number: true, ..Peculiarities::default() };
    let instrument = SimulatedInstrument::start(how).unwrap();
    let error = PowerOutlet::open(&plan(&instrument)).unwrap().begin().unwrap_err();
    assert!(matches!(&error, PowerError::Nonsense { reply, .. } if reply == "9.91E37"), "{error}");
}

#[test]
fn the_end_state_is_on_where_the_plan_says_so_even_after_a_cut() {
    let instrument = instrument();
    let mut outlet = begun(&PowerPlan { end_on: true, ..plan(&instrument) });
    outlet.lower(3.0, None).unwrap();
    outlet.switch(false, None).unwrap();
    drop(outlet);
    assert!(instrument.is_on(2));
    assert_eq!(instrument.set_v(2), 24.0);
}

#[test]
fn looking_switches_nothing_not_even_in_the_end() {
    let instrument = instrument();
    begun(&PowerPlan { end_on: true, ..plan(&instrument) });
    let mut outlet = PowerOutlet::open(&plan(&instrument)).unwrap();
    assert!(outlet.read().unwrap().on);
    drop(outlet);
    assert!(instrument.is_on(2));
}

#[test]
fn an_output_rests_before_it_is_switched_on() {
    let instrument = instrument();
    begun(&PowerPlan { end_on: true, ..plan(&instrument) });
    // The voltage that is left at the start is the one before.
    let rest = Duration::from_millis(30);
    let outlet = begun(&PowerPlan { rest, ..plan(&instrument) });
    let [off, on] = outlet.switchings() else { panic!("{:?}", outlet.switchings()) };
    assert_eq!((off.command.as_str(), on.command.as_str()), ("OUTP OFF", "OUTP ON"));
    assert!(on.at.duration_since(off.at).unwrap() >= rest);
}

#[test]
fn the_end_comes_over_a_new_connection_where_the_old_one_is_mute() {
    let instrument = instrument();
    let short = PowerPlan { reply: Duration::from_secs(1), ..plan(&instrument) };
    let mut outlet = begun(&short);
    instrument.becomes(Peculiarities { silent: true, ..Peculiarities::default() });
    // Nobody answers on any connection: it is told, and the bytes are written all the same.
    outlet.end().unwrap_err();
    assert!(within(octant_test_processes::HANGS, || !instrument.is_on(2)));
}

#[test]
fn a_program_that_cannot_go_on_writes_the_end_states() {
    // In a process of its own: the outlets of other tests would be switched off too.
    const PORT: &str = "OCTANT_TEST_POWER_PORT";
    if let Ok(port) = std::env::var(PORT) {
        let end_on = std::env::var_os("OCTANT_TEST_POWER_END_ON").is_some();
        let mut outlet = begun(&PowerPlan { port, end_on, ..plan(&instrument()) });
        outlet.lower(6.0, None).unwrap();
        assert_eq!(write_all_ends(), 1);
        std::process::exit(0);
    }
    let this = "outlet::a_program_that_cannot_go_on_writes_the_end_states";
    for (end_on, set_v) in [(false, 6.0), (true, 24.0)] {
        let instrument = instrument();
        let mut child = command(std::env::current_exe().unwrap());
        child.args(["--exact", this]).env(PORT, instrument.port());
        if end_on {
            child.env("OCTANT_TEST_POWER_END_ON", "1");
        }
        assert!(child.output().unwrap().status.success());
        let is_left = || instrument.is_on(2) == end_on && instrument.set_v(2) == set_v;
        assert!(within(octant_test_processes::HANGS, is_left), "{instrument:?}");
        // It was on at its lowered voltage before.
        assert!(instrument.heard().contains(&"VOLT 6".to_owned()));
    }
}
