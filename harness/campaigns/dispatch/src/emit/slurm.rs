//! A script for Slurm: arrays of one task per part, then the merge.

use super::SchedulerJob;

/// Renders a script for Slurm, whose arrays have at most so many tasks (`MaxArraySize` of the site is one
/// more).
///
/// Run by a shell, the script submits itself as often as that limit asks for, and a job that merges when
/// all tasks have ended. Submitted by `sbatch`, it is one array. Parts that were killed are submitted again
/// with the same script, all of them or, with `--array`, some.
#[must_use]
pub fn slurm(job: &SchedulerJob, array: u32) -> String {
    let SchedulerJob { shards, jobs, cases, title, name, memory_mib, .. } = job;
    let folder = shell(&job.folder);
    let array = array.clamp(1, (*shards).max(1));
    format!(
        r#"#!/bin/sh
# {cases} cases of {title} in {shards} parts of a Slurm array. sh FILE submits all parts and the merge. Each part
# goes on where it was interrupted: submit it again. Output of the tasks: {folder}/logs.
#SBATCH --job-name={name}
#SBATCH --array=1-{array}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={jobs}
#SBATCH --mem={memory_mib}M
#SBATCH --requeue
folder={folder}
if [ -z "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
  # Arrays of at most {array} tasks.
  set -eu
  mkdir -p "$folder/logs"
  first=0 after=
  while [ "$first" -lt {shards} ]; do
    tasks=$(({shards} - first))
    [ "$tasks" -le {array} ] || tasks={array}
    job=$(OCTANT_FIRST=$first sbatch --parsable --export=ALL --array="1-$tasks" --output="$folder/logs/%A_%a.txt" "$0")
    after=$after:${{job%%;*}} first=$((first + tasks))
  done
  job=$(sbatch --parsable --export=ALL --job-name={name}-merge --dependency="afterany$after" \
    --output="$folder/logs/merge-%j.txt" --wrap '"${{OCTANT:-octant}}" campaign merge '{quoted})
  echo "submitted:$(echo "$after" | tr : ' '), then the merge, ${{job%%;*}}"
  exit
fi
part=$((${{OCTANT_FIRST:-0}} + SLURM_ARRAY_TASK_ID))
exec "${{OCTANT:-octant}}" campaign run "$folder" --shard "$part/{shards}" --jobs {jobs}
"#,
        quoted = shell(&folder),
    )
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
