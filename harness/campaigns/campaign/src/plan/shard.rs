//! Parts of a plan, for several processes or machines.

/// Part of a plan: every n-th case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u32,
    /// Number of parts.
    pub of: u32,
}

/// Reasons why a text or a scheduler names no part of a plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShardError {
    /// The scheduler names a part beyond the number of parts.
    #[error("the scheduler names part {part} of {of}: expected 1 to {of}")]
    Outside {
        /// Number of the part.
        part: u32,
        /// Number of parts.
        of: u32,
    },
    /// The scheduler names a part without the number of parts.
    #[error(
        "the scheduler names part {part}, and not of how many: expected OCTANT_SHARDS in the \
         environment, or --shard K/N"
    )]
    Alone {
        /// Number of the part.
        part: u32,
    },
    /// The text isn't a part and the number of parts.
    #[error("found {found:?}, expected a part and the number of parts, as in 3/16")]
    Form {
        /// The text.
        found: String,
    },
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Returns whether a case, given by its place in the plan, is in this part.
    #[must_use]
    pub fn has(self, index: usize) -> bool {
        index % self.of as usize == self.number as usize - 1
    }

    /// Returns the part that a scheduler assigns to a task, from the variables that Slurm (array
    /// jobs) and Kubernetes (indexed jobs) set; the whole plan without them.
    ///
    /// # Errors
    /// If the number of a part is given without the number of parts.
    pub fn of_scheduler(variable: impl Fn(&str) -> Option<String>) -> Result<Self, ShardError> {
        let number = |name: &str| variable(name).and_then(|text| text.trim().parse::<u32>().ok());
        let slurm = number("SLURM_ARRAY_TASK_ID");
        let kubernetes = number("JOB_COMPLETION_INDEX").map(|index| index.saturating_add(1));
        let Some(part) = slurm.or(kubernetes) else { return Ok(Self::WHOLE) };
        // If some tasks of an array are submitted again, they have a count of their own.
        let array = || {
            let (least, most) = (number("SLURM_ARRAY_TASK_MIN")?, number("SLURM_ARRAY_TASK_MAX")?);
            (least == 1 && number("SLURM_ARRAY_TASK_COUNT") == Some(most)).then_some(most)
        };
        match number("OCTANT_SHARDS").or_else(array) {
            Some(of) if (1..=of).contains(&part) => Ok(Self { number: part, of }),
            Some(of) => Err(ShardError::Outside { part, of }),
            None => Err(ShardError::Alone { part }),
        }
    }

    /// Returns the beginning of the names of its part files.
    #[must_use]
    pub fn stem(self) -> String {
        format!("{}-of-{}", self.number, self.of)
    }

    /// Parses `3/16`.
    ///
    /// # Errors
    /// If it isn't a part and the number of parts.
    pub fn parse(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/').map(|(a, b)| (a.trim().parse(), b.trim().parse()));
        match parts {
            Some((Ok(number), Ok(of))) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err(ShardError::Form { found: text.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(variables: &[(&str, &str)]) -> Result<Shard, String> {
        let value = |name: &str| {
            let found = variables.iter().find(|(other, _)| *other == name);
            found.map(|(_, value)| (*value).to_owned())
        };
        Shard::of_scheduler(value).map_err(|error| error.to_string())
    }

    #[test]
    fn the_scheduler_names_the_part() {
        assert_eq!(shard(&[]), Ok(Shard::WHOLE));
        let array = |id, least, most, count| {
            shard(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", least),
                ("SLURM_ARRAY_TASK_MAX", most),
                ("SLURM_ARRAY_TASK_COUNT", count),
            ])
        };
        assert_eq!(array("3", "1", "16", "16"), Ok(Shard { number: 3, of: 16 }));
        // Two tasks of sixteen, submitted again.
        assert!(array("5", "5", "6", "2").unwrap_err().contains("not of how many"));
        assert!(array("1", "1", "16", "4").is_err(), "every fourth");
        let indexed = [("JOB_COMPLETION_INDEX", "0"), ("OCTANT_SHARDS", "7")];
        assert_eq!(shard(&indexed), Ok(Shard { number: 1, of: 7 }));
        assert!(shard(&indexed[..1]).unwrap_err().contains("OCTANT_SHARDS"));
        let again = [("SLURM_ARRAY_TASK_ID", "5"), ("OCTANT_SHARDS", "16")];
        assert_eq!(shard(&again), Ok(Shard { number: 5, of: 16 }));
        let beyond = [("SLURM_ARRAY_TASK_ID", "17"), ("OCTANT_SHARDS", "16")];
        assert!(shard(&beyond).unwrap_err().contains("expected 1 to 16"));
    }

    #[test]
    fn every_case_is_in_one_shard() {
        for of in 1..9 {
            for index in 0..50 {
                let of_it = (1..=of).filter(|number| Shard { number: *number, of }.has(index));
                assert_eq!(of_it.count(), 1);
            }
        }
        assert_eq!(Shard::parse("3/16"), Ok(Shard { number: 3, of: 16 }));
        for wrong in ["", "3", "0/4", "5/4", "a/b", "1/0"] {
            assert!(Shard::parse(wrong).unwrap_err().to_string().contains("as in 3/16"), "{wrong}");
        }
    }
}
