//! `octant campaign emit`: job files of schedulers.

use super::planned::read;
use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::place::{self, CampaignPlace, Needs};
use crate::terminal::print;
use clap::{Args, ValueEnum};
use octant_dispatch::emit::{self, KubernetesVolume, SchedulerJob};
use octant_verdict::Verdict;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Scheduler of the job file.
    #[arg(value_enum)]
    scheduler: Scheduler,
    /// Folder of the campaign, as the nodes see it; for Kubernetes also its address on object storage,
    /// s3://BUCKET/PREFIX.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Number of shards of the campaign.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
    /// Number of parallel cases of each shard.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    jobs: u16,
    /// Largest number of tasks of an array, for Slurm: the site's MaxArraySize less one.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..))]
    array: u32,
    /// Image with the program, for Kubernetes.
    #[arg(long, value_name = "IMAGE", default_value = "octant:latest")]
    image: String,
    /// Claim of the volume that holds the folder, for Kubernetes; by default octant.
    #[arg(long, value_name = "NAME")]
    claim: Option<String>,
    /// Secret with the variables AWS_* of the object storage, for Kubernetes. Without it the pods have what their
    /// service account gives them.
    #[arg(long, value_name = "NAME")]
    secret: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Scheduler {
    /// A script that submits itself to sbatch as arrays, and the merge after them.
    Slurm,
    /// A Snakefile.
    Snakemake,
    /// An indexed job for kubectl.
    K8s,
}

impl Scheduler {
    /// Name on the command line.
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { scheduler, folder, shards, jobs, array, image, claim, secret } = arguments;
    let refused = |option: &str, expected: &str| {
        Failure::input(format!("{option}: found {}, expected {expected}", folder.display()))
    };
    if *scheduler != Scheduler::Slurm {
        given.refuse_ids(&["array"], format!("found with {}, expected slurm", scheduler.name()))?;
    }
    if *scheduler != Scheduler::K8s {
        given.refuse_ids(
            &["image", "claim", "secret"],
            format!("found with {}, expected k8s", scheduler.name()),
        )?;
    }
    let address = place::address(folder);
    if address.is_some() && *scheduler != Scheduler::K8s {
        return Err(refused("DIR", "a folder that all nodes see; on object storage emit k8s"));
    }
    if address.is_some_and(|text| !text.starts_with("s3://")) {
        return Err(refused("DIR", "s3://BUCKET/PREFIX, or an absolute folder on a volume"));
    }
    if address.is_some() && claim.is_some() {
        return Err(refused("--claim", "a folder on a volume"));
    }
    if address.is_none() && secret.is_some() {
        return Err(refused("--secret", "an address on object storage, s3://BUCKET/PREFIX"));
    }
    let plan = read(CampaignPlace::of(folder, Needs::Plan)?.folder())?;
    let job = SchedulerJob::new(&plan, folder, *shards, *jobs).map_err(Failure::input)?;
    print(&match scheduler {
        Scheduler::Slurm => emit::slurm(&job, *array),
        Scheduler::Snakemake => emit::snakemake(&job).map_err(Failure::input)?,
        Scheduler::K8s => {
            let volume = match address {
                Some(_) => KubernetesVolume::Objects { secret: secret.as_deref() },
                None => KubernetesVolume::Claim(claim.as_deref().unwrap_or("octant")),
            };
            emit::kubernetes(&job, image, volume).map_err(Failure::input)?
        }
    })?;
    Ok(Verdict::Pass)
}
