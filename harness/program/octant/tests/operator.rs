//! A person at the bench: asked on a terminal, from another process, on a page and from a file; whatever is answered,
//! the samples of a lock-step run keep their bits, and a run without its answers is no evidence.

use crate::common::attended::{Bench, DOOR, Going, LEVEL, record, said};
use octant_recorder::Event;
use octant_recorder::reader::{Item, Recording};
use serde_json::Value;
use std::time::Duration;

#[test]
fn answers_of_another_process_are_evidence_and_change_no_bit() {
    let bench = Bench::new(&format!("{DOOR}{LEVEL}"));
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step door: Is the door shut?", 1);
    let (status, words) = bench.answer("level", "0.02", "Ada");
    assert!(status == Some(2) && words.contains("isn't asked yet"), "{words}");
    assert_eq!(bench.answer("door", "yes", "Ada").0, Some(0));
    run.hears("step level: Read the level.", 1);
    // The device's patience of 3 s is shorter than the person's.
    std::thread::sleep(Duration::from_millis(4500));
    let (status, words) = bench.answer("level", "0.2", "Ada");
    assert!(status == Some(2) && words.contains("a number from -0.1 to 0.1 mm/m"), "{words}");
    let (status, words) = bench.answer("door", "no", "Bob");
    assert!(status == Some(2) && words.contains("already: yes by Ada (command)"), "{words}");
    assert_eq!(bench.answer("level", "0.02", "Bob").0, Some(0));
    let (status, words) = run.end();
    assert_eq!(status, Some(0), "{words}");
    assert!(!bench.path("run/operator").exists());
    let hash = bench.json("run/summary.json")["stream_hash"].clone();
    assert_eq!(hash, Value::String(bench.hash()));

    let acts = [
        record(["asked", "door", "-", "-", "-"]),
        record(["answered", "door", "yes", "Ada", "command"]),
        record(["asked", "level", "-", "-", "-"]),
        record(["answered", "level", "0.02", "Bob", "command"]),
    ];
    assert_eq!(bench.acts("run"), acts);
    let answers = bench.json("run/manifest.json")["answers"].clone();
    // 1 s at 200 Hz: before sample 201.
    assert_eq!((&answers[0]["sample"], &answers[2]["sample"]), (&Value::Null, &Value::from(201)));
    assert!(answers[3]["after_s"].as_f64().unwrap() >= 4.5, "{answers}");
    let mut recording = Recording::open(&bench.path("run/recording.mcap")).unwrap();
    let mut recorded = Vec::new();
    while let Some((_, item)) = recording.next_item().unwrap() {
        if let Item::Event(Event::Operator(detail)) = item {
            recorded.push(detail);
        }
    }
    assert_eq!(Value::Array(recorded), answers);
    let report = std::fs::read_to_string(bench.path("run/report.html")).unwrap();
    assert!(report.contains("answered level: 0.02 mm/m, by Bob (command)"));

    // An edited answer is found, wherever it is edited.
    let verify = || said(&bench.octant(&["verify", "run"]));
    assert_eq!(verify().0, Some(0), "{}", verify().1);
    for file in ["run/operator.jsonl", "run/manifest.json"] {
        let text = std::fs::read_to_string(bench.path(file)).unwrap();
        assert!(text.contains("Bob"));
        std::fs::write(bench.path(file), text.replace("Bob", "Eve")).unwrap();
        assert_eq!(verify().0, Some(1), "{file}");
        std::fs::write(bench.path(file), text).unwrap();
    }
    assert_eq!(verify().0, Some(0));
}

