//! Options that are on the command line, as clap knows them.

use crate::failure::Failure;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args};

/// Options that the user gave to a command and to its subcommands. An option that has its default isn't one of them.
#[derive(Debug, Default)]
pub(crate) struct GivenOptions {
    /// Id and name of each, such as `sample_seed` and `--sample-seed`.
    options: Vec<(String, String)>,
}

impl GivenOptions {
    /// Collects the options of a command line.
    pub(crate) fn of(command: &clap::Command, matches: &ArgMatches) -> Self {
        let mut options = Vec::new();
        let (mut command, mut matches) = (command, matches);
        loop {
            for option in command.get_arguments() {
                let id = option.get_id().as_str();
                let is_given = matches.value_source(id) == Some(ValueSource::CommandLine);
                if let (Some(name), true) = (option.get_long(), is_given) {
                    options.push((id.to_owned(), format!("--{name}")));
                }
            }
            let Some((name, of_subcommand)) = matches.subcommand() else { break };
            let Some(subcommand) = command.find_subcommand(name) else { break };
            (command, matches) = (subcommand, of_subcommand);
        }
        Self { options }
    }

    /// Refuses the options of `A`, which a way of the command can't obey: `reason` says why, after the option's name.
    pub(crate) fn refuse<A: Args>(&self, reason: impl std::fmt::Display) -> Result<(), Failure> {
        let group = A::augment_args(clap::Command::new("group"));
        let ids: Vec<&str> = group.get_arguments().map(|option| option.get_id().as_str()).collect();
        self.refuse_ids(&ids, reason)
    }

    /// Refuses options by their ids, the names of their fields.
    pub(crate) fn refuse_ids(
        &self,
        ids: &[&str],
        reason: impl std::fmt::Display,
    ) -> Result<(), Failure> {
        let refused = self.options.iter().filter(|(id, _)| ids.contains(&id.as_str()));
        let names: Vec<&str> = refused.map(|(_, name)| name.as_str()).collect();
        if names.is_empty() {
            return Ok(());
        }
        Err(Failure::input(format!("{}: {reason}", names.join(", "))))
    }
}
