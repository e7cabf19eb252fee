//! Integration tests of the harness: one program, with a module for each subject.
// `pub` in a test program is visible nowhere else, and `pub(crate)` everywhere adds nothing.
#![allow(unreachable_pub)]
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::float_cmp)]

mod common;

mod accounts;
mod allan;
mod architecture;
mod campaign;
mod campaign_alike;
mod campaign_bundle;
#[cfg(unix)]
mod campaign_emit;
mod campaign_looks;
mod campaign_objects;
mod campaign_report;
mod campaign_scale;
mod campaign_selection;
mod campaign_twins;
#[cfg(unix)]
mod capture;
mod case_at_rest;
mod case_progress;
mod chain;
mod characterise;
mod child_processes;
mod compare_refused;
mod completions;
mod crate_targets;
#[cfg(feature = "dashboard")]
mod dashboard_small;
mod described_source;
mod design;
mod diff;
mod document_links;
mod ensemble_against;
mod equipment;
mod export;
mod extending;
mod faults_host;
mod faults_run;
mod faults_search;
mod faults_tools;
mod fmu_build;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod fmu_check;
mod fmu_once;
#[cfg(target_os = "linux")]
mod fmu_process;
mod fmu_run;
#[cfg(target_os = "linux")]
mod fmu_scheduled;
mod fmu_source;
mod fmu_timed;
mod formats;
mod further_states;
mod fuzz_corpus;
#[cfg(target_os = "linux")]
mod generated;
mod gimbal_angles;
mod hostile;
mod innovations;
mod known_limitations;
#[cfg(unix)]
mod least_squares_end;
mod line_solution;
mod live;
mod log_source;
mod measures;
mod messages;
mod new_scenario;
mod nightly;
mod observe_protection;
#[cfg(target_os = "linux")]
mod operator;
#[cfg(target_os = "linux")]
mod operator_ways;
#[cfg(all(unix, feature = "full"))]
mod options;
#[cfg(target_os = "linux")]
mod out_of_memory;
#[cfg(unix)]
mod outside_text;
mod own_sequences;
mod page_figures;
#[cfg(unix)]
mod ports;
mod power;
mod progress_bar;
mod qualification;
mod rare;
mod real_chain;
mod realtime;
mod recorded_topics;
#[cfg(unix)]
mod recording_killed;
mod reference_columns;
mod rejudge;
mod requirements_convert;
mod rotation_reference;
mod score_headings;
mod score_solution;
mod selftest;
#[cfg(unix)]
mod shared_table;
mod smooth;
mod solution;
mod solution_doubts;
mod source_uri;
#[cfg(feature = "object-storage")]
mod storage_lies;
mod system_exact;
mod system_foreign;
mod terminal;
mod text_gaps;
mod trace_verdicts;
#[cfg(unix)]
mod turntable;
#[cfg(unix)]
mod turntable_panic;
mod verdict_edges;
mod watch;
mod workflows;
