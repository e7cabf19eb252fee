//! One FMU stepped with inputs from a file.

use octant_base::control::Control;
use octant_cosim::single::input::{InputFileError, Inputs};
use octant_cosim::single::output::{Outputs, Sink, TOPIC};
use octant_cosim::single::{Finished, Span, simulate};
use octant_fmu_bind::settings::{Starts, ValueSettings};
use octant_fmu_bind::testing::{Scripted, With, description, variable};
use octant_fmu_host::description::{
    Causality, ClockProperties, Description, IntervalVariability, Variability, Variable,
    VariableType,
};
use octant_fmu_host::instance::Instance;
use octant_scenario::Set;

/// y = 2 u + w[2], held: a copy of h; also a whole number and a text.
fn model() -> Description {
    use Causality::{Input, Output, Parameter};
    let mut held = variable("h", 2, VariableType::Float64, Input).in_unit("rad/s");
    held.variability = Variability::Discrete;
    description(
        "gain",
        vec![
            variable("u", 1, VariableType::Float64, Input).in_unit("m"),
            held,
            variable("on", 3, VariableType::Boolean, Input),
            variable("w", 4, VariableType::Float64, Input).array(2),
            variable("y", 6, VariableType::Float64, Output).in_unit("m"),
            variable("held", 7, VariableType::Float64, Output),
            variable("n", 8, VariableType::Int32, Output),
            variable("was_on", 9, VariableType::Boolean, Output),
            variable("m", 10, VariableType::Float64, Output).array(2),
            variable("words", 12, VariableType::String, Output),
            variable("bytes", 11, VariableType::Binary, Output),
            variable("k", 13, VariableType::Float64, Parameter),
            tunable(variable("t", 14, VariableType::Float64, Parameter).array(2)),
        ],
    )
}

fn tunable(mut variable: Variable) -> Variable {
    variable.variability = Variability::Tunable;
    variable
}

fn gain() -> Box<dyn Instance> {
    let mut steps = 0.0;
    Scripted::boxed(model(), move |cells, _| {
        steps += 1.0;
        cells[6] = 2.0 * cells[1] + cells[5] + cells[13] + cells[15];
        cells[7] = cells[2];
        cells[8] = steps;
        cells[9] = cells[3];
        cells[10] = 0.1 * steps;
        cells[11] = f64::NAN;
        Ok(true)
    })
}

fn inputs(text: &str) -> Result<Inputs, InputFileError> {
    Inputs::from_reader(text.as_bytes(), "in.csv", &model())
}

fn run(text: &str, names: &[&str], span: Span, file: &str) -> (Finished, Vec<u8>) {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let outputs = Outputs::choose(&model(), &names).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    let mut sink = Sink::file(&path, &outputs, "gain").unwrap();
    let mut inputs = inputs(text).unwrap();
    let description = model();
    let mut settings = ValueSettings::new(&description);
    settings.set("k", &[Set::Number(0.5)]).unwrap();
    let starts = settings.finish().unwrap();
    let mut instance = gain();
    let control = Control::default();
    let finished = simulate(
        instance.as_mut(),
        &starts,
        Some(&mut inputs),
        &outputs,
        &span,
        &mut sink,
        &control,
    )
    .unwrap();
    sink.finish().unwrap();
    (finished, std::fs::read(&path).unwrap())
}

const INPUTS: &str = "time,u [cm],h [deg/s],on,w[2]\n0,0,180,0,7\n1,100,180,1,7\n1,300,360,1,8\n\
                      # a comment\n2,300,0,false,8\n";

