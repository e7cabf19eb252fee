//! `octant faults`: the kinds of faults, and their effects.

use super::fault_page::{acts, lasts};
use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::terminal::{print, print_json, write};
use clap::{Args, Subcommand};
use octant_base::names::suggestion;
use octant_faults::catalogue::{Family, FaultKind, FaultParameter, Lasts};
use octant_faults::connection::kinds as connection;
use octant_faults::kinds;
use octant_scenario::fault_example;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the kinds of faults.
    List {
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Describe a kind of fault: its effect on samples, its parameters, and an example entry.
    Describe {
        /// Name of the kind.
        #[arg(value_name = "KIND")]
        kind: String,
        /// Print it as a page of Markdown.
        #[arg(long)]
        markdown: bool,
        /// Also simulate the example, and draw its effect into this file.
        #[arg(long, value_name = "FILE.svg")]
        picture: Option<PathBuf>,
    },
    /// Run a grid over the parameters of one fault, and map where it is harmful but undetected.
    Sweep(super::sweep::Arguments),
    /// Search for the fault that does most harm unnoticed, and make it small.
    Search(super::search::Arguments),
    /// Find the smallest set of a run's faults with which it still fails.
    Minimise(super::minimise::Arguments),
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { command } = arguments;
    match command {
        Command::List { json: true } => {
            let on_connections = connection::KINDS.iter().map(|kind| Row::of_connection(kind));
            print_json(&List { kinds: kinds::all().map(Row::of).chain(on_connections).collect() })?
        }
        Command::List { json: false } => print(&list())?,
        Command::Describe { kind: name, markdown, picture } => {
            if let Some(kind) = connection::named(name) {
                given.refuse_ids(
                    &["markdown", "picture"],
                    format!(
                        "found {name}, a fault on connections, which has neither a page of its own nor a picture: \
                         see docs/co-simulation.md"
                    ),
                )?;
                print(&describe(&Page::of_connection(kind)))?;
                return Ok(Verdict::Pass);
            }
            let Some(kind) = kinds::named(name) else {
                let names = kinds::all().map(|kind| kind.name);
                let names: Vec<&str> =
                    names.chain(connection::KINDS.iter().map(|kind| kind.name)).collect();
                let known = suggestion(name, names.into_iter(), "kinds");
                return Err(Failure::input(format!("unknown kind of fault {name:?}, {known}")));
            };
            if let Some(file) = picture {
                write(file, super::fault_page::picture(kind)?)?;
            }
            print(&if *markdown {
                super::fault_page::markdown(kind)
            } else {
                describe(&Page::of(kind))
            })?;
        }
        Command::Sweep(arguments) => return super::sweep::command(arguments),
        Command::Search(arguments) => return super::search::command(arguments, given),
        Command::Minimise(arguments) => return super::minimise::command(arguments),
    }
    Ok(Verdict::Pass)
}

#[derive(Serialize)]
struct List {
    kinds: Vec<Row>,
}

/// Kind as JSON.
#[derive(Serialize)]
struct Row {
    name: &'static str,
    family: &'static str,
    acts: &'static str,
    lasts: &'static str,
    summary: &'static str,
    parameters: Vec<ParameterRow>,
}

#[derive(Serialize)]
struct ParameterRow {
    name: &'static str,
    takes: String,
    default: Option<&'static str>,
    doc: &'static str,
}

impl Row {
    fn of(kind: &'static FaultKind) -> Self {
        Self::new(&Page::of(kind))
    }

    fn of_connection(kind: &'static connection::ConnectionFaultKind) -> Self {
        Self::new(&Page::of_connection(kind))
    }

    fn new(page: &Page) -> Self {
        let takes = octant_scenario::fault_parameters(page.name);
        let parameter = |parameter: &'static FaultParameter| ParameterRow {
            name: parameter.name,
            takes: takes
                .iter()
                .find(|(name, _)| *name == parameter.name)
                .map_or_else(String::new, |(_, takes)| takes.clone()),
            default: parameter.default,
            doc: parameter.doc,
        };
        Self {
            name: page.name,
            family: page.family,
            acts: page.acts,
            lasts: match page.lasts {
                Lasts::Span => "span",
                Lasts::Fading => "fading",
                Lasts::Instant => "instant",
            },
            summary: page.summary,
            parameters: page.parameters.iter().map(parameter).collect(),
        }
    }
}

