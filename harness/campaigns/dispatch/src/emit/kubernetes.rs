//! A job for Kubernetes.

use super::{EmitError, SchedulerJob};

/// Place from which every pod has the campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KubernetesVolume<'a> {
    /// A volume that all pods see, by the name of its claim.
    Claim(&'a str),
    /// Object storage: the folder of the job is an address.
    Objects {
        /// Secret with the variables of the environment that give access.
        secret: Option<&'a str>,
    },
}

/// Renders a job for `kubectl apply`: indexed, one completion per part, whose folder is on a volume that all pods
/// see, or on object storage.
///
/// A part is done when each of its cases has a result, whatever the verdicts. A pod that is lost is replaced, and
/// goes on where its predecessor was interrupted: after an eviction any number of times, otherwise up to five times.
/// Bad input ends the job, because no repetition would help.
///
/// # Errors
/// If the folder on a volume is relative, or a name isn't one of Kubernetes.
pub fn kubernetes(
    job: &SchedulerJob,
    image: &str,
    volume: KubernetesVolume<'_>,
) -> Result<String, EmitError> {
    let text = |text: &str| serde_json::Value::from(text).to_string();
    let SchedulerJob { shards, jobs, cases, title, name, folder, memory_mib } = job;
    let volume = match volume {
        KubernetesVolume::Claim(_) if !folder.starts_with('/') => {
            return Err(EmitError::Relative { found: folder.clone() });
        }
        KubernetesVolume::Claim(claim) => {
            check(claim)?;
            format!(
                r#"
          volumeMounts:
            - name: campaign
              mountPath: {folder}
      volumes:
        - name: campaign
          persistentVolumeClaim:
            claimName: {claim}"#,
                folder = text(folder),
                claim = text(claim)
            )
        }
        KubernetesVolume::Objects { secret: None } => String::new(),
        KubernetesVolume::Objects { secret: Some(secret) } => {
            check(secret)?;
            let secret = text(secret);
            format!(
                r#"
          # AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and others.
          envFrom:
            - secretRef:
                name: {secret}"#
            )
        }
    };
    Ok(format!(
        r#"# {cases} cases of {title} in {shards} parts. After the last: octant campaign merge
apiVersion: batch/v1
kind: Job
metadata:
  name: {name}
spec:
  completionMode: Indexed
  completions: {shards}
  parallelism: {shards}
  # A part that is lost goes on where it was interrupted.
  backoffLimitPerIndex: 5
  podFailurePolicy:
    rules:
      # Evictions aren't counted.
      - action: Ignore
        onPodConditions:
          - type: DisruptionTarget
            status: "True"
      # Bad input: no part can run.
      - action: FailJob
        onExitCodes:
          containerName: octant
          operator: In
          values: [2]
  template:
    spec:
      restartPolicy: Never
      # Time in which results are uploaded.
      terminationGracePeriodSeconds: 120
      containers:
        - name: octant
          image: {image}
          command: ["octant", "campaign", "run", {folder}, "--jobs", "{jobs}", "--any-verdict"]
          env:
            - name: OCTANT_SHARDS
              value: "{shards}"
          resources:
            requests: {{ cpu: "{jobs}", memory: {memory_mib}Mi }}
            limits: {{ memory: {memory_mib}Mi }}{volume}
"#,
        image = text(image),
        folder = text(folder),
    ))
}

/// Checks a name of Kubernetes: a DNS subdomain.
fn check(name: &str) -> Result<(), EmitError> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit();
    let fits = |part: &str| {
        part.starts_with(plain)
            && part.ends_with(plain)
            && part.chars().all(|c| plain(c) || c == '-')
    };
    if name.len() <= 253 && name.split('.').all(fits) {
        return Ok(());
    }
    Err(EmitError::KubernetesName { found: name.to_owned() })
}
