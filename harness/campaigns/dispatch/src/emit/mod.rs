//! Renders files with which schedulers and workflow engines run a campaign in parts.

mod kubernetes;
mod slurm;
mod snakemake;

use octant_campaign::plan::{Plan, short};
use std::path::Path;

pub use kubernetes::{KubernetesVolume, kubernetes};
pub use slurm::slurm;
pub use snakemake::snakemake;

/// Campaign for a scheduler.
#[derive(Clone, Debug)]
pub struct SchedulerJob {
    /// Title of the campaign, on one line.
    title: String,
    /// Number of cases.
    cases: usize,
    /// Name that schedulers accept.
    name: String,
    /// Folder, as the nodes see it.
    folder: String,
    /// Number of parts.
    shards: u32,
    /// Cases run at a time in each part.
    jobs: u16,
    /// Memory of one part, MiB.
    memory_mib: u64,
}

/// Reasons why a campaign can't be given to a scheduler.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EmitError {
    /// The folder's name can't be written into a job file.
    #[error(
        "the folder {found:?}: expected a name in UTF-8 without line breaks and control characters"
    )]
    Name {
        /// The name.
        found: String,
    },
    /// The folder has braces where these are wildcards.
    #[error(
        "the folder {found:?}: expected a name without braces, which are wildcards of Snakemake"
    )]
    Braces {
        /// The name.
        found: String,
    },
    /// The name of a claim or of a secret isn't one of Kubernetes.
    #[error(
        "the name {found:?}: expected lower-case letters, digits, - and . as Kubernetes has them in names"
    )]
    KubernetesName {
        /// The name.
        found: String,
    },
    /// The folder is relative where no part knows to what.
    #[error("the folder {found:?}: expected an absolute path, at which every pod has the volume")]
    Relative {
        /// The name.
        found: String,
    },
}

impl SchedulerJob {
    /// Describes a campaign for a scheduler: so many parts, each of which runs so many cases at a time.
    ///
    /// # Errors
    /// If the folder has a name that no job file can hold.
    pub fn new(plan: &Plan, folder: &Path, shards: u32, jobs: u16) -> Result<Self, EmitError> {
        let name = || EmitError::Name { found: folder.display().to_string() };
        let text = folder.to_str().ok_or_else(name)?;
        if text.chars().any(char::is_control) {
            return Err(name());
        }
        let one_line = |c: char| if c.is_control() { ' ' } else { c };
        Ok(Self {
            title: plan.title.chars().map(one_line).collect(),
            cases: plan.cases.len(),
            name: format!("octant-{}", short(&plan.id)),
            // A name that begins with a dash would be an option.
            folder: if text.starts_with('-') { format!("./{text}") } else { text.to_owned() },
            shards,
            jobs,
            // The cases that run at a time, and the program that starts them.
            memory_mib: plan.limits.memory_mib * u64::from(jobs) + 256,
        })
    }
}