/// Description of a kind of fault, on samples or on connections.
struct Page {
    name: &'static str,
    family: &'static str,
    acts: &'static str,
    lasts: Lasts,
    summary: &'static str,
    model: &'static str,
    parameters: &'static [FaultParameter],
    /// Place of its entry.
    written_in: &'static str,
}

/// Family of the faults on connections.
const CONNECTION: &str = "connection of FMUs";

impl Page {
    fn of(kind: &'static FaultKind) -> Self {
        Self {
            name: kind.name,
            family: kind.family.name(),
            acts: acts(kind.acts),
            lasts: kind.lasts,
            summary: kind.summary,
            model: kind.model,
            parameters: kind.parameters,
            written_in: "In a scenario",
        }
    }

    fn of_connection(kind: &'static connection::ConnectionFaultKind) -> Self {
        Self {
            name: kind.name,
            family: CONNECTION,
            acts: "on a value on its way from one FMU to another",
            lasts: kind.lasts,
            summary: kind.summary,
            model: kind.model,
            parameters: kind.parameters,
            written_in: "In the file of --faults, for a system of FMUs",
        }
    }
}

fn list() -> String {
    let width = kinds::all().map(|kind| kind.name.len()).max().unwrap_or_default();
    let line = |name: &str, summary: &str| format!("  {name:width$}  {summary}\n");
    let mut out = String::new();
    for family in Family::ALL {
        let of: Vec<_> = kinds::all().filter(|kind| kind.family == family).collect();
        if of.is_empty() {
            continue;
        }
        if !out.is_empty() {
            out.push('\n');
        }
        out += &format!("{}\n", family.name());
        for kind in of {
            out += &line(kind.name, kind.summary);
        }
    }
    out += &format!("\n{CONNECTION}\n");
    for kind in connection::KINDS {
        out += &line(kind.name, kind.summary);
    }
    out
}

/// Renders a description.
fn describe(page: &Page) -> String {
    let mut out = format!("{} ({})\n", page.name, page.family);
    out += &format!("{}\n\n", wrapped(page.summary, ""));
    for paragraph in page.model.split('\n') {
        // Equations are on indented lines, which are kept unchanged.
        let indented = paragraph.starts_with(' ');
        out += &if indented { paragraph.to_owned() } else { wrapped(paragraph, "") };
        out.push('\n');
    }
    out += &format!("\n{}\n", wrapped(&format!("Acts {}.", page.acts), ""));
    out += &format!("{}\n\nParameters\n", wrapped(&format!("Lasts {}.", lasts(page.lasts)), ""));
    if page.parameters.is_empty() {
        out += "  none\n";
    }
    let takes = octant_scenario::fault_parameters(page.name);
    for parameter in page.parameters {
        out += &format!("  {}\n", parameter.name);
        out += &format!("{}\n", wrapped(parameter.doc, "      "));
        if let Some((_, takes)) = takes.iter().find(|(name, _)| *name == parameter.name) {
            out += &format!("{}\n", wrapped(&format!("Takes {takes}."), "      "));
        }
        match parameter.default {
            Some(default) => out += &format!("      Default {default}.\n"),
            None => out += "      Always given.\n",
        }
    }
    let example = fault_example(page.name).unwrap_or_default();
    out += &format!("\n{}\n\n{}", page.written_in, indent(&example));
    out
}

fn indent(text: &str) -> String {
    text.lines().map(|line| format!("    {line}\n")).collect()
}

/// Breaks a paragraph into lines.
fn wrapped(text: &str, indent: &str) -> String {
    const WIDTH: usize = 92;
    let mut out = String::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty()
            && indent.len() + line.chars().count() + 1 + word.chars().count() > WIDTH
        {
            out += &format!("{indent}{line}\n");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    if !line.is_empty() {
        out += &format!("{indent}{line}");
    }
    out
}
