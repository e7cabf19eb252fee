//! A Snakefile: a rule for the parts, and one for the merge.

use super::{EmitError, SchedulerJob};

/// Renders a Snakefile, with which Snakemake runs the campaign on this computer or, by its executors, on
/// Slurm, LSF, Kubernetes and batch services.
///
/// A part is complete when its tables are there, whatever its verdict: exit statuses up to 3 are verdicts.
///
/// # Errors
/// If the folder's name has braces: Snakemake takes them for wildcards, doubled ones too.
pub fn snakemake(job: &SchedulerJob) -> Result<String, EmitError> {
    let SchedulerJob { shards, jobs, cases, title, memory_mib, .. } = job;
    if job.folder.contains(['{', '}']) {
        return Err(EmitError::Braces { found: job.folder.clone() });
    }
    let folder = serde_json::Value::from(job.folder.as_str());
    Ok(format!(
        r#"# {cases} cases of {title} in {shards} parts. With Snakemake 8 or newer:
#   snakemake --snakefile FILE --cores 8
#   snakemake --snakefile FILE --executor slurm --jobs 100 --keep-going
# Each part goes on where it was interrupted. Output of the parts: logs in the campaign's folder.
import os

OCTANT = os.environ.get("OCTANT", "octant")
CAMPAIGN = {folder}
TABLES = ["cases", "checks", "drift"]


localrules:
    all,
    merge,


rule all:
    input:
        [f"{{CAMPAIGN}}/{{table}}.parquet" for table in TABLES],


rule part:
    input:
        # A plan that has grown has more to run.
        CAMPAIGN + "/plan.json",
    output:
        CAMPAIGN + "/parts/{{part}}-of-{shards}.cases.parquet",
    log:
        CAMPAIGN + "/logs/{{part}}-of-{shards}.txt",
    retries: 3
    threads: {jobs}
    resources:
        mem_mb={memory_mib},
    shell:
        # Up to 3 the exit status is a verdict; without its tables the part isn't complete.
        "{{OCTANT:q}} campaign run {{CAMPAIGN:q}} --shard {{wildcards.part}}/{shards} --jobs {{threads}}"
        " > {{log:q}} 2>&1 || [ $? -le 3 ]"


rule merge:
    input:
        [f"{{CAMPAIGN}}/parts/{{part}}-of-{shards}.cases.parquet" for part in range(1, {shards} + 1)],
    output:
        [f"{{CAMPAIGN}}/{{table}}.parquet" for table in TABLES],
    log:
        CAMPAIGN + "/logs/merge.txt",
    shell:
        "{{OCTANT:q}} campaign merge {{CAMPAIGN:q}} > {{log:q}} 2>&1 || [ $? -le 3 ]"
"#
    ))
}
