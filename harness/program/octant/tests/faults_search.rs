//! `octant faults search`: its files, its exit statuses, and what it does with nonsense.

use crate::common::program::program;
use std::path::Path;
use std::process::Output;

const SHORT: &str = include_str!("../../../../fixtures/search/short.toml");

fn search(folder: &Path, arguments: &[&str]) -> Output {
    program(&["faults", "search"]).args(arguments).current_dir(folder).output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&[&*output.stdout, &*output.stderr].concat()).into_owned()
}

#[test]
fn the_worst_is_a_scenario_that_runs_and_an_interrupted_search_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.toml"), SHORT).unwrap();
    // The window of one fault: all gyros, 127 ppm of asymmetry, two minutes from 366 s on.
    let space = "schema = 1
[[faults]]
kind = \"asymmetry\"
channels = \"gyro\"
error = { from = \"1 ppm\", to = \"10000 ppm\" }
onset = { from = \"350 s\", to = \"380 s\" }
duration = \"131 s\"
";
    std::fs::write(folder.path().join("space.toml"), space).unwrap();
    let arguments = ["short.toml", "--space", "space.toml", "--runs", "32", "--out", "found"];
    let found = search(folder.path(), &arguments);
    assert_eq!(found.status.code(), Some(1), "{}", words(&found));
    let text = words(&found);
    assert!(
        text.contains("harmful and unnoticed") && text.contains("octant run found/worst.toml"),
        "{text}"
    );
    let read =
        |name: &str| std::fs::read_to_string(folder.path().join("found").join(name)).unwrap();
    let files = ["worst.toml", "search.json", "search.jsonl"].map(read);
    // As after a kill: the journal alone, with half of its last line.
    let journal = folder.path().join("found/search.jsonl");
    std::fs::remove_file(folder.path().join("found/worst.toml")).unwrap();
    std::fs::write(&journal, &files[2].as_bytes()[..files[2].len() - 20]).unwrap();
    assert_eq!(search(folder.path(), &arguments).status.code(), Some(1));
    assert_eq!(["worst.toml", "search.json", "search.jsonl"].map(read), files);
    // Its counterfactual says the same.
    let run =
        program(&["run", "found/worst.toml", "--out", "run"]).current_dir(folder.path()).output();
    let run = run.unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", words(&run));
    let json = |path: &Path| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
    };
    let summary = json(&folder.path().join("run/summary.json"));
    assert_eq!(summary["counterfactual"]["missed"], true);
    let minimal = &json(&folder.path().join("found/search.json"))["minimal"];
    let sigma = minimal["effect"]["worst"][1].as_f64().unwrap();
    assert_eq!(
        summary["counterfactual"]["worst_shift_sigma"].as_f64().unwrap().to_bits(),
        sigma.to_bits()
    );
    let page = read("search.html");
    assert!(page.contains("Harm of every run") && page.contains("asymmetry"));
    // A search of another core begins with it.
    let again = [
        &arguments[..4],
        &["32", "--set", "screening.gate=\"off\"", "--after", "found", "--out", "after"],
    ];
    let after = search(folder.path(), &again.concat());
    assert!(words(&after).contains("after a search of 3"), "{}", words(&after));
    let found = json(&folder.path().join("after/search.json"));
    let screens = found["earlier"]["screens"].as_array().unwrap();
    assert!(screens.iter().any(|screen| screen["again"].as_u64() > Some(0)), "{found}");
    let page = std::fs::read_to_string(folder.path().join("after/search.html")).unwrap();
    assert!(page.contains("After an earlier search") && page.contains("--after found"));
    for (more, expected) in [
        (["--after", "nowhere", "--pairs", "0"], "--after: read nowhere/search.jsonl"),
        (["--after", "found", "--strategy", "latin"], "takes no earlier search"),
    ] {
        let told = search(folder.path(), &[&arguments[..5], &more].concat());
        assert_eq!(told.status.code(), Some(2), "{}", words(&told));
        assert!(words(&told).contains(expected), "{}", words(&told));
    }
    let told = search(folder.path(), &["short.toml", "--kinds", "spike", "--after", "found"]);
    assert_eq!(told.status.code(), Some(2), "{}", words(&told));
    assert!(words(&told).contains("found/search.jsonl: line 1: found a search of another space"));
}