#[test]
fn what_is_continuous_is_interpolated_and_everything_else_held() {
    let span = Span { start_s: 0.0, stop_s: 2.0, step_s: 0.25, tolerance: None, splits: true };
    let numbers = ["y", "held", "n", "was_on", "m"];
    let (finished, csv) = run(INPUTS, &numbers, span, "out.csv");
    assert_eq!((finished.steps, finished.time_s, finished.terminated), (8, 2.0, false));
    let text = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "\"time\",\"y\",\"held\",\"n\",\"was_on\",\"m[1]\",\"m[2]\"");
    // After initialization no step was made.
    assert_eq!(lines[1], "0.0,0.0,0.0,0,0,0.0,0.0");
    let rows: Vec<Vec<&str>> = lines[2..].iter().map(|line| line.split(',').collect()).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<_>>();
    // u at the start of each step: 0, 0.25, 0.5, 0.75 m, then 3 m after the step in it at 1 s.
    assert_eq!(column(1), ["7.5", "8.0", "8.5", "9.0", "14.5", "14.5", "14.5", "14.5"]);
    let pi = format!("{:?}", std::f64::consts::PI);
    let two_pi = format!("{:?}", std::f64::consts::TAU);
    let held: Vec<&str> = column(2);
    assert!(held[..4].iter().all(|held| *held == pi), "{held:?}");
    assert!(held[4..].iter().all(|held| *held == two_pi), "{held:?}");
    assert_eq!(column(3), ["1", "2", "3", "4", "5", "6", "7", "8"]);
    assert_eq!(column(4), ["0", "0", "0", "0", "1", "1", "1", "1"]);
    assert_eq!(rows[2][5], "0.30000000000000004", "every digit");
    assert_eq!(rows[2][6], "NaN");
}

#[test]
fn some_outputs_and_a_last_step_that_is_shorter() {
    let span = Span { start_s: 0.5, stop_s: 1.25, step_s: 0.5, tolerance: None, splits: true };
    let (finished, csv) = run(INPUTS, &["n", "m", "y"], span, "out.csv");
    assert_eq!((finished.steps, finished.time_s), (2, 1.25));
    let text = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "\"time\",\"n\",\"m[1]\",\"m[2]\",\"y\"");
    assert!(lines[2].starts_with("1.0,1,") && lines[3].starts_with("1.25,2,"), "{lines:?}");
    let mut clocked = model();
    clocked.variables.push(variable("tick", 17, VariableType::Clock, Causality::Output));
    let mut frames = variable("frames", 18, VariableType::Binary, Causality::Output);
    frames.clocks = vec![17];
    clocked.variables.push(frames);
    for (name, expected) in [("tick", "is a clock"), ("frames", "at the ticks of its clock alone")]
    {
        let error = Outputs::choose(&clocked, &[name.to_owned()]).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(expected), "{error}");
    }
    let error = Outputs::choose(&model(), &["z".to_owned()]).unwrap_err().to_string();
    assert!(error.contains("no variable \"z\""), "{error}");
    assert_eq!(Outputs::choose(&clocked, &[]).unwrap().left_out, ["tick", "frames"]);
}

#[test]
fn rows_of_mcap_are_json_with_a_schema() {
    let span = Span { start_s: 0.0, stop_s: 1.0, step_s: 0.5, tolerance: None, splits: true };
    let (_, bytes) = run(INPUTS, &["y", "was_on", "m[2]"], span, "out.mcap");
    let messages: Vec<_> =
        mcap::MessageStream::new(&bytes).unwrap().map(|message| message.unwrap()).collect();
    assert_eq!(messages.len(), 3);
    let last = &messages[2];
    assert_eq!((last.channel.topic.as_str(), last.log_time), (TOPIC, 1_000_000_000));
    assert_eq!(last.data.as_ref(), br#"{"time":1.0,"y":8.5,"was_on":false,"m[2]":null}"#);
    let schema = last.channel.schema.as_ref().unwrap();
    assert_eq!(schema.encoding, "jsonschema");
    let schema: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
    assert_eq!(schema["properties"]["y"]["description"], "in m");
    let message: serde_json::Value = serde_json::from_slice(&last.data).unwrap();
    assert!(octant_json_schema::draft202012::is_valid(&schema, &message));
}

/// A text between quotes with its own doubled (RFC 4180), bytes as digits; in a row of JSON as strings.
#[test]
fn texts_and_bytes_are_recorded_beside_numbers() {
    let span = Span { start_s: 0.0, stop_s: 0.5, step_s: 0.5, tolerance: None, splits: true };
    let (_, csv) = run(INPUTS, &["bytes", "n", "words"], span, "out.csv");
    let mut table = csv::Reader::from_reader(csv.as_slice());
    assert_eq!(table.headers().unwrap(), vec!["time", "bytes", "n", "words"]);
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows[0], vec!["0.0", "0000000b", "0", "\"12, text"]);
    assert_eq!(rows[1], vec!["0.5", "0000000b", "1", "\"12, text"]);
    let (_, bytes) = run(INPUTS, &["words", "bytes"], span, "out.mcap");
    let last = mcap::MessageStream::new(&bytes).unwrap().last().unwrap().unwrap();
    let expected = br#"{"time":0.5,"words":"\"12, text","bytes":"0000000b"}"#;
    assert_eq!(last.data.as_ref(), expected);
    let schema = last.channel.schema.as_ref().unwrap();
    let schema: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
    let message: serde_json::Value = serde_json::from_slice(&last.data).unwrap();
    assert!(octant_json_schema::draft202012::is_valid(&schema, &message));
    // Without names: all of them.
    let all = Outputs::choose(&model(), &[]).unwrap();
    let names = all.columns.iter().map(|column| column.name.as_str());
    assert_eq!(
        names.collect::<Vec<_>>(),
        ["y", "held", "n", "was_on", "m[1]", "m[2]", "words", "bytes"]
    );
}