#[test]
fn a_no_and_a_timeout_abort_and_a_late_person_may_still_answer() {
    let bench = Bench::new(DOOR);
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step door", 1);
    assert_eq!(bench.answer("door", "No", "Ada").0, Some(0));
    let (status, words) = run.end();
    assert_eq!(status, Some(3), "{words}");
    let summary = bench.json("run.partial/summary.json");
    assert_eq!(summary["verdict"], "inconclusive");
    assert!(
        summary.to_string().contains("the answer to step \\\"door\\\" was no, Ada"),
        "{summary}"
    );
    assert_eq!(bench.acts("run.partial")[2][0], "aborted");

    let bench = Bench::new(&format!("{DOOR}timeout = \"300 ms\"\n"));
    let (status, words) = said(&bench.with_device(&["--no-terminal"]).output().unwrap());
    assert_eq!(status, Some(3), "{words}");
    let acts: Vec<String> =
        bench.acts("run.partial").into_iter().map(|record| record[0].clone()).collect();
    assert_eq!(acts, ["asked", "overdue", "aborted", "unanswered"]);

    let bench = Bench::new(&format!("{DOOR}timeout = \"300 ms\"\non_timeout = \"wait\"\n"));
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("overdue door", 1);
    assert_eq!(bench.answer("door", "yes", "Ada").0, Some(0));
    assert_eq!(run.end().0, Some(0));
    assert_eq!(bench.acts("run")[1], record(["overdue", "door", "-", "-", "-"]));
}

#[test]
fn after_a_no_a_step_is_asked_again_where_it_says_so() {
    let bench = Bench::new(&format!("{DOOR}on_no = \"ask-again\"\n"));
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step door", 1);
    assert_eq!(bench.answer("door", "no", "Ada").0, Some(0));
    run.hears("step door: Is", 2);
    assert_eq!(bench.answer("door", "yes", "Ada").0, Some(0));
    assert_eq!(run.end().0, Some(0));
    let values: Vec<String> =
        bench.acts("run").into_iter().map(|record| record[2].clone()).collect();
    assert_eq!(values, ["-", "no", "-", "yes"]);
}

