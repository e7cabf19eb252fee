//! Options of the commands that make, run and look at single runs.

use super::Evidence::{Acts, Refused, Tested};
use super::Row;

const SYSTEM: &str = "found the system of FMUs ../fmus/octant.ssp, expected a scenario";
const SCENARIO: &str = "found the scenario ../short.toml, expected a system of FMUs";

#[rustfmt::skip]
pub(super) const ROWS: &[Row] = &[
    ("", "--parent", &[Acts("[--parent 999999] schema", "exit status 4")]),
    // octant new
    ("new", "--instrument", &[Tested("new_scenario::a_new_scenario_is_valid_and_needs_force_to_be_replaced")]),
    ("new", "--motion", &[Acts("new a.toml [--motion dockside]", "kind = \"dockside\"")]),
    ("new", "--positions", &[Acts("new a.toml [--positions six]", "positions = \"six\"")]),
    ("new", "--calibration", &[Acts("new a.toml [--calibration '3 h']", "duration = \"3 h\"")]),
    ("new", "--navigation", &[Acts("new a.toml [--navigation '30 h']", "duration = \"30 h\"")]),
    ("new", "--limit", &[Acts("new a.toml [--limit '2 nmi']", "\nlimit = \"2 nmi\"")]),
    ("new", "--title", &[Acts("new a.toml [--title Ada]", "title = \"Ada\"")]),
    ("new", "--defaults", &[Tested("new_scenario::defaults_take_the_place_of_questions_on_a_terminal")]),
    ("new", "--force", &[Acts("new ../old.toml [--force]", "next: octant run")]),
    // octant run
    ("run", "--set", &[Acts("run ../short.toml [--set title=Ada]", "Ada: none"), Tested("system_foreign::a_packed_system_is_run_and_what_is_none_is_refused")]),
    ("run", "--out", &[Acts("run ../short.toml [--out here]", "file here/summary.json"), Acts("run ../fmus/octant.ssp --stop 0.1s --in-process [--out here]", "file here/summary.json")]),
    ("run", "--force", &[Acts("run ../short.toml --out ../again [--force]", "short: none"), Acts("run ../fmus/octant.ssp --stop 0.1s --in-process --out ../again [--force]", "octant: none")]),
    ("run", "--seed", &[Acts("run ../short.toml --json [--seed 7]", "\"seed\": 7"), Acts("run ../fmus/octant.ssp --stop 0.1s --in-process --json [--seed 7]", "\"seed\": 7")]),
    ("run", "--fire", &[Acts("run ../faulty.toml [--fire hand=30s]", "fault hand (bias-step): fired once"), Tested("system_foreign::a_packed_system_is_run_and_what_is_none_is_refused")]),
    ("run", "--require", &[Acts("run ../short.toml [--require]", "exit status 3"), Acts("run ../fmus/octant.ssp --stop 0.1s --in-process [--require]", "exit status 3")]),
    ("run", "--json", &[Acts("run ../short.toml [--json]", "exit status 0\n{"), Acts("run ../fmus/octant.ssp --stop 0.1s --in-process [--json]", "exit status 0\n{")]),
    ("run", "--source", &[Acts("run ../short.toml [--source nonsense]", "source.uri"), Refused("run ../fmus/octant.ssp --source plant", SYSTEM)]),
    ("run", "--endpoint", &[Acts("run ../short.toml [--endpoint nonsense]", "found \"nonsense\""), Refused("run ../fmus/octant.ssp --endpoint in-process", SYSTEM)]),
    ("run", "--only-faults", &[Acts("run ../faulty.toml [--only-faults=]", "exit status 0"), Refused("run ../fmus/octant.ssp --only-faults=", SYSTEM)]),
    ("run", "--realtime", &[Tested("realtime::the_clock_changes_nothing_of_what_is_computed"), Refused("run ../fmus/octant.ssp --realtime", SYSTEM)]),
    ("run", "--stop-when-lost", &[Tested("realtime::a_run_whose_bench_is_lost_ends_there_where_it_is_told_to"), Refused("run ../fmus/octant.ssp --stop-when-lost", SYSTEM)]),
    ("run", "--no-twin", &[Acts("run ../faulty.toml --out a [--no-twin]", "\"counterfactual\": null"), Refused("run ../fmus/octant.ssp --no-twin", SYSTEM)]),
    ("run", "--live", &[Acts("run ../short.toml [--live=nonsense]", "serve at \"nonsense\""), Refused("run ../fmus/octant.ssp --live", SYSTEM)]),
    ("run", "--answers", &[Tested("operator::a_file_answers_a_simulated_run_and_changes_no_bit"), Refused("run ../short.toml --answers a.toml", "the scenario has no steps"), Refused("run ../fmus/octant.ssp --answers a.toml", SYSTEM)]),
    ("run", "--page", &[Tested("operator_ways::a_page_asks_and_takes_answers_with_the_token_of_the_run_alone"), Refused("run ../fmus/octant.ssp --page", SYSTEM)]),
    ("run", "--no-terminal", &[Tested("operator::answers_of_another_process_are_evidence_and_change_no_bit"), Refused("run ../fmus/octant.ssp --no-terminal", SYSTEM)]),
    ("run", "--units", &[Acts("run ../short.toml [--units deg]", "attitude at its end: error +0.0"), Refused("run ../fmus/octant.ssp --units deg", SYSTEM)]),
    ("run", "--faults", &[Tested("system_foreign::a_packed_system_is_run_and_what_is_none_is_refused"), Refused("run ../short.toml --faults a.toml", SCENARIO)]),
    ("run", "--requirements", &[Tested("system_foreign::a_system_has_requirements_on_its_signals"), Refused("run ../short.toml --requirements a.toml", SCENARIO)]),
    ("run", "--tune", &[Acts("run ../fmus/octant.ssp --stop 0.1s --in-process [--tune plant.x=1@1s]", "plant.x"), Refused("run ../short.toml --tune a.b=1@1s", SCENARIO)]),
    ("run", "--order", &[Tested("system_foreign::a_packed_system_is_run_and_what_is_none_is_refused"), Refused("run ../short.toml --order jacobi", SCENARIO)]),
    ("run", "--step", &[Tested("system_foreign::a_packed_system_is_run_and_what_is_none_is_refused"), Refused("run ../short.toml --step 1s", SCENARIO)]),
    ("run", "--start", &[Acts("run ../fmus/octant.ssp --stop 0.1s --in-process [--start early]", "--start: found \"early\""), Refused("run ../short.toml --start 1s", SCENARIO)]),
    ("run", "--stop", &[Tested("system_foreign::a_packed_system_is_run_and_what_is_none_is_refused"), Refused("run ../short.toml --stop 1s", SCENARIO)]),
    ("run", "--time-limit", &[Refused("run ../fmus/octant.ssp --stop 0.1s --time-limit 0", "--time-limit: found \"0\""), Refused("run ../short.toml --time-limit 2", SCENARIO)]),
    ("run", "--nan-limit", &[Tested("system_exact::an_output_that_is_no_number_is_said_once_with_its_first_time_and_a_limit_ends_the_run"), Refused("run ../short.toml --nan-limit 2", SCENARIO)]),
    ("run", "--every", &[Acts("run ../fmus/octant.ssp --stop 0.1s --in-process --json [--every 5]", "\"recorded_every\": 5"), Refused("run ../short.toml --every 2", SCENARIO)]),
    ("run", "--csv", &[Tested("system_foreign::a_signal_dictionary_carries_what_a_connection_carries"), Refused("run ../short.toml --csv", SCENARIO)]),
    ("run", "--in-process", &[Tested("system_foreign::model_exchange_and_co_simulation_run_together"), Refused("run ../short.toml --in-process", SCENARIO)]),
    ("run", "--allow-tool", &[Tested("system_foreign::an_fmu_that_needs_its_tool_is_run_on_request_alone"), Refused("run ../short.toml --allow-tool", SCENARIO)]),
    // octant answer, octant operator
    ("answer", "--by", &[Acts("answer ../done door yes [--by Ada]", "no operator is heard there")]),
    ("operator hold", "--by", &[Tested("operator::a_run_in_lock_step_is_held_resumed_and_aborted_and_one_by_the_clock_aborted_alone"), Acts("operator hold ../done [--by Ada]", "no operator is heard there")]),
    ("operator resume", "--by", &[Acts("operator resume ../done [--by Ada]", "no operator is heard there")]),
    ("operator abort", "--by", &[Acts("operator abort ../done [--by Ada]", "no operator is heard there")]),
    // octant compare
    ("compare", "--set", &[Acts("compare ../short.toml [--set title=Ada]", "both methods need a navigation")]),
    ("compare", "--against", &[Acts("compare ../short.toml [--against none.toml]", "failed to read none.toml")]),
    ("compare", "--seeds", &[Tested("own_sequences::every_table_of_a_run_says_the_names")]),
    ("compare", "--out", &[Acts("compare ../refused.toml --seeds 2 [--out here]", "file here/compare.html")]),
    ("compare", "--units", &[Acts("compare ../free.toml --against ../free.toml --seeds 2 [--units kn]", "velocity north, kn"), Refused("compare ../refused.toml --seeds 2 --json --units km", "found with --json")]),
    ("compare", "--json", &[Acts("compare ../refused.toml --seeds 2 [--json]", "exit status 3\n{")]),
    // octant diff
    ("diff", "--json", &[Acts("diff ../done ../broken [--json]", "exit status 1\n{")]),
    ("diff", "--out", &[Acts("diff ../done ../broken [--out a.html]", "file a.html")]),
    // octant replay
    ("replay", "--scenario", &[Acts("replay ../done/recording.mcap [--scenario ../short.toml]", "short: none")]),
    ("replay", "--set", &[Acts("replay ../done/recording.mcap --scenario ../short.toml [--set title=Ada]", "Ada: none"), Refused("replay ../done/recording.mcap --set title=Ada", "--scenario")]),
    ("replay", "--out", &[Acts("replay ../done/recording.mcap --scenario ../short.toml [--out here]", "file here/summary.json"), Refused("replay ../done/recording.mcap --out here", "--scenario")]),
    ("replay", "--json", &[Acts("replay ../done/recording.mcap [--json]", "exit status 0\n{"), Acts("replay ../done/recording.mcap --scenario ../short.toml [--json]", "exit status 0\n{")]),
    // octant smooth
    ("smooth", "--csv", &[Acts("smooth ../done [--csv a.csv]", "file a.csv")]),
    ("smooth", "--json", &[Acts("smooth ../done [--json]", "\n{")]),
    // octant score
    ("score", "--solution", &[Tested("score_solution::an_exported_run_has_the_scores_of_the_run"), Refused("score ../done --solution a.csv --reference b.csv", "cannot be used with")]),
    ("score", "--reference", &[Tested("score_solution::an_exported_run_has_the_scores_of_the_run"), Refused("score ../done --reference b.csv", "--solution")]),
    ("score", "--scenario", &[Tested("score_solution::less_than_the_duration_is_no_pass"), Refused("score ../done --scenario ../short.toml", "--solution")]),
    ("score", "--duration", &[Tested("score_solution::less_than_the_duration_is_no_pass"), Refused("score ../done --duration 1h", "--solution")]),
    ("score", "--skip", &[Tested("score_solution::an_exported_run_has_the_scores_of_the_run"), Refused("score ../done --skip 1h", "--solution")]),
    ("score", "--offset", &[Tested("score_solution::a_drift_is_scored_as_it_was_made"), Refused("score ../done --offset 1s", "--solution")]),
    ("score", "--true-heading", &[Tested("score_headings::headings_alone_are_scored_against_a_surveyed_one"), Refused("score ../done --true-heading 1deg", "--solution")]),
    ("score", "--talker", &[Tested("solution_doubts::a_talker_is_chosen_by_its_letters"), Refused("score ../done --talker IN", "--solution")]),
    ("score", "--offset-uncertainty", &[Tested("score_solution::a_drift_is_scored_as_it_was_made"), Refused("score ../done --offset-uncertainty 1s", "--solution")]),
    ("score", "--set", &[Tested("score_solution::messages_of_a_unit_are_a_solution"), Refused("score ../done --set title=Ada", "--solution")]),
    ("score", "--out", &[Tested("score_solution::an_exported_run_has_the_scores_of_the_run"), Refused("score ../done --out a", "--solution")]),
    ("score", "--force", &[Acts("score --solution ../csv/navigation.csv --reference ../csv/navigation.csv --offset 0s --out ../again [--force]", "nothing was required"), Refused("score ../done --force --out a", "--solution")]),
    ("score", "--require", &[Acts("score --solution ../csv/navigation.csv --reference ../csv/navigation.csv --offset 0s [--require]", "exit status 3"), Refused("score ../done --require", "--solution")]),
    ("score", "--units", &[Acts("score ../nav [--units m]", " m\n"), Acts("score --solution ../csv/navigation.csv --reference ../csv/navigation.csv --offset 0s [--units m]", " m,"), Refused("score ../done --json --units m", "found with --json")]),
    ("score", "--json", &[Acts("score ../done [--json]", "exit status 0\n{"), Acts("score --solution ../csv/navigation.csv --reference ../csv/navigation.csv --offset 0s [--json]", "exit status 0\n{")]),
    // octant export
    ("export", "--to", &[Acts("export ../done --out here [--to csv]", "file here/navigation.csv")]),
    ("export", "--tables", &[Acts("export ../done --to csv --out here [--tables samples]", "exit status 0\nhere/samples.csv\nhere/export.json\n"), Refused("export ../done --to kml --tables samples", "kml has no tables")]),
    ("export", "--every", &[Acts("export ../done --to csv --out here [--every 10s]", "\"every_s\": 10"), Acts("export ../done --to rosbag-mcap [--every never]", "--every: found \"never\"")]),
    ("export", "--out", &[Acts("export ../done --to csv [--out here]", "file here/navigation.csv")]),
    ("export", "--force", &[Tested("export::mistakes_are_told_and_nothing_is_overwritten")]),
    // octant observe
    ("observe", "--set", &[Acts("observe ../short.toml [--set site.latitude=nowhere]", "site.latitude"), Acts("observe ../short.toml --ensemble [--set site.latitude=nowhere]", "site.latitude"), Acts("observe ../short.toml --protection [--set site.latitude=nowhere]", "site.latitude")]),
    ("observe", "--ensemble", &[Acts("observe ../short.toml [--ensemble]", "as an ensemble")]),
    ("observe", "--against", &[Tested("ensemble_against::a_comparison_in_other_units_is_converted_and_concludes_the_same"), Refused("observe ../short.toml --against ../planned", "--ensemble")]),
    ("observe", "--protection", &[Acts("observe ../short.toml [--protection]", "largest shift by a jump")]),
    ("observe", "--units", &[Tested("solution::a_predicted_ensemble_obeys_the_units_and_its_json_keeps_its_own"), Refused("observe ../short.toml --units m --json", "--json"), Refused("observe ../short.toml --units m --protection", "--protection")]),
    ("observe", "--json", &[Acts("observe ../short.toml [--json]", "exit status 0\n["), Acts("observe ../short.toml --ensemble [--json]", "exit status 0\n["), Acts("observe ../short.toml --protection [--json]", "exit status 0\n{")]),
    // octant characterise
    ("characterise", "--scenario", &[Acts("characterise ../done/recording.mcap [--scenario none.toml]", "none.toml")]),
    ("characterise", "--set", &[Tested("characterise::a_temperature_in_a_text_and_in_an_instruments_bytes_is_told")]),
    ("characterise", "--imu", &[Acts("characterise ../done --no-twin [--imu a.toml]", "file a.toml")]),
    ("characterise", "--html", &[Acts("characterise ../done --no-twin [--html a.html]", "file a.html")]),
    ("characterise", "--seed", &[Acts("characterise ../done --json [--seed 7]", "\"seed\": 7"), Refused("characterise ../done --no-twin --seed 7", "--no-twin")]),
    ("characterise", "--no-twin", &[Acts("characterise ../done --json [--no-twin]", "\"twin\": null")]),
    ("characterise", "--force", &[Tested("characterise::a_temperature_in_a_text_and_in_an_instruments_bytes_is_told"), Refused("characterise ../done --force", "--imu")]),
    ("characterise", "--json", &[Acts("characterise ../done --no-twin [--json]", "exit status 0\n{")]),
    // octant report
    ("report", "--out", &[Acts("report ../done [--out a.html]", "file a.html")]),
    ("report", "--dispositions", &[Acts("report ../broken [--dispositions a.toml]", "file a.toml")]),
    ("report", "--units", &[Acts("report ../nav [--units km]", "atitude error, km")]),
    // octant verify
    ("verify", "--key", &[Tested("campaign_report::two_persons::two_keys_sign_and_one_key_never_does_for_two")]),
    ("verify", "--second-key", &[Tested("campaign_report::two_persons::two_keys_sign_and_one_key_never_does_for_two")]),
    ("verify", "--expect", &[Acts("verify ../done [--expect seed=7]", "another seed: found 1, expected 7")]),
    ("verify", "--reexecute", &[Acts("verify ../done [--reexecute]", "re-executed: the stream hash and every measure are the same"), Tested("chain::a_run_and_a_campaign_are_run_again_from_their_folders_alone"), Refused("verify ../done --reexecute 3", "the folder of a run, expected a campaign")]),
    ("verify", "--sample-seed", &[Tested("chain::a_run_and_a_campaign_are_run_again_from_their_folders_alone"), Refused("verify ../done --reexecute --sample-seed 7", "the folder of a run, expected a campaign")]),
    ("verify", "--attest", &[Acts("verify ../done [--attest a.json]", "file a.json")]),
    ("verify", "--json", &[Acts("verify ../done [--json]", "exit status 0\n{")]),
    // octant rejudge
    ("rejudge", "--out", &[Acts("rejudge ../done [--out a.json]", "file a.json")]),
    ("rejudge", "--json", &[Acts("rejudge ../done --out a.json [--json]", "exit status 0\n{")]),
    // octant watch
    ("watch", "--plain", &[Tested("watch::a_run_that_was_killed_is_told_from_one_that_goes_on")]),
    ("watch", "--once", &[Acts("watch ../done [--once]", "health"), Refused("watch ../done --once --plain", "cannot be used with")]),
    ("watch", "--foxglove", &[Acts("watch ../done [--foxglove=nonsense]", "serve at \"nonsense\"")]),
];