#[test]
fn an_array_has_a_column_or_one_for_each_element() {
    let at_half = |text: &str| {
        let mut inputs = inputs(text).unwrap();
        inputs.at(0.5);
        inputs.numbers
    };
    let apart = at_half("time,w[1],w[2],u\n0,1,2,3\n1,2,4,6\n");
    assert_eq!(apart, at_half("time,w,u\n0,1 2,3\n1, 2  4 ,6\n"));
    assert_eq!(apart, at_half("time,w[2],w[1],u\n0,2,1,3\n1,4,2,6\n"));
}

/// Each row ticks once, at the first communication point at or after it; none before the first row.
#[test]
fn a_triggered_clock_ticks_at_the_rows_that_say_so() {
    let mut description = model();
    let of_kind = |interval_variability| ClockProperties {
        interval_variability,
        interval_s: None,
        interval_counter: None,
        resolution: None,
        shift_s: 0.0,
        shift_counter: 0,
        supports_fraction: false,
        priority: None,
        can_be_deactivated: false,
    };
    for (name, reference) in [("a", 20), ("b", 21), ("c", 22)] {
        let mut clock = variable(name, reference, VariableType::Clock, Causality::Input);
        clock.clock = Some(of_kind(IntervalVariability::Triggered));
        description.variables.push(clock);
    }
    description.variables.last_mut().unwrap().clock = Some(of_kind(IntervalVariability::Countdown));
    let text = "time,a,u,b\n1,1,0,0\n1.5,0,1,1\n1.6,1,2,0\n2,0,3,0\n2,1,4,0\n";
    let read = |text: &str| Inputs::from_reader(text.as_bytes(), "in.csv", &description);
    let mut inputs = read(text).unwrap();
    let mut found = Vec::new();
    for time_s in [0.0, 0.5, 1.0, 1.25, 1.75, 2.0, 2.5] {
        inputs.at(time_s);
        found.push(inputs.ticks().map(|group| group.references));
    }
    let [a, both] = [vec![20], vec![20, 21]];
    assert_eq!(found, [None, None, Some(a.clone()), None, Some(both), Some(a), None]);
    for (text, expected) in [
        ("time,c\n0,1\n", "c is a clock with times of its own, expected a triggered one"),
        ("time,a\n0,2\n", "in.csv:2:2: found \"2\", expected 0, 1, true or false"),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn mistakes_in_inputs_have_file_line_and_column() {
    for (text, expected) in [
        ("", "in.csv:1:1: found \"\", expected time as the first column"),
        ("u,time\n1,2\n", "in.csv:1:1: found \"u\", expected time as the first column"),
        ("time [m],u\n1,2\n", "in.csv:1:1: found \"time [m]\""),
        ("time,u\n", "in.csv:2:1: the file ends, expected a row of numbers"),
        ("time,uu\n0,1\n", "in.csv:1:2: the FMU has no variable \"uu\"; nearest are \"u\""),
        ("time,y\n0,1\n", "in.csv:1:2: y is an output of the FMU, expected an input"),
        ("time,w\n0,1\n", "in.csv:2:2: found 1 numbers, expected 2"),
        ("time,w\n0,1 x\n", "in.csv:2:2: found \"x\", expected a number"),
        ("time,w,w[2]\n0,1 2,2\n", "in.csv:1:3: w[2] a second time"),
        ("time,w[3]\n0,1\n", "in.csv:1:2: the FMU has no variable \"w[3]\""),
        ("time,u,u\n0,1,1\n", "in.csv:1:3: u a second time"),
        ("time,u [s]\n0,1\n", "in.csv:1:2: u: unit \"s\" (s) can't become \"m\" (m)"),
        ("time,on [s]\n0,1\n", "in.csv:1:2: found the unit \"s\", and on has none"),
        ("time,u,on\n0,1,1\n0.5,x,1\n", "in.csv:3:2: found \"x\", expected a number"),
        ("time,u,on\n0,1,2\n", "in.csv:2:3: found \"2\", expected 0, 1, true or false"),
        ("time,u\n1,1\n0,1\n", "in.csv:3:1: found the time 0 s after 1 s"),
        ("time,u\n1\n", "in.csv:2:1: found 1 columns, expected 2"),
    ] {
        let error = inputs(text).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(expected), "{text:?}:\n  {error}\n  {expected}");
    }
}

#[test]
fn spans_that_contradict_themselves_are_refused() {
    let steps = |start_s, stop_s, step_s| {
        Span { start_s, stop_s, step_s, tolerance: None, splits: true }.steps()
    };
    assert_eq!(steps(0.0, 10.0, 0.005), Ok(2000));
    assert_eq!(steps(0.1, 0.4, 0.1), Ok(3), "no step of rounding");
    assert_eq!(steps(0.0, 1.0, 0.3), Ok(4));
    assert_eq!(steps(1.0, 1.0, 0.3), Ok(0));
    for (start_s, stop_s, step_s, expected) in [
        (1.0, 0.0, 0.1, "a stop at or after the start"),
        (0.0, f64::NAN, 0.1, "a stop at or after the start"),
        (0.0, 1.0, 0.0, "a time above 0"),
        (0.0, 1.0, -1.0, "a time above 0"),
        (0.0, 1.0, 1e-300, "at most"),
    ] {
        let error = steps(start_s, stop_s, step_s).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn an_fmu_that_ends_or_fails_leaves_its_rows() {
    for (behaviour, steps, failed) in
        [(Ok(false), 3, false), (Err("was killed".to_owned()), 0, true)]
    {
        let outputs = Outputs::choose(&model(), &["y".to_owned()]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.csv");
        let mut sink = Sink::file(&path, &outputs, "gain").unwrap();
        let mut instance =
            Scripted::boxed(
                model(),
                move |_, time_s| {
                    if time_s > 0.25 { behaviour.clone() } else { Ok(true) }
                },
            );
        let span = Span { start_s: 0.0, stop_s: 1.0, step_s: 0.1, tolerance: None, splits: true };
        let control = Control::default();
        let starts = Starts::default();
        let finished =
            simulate(instance.as_mut(), &starts, None, &outputs, &span, &mut sink, &control);
        sink.finish().unwrap();
        assert_eq!(finished.is_err(), failed);
        if let Ok(finished) = finished {
            assert_eq!((finished.steps, finished.terminated), (steps, true));
        }
        let rows = std::fs::read_to_string(&path).unwrap().lines().count() - 1;
        assert!(rows >= 3, "{rows}");
    }
}

/// A tunable parameter is a column as an input is; the others of its array aren't known.
#[test]
fn tunable_parameters_are_held_from_their_row_on() {
    let span = Span { start_s: 0.0, stop_s: 1.0, step_s: 0.25, tolerance: None, splits: true };
    let (_, csv) = run("time,t[1],t[2]\n0,9,1\n0.5,9,2\n", &["y"], span, "out.csv");
    let text = String::from_utf8(csv).unwrap();
    let rows: Vec<&str> = text.lines().skip(2).collect();
    assert_eq!(rows, ["0.25,1.5", "0.5,1.5", "0.75,2.5", "1.0,2.5"]);
    let error = inputs("time,t[2]\n0,1\n").unwrap_err().to_string();
    let expected = "found columns for 1 of 2 elements of the parameter t, expected all of them";
    assert!(error.ends_with(expected), "{error}");
    let error = inputs("time,k\n0,1\n").unwrap_err().to_string();
    assert!(error.contains("k is a parameter of the FMU"), "{error}");
}
