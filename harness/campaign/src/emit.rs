//! Renders files with which schedulers run a campaign in parts: a script for Slurm, a job for
//! Kubernetes.

use super::plan::{Plan, short};
use std::path::Path;

/// Campaign for a scheduler.
#[derive(Clone, Copy, Debug)]
pub struct SchedulerJob<'a> {
    /// Plan.
    pub plan: &'a Plan,
    /// Folder, as the nodes see it.
    pub folder: &'a Path,
    /// Number of parts.
    pub shards: u32,
    /// Cases run at a time in each part.
    pub jobs: u16,
}

impl SchedulerJob<'_> {
    /// Returns the memory for the cases that run at a time and the program that starts them, MiB.
    fn memory_mib(&self) -> u64 {
        self.plan.limits.memory_mib * u64::from(self.jobs) + 256
    }

    /// Returns a name that schedulers accept.
    fn name(&self) -> String {
        format!("octant-{}", short(&self.plan.id))
    }
}

/// Renders a script for `sbatch`: an array of one task per part. Killed tasks are submitted again
/// with the same script, all of them or selected by `--array`.
#[must_use]
pub fn slurm(job: &SchedulerJob<'_>) -> String {
    let SchedulerJob { shards, jobs, folder, .. } = job;
    let folder = shell(&folder.display().to_string());
    format!(
        "#!/bin/sh\n\
         # {} cases of {} in {shards} parts. Each goes on where it was interrupted: submit it again.\n\
         #SBATCH --job-name={}\n\
         #SBATCH --array=1-{shards}\n\
         #SBATCH --ntasks=1\n\
         #SBATCH --cpus-per-task={jobs}\n\
         #SBATCH --mem={}M\n\
         #SBATCH --requeue\n\
         # After the last: octant campaign merge {folder}\n\
         exec \"${{OCTANT:-octant}}\" campaign run {folder} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --jobs {jobs}\n",
        job.plan.cases.len(),
        comment(&job.plan.title),
        job.name(),
        job.memory_mib(),
    )
}

/// Renders a job for `kubectl apply`: indexed, one completion per part, the folder on a volume
/// shared by all pods.
#[must_use]
pub fn kubernetes(job: &SchedulerJob<'_>, image: &str, claim: &str) -> String {
    let text = |text: &str| serde_json::Value::from(text).to_string();
    let SchedulerJob { shards, jobs, folder, .. } = job;
    let folder = folder.display().to_string();
    format!(
        "# {} cases of {} in {shards} parts. After the last: octant campaign merge\n\
         apiVersion: batch/v1\n\
         kind: Job\n\
         metadata:\n  \
           name: {}\n\
         spec:\n  \
           completionMode: Indexed\n  \
           completions: {shards}\n  \
           parallelism: {shards}\n  \
           # A part that is evicted goes on where it was interrupted.\n  \
           backoffLimitPerIndex: 5\n  \
           template:\n    \
             spec:\n      \
               restartPolicy: Never\n      \
               containers:\n        \
                 - name: octant\n          \
                   image: {}\n          \
                   command: [\"octant\", \"campaign\", \"run\", {}, \"--jobs\", \"{jobs}\"]\n          \
                   env:\n            \
                     - name: OCTANT_SHARDS\n              \
                       value: \"{shards}\"\n          \
                   resources:\n            \
                     requests: {{ cpu: \"{jobs}\", memory: {}Mi }}\n            \
                     limits: {{ memory: {}Mi }}\n          \
                   volumeMounts:\n            \
                     - name: campaign\n              \
                       mountPath: {}\n      \
               volumes:\n        \
                 - name: campaign\n          \
                   persistentVolumeClaim:\n            \
                     claimName: {}\n",
        job.plan.cases.len(),
        comment(&job.plan.title),
        job.name(),
        text(image),
        text(&folder),
        job.memory_mib(),
        job.memory_mib(),
        text(&folder),
        text(claim),
    )
}

/// Puts a title on one line of a comment.
fn comment(title: &str) -> String {
    title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Quotes a word for a POSIX shell.
fn shell(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}
