//! Keys of a campaign: its scenarios and their variations.

use super::definition::{Bounds, Kind, SCHEMA};
use super::table::{
    At, Of, Raw, Value, boolean, choice, form_tables, forms, integer, keys, number, numbers, si,
    table, tables, text,
};
use crate::error::Problem;
use crate::quantity::UnitDimension;
use crate::read::reader::Reader;
use octant_toml_tree::Node;

/// Design of the draws over the replicates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Independent draws.
    MonteCarlo,
    /// One draw in each of as many strips as there are replicates (McKay, Beckman and Conover,
    /// 1979).
    LatinHypercube,
}

keys! {
    /// A campaign.
    pub(crate) struct CampaignKeys {
        #[expect(dead_code, reason = "it has one value")]
        schema: u32 = integer(SCHEMA, SCHEMA), required, "Version of the format.";
        title: String = text(), required, "Name of the campaign.";
        seed: Option<u64> = integer::<u64>(0, i64::MAX),
            derived("the hash of what the plan says of scenarios, requirements, factors and looks"),
            "Of what is drawn; the first replicate runs with it, the next with the next number.";
        replicates: u32 = integer(1, 1_000_000), "1",
            "Runs of every combination, each with a seed and draws of its own.";
        requirements: Option<String> = text(), absent("those of the scenarios alone"),
            "File with the requirements, counted from the campaign's own folder.";
        scenarios: Vec<MemberKeys> = tables(1, 1000), required, "What is run.";
        factors: Option<Vec<FactorKeys>> = form_tables(100), absent("nothing is varied but seeds"),
            "What is varied, in every scenario.";
        correlations: Option<Vec<CorrelationKeys>> = tables(0, 1000), absent("draws are independent"),
            "Draws that go together.";
        design: Design = choice! {
                "monte-carlo" => Design::MonteCarlo,
                    "each draw for itself: more replicates leave the cases that there are";
                "latin-hypercube" => Design::LatinHypercube,
                    "one draw in each of as many strips as there are replicates: another number of \
                     replicates is another design";
            }, "monte-carlo", "How draws are spread.";
        limits: LimitsKeys = table(), section, "What a case may use.";
        stop: Option<EarlyStopKeys> = table::<EarlyStopKeys>(), absent("every case is run"),
            "When enough is known.";
        looks: At<LookSpec> = looks(), "once",
            "How often the results are looked at before a required probability counts as shown.";
    }
}

/// How often the results of a campaign are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookSpec {
    /// Once, when every case has run.
    Once,
    /// So many times, after equal parts of the draws.
    Planned(u32),
    /// At any time.
    Open,
}

impl Value for LookSpec {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        table.integer(key).map(|count| Some(Self::Planned(count)))
    }
}

/// Largest number of planned looks.
const LOOKS_MAX: u32 = 50;

const fn looks() -> Of<LookSpec> {
    const WAYS: Kind = Kind::Choice(&[
        ("once", "when every case has run; draws that are added later don't count"),
        ("open", "at any time, by a bound that holds whenever it is looked at"),
    ]);
    Of::or_choice(
        const { Kind::Either(&[WAYS, Kind::Integer(2, LOOKS_MAX as i64)]) },
        const { &[LookSpec::Once, LookSpec::Open] },
    )
}

keys! {
    /// One of `[[scenarios]]`.
    pub(crate) struct MemberKeys {
        id: At<String> = text(), required, "Name, unique in the campaign.";
        file: String = text(), required, "File, counted from the campaign's own folder.";
        set: Option<Raw> = Of::<Raw>::kind(Kind::Settings), absent("the scenario as it is"),
            "Keys of the scenario with other values, as --set has them.";
        verifies: Option<Vec<String>> = Of::<Vec<String>>::kind(Kind::Names),
            absent("all that are verified by test"),
            "Ids of the requirements of the campaign's file that its cases check.";
    }
}

forms! {
    /// One of `[[factors]]`.
    pub(crate) enum FactorKeys("values of the factor") {
        "values" => Grid(GridKeys);
        "choose" => Choose(ChooseKeys);
        "faults" => Faults(FaultListsKeys);
        "uniform" => Uniform(UniformKeys);
        "normal" => Normal(NormalKeys);
    }
}

