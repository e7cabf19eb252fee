//! Job files of campaigns: what their schedulers are asked for, and what a task runs.

use crate::campaign_report::bench::Bench;
use crate::common::program::program;
use octant_test_processes::command;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Output;

const SCENARIO: &str = "schema = 1
title = \"short\"
[procedure.calibration]
duration = \"10 min\"
[procedure.navigation]
duration = \"10 min\"
";
const CAMPAIGN: &str = "schema = 1
title = \"two words\"
replicates = 3
[[scenarios]]
id = \"short\"
file = \"short.toml\"
";

/// A planned campaign in a folder of this name.
fn planned(folder: &str) -> Bench {
    let bench = Bench::new(CAMPAIGN);
    std::fs::write(bench.at("short.toml"), SCENARIO).unwrap();
    let planned = program(&["campaign", "plan", "campaign.toml", "--out", folder])
        .current_dir(bench.at(""))
        .output()
        .unwrap();
    assert!(planned.status.success(), "{planned:?}");
    bench
}

fn emitted(bench: &Bench, arguments: &[&str]) -> Output {
    let all = [&["campaign", "emit"], arguments].concat();
    program(&all).current_dir(bench.at("")).output().unwrap()
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A scheduler that writes down what it is asked for, and numbers the jobs from 1.
const SBATCH: &str = "#!/bin/sh
printf '%s|' \"$OCTANT_FIRST\" \"$@\" >>calls
echo >>calls
wc -l <calls
";

fn sh(bench: &Bench, variables: &[(&str, &str)]) -> String {
    let path = format!("{}:{}", bench.at("").display(), std::env::var("PATH").unwrap());
    let mut shell = command("sh");
    shell.arg("job.sh").current_dir(bench.at("")).env("PATH", path);
    shell.env_remove("OCTANT_FIRST").env_remove("SLURM_ARRAY_TASK_ID");
    text(&shell.envs(variables.iter().copied()).output().unwrap())
}

fn executable(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap();
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn the_script_for_slurm_submits_itself_in_arrays_and_the_merge() {
    let bench = planned("it's here");
    let script = text(&emitted(&bench, &["slurm", "it's here", "--shards", "8", "--array", "3"]));
    assert!(script.contains("# 3 cases of two words in 8 parts"), "{script}");
    std::fs::write(bench.at("job.sh"), script).unwrap();
    executable(&bench.at("sbatch"), SBATCH);
    let said = sh(&bench, &[]);
    assert_eq!(
        said.split_whitespace().collect::<Vec<_>>().join(" "),
        "submitted: 1 2 3, then the merge, 4"
    );
    let calls = std::fs::read_to_string(bench.at("calls")).unwrap();
    let arrays: Vec<&str> = calls.lines().take(3).collect();
    for (line, (first, tasks)) in arrays.iter().zip([("0", 3), ("3", 3), ("6", 2)]) {
        let expected = format!(
            "{first}|--parsable|--export=ALL|--array=1-{tasks}|--output=it's here/logs/%A_%a.txt|job.sh|"
        );
        assert_eq!(*line, expected);
    }
    let merge = calls.lines().nth(3).unwrap();
    assert!(merge.contains("|--dependency=afterany:1:2:3|"), "{merge}");
    assert!(bench.at("it's here/logs").is_dir());
    // The commands of a task and of the merge, with a program that prints its arguments.
    executable(&bench.at("told"), "#!/bin/sh\nprintf '<%s>' \"$@\"\n");
    let told = bench.at("told").display().to_string();
    let task = [("OCTANT", told.as_str()), ("OCTANT_FIRST", "3"), ("SLURM_ARRAY_TASK_ID", "2")];
    assert_eq!(sh(&bench, &task), "<campaign><run><it's here><--shard><5/8><--jobs><1>");
    assert_eq!(
        sh(&bench, &[task[0], task[2]]),
        "<campaign><run><it's here><--shard><2/8><--jobs><1>"
    );
    let wrapped = merge.split('|').skip_while(|word| *word != "--wrap").nth(1).unwrap();
    let mut shell = command("sh");
    let merged = shell.args(["-c", wrapped]).env("OCTANT", &told).output().unwrap();
    assert_eq!(text(&merged), "<campaign><merge><it's here>");
}

#[test]
fn a_campaign_that_fits_is_one_array() {
    let bench = planned("out");
    let script = text(&emitted(&bench, &["slurm", "out", "--shards", "8", "--jobs", "2"]));
    assert!(script.contains("#SBATCH --array=1-8\n"), "{script}");
    assert!(script.contains("#SBATCH --cpus-per-task=2\n"), "{script}");
}

#[test]
fn a_snakefile_names_the_tables_of_every_part() {
    let bench = planned("a \"b\"");
    let file = text(&emitted(&bench, &["snakemake", "a \"b\"", "--shards", "8"]));
    for expected in [
        "CAMPAIGN = \"a \\\"b\\\"\"",
        "CAMPAIGN + \"/parts/{part}-of-8.cases.parquet\"",
        "for part in range(1, 8 + 1)",
        "CAMPAIGN + \"/plan.json\"",
        "--shard {wildcards.part}/8 --jobs {threads}",
        "# 3 cases of two words in 8 parts.",
    ] {
        assert!(file.contains(expected), "{expected}: {file}");
    }
}

#[test]
fn folders_that_a_scheduler_does_not_find_are_refused() {
    let bench = planned("a{b}");
    let said = refused(&emitted(&bench, &["snakemake", "a{b}", "--shards", "2"]));
    assert!(said.contains("a{b}") && said.contains("without braces"), "{said}");
    let said = refused(&emitted(&bench, &["k8s", "a{b}", "--shards", "2"]));
    assert!(said.contains("a{b}") && said.contains("an absolute path"), "{said}");
    let absolute = bench.at("a{b}").display().to_string();
    let job = text(&emitted(&bench, &["k8s", &absolute, "--shards", "2"]));
    assert!(job.contains("completions: 2\n") && job.contains(&absolute), "{job}");
}

#[test]
fn a_job_of_kubernetes_tells_a_lost_pod_from_a_verdict() {
    let bench = planned("out");
    let folder = bench.at("out").display().to_string();
    let job = text(&emitted(&bench, &["k8s", &folder, "--shards", "8", "--claim", "data-1.site"]));
    for expected in [
        "claimName: \"data-1.site\"\n",
        "\"--any-verdict\"]\n",
        "backoffLimitPerIndex: 5\n",
        "- action: Ignore\n        onPodConditions:\n          - type: DisruptionTarget\n",
        "values: [2]\n",
    ] {
        assert!(job.contains(expected), "{expected}: {job}");
    }
    for name in ["Data", "data-", "a..b", "a b", ""] {
        let said = refused(&emitted(&bench, &["k8s", &folder, "--shards", "8", "--claim", name]));
        assert!(said.contains(&format!("the name {name:?}: expected lower-case")), "{said}");
    }
}
