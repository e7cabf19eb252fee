//! A job for Kubernetes.

use super::{EmitError, SchedulerJob};

/// Renders a job for `kubectl apply`: indexed, one completion per part, the folder on a volume
/// shared by all pods.
///
/// # Errors
/// If the folder is relative.
pub fn kubernetes(job: &SchedulerJob, image: &str, claim: &str) -> Result<String, EmitError> {
    let text = |text: &str| serde_json::Value::from(text).to_string();
    let SchedulerJob { shards, jobs, cases, title, name, folder, memory_mib } = job;
    if !folder.starts_with('/') {
        return Err(EmitError::Relative { found: folder.clone() });
    }
    Ok(format!(
        "# {cases} cases of {title} in {shards} parts. After the last: octant campaign merge\n\
         apiVersion: batch/v1\n\
         kind: Job\n\
         metadata:\n  \
           name: {name}\n\
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
                     requests: {{ cpu: \"{jobs}\", memory: {memory_mib}Mi }}\n            \
                     limits: {{ memory: {memory_mib}Mi }}\n          \
                   volumeMounts:\n            \
                     - name: campaign\n              \
                       mountPath: {}\n      \
               volumes:\n        \
                 - name: campaign\n          \
                   persistentVolumeClaim:\n            \
                     claimName: {}\n",
        text(image),
        text(folder),
        text(folder),
        text(claim),
    ))
}
