//! Converts requirements from one format to another, and shows a campaign in StrictDoc.
//!
//! ```text
//! exchange convert FROM TO              formats by their endings, as `octant requirements convert`
//! exchange strictdoc REQUIREMENTS CASES FOLDER
//! ```
//!
//! CASES has a line for each case: its id, the verdict of each check as `ID=verdict`.
#![allow(clippy::print_stdout)]

use octant_requirements::{Imported, exchange, strictdoc};
use octant_verdict::Verdict;
use octant_verdict::trace::{CampaignTrace, TracedCase, TracedResult};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["convert", from, to] => write(&read(from)?, to),
        ["strictdoc", requirements, cases, folder] => show(requirements, cases, Path::new(folder)),
        _ => Err("usage: exchange convert FROM TO | strictdoc REQUIREMENTS CASES FOLDER".into()),
    }
}

fn read(path: &str) -> Result<Imported, Box<dyn Error>> {
    let imported = exchange::read(Path::new(path), None, &exchange::Anything)?;
    for note in &imported.notes {
        println!("{path}: {note}");
    }
    Ok(imported)
}

fn write(imported: &Imported, path: &str) -> Result<(), Box<dyn Error>> {
    for loss in exchange::write(Path::new(path), imported, "2026-01-31T12:00:00Z", true)? {
        println!("{path}: {loss}");
    }
    Ok(())
}

fn show(requirements: &str, cases: &str, folder: &Path) -> Result<(), Box<dyn Error>> {
    let requirements = read(requirements)?.requirements;
    let mut all = Vec::new();
    for line in std::fs::read_to_string(cases)?.lines().filter(|line| !line.trim().is_empty()) {
        let mut words = line.split_whitespace();
        let id = words.next().unwrap_or_default().to_owned();
        let mut checks = Vec::new();
        for word in words {
            let (requirement, name) = word.split_once('=').ok_or(format!("found {word:?}"))?;
            let verdict = Verdict::ALL.into_iter().find(|v| v.name() == name);
            checks.push((requirement.to_owned(), verdict.ok_or(format!("found {name:?}"))?));
        }
        let verifies = checks.iter().map(|(id, _)| id.clone()).collect();
        let verdict = checks.iter().map(|(_, v)| *v).max().unwrap_or(Verdict::Inconclusive);
        let recording = Some(format!("runs/{id}/recording.mcap"));
        let result = Some(TracedResult { verdict, checks, recording, folder: None });
        let draw = all.len();
        all.push(TracedCase { id, verifies, draw, result });
    }
    let trace = CampaignTrace::new(&requirements, &all);
    for (path, text) in strictdoc::folder(&requirements, &trace, "Campaign")? {
        let path = folder.join(path);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)?;
        }
        std::fs::write(path, text)?;
    }
    for row in &trace.requirements {
        println!(
            "{}: {} ({})",
            row.id,
            row.verdict.map_or(row.verification.as_str(), |v| v.name()),
            row.reason
        );
    }
    Ok(())
}
