//! Names of the objects of a campaign, below its address.
//!
//! | object | content |
//! |---|---|
//! | `bundle.zip` | the plan with all of its files, written once |
//! | `results/K-of-N/NUMBER.octres` | a segment: results of a shard as a part file, numbered from `00000001`, written once |
//! | any other | a file of the campaign's folder under its own path: tables, report, evidence; overwritten |

use octant_campaign::execute::Shard;

/// Name of the bundle.
pub const BUNDLE: &str = "bundle.zip";
/// Beginning of the names of segments.
pub const RESULTS: &str = "results";
/// Digits of a segment's number.
const DIGITS: usize = 8;
/// Extension of a segment.
const EXTENSION: &str = "octres";

/// Name of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentName {
    /// Shard whose worker has stored it.
    pub shard: Shard,
    /// Number, from 1.
    pub number: u32,
}

impl SegmentName {
    /// Returns the object's name.
    #[must_use]
    pub fn object(self) -> String {
        let Self { shard, number } = self;
        format!("{RESULTS}/{}/{number:0DIGITS$}.{EXTENSION}", shard.stem())
    }

    /// Returns the name of the file in the folder of results. No worker has a part file of such a name.
    #[must_use]
    pub fn file(self) -> String {
        let Self { shard, number } = self;
        format!("{}.s{number:0DIGITS$}.{EXTENSION}", shard.stem())
    }

    /// Parses an object's name; `None` if it is no segment's.
    #[must_use]
    pub fn parse(object: &str) -> Option<Self> {
        let (shard, file) = object.strip_prefix(RESULTS)?.strip_prefix('/')?.split_once('/')?;
        let (number, of) = shard.split_once("-of-")?;
        let shard = Shard::parse(&format!("{number}/{of}")).ok()?;
        let number = file.strip_suffix(EXTENSION)?.strip_suffix('.')?.parse().ok()?;
        let name = Self { shard, number };
        // Any other spelling of the same numbers would be a second object of this name.
        (name.object() == object && number > 0).then_some(name)
    }

    /// Returns whether a file in the folder of results is a segment's.
    #[must_use]
    pub fn is_file(name: &str) -> bool {
        let digits = |text: &str| text.len() == DIGITS && text.bytes().all(|b| b.is_ascii_digit());
        let stem = name.strip_suffix(EXTENSION).and_then(|name| name.strip_suffix('.'));
        stem.and_then(|stem| stem.rsplit_once(".s")).is_some_and(|(_, number)| digits(number))
    }
}

/// Returns whether a worker of a shard can have results of another shard: not if both are of the same number of
/// shards.
#[must_use]
pub fn may_share(one: Shard, other: Shard) -> bool {
    one.of != other.of || one.number == other.number
}
