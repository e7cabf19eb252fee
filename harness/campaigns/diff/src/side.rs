//! One of two runs: its recording, and what its folder says about it.

use super::error::DiffError;
use octant_evidence::Manifest;
use octant_evidence::ended;
use octant_evidence::manifest::FILE_NAME as MANIFEST;
use octant_evidence::statements::SUMMARY;
use octant_recorder::reader::{Info, Recording};
use octant_score::summary::Summary;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Origin of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SideAbout {
    /// Folder or recording as it was named.
    pub path: PathBuf,
    /// Version of the program that made it.
    pub octant: String,
    /// Numerics version of that program; null where it isn't known.
    pub numerics: Option<u32>,
    /// Commit of that program; null where it isn't known.
    pub commit: Option<String>,
    /// Time of the run's end; null without a manifest.
    pub ended: Option<String>,
    /// Seed.
    pub seed: Option<u64>,
    /// Method of the recording: `primary` or `baseline`.
    pub method: Option<String>,
    /// Verdict; null without a summary.
    pub verdict: Option<String>,
    /// Hash of the whole stream; null without a summary.
    pub stream_hash: Option<String>,
    /// True if the recording ends in the middle.
    pub truncated: bool,
}

/// One of two runs.
#[derive(Clone, Debug)]
pub struct Side {
    /// Origin.
    pub about: SideAbout,
    /// The recording.
    pub recording: PathBuf,
    /// Head of the recording.
    pub info: Info,
    /// Resolved scenario.
    pub scenario: toml::Table,
    /// Summary; `None` of a recording alone, and of a run whose folder isn't whole.
    pub summary: Option<Summary>,
}

impl Side {
    /// Reads the run in a folder, or a recording alone.
    ///
    /// # Errors
    /// If there is no recording, or a file can't be read.
    pub fn read(path: &Path) -> Result<Self, DiffError> {
        let recording = if path.is_dir() { path.join("recording.mcap") } else { path.to_owned() };
        if !recording.is_file() {
            return Err(DiffError::NoRun { path: path.to_owned() });
        }
        let wrong = |source| DiffError::Recording { path: recording.clone(), source };
        let mut reader = Recording::open(&recording).map_err(wrong)?;
        let info = reader.info().clone();
        while reader.next_item().map_err(wrong)?.is_some() {}
        let truncated = reader.truncated();
        let scenario = info.scenario.parse().map_err(|error: toml::de::Error| {
            let reason = format!("scenario.toml in it: {}", error.message());
            DiffError::File { path: recording.clone(), reason }
        })?;
        let (summary, manifest) = match path.is_dir() {
            true => (summary(path)?, manifest(path)?),
            false => (None, None),
        };
        let about = SideAbout {
            path: path.to_owned(),
            octant: info.octant.clone(),
            numerics: summary.as_ref().and_then(|summary| summary.numerics),
            commit: manifest.as_ref().and_then(|manifest| {
                let git = manifest.git.as_ref()?;
                Some(format!(
                    "{}{}",
                    git.commit,
                    if git.dirty { ", with local changes" } else { "" }
                ))
            }),
            ended: manifest.map(|manifest| manifest.ended),
            seed: info.run.get("seed").and_then(|seed| seed.parse().ok()),
            method: info.run.get("method").cloned(),
            verdict: summary.as_ref().map(|summary| summary.verdict.name().to_owned()),
            stream_hash: summary.as_ref().map(|summary| summary.stream_hash.clone()),
            truncated,
        };
        Ok(Self { about, recording, info, scenario, summary })
    }
}

fn summary(folder: &Path) -> Result<Option<Summary>, DiffError> {
    let wrong = |error: octant_evidence::ManifestError| DiffError::File {
        path: folder.join(SUMMARY),
        reason: error.to_string(),
    };
    ended::summary(folder).map_err(wrong)
}

fn manifest(folder: &Path) -> Result<Option<Manifest>, DiffError> {
    let path = folder.join(MANIFEST);
    if !path.exists() {
        return Ok(None);
    }
    let wrong = |error: octant_evidence::ManifestError| DiffError::File {
        path: path.clone(),
        reason: error.to_string(),
    };
    Manifest::read(folder).map(Some).map_err(wrong)
}
