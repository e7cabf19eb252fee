//! Facts that a run or a campaign states about itself.

use super::inputs::InputFacts;
use super::maker::MadeBy;
use super::signature::SigningKey;
use octant_account::Account;
use octant_operator::OperatorRecord;
use octant_realtime::schedule::Granted;
use octant_verdict::Verdict;
use octant_verdict::equipment::Equipment;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::SystemTime;

/// Facts known to the run itself.
#[derive(Clone, Debug)]
pub struct RunFacts {
    /// Seed, where there is one.
    pub seed: Option<u64>,
    /// Host time of the start.
    pub started: SystemTime,
    /// Host time of the end.
    pub ended: SystemTime,
    /// The command line, program first.
    pub command_line: Vec<String>,
    /// FMUs that took part.
    pub fmus: Vec<FmuFacts>,
    /// Recordings from which its samples came.
    pub inputs: Vec<InputFacts>,
    /// Accounts of what came in from outside, as in the summary.
    pub accounts: Vec<Account>,
    /// Equipment of the bench.
    pub equipment: Vec<Equipment>,
    /// Device of a run over a wire, and the traffic counts.
    pub link: Option<serde_json::Value>,
    /// Clocks and counts of a real instrument and the table under it.
    pub bench: Option<serde_json::Value>,
    /// Real-time settings that the host granted a run by the clock.
    pub realtime: Option<Granted>,
    /// Questions to a person, answers and requests.
    pub answers: Vec<OperatorRecord>,
    /// Result of a campaign.
    pub campaign: Option<CampaignFacts>,
    /// The key that signs the manifest.
    pub key: Option<Arc<SigningKey>>,
}

impl RunFacts {
    /// Creates facts of something between two times of the host, without other details.
    #[must_use]
    pub fn between(started: SystemTime, ended: SystemTime) -> Self {
        Self {
            seed: None,
            started,
            ended,
            command_line: Vec::new(),
            fmus: Vec::new(),
            inputs: Vec::new(),
            accounts: Vec::new(),
            equipment: Vec::new(),
            link: None,
            bench: None,
            realtime: None,
            answers: Vec::new(),
            campaign: None,
            key: None,
        }
    }
}

/// Result of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CampaignFacts {
    /// Name.
    pub title: String,
    /// Plan.
    pub plan: String,
    /// Overall verdict.
    pub verdict: Verdict,
    /// Cases that count.
    pub cases: usize,
    /// Cases without a result.
    pub open_cases: usize,
    /// Discrepancies.
    pub discrepancies: usize,
    /// Discrepancies without a disposition.
    pub open_discrepancies: usize,
    /// BLAKE3 over all results.
    pub results_blake3: String,
    /// Seed of the first replicate, and where it comes from; empty in older manifests.
    #[serde(default)]
    pub seed: String,
    /// How its results are looked at; empty in older manifests.
    #[serde(default)]
    pub looks: String,
    /// Numbers of entries of its journal; null in older manifests.
    #[serde(default)]
    pub journal: Option<JournalCounts>,
    /// SHA-256 of the program that wrote the report; `null` where it can't be read.
    pub program_sha256: Option<String>,
    /// Who made the results: program, host and operator, with the number of results of each; empty in older manifests.
    #[serde(default)]
    pub made_by: Vec<MadeBy>,
    /// Verdict of the self-test in the folder; `null` without one.
    pub selftest: Option<Verdict>,
    /// Time of the file of the first result, UTC; `null` without one.
    pub first_result: Option<String>,
    /// Time of the file of the last result.
    pub last_result: Option<String>,
    /// Line for a POSIX shell that makes the campaign again.
    #[serde(skip)]
    pub rerun: String,
}

/// An FMU of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FmuFacts {
    /// `source`, `endpoint`, or its name in a system.
    pub role: String,
    /// The file.
    pub file: String,
    /// SHA-256 of the file, hexadecimal; `null` for an unpacked one.
    pub sha256: Option<String>,
    /// Name of the model.
    pub model: String,
    /// `guid` or `instantiationToken`.
    pub token: String,
    /// Version of the standard, as in the description.
    pub fmi: String,
    /// Tool that made it, as in the description.
    pub generation_tool: String,
    /// `own` or `shared`: the process in which it ran.
    pub process: String,
    /// True if a process can hold only one instance.
    #[serde(skip)]
    pub only_once: bool,
}

/// Numbers of entries of the journal of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JournalCounts {
    /// All entries.
    pub entries: usize,
    /// Looks at the results.
    pub looks: usize,
}