#[test]
fn a_search_that_finds_nothing_passes_and_one_that_shows_nothing_does_not() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.toml"), SHORT).unwrap();
    let space = |amplitude: &str| {
        let text = format!(
            "schema = 1\n[[faults]]\nkind = \"bias-step\"\nchannels = \"gyro x\"\namplitude = {amplitude}\n\
             onset = {{ from = \"100 s\", to = \"1000 s\" }}\nduration = \"1 samples\"\n"
        );
        std::fs::write(folder.path().join("space.toml"), text).unwrap();
        search(folder.path(), &["short.toml", "--space", "space.toml", "--runs", "16"])
    };
    let small = space("{ from = \"1 deg/h\", to = \"10 deg/h\" }");
    assert_eq!(small.status.code(), Some(0), "{}", words(&small));
    assert!(words(&small).contains("nothing harmful went unnoticed"), "{}", words(&small));
    // Less than a count: no sample is altered.
    let none = space("{ from = \"1e-12 deg/h\", to = \"1e-11 deg/h\" }");
    assert_eq!(none.status.code(), Some(3), "{}", words(&none));
    assert!(words(&none).contains("no fault altered anything whose harm"), "{}", words(&none));
    // A bias that stays is rightly estimated, and nothing navigates: no harm can be told.
    let stays = "schema = 1\n[[faults]]\nkind = \"bias-step\"\nchannels = \"accelerometer x\"\n\
                 amplitude = { from = \"1 ug\", to = \"2 ug\" }\nonset = \"0 s\"\n";
    std::fs::write(folder.path().join("space.toml"), stays).unwrap();
    let stays = search(folder.path(), &["short.toml", "--space", "space.toml", "--runs", "16"]);
    // The same on one thread.
    let alone = ["short.toml", "--space", "space.toml", "--runs", "16", "--jobs", "1"];
    assert_eq!(search(folder.path(), &alone).stdout, stays.stdout);
    assert_eq!(stays.status.code(), Some(3), "{}", words(&stays));
    assert!(words(&stays).contains("not judged"), "{}", words(&stays));
}

#[test]
fn nonsense_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("short.toml", SHORT);
    write(
        "faulty.toml",
        &(SHORT.to_owned()
            + "[[faults]]\nid = \"a\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
        amplitude = \"1 deg/h\"\ntrigger = { at = \"5 s\" }\nduration = \"1 samples\"\n"),
    );
    write(
        "space.toml",
        "schema = 1\n[[faults]]\nkind = \"spike\"\nchannels = \"gyro q\"\namplitude = \"1 deg/h\"\nonset = \"5 s\"\n",
    );
    let cases: [(&[&str], &str); 7] = [
        (&["faulty.toml"], "expected none: the search sets them"),
        (&["short.toml", "--kinds", "bias-stop"], "did you mean \"bias-step\"?"),
        (&["short.toml", "--kinds", "garbage", "--space", "space.toml"], "cannot be used with"),
        (&["short.toml", "--space", "space.toml"], "space.toml: faults[1]"),
        (&["short.toml", "--space", "absent.toml"], "absent.toml"),
        (&["short.toml", "--pairs", "1.5"], "expected a number from 0 to 1"),
        (&["short.toml", "--enough", "nan"], "expected a number above 0"),
    ];
    for (arguments, expected) in cases {
        let told = search(folder.path(), arguments);
        assert_eq!(told.status.code(), Some(2), "{arguments:?}: {}", words(&told));
        assert!(words(&told).contains(expected), "{arguments:?}: {}", words(&told));
    }
}
