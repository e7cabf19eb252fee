//! Options of campaigns, nights, requirements and the self-test.

use super::Evidence::{Acts, Refused, Tested};
use super::Row;

const FOLDER: &str = "expected a campaign on object storage";

#[rustfmt::skip]
pub(super) const ROWS: &[Row] = &[
    // octant campaign
    ("campaign plan", "--out", &[Acts("campaign plan ../campaign.toml [--out here]", "file here/plan.json")]),
    ("campaign plan", "--extend", &[Acts("campaign plan ../longer.toml --out ../grown [--extend]", "1 of them new")]),
    ("campaign run", "--shard", &[Acts("campaign run ../planned [--shard 1/2]", "1 with a result already")]),
    ("campaign run", "--jobs", &[Tested("campaign_alike::the_command_gives_the_same_bytes_both_ways")]),
    ("campaign run", "--again", &[Acts("campaign run ../bad [--again]", "2 cases run, 0 with a result already")]),
    ("campaign run", "--only", &[Tested("campaign_selection::a_selection_is_inconclusive_about_the_rest_and_the_rest_completes_it")]),
    ("campaign run", "--failed", &[Tested("campaign_selection::failed_and_missing_cases_run_again_and_count_once")]),
    ("campaign run", "--undivided", &[Tested("campaign_alike::the_command_gives_the_same_bytes_both_ways")]),
    ("campaign run", "--any-verdict", &[Acts("campaign run ../planned [--any-verdict]", "exit status 0")]),
    ("campaign run", "--work", &[Acts("campaign run file://$BENCH/stored [--work w]", "file w/plan.json"), Refused("campaign run ../planned --work w", FOLDER)]),
    ("campaign run", "--upload-every", &[Refused("campaign run file://$BENCH/stored --upload-every 0", "expected a number of seconds from 0.1 to 3600"), Refused("campaign run ../planned --upload-every 1", FOLDER)]),
    ("campaign status", "--json", &[Acts("campaign status ../planned [--json]", "exit status 3\n{")]),
    ("campaign trace", "--strictdoc", &[Tested("campaign::requirements_of_a_file_are_checked_in_every_case")]),
    ("campaign trace", "--json", &[Acts("campaign trace ../planned [--json]", "\n{")]),
    ("campaign report", "--out", &[Acts("campaign report ../planned [--out a.html]", "file a.html")]),
    ("campaign report", "--units", &[Tested("campaign_report::units::a_page_in_other_units_equals_the_conversion_by_hand_and_the_files_keep_theirs")]),
    ("campaign case", "--out", &[Tested("equipment::cases_of_a_campaign_have_no_day")]),
    ("campaign bundle", "--out", &[Acts("campaign bundle ../planned [--out a.zip]", "file a.zip")]),
    ("campaign emit", "--shards", &[Acts("campaign emit snakemake ../planned [--shards 3]", "3")]),
    ("campaign emit", "--jobs", &[Acts("campaign emit slurm ../planned --shards 3 [--jobs 7]", "--cpus-per-task=7")]),
    ("campaign emit", "--array", &[Acts("campaign emit slurm ../planned --shards 3 [--array 2]", "#SBATCH --array=1-2"), Refused("campaign emit snakemake ../planned --shards 3 --array 2", "found with snakemake, expected slurm"), Refused("campaign emit k8s /data --shards 3 --array 2", "found with k8s, expected slurm")]),
    ("campaign emit", "--image", &[Acts("campaign emit k8s $BENCH/planned --shards 3 [--image mine:1]", "mine:1"), Refused("campaign emit slurm ../planned --shards 3 --image mine:1", "found with slurm, expected k8s"), Refused("campaign emit snakemake ../planned --shards 3 --image mine:1", "found with snakemake, expected k8s")]),
    ("campaign emit", "--claim", &[Acts("campaign emit k8s $BENCH/planned --shards 3 [--claim mine]", "mine"), Refused("campaign emit slurm ../planned --shards 3 --claim mine", "found with slurm, expected k8s"), Refused("campaign emit k8s s3://b/x --shards 3 --claim mine", "expected a folder on a volume")]),
    ("campaign emit", "--secret", &[Refused("campaign emit slurm ../planned --shards 3 --secret mine", "found with slurm, expected k8s"), Refused("campaign emit k8s /data --shards 3 --secret mine", "expected an address on object storage")]),
    // octant nightly
    ("nightly", "--suite", &[Tested("nightly::what_got_worse_is_found_and_what_is_the_same_is_the_same"), Refused("nightly accept --history h --suite s.toml", "unexpected argument")]),
    ("nightly", "--history", &[Acts("nightly ../campaign.toml [--history h]", "file h/trend.html")]),
    ("nightly", "--first", &[Tested("nightly::a_history_is_started_by_name_and_once")]),
    ("nightly", "--accept", &[Acts("nightly ../campaign.toml --history h [--accept]", "this night is the baseline now")]),
    ("nightly", "--out", &[Acts("nightly ../campaign.toml --history h [--out o]", "file o/nightly.md")]),
    ("nightly", "--jobs", &[Tested("nightly::a_night_that_is_interrupted_goes_on_and_finds_nothing")]),
    ("nightly", "--alpha", &[Acts("nightly ../campaign.toml --history ../nights --json [--alpha 0.25]", "\"alpha\": 0.25"), Refused("nightly ../campaign.toml --history h --first --alpha 0.25", "--first")]),
    ("nightly", "--least", &[Acts("nightly ../campaign.toml --history ../nights --json [--least 0.25]", "\"least\": 0.25"), Refused("nightly ../campaign.toml --history h --first --least 0.25", "--first")]),
    ("nightly", "--units", &[Tested("nightly::the_trend_has_the_units_that_are_chosen_or_those_of_the_scenario")]),
    ("nightly", "--json", &[Acts("nightly ../campaign.toml --history h [--json]", "exit status 3\n{")]),
    ("nightly accept", "--history", &[Acts("nightly accept [--history ../nights]", "is the baseline")]),
    ("nightly accept", "--units", &[Tested("nightly::the_trend_has_the_units_that_are_chosen_or_those_of_the_scenario")]),
    // octant selftest
    ("selftest", "--out", &[Tested("selftest::every_case_comes_as_it_has_to")]),
    ("selftest", "--for", &[Tested("selftest::every_case_comes_as_it_has_to")]),
    ("selftest", "--answers", &[Tested("selftest::a_part_is_run_to_its_first_failure_alone")]),
    ("selftest", "--jobs", &[Tested("selftest::every_case_comes_as_it_has_to")]),
    ("selftest", "--fail-fast", &[Tested("selftest::a_part_is_run_to_its_first_failure_alone")]),
    ("selftest", "--json", &[Tested("selftest::every_case_comes_as_it_has_to")]),
    // octant requirements
    ("requirements check", "--mapping", &[Acts("requirements check ../needs.toml [--mapping none.toml]", "none.toml")]),
    ("requirements convert", "--mapping", &[Tested("requirements_convert::a_file_of_doors_is_converted_with_a_mapping_and_what_is_missing_is_told")]),
    ("requirements convert", "--force", &[Acts("requirements convert ../needs.toml ../old.sdoc [--force]", "exit status 0")]),
    ("requirements measures", "--json", &[Acts("requirements measures [--json]", "exit status 0\n{")]),
];