impl FactorKeys {
    pub(crate) fn name(&self) -> &At<String> {
        match self {
            Self::Grid(GridKeys { name, .. })
            | Self::Choose(ChooseKeys { name, .. })
            | Self::Faults(FaultListsKeys { name, .. })
            | Self::Uniform(UniformKeys { name, .. })
            | Self::Normal(NormalKeys { name, .. }) => name,
        }
    }
}

const NAME: &str = "Name of the factor, unique in the campaign.";
const SET: &str = "Key of the scenario that it sets, as in --set; faults.ID.KEY is one of a fault.";
const UNIT: &str = "Unit of the numbers, such as \"deg/h\".";

keys! {
    /// Values of a grid.
    pub(crate) struct GridKeys {
        name: At<String> = text(), required, NAME;
        key: Option<String> = text(), derived("the name"), SET;
        values: At<Vec<Node>> = Of::<Vec<Node>>::kind(Kind::Values), required,
            "Values: every one is run, as a grid.";
    }
}

keys! {
    /// Values to draw from.
    pub(crate) struct ChooseKeys {
        name: At<String> = text(), required, NAME;
        key: Option<String> = text(), derived("the name"), SET;
        choose: At<Vec<Node>> = Of::<Vec<Node>>::kind(Kind::Values), required,
            "Values: one is drawn for each replicate.";
    }
}

keys! {
    /// Sets of faults.
    pub(crate) struct FaultListsKeys {
        name: At<String> = text(), required, NAME;
        faults: At<Vec<Vec<String>>> = Of::<Vec<Vec<String>>>::kind(Kind::Lists), required,
            "Lists of ids of the scenario's faults: those of the list are injected, the others left out.";
        draw: bool = boolean(), "false",
            "One list is drawn for each replicate, instead of every one run.";
    }
}

keys! {
    /// A uniform distribution.
    pub(crate) struct UniformKeys {
        name: At<String> = text(), required, NAME;
        key: Option<String> = text(), derived("the name"), SET;
        unit: Option<String> = text(), absent("a plain number"), UNIT;
        uniform: At<[f64; 2]> = numbers(), required, "Least and greatest value.";
    }
}

keys! {
    /// A normal distribution.
    pub(crate) struct NormalKeys {
        name: At<String> = text(), required, NAME;
        key: Option<String> = text(), derived("the name"), SET;
        unit: Option<String> = text(), absent("a plain number"), UNIT;
        normal: At<[f64; 2]> = numbers(), required, "Mean and standard deviation.";
        within: At<Option<[f64; 2]>> = numbers::<2>(), absent("not truncated"),
            "Least and greatest value: the distribution is truncated there.";
    }
}

const fn probability() -> Of<f64> {
    number(Bounds::Within(0.001, 0.999_999, "between 0.001 and 0.999999"))
}

keys! {
    /// One of `[[correlations]]`.
    pub(crate) struct CorrelationKeys {
        first: At<String> = text(), required, "Name of a factor that is drawn.";
        second: At<String> = text(), required, "Name of another.";
        value: f64 = number(Bounds::Within(-0.999, 0.999, "between -0.999 and 0.999")), required,
            "The correlation of the Gaussian copula that joins them: of normal factors their own.";
    }
}

keys! {
    /// `[limits]`.
    pub(crate) struct LimitsKeys {
        time: f64 = si(&[UnitDimension::TIME], Bounds::Positive), "10 min",
            "After which a case is ended as an error.";
        memory_mib: u64 = integer(64, 1_000_000), "2048",
            "Address space of a case, MiB; a case that wants more ends as an error. On Linux.";
    }
}

keys! {
    /// `[stop]`.
    pub(crate) struct EarlyStopKeys {
        requirement: String = text(), required, "Id of the requirement that decides.";
        pass: f64 = probability(), "0.95", "It has to be kept with at least this probability.";
        confidence: f64 = number(Bounds::Within(0.5, 0.999_999, "between 0.5 and 0.999999")), "0.95",
            "With this confidence, one-sided.";
        every: u64 = integer(1, 1_000_000), "20",
            "After how many cases, in the order of the plan, it is looked at again.";
    }
}
