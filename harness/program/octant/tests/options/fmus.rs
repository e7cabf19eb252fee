//! Options of `octant fmu`.

use super::Evidence::{Acts, Read, Refused, Tested};
use super::Row;

const CONFLICT: &str = "cannot be used with";

#[rustfmt::skip]
pub(super) const ROWS: &[Row] = &[
    ("fmu build", "--out", &[Tested("fmu_build::the_command_builds_without_references_and_lists_its_files")]),
    ("fmu build", "--scenario", &[Read("fmu build --out a --scenario none.toml", "none.toml")]),
    ("fmu build", "--set", &[Refused("fmu build --out a --scenario ../short.toml --set site.latitude=nowhere", "site.latitude"), Refused("fmu build --out a --set title=Ada", "--scenario")]),
    ("fmu build", "--target", &[Read("fmu build --out a --target nowhere", "nowhere")]),
    ("fmu build", "--library", &[Read("fmu build --out a --library ../short.toml", "can't go into an FMU")]),
    ("fmu build", "--without-reference", &[Tested("fmu_build::the_command_builds_without_references_and_lists_its_files")]),
    ("fmu build", "--json", &[Tested("fmu_build::the_command_builds_without_references_and_lists_its_files")]),
    ("fmu check", "--json", &[Acts("fmu check ../fmus/calibrator_fmi3.fmu --no-load [--json]", "exit status 0\n{")]),
    ("fmu check", "--load", &[Tested("fmu_check::nothing_of_a_hostile_fmu_is_run")]),
    ("fmu check", "--no-load", &[Tested("fmu_check::nothing_of_a_hostile_fmu_is_run")]),
    ("fmu check", "--step", &[Tested("fmu_check::what_needs_its_tool_is_loaded_on_request_alone"), Refused("fmu check a.fmu --no-load --step", CONFLICT)]),
    ("fmu check", "--allow-tool", &[Tested("fmu_check::what_needs_its_tool_is_loaded_on_request_alone"), Refused("fmu check a.fmu --no-load --allow-tool", CONFLICT)]),
    ("fmu check", "--time-limit", &[Tested("fmu_check::the_program_says_what_it_found_and_with_which_status"), Refused("fmu check a.fmu --no-load --time-limit 5", CONFLICT)]),
    ("fmu run", "--source", &[Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared [--source ../short.toml]", "700 samples"), Refused("fmu run a.fmu --source s.toml --interface se", "found with --interface scheduled-execution")]),
    ("fmu run", "--input", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Refused("fmu run a.fmu --source s.toml --input a.csv", "found with --source")]),
    ("fmu run", "--start", &[Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared --stop 1 [--start early]", "--start: found \"early\""), Refused("fmu run a.fmu --source s.toml --start 1", "found with --source")]),
    ("fmu run", "--stop", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Refused("fmu run a.fmu --source s.toml --stop 1", "found with --source")]),
    ("fmu run", "--step", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Refused("fmu run a.fmu --source s.toml --step 1", "found with --source"), Refused("fmu run a.fmu --interface se --step 1", "found with --interface scheduled-execution")]),
    ("fmu run", "--tolerance", &[Tested("fmu_source::a_foreign_ship_in_model_exchange_moves_the_plant"), Refused("fmu run a.fmu --source s.toml --tolerance 1", "found with --source")]),
    ("fmu run", "--output", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Refused("fmu run a.fmu --source s.toml --out a.mcap --output y", "found with --source"), Refused("fmu run a.fmu --output y", "--out")]),
    ("fmu run", "--set", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Refused("fmu run a.fmu --source ../short.toml --set nonsense", "--set nonsense")]),
    ("fmu run", "--interface", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared --source ../short.toml [--interface me]", "exit status 2")]),
    ("fmu run", "--process", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Tested("fmu_source::our_calibrator_gives_the_same_bits_in_both_standards_and_both_processes")]),
    ("fmu run", "--allow-tool", &[Tested("fmu_check::what_needs_its_tool_is_loaded_on_request_alone")]),
    ("fmu run", "--time-limit", &[Tested("fmu_source::the_time_limit_holds_while_the_fmu_is_loaded_and_made"), Refused("fmu run a.fmu --process shared --time-limit 5", "found with --process shared"), Refused("fmu run a.fmu --source s.toml --process shared --time-limit 5", "found with --process shared")]),
    ("fmu run", "--out", &[Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared --source ../short.toml [--out a.mcap]", "file a.mcap"), Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file")]),
    ("fmu run", "--force", &[Tested("fmu_source::any_fmu_is_stepped_with_inputs_from_a_file"), Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared --source ../short.toml --out ../old.mcap [--force]", "700 samples")]),
    ("fmu run", "--json", &[Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared --stop 0.1 [--json]", "\n{"), Acts("fmu run ../fmus/calibrator_fmi3.fmu --process shared --source ../short.toml [--json]", "exit status 0\n{")]),
    ("fmu host", "--name", &[Refused("fmu host --unguarded --name x", CONFLICT)]),
    ("fmu host", "--unguarded", &[Tested("fmu_process::the_host_is_not_for_people")]),
];
