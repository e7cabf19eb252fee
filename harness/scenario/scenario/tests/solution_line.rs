//! A solution from a port, and heading tests of a solution: what belongs to them, and what is refused.

use crate::Scenario;
use crate::SourceSpec;
use crate::trajectory::{NmeaPoints, SolutionReference, TrajectoryFormat};
use std::path::Path;

const LINE: &str = "schema = 1
title = \"line\"
[source]
uri = \"solution:serial:/dev/ttyUSB0?baud=4800\"
[source.solution]
silence = \"20 s\"
[source.trajectory]
true_heading = \"40 deg\"
[procedure.navigation]
duration = \"290 min\"
[procedure.heading_test]
test = \"settle\"
run_ups = 2
off = \"12 h\"
";

fn parsed(text: &str) -> Result<Scenario, String> {
    Scenario::parse(text, "s.toml", Path::new("."), &[]).map_err(|error| error.to_string())
}

fn step(at: &str, more: &str) -> String {
    format!(
        "{LINE}[[operator]]\nid = \"a\"\nask = \"Is it so?\"\ntrigger = {{ at = \"{at}\" }}\n{more}"
    )
}

#[test]
fn a_port_is_a_solution_that_comes_while_the_run_goes() {
    let scenario = parsed(LINE).unwrap();
    let line = scenario.solution_line().unwrap();
    assert_eq!(line.uri.to_string(), "serial:/dev/ttyUSB0?baud=4800");
    assert_eq!(line.silence.as_secs(), 20);
    // Two run-ups with a pause; what is scored is the time with power.
    assert_eq!(scenario.line_s(), Some(2.0 * 17_400.0 + 43_200.0));
    assert_eq!(scenario.samples(), Some(2 * scenario.run_up_samples().unwrap()));
    assert!(scenario.power_cycles().is_empty() && scenario.files().is_empty());
    assert_eq!(scenario.devices(), ["serial:/dev/ttyUSB0?baud=4800"]);
    let SourceSpec::Solution(spec) = &scenario.source else { panic!("a solution") };
    let TrajectoryFormat::Nmea(choice) = &spec.solution.format else { panic!("NMEA") };
    assert!(choice.points == Some(NmeaPoints::Headings) && choice.tells_none);
    // The bench of a file is that of the run that made it.
    let step = step("290 min", "");
    let of_file = step.replace("solution:serial:/dev/ttyUSB0?baud=4800", "solution:a.nmea");
    assert_eq!(parsed(&step).unwrap().operator.len(), 1);
    assert_eq!(parsed(&of_file).unwrap().operator.len(), 0);
    let blind = LINE.replace("[source.trajectory]\ntrue_heading = \"40 deg\"\n", "");
    let SourceSpec::Solution(spec) = parsed(&blind).unwrap().source else { panic!("a solution") };
    assert_eq!(spec.reference, SolutionReference::Unknown);
}

#[test]
fn steps_may_hold_a_unit_without_power_alone() {
    for at in ["290 min", "300 min", "1010 min"] {
        assert!(parsed(&step(at, "")).is_ok(), "{at}");
    }
    for at in ["100 min", "1020 min"] {
        assert!(parsed(&step(at, "hold = false\n")).is_ok(), "{at}");
        let refused = parsed(&step(at, "")).unwrap_err();
        assert!(refused.contains("the unit sends on while a question is open"), "{refused}");
    }
    let refused = parsed(&step("1301 min", "hold = false\n")).unwrap_err();
    assert!(refused.contains("s.toml"), "{refused}");
    let by_mode = format!(
        "{LINE}[[operator]]\nid = \"a\"\nask = \"Is it so?\"\ntrigger = {{ mode = \"navigating\" }}\n"
    );
    let refused = parsed(&by_mode).unwrap_err();
    assert!(refused.contains("expected trigger = { at"), "{refused}");
}

#[test]
fn keys_that_contradict_a_heading_test_of_a_solution_are_refused() {
    let with = |from: &str, to: &str| parsed(&LINE.replacen(from, to, 1)).unwrap_err();
    for (from, to, words) in [
        ("off =", "resolution = \"0.1 deg\"\noff =", "the last digit of its headings"),
        ("off =", "azimuths = [\"0 deg\"]\noff =", "found 1 angles, expected 2"),
        ("off =", "azimuths = [\"0 deg\", \"right\"]\noff =", "expected an angle"),
        ("serial:/dev/ttyUSB0?baud=4800", "can:can0", "expected serial:PORT"),
        ("silence", "format = \"csv\"\nsilence", "sentences of NMEA 0183 from a port"),
        ("silence", "skip = \"1 min\"\nsilence", "expected source.solution.switched_on"),
        (
            "silence",
            "switched_on = [\"2027-03-31T08:00:00Z\", \"2027-03-30T08:00:00Z\"]\nsilence",
            "expected times that run forward",
        ),
        ("silence", "switched_on = [\"today\"]\nsilence", "expected a time such as"),
        ("silence", "heading_delay_uncertainty = \"1 s\"\nsilence", "without heading_delay"),
        ("silence", "quality_left_out = [\"0\"]\nsilence", "which isn't columns of text"),
        ("duration = \"290 min\"\n", "", "duration"),
    ] {
        let refused = with(from, to);
        assert!(refused.contains(words), "{words}: {refused}");
    }
    let three = "switched_on = [\"2027-03-31T08:00:00Z\", \"2027-04-01T08:00:00Z\", \"2027-04-02T08:00:00Z\"]\n";
    let refused = with("silence", &format!("{three}silence"));
    assert!(refused.contains("found 3 times, expected 2"), "{refused}");
    let turned = LINE.replace("off =", "azimuths = [\"0 deg\", \"90 deg\"]\noff =");
    assert!(parsed(&turned).is_ok());
    let blind = turned.replace("true_heading = \"40 deg\"\n", "");
    assert!(parsed(&blind).unwrap_err().contains("without source.trajectory.true_heading"));
    let drive = "[turntable.drive]\nport = \"tcp:a:1\"\nazimuth = [\"-5 deg\", \"100 deg\"]\nroll = [\"-5 deg\", \"5 deg\"]\n";
    assert!(parsed(&format!("{turned}{drive}")).is_ok());
    let beyond = format!("{turned}{drive}").replace("100 deg", "80 deg");
    assert!(parsed(&beyond).unwrap_err().contains("azimuths has 90.0000 deg"));
    let simulated = turned.replace("uri = \"solution:serial:/dev/ttyUSB0?baud=4800\"\n", "");
    assert!(parsed(&simulated).is_err());
    // Without a heading test a solution needs its reference, and has no run-ups.
    let plain = &LINE[..LINE.find("[procedure.heading_test]").unwrap()];
    let blind = plain.replace("[source.trajectory]\ntrue_heading = \"40 deg\"\n", "");
    assert!(parsed(plain).is_ok());
    assert!(parsed(&blind).unwrap_err().contains("expected the trajectory that the solution"));
    let on = plain.replace("silence", "switched_on = [\"2027-03-31T08:00:00Z\"]\nsilence");
    assert!(parsed(&on).unwrap_err().contains("whose run-ups they begin"));
}
