//! Loads scenarios: parses a file, applies arguments, checks, adds defaults, reads.

use super::arguments::{fire, override_set};
use super::complete::complete;
use super::error::{FileProblems, Place, Problem};
use super::files::{FilePlaces, put_places};
use super::model::Scenario;
use super::{derive, keys, other_format, read};
use octant_toml_tree::Table;
use std::path::Path;

impl Scenario {
    /// Reads and checks a scenario file, with `--set` arguments `KEY=VALUE` applied.
    ///
    /// # Errors
    /// If the file can't be read, isn't TOML, or is not a scenario: every problem with its place.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, FileProblems> {
        Self::load_fired(path, overrides, &[])
    }

    /// Loads as [`Scenario::load_fired`] does, with files read from other places than those that the
    /// scenario names.
    ///
    /// # Errors
    /// As [`Scenario::load_fired`].
    pub fn load_placed(
        path: &Path,
        overrides: &[String],
        fires: &[String],
        places: &FilePlaces,
    ) -> Result<Self, FileProblems> {
        let file = path.display().to_string();
        let text = FileProblems::text_of(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        parse(&text, &file, folder, [overrides, fires], places)
    }

    /// Loads as [`Scenario::load`] does, with `--fire` arguments `ID=TIME` applied: times at which
    /// faults with a manual trigger begin.
    ///
    /// # Errors
    /// As [`Scenario::load`], and if an argument names no fault with a manual trigger.
    pub fn load_fired(
        path: &Path,
        overrides: &[String],
        fires: &[String],
    ) -> Result<Self, FileProblems> {
        Self::load_placed(path, overrides, fires, &FilePlaces::default())
    }

    /// Checks a scenario's text. `file` names it in errors, `folder` is where relative file names
    /// start.
    ///
    /// # Errors
    /// If it isn't TOML or not a scenario: every problem with its place.
    pub fn parse(
        text: &str,
        file: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, FileProblems> {
        Self::parse_fired(text, file, folder, overrides, &[])
    }

    /// Returns those of `keys`, dotted paths, that neither a scenario's file nor `--set` arguments give. A command that
    /// uses a part of a scenario can add what the rest needs.
    ///
    /// # Errors
    /// If the file can't be read or isn't TOML, or an argument can't be applied.
    pub fn absent<'a>(
        path: &Path,
        overrides: &[String],
        keys: &[&'a str],
    ) -> Result<Vec<&'a str>, FileProblems> {
        let file = path.display().to_string();
        let text = FileProblems::text_of(path)?;
        other_format::refuse(&text, &file, "a scenario")?;
        let with_file = |problems| FileProblems { file: file.clone(), problems };
        let mut document = octant_toml_tree::parse(&text).map_err(with_file)?;
        let problems = override_all(&mut document, overrides);
        if !problems.is_empty() {
            return Err(with_file(problems));
        }
        Ok(keys.iter().copied().filter(|key| document.at(key).is_none()).collect())
    }

    /// Checks a text as [`Scenario::parse`] does, with `--fire` arguments applied as
    /// [`Scenario::load_fired`] does.
    ///
    /// # Errors
    /// As both.
    pub fn parse_fired(
        text: &str,
        file: &str,
        folder: &Path,
        overrides: &[String],
        fires: &[String],
    ) -> Result<Self, FileProblems> {
        parse(text, file, folder, [overrides, fires], &FilePlaces::default())
    }
}

/// Applies `--set` arguments; returns the problems of those that can't be.
fn override_all(document: &mut Table, overrides: &[String]) -> Vec<Problem> {
    overrides.iter().filter_map(|argument| override_set(document, argument).err()).collect()
}

/// Checks a text; `arguments` are those of `--set` and of `--fire`.
fn parse(
    text: &str,
    file: &str,
    folder: &Path,
    arguments: [&[String]; 2],
    places: &FilePlaces,
) -> Result<Scenario, FileProblems> {
    other_format::refuse(text, file, "a scenario")?;
    let with_file = |problems| FileProblems { file: file.to_owned(), problems };
    let mut document = octant_toml_tree::parse(text).map_err(with_file)?;
    let [overrides, fires] = arguments;
    let mut problems = override_all(&mut document, overrides);
    for argument in fires {
        if let Err(problem) = fire(&mut document, argument) {
            problems.push(problem);
        }
    }
    derive::derive(&mut document);
    let start = Place::File { line: 1, column: 1 };
    complete(&mut document, keys::SCENARIO, "", &start, &mut problems);
    if problems.is_empty() {
        problems = derive::refuse_without_effect(&document);
    }
    if !problems.is_empty() {
        return Err(with_file(problems));
    }
    put_places(&mut document, places);
    let scenario = read::scenario(document, folder).map_err(|problem| with_file(vec![problem]))?;
    Ok(Scenario { file: file.to_owned(), ..scenario })
}