#[test]
fn an_interrupt_while_a_question_is_open_ends_in_order_and_a_kill_leaves_it_open() {
    let bench = Bench::new(LEVEL);
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step level", 1);
    run.signal("-INT");
    let (status, words) = run.end();
    assert_eq!(status, Some(3), "{words}");
    assert_eq!(bench.acts("run.partial")[1], record(["unanswered", "level", "-", "-", "-"]));
    let summary = bench.json("run.partial/summary.json").to_string();
    assert!(
        summary.contains("the run ended while step \\\"level\\\" was not answered"),
        "{summary}"
    );

    let bench = Bench::new(LEVEL);
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step level", 1);
    run.signal("-KILL");
    assert_eq!(run.end().0, None);
    assert!(bench.path("run.partial").is_dir() && !bench.path("run").exists());
    assert!(!bench.path("run.partial/manifest.json").exists());
    let output = bench.octant(&["operator", "status", "run.partial"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("open: level\nthe run doesn't go on\n"), "{text}");
    let (status, words) = bench.answer("level", "0", "Ada");
    assert!(status == Some(4) && words.contains("took no request"), "{words}");

    // Nor is there a recording before the start.
    let bench = Bench::new(DOOR);
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step door", 1);
    run.signal("-KILL");
    assert_eq!(run.end().0, None);
    let output = bench.octant(&["operator", "status", "run"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("open: door\nthe run doesn't go on\n"), "{text}");
}

#[test]
fn without_a_person_a_run_is_refused_before_anything_is_written() {
    let bench = Bench::new(&format!("{DOOR}{LEVEL}"));
    for (command, words) in [
        (&mut bench.with_device(&[]), "stdin is no terminal"),
        (&mut bench.command(&["--no-terminal"]), "nobody stands at a bench that is simulated"),
        (&mut bench.command(&["--realtime", "--no-terminal"]), "samples can't be stopped"),
    ] {
        let (status, found) = said(&command.output().unwrap());
        assert!(status == Some(2) && found.contains(words), "{found}");
        assert!(!bench.path("run").exists() && !bench.path("run.partial").exists());
    }
    let going_on = Bench::new(&format!("{DOOR}{LEVEL}hold = false\n"));
    let (status, found) = said(&going_on.command(&["--realtime"]).output().unwrap());
    assert!(status == Some(2) && found.contains("stdin is no terminal"), "{found}");
    // Commands that ask nobody don't leave the steps out.
    let campaign = "schema = 1\ntitle = \"c\"\n[[scenarios]]\nid = \"s\"\nfile = \"s.toml\"\n";
    std::fs::write(bench.path("c.toml"), campaign).unwrap();
    let (status, words) = said(&bench.octant(&["campaign", "plan", "c.toml", "--out", "cases"]));
    assert!(status == Some(2) && words.contains("nobody is at a case of a campaign"), "{words}");
    let (status, words) = said(&bench.octant(&["rare", "s.toml", "--protection"]));
    assert!(status == Some(2) && words.contains("found step \"door\""), "{words}");
}

#[test]
fn a_file_answers_a_simulated_run_and_changes_no_bit() {
    let bench = Bench::new(&format!("{DOOR}{LEVEL}"));
    let file = |text: &str| {
        std::fs::write(bench.path("a.toml"), text).unwrap();
        bench.command(&["--answers", "a.toml", "--force"]).output().unwrap()
    };
    let door = "[[answer]]\nid = \"door\"\nvalue = \"yes\"\n";
    let level = "[[answer]]\nid = \"level\"\nvalue = \"0.05\"\n";
    for (text, words) in [
        (door.to_owned(), "no answer to \"level\""),
        (format!("{door}{level}"), "expected by"),
        (format!("{door}{door}{level}"), "a second answer to \"door\""),
        (format!("{door}{}by = \"Ada\"\n", level.replace("0.05", "NaN")), "a number from -0.1"),
        (
            format!("{door}{level}by = \"Ada\"\n[[answer]]\nid = \"dor\"\nvalue = \"yes\"\n"),
            "did you mean \"door\"",
        ),
        ("answer = 1".to_owned(), "a.toml"),
    ] {
        let (status, found) = said(&file(&text));
        assert!(status == Some(2) && found.contains(words), "{words}: {found}");
        assert!(!bench.path("run").exists() && !bench.path("run.partial").exists());
    }
    let output = file(&format!("{door}{level}by = \"Ada\"\n"));
    assert!(output.status.success(), "{}", said(&output).1);
    assert_eq!(bench.acts("run")[3], record(["answered", "level", "0.05", "Ada", "file"]));
    let hash = bench.json("run/summary.json")["stream_hash"].clone();
    assert_eq!(hash, Value::String(bench.hash()));
    // The journal of a run answers the next one.
    std::fs::rename(bench.path("run"), bench.path("first")).unwrap();
    let output = bench.command(&["--answers", "first/operator.jsonl"]).output().unwrap();
    assert!(output.status.success(), "{}", said(&output).1);
    assert_eq!(bench.acts("run"), bench.acts("first"));
}

#[test]
fn a_step_whose_trigger_never_comes_makes_the_run_inconclusive() {
    let steps = LEVEL.replace("at = \"1 s\"", "when = \"nis above 1e9\"");
    let bench = Bench::new(&steps);
    let output = bench.with_device(&["--no-terminal"]).output().unwrap();
    let (status, words) = said(&output);
    assert_eq!(status, Some(3), "{words}");
    assert_eq!(bench.acts("run"), [record(["never-asked", "level", "-", "-", "-"])]);
    assert!(
        bench.json("run/summary.json").to_string().contains("before step \\\"level\\\" was asked")
    );
}

#[test]
fn a_run_in_lock_step_is_held_resumed_and_aborted_and_one_by_the_clock_aborted_alone() {
    let steps =
        LEVEL.replace("answer = \"number\"\nunit = \"mm/m\"\nleast = -0.1\nmost = 0.1\n", "");
    let bench = Bench::new(&steps);
    let run = Going::start(&mut bench.with_device(&["--no-terminal"]));
    run.hears("step level", 1);
    let operator = |act: &str| said(&bench.octant(&["operator", act, "run", "--by", "Ada"]));
    assert!(operator("resume").1.contains("isn't held"));
    assert_eq!(operator("hold").0, Some(0));
    assert!(operator("hold").1.contains("held already"));
    let status = bench.octant(&["operator", "status", "run"]);
    assert!(String::from_utf8_lossy(&status.stdout).ends_with("the run is held\n"));
    assert_eq!(bench.answer("level", "yes", "Ada").0, Some(0));
    std::thread::sleep(Duration::from_millis(500));
    assert!(bench.path("run.partial").exists(), "it goes on though it is held");
    assert_eq!(operator("resume").0, Some(0));
    assert_eq!(run.end().0, Some(0));
    let acts: Vec<String> = bench.acts("run").into_iter().map(|record| record[0].clone()).collect();
    assert_eq!(acts, ["asked", "held", "answered", "resumed"]);
    let answers = bench.json("run/manifest.json")["answers"].clone();
    assert_eq!(answers[3]["sample"], 201);
    let hash = bench.json("run/summary.json")["stream_hash"].clone();
    assert_eq!(hash, Value::String(bench.hash()));
    assert!(operator("abort").1.contains("no operator is heard there"));

    // By the clock samples go on while a question is open.
    let bench = Bench::new(&format!("{}hold = false\n", steps.replace("1 s", "200 ms")));
    let longer = ["--realtime", "--no-terminal", "--set", "procedure.navigation.duration=\"60 s\""];
    let run = Going::start(&mut bench.command(&longer));
    run.hears("step level", 1);
    let operator = |act: &str| said(&bench.octant(&["operator", act, "run", "--by", "Ada"]));
    assert!(operator("hold").1.contains("can't be held: they leave by the clock"));
    assert_eq!(bench.answer("level", "yes", "Ada").0, Some(0));
    assert_eq!(operator("abort").0, Some(0));
    let (status, words) = run.end();
    assert_eq!(status, Some(3), "{words}");
    let acts: Vec<String> =
        bench.acts("run.partial").into_iter().map(|record| record[0].clone()).collect();
    assert_eq!(acts, ["asked", "answered", "aborted"]);
}

/// Steps that contradict themselves are refused where they stand.
#[test]
fn steps_that_contradict_themselves_are_refused() {
    let refused = |step: &str, words: &str| {
        let bench = Bench::new(&format!("{DOOR}{step}"));
        let (status, found) = said(&bench.with_device(&["--no-terminal"]).output().unwrap());
        assert!(
            status == Some(2) && found.contains(words) && found.contains("s.toml:"),
            "{words}: {found}"
        );
    };
    let level = |more: &str| {
        format!(
            "{}{more}",
            LEVEL.replace("answer = \"number\"\nunit = \"mm/m\"\nleast = -0.1\nmost = 0.1\n", "")
        )
    };
    refused(DOOR, "a second time");
    refused("on_no = \"go-on\"\n", "expected answer = \"yes-no\"");
    refused("hold = false\n", "without trigger");
    refused("unit = \"mm\"\n", "without answer = \"number\"");
    refused("answer = \"choice\"\nchoices = [\"a\"]\n", "two or more");
    refused("answer = \"number\"\nleast = 2\nmost = 1\n", "expected 2 or more");
    refused("answer = \"text\"\non_no = \"abort\"\n", "has no \"no\"");
    refused("on_timeout = \"wait\"\n", "without timeout");
    refused(&level("").replace("1 s", "1 h"), "never asked");
    refused(&level("").replace("at = \"1 s\"", "every = \"1 s\""), "comes once");
    refused(
        &level("").replace("at = \"1 s\"", "when = \"latitude error above 1 arcmin\""),
        "truth",
    );
    refused(&level("").replace("at = \"1 s\"", "mode = \"calibrating\""), "never is calibrating");
    refused("timeout = \"-1 s\"\n", "above 0");
}
