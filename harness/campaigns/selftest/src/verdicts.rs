//! Cases that must pass, and cases that must not: known faults in the unit, in requirements, in
//! recordings, in evidence and in campaigns.

use super::bench::CaseBench;
use super::case::{Case, STARTED_LIMIT};
use super::error::CaseSetupError;
use super::judge::{CaseOutcome, Expectation};
use super::scenarios::{ALWAYS, BELIEVING, MOSTLY, SHORT, SPIKE, campaign, needs, planned};
use minisign::KeyPair;
use octant_campaign::execute::case::ResultError;
use octant_campaign::store::{CampaignResults, keep};
use octant_verdict::Verdict;

const BIAS_STEP: &str = include_str!("../../../../fixtures/selftest/bias-step.toml");
const DROPPED: &str = include_str!("../../../../fixtures/selftest/dropped.toml");

type Work = fn(&CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError>;

fn passes(id: &'static str, about: &'static str, run: Work) -> Case {
    Case { id, about, expectation: Expectation::Pass, limit: STARTED_LIMIT, run }
}

fn fails(
    id: &'static str,
    about: &'static str,
    (status, because): (i32, &'static str),
    run: Work,
) -> Case {
    let expectation = Expectation::NotPass { status, because };
    Case { id, about, expectation, limit: STARTED_LIMIT, run }
}

pub(super) fn must_pass() -> Vec<Case> {
    vec![
        passes("kept", "A requirement that is kept, without a fault.", |bench| {
            Ok(bench.run(&clean(SHORT)?, &[])?.into())
        }),
        passes("survived", "A spike that the core sees and survives.", |bench| {
            Ok(bench.run(SPIKE, &[])?.into())
        }),
        passes("replayed", "A recording, put through the core again.", |bench| {
            recorded(bench)?;
            Ok(bench.octant(&["replay", "run/recording.mcap"])?.into())
        }),
        passes("untouched", "A signed folder of evidence that nobody has touched.", |bench| {
            let key = evidence(bench, "own")?;
            Ok(bench.octant(&["verify", "run", "--key", &key])?.into())
        }),
        passes("campaign", "A campaign all of whose cases keep their requirements.", |bench| {
            campaign(bench, 2, ALWAYS, "")?;
            status(bench)
        }),
    ]
}

pub(super) fn must_fail() -> Vec<Case> {
    let mut all = runs();
    all.extend(files());
    all.extend(campaigns());
    all
}

/// Lists the cases about verdicts of runs.
fn runs() -> Vec<Case> {
    vec![
        fails("broken", "A limit that no run can keep.", (1, "NEAR"), |bench| {
            let text = edited(&clean(SHORT)?, "limit = \"10 nmi\"", "limit = \"1e-9 nmi\"")?;
            Ok(bench.run(&text, &[])?.into())
        }),
        fails(
            "harmed",
            "A spike that the core believes has to break the requirement that nothing moves.",
            (1, "SHIFT"),
            |bench| Ok(bench.run(SPIKE, &BELIEVING)?.into()),
        ),
        fails(
            "refused",
            "A calibration that has to be refused fails, though its requirement is kept.",
            (1, "refused"),
            |bench| Ok(bench.run(BIAS_STEP, &[])?.into()),
        ),
        fails("unfired", "A fault that never fires shows nothing.", (3, "never fired"), |bench| {
            let text = edited(SHORT, "at = \"500 s\"", "when = \"nis above 1e9\"")?;
            Ok(bench.run(&text, &[])?.into())
        }),
        fails(
            "no-such-measure",
            "A requirement on a measure that there isn't is refused.",
            (2, "radial_eror_nmi"),
            |bench| {
                let text = edited(SHORT, "radial_error_nmi", "radial_eror_nmi")?;
                Ok(bench.run(&text, &[])?.into())
            },
        ),
        fails(
            "measure-missing",
            "A requirement on a measure that the run doesn't have shows nothing.",
            (3, "NEAR: navigation is null"),
            |bench| {
                let navigation = "[procedure.navigation]\nduration = \"10 min\"\n";
                Ok(bench.run(&edited(&clean(SHORT)?, navigation, "")?, &[])?.into())
            },
        ),
        fails(
            "fault-left-out",
            "A requirement whose fault was left out on the command line is not shown.",
            (3, "--only-faults left out"),
            |bench| Ok(bench.run(SHORT, &["--only-faults="])?.into()),
        ),
        fails(
            "nothing-required",
            "A scenario whose requirements somebody removed doesn't pass where one is wanted.",
            (3, "requires nothing"),
            |bench| {
                let text = clean(SHORT)?;
                let end = text.find("[[requirements]]").ok_or("it has no requirement")?;
                Ok(bench.run(&text[..end], &["--require"])?.into())
            },
        ),
        fails(
            "records-dropped",
            "A recorder that loses samples, by the clock: the run shows nothing.",
            (3, "found no room on their way to the recorder"),
            |bench| Ok(bench.run(DROPPED, &["--realtime"])?.into()),
        ),
    ]
}

/// Lists the cases about altered recordings and evidence.
fn files() -> Vec<Case> {
    vec![
        fails(
            "recording-cut",
            "Half a recording is no proof that all outputs are the same.",
            (3, "is truncated"),
            |bench| {
                recorded(bench)?;
                let whole = bench.read("run/recording.mcap")?;
                bench.write("cut.mcap", &whole[..whole.len() / 2])?;
                Ok(bench.octant(&["replay", "cut.mcap"])?.into())
            },
        ),
        fails(
            "recording-damaged",
            "A recording with one other bit is refused.",
            (2, "damaged"),
            |bench| {
                recorded(bench)?;
                let mut bytes = bench.read("run/recording.mcap")?;
                flip(&mut bytes)?;
                bench.write("damaged.mcap", bytes)?;
                Ok(bench.octant(&["replay", "damaged.mcap"])?.into())
            },
        ),
        fails("evidence-changed", "One bit of one file.", (1, "was changed"), |bench| {
            let key = evidence(bench, "own")?;
            let mut bytes = bench.read("run/summary.json")?;
            flip(&mut bytes)?;
            bench.write("run/summary.json", bytes)?;
            Ok(bench.octant(&["verify", "run", "--key", &key])?.into())
        }),
        fails("evidence-missing", "A file is taken away.", (1, "is missing"), |bench| {
            let key = evidence(bench, "own")?;
            let path = bench.at("run/junit.xml");
            std::fs::remove_file(&path)
                .map_err(|error| format!("remove {}: {error}", path.display()))?;
            Ok(bench.octant(&["verify", "run", "--key", &key])?.into())
        }),
        fails("evidence-added", "A file is put in.", (1, "was added"), |bench| {
            let key = evidence(bench, "own")?;
            bench.write("run/better.json", "{}")?;
            Ok(bench.octant(&["verify", "run", "--key", &key])?.into())
        }),
        fails(
            "manifest-changed",
            "A manifest that was changed with its file isn't what was signed.",
            (1, "verify the signature"),
            |bench| {
                let key = evidence(bench, "own")?;
                let text = String::from_utf8_lossy(&bench.read("run/manifest.json")?).into_owned();
                bench.write("run/manifest.json", text + "\n")?;
                Ok(bench.octant(&["verify", "run", "--key", &key])?.into())
            },
        ),
        fails(
            "signed-by-another",
            "Evidence that somebody else has signed.",
            (1, "verify the signature"),
            |bench| {
                evidence(bench, "own")?;
                let other = key_pair(bench, "other")?;
                Ok(bench.octant(&["verify", "run", "--key", &other])?.into())
            },
        ),
    ]
}

/// Lists the cases about verdicts of campaigns.
fn campaigns() -> Vec<Case> {
    vec![
        fails(
            "campaign-too-few",
            "Two runs without a failure don't show 95 %.",
            (3, "MOSTLY: inconclusive"),
            |bench| {
                campaign(bench, 2, MOSTLY, "")?;
                status(bench)
            },
        ),
        fails(
            "campaign-labels",
            "One run under four labels is one draw, whatever four would show.",
            (3, "1 of 1 independent draw passed in all of their 4 checks"),
            |bench| {
                let half = edited(MOSTLY, "95 %", "50 %")?;
                let labels = "[[factors]]\nname = \"label\"\nkey = \"title\"\n\
                              values = [\"a\", \"b\", \"c\", \"d\"]\n";
                campaign(
                    bench,
                    1,
                    &edited(&half, "confidence = \"50 %\"", "confidence = \"90 %\"")?,
                    labels,
                )?;
                status(bench)
            },
        ),
        fails(
            "campaign-broken",
            "A requirement that every case breaks.",
            (1, "ALWAYS: fail"),
            |bench| {
                campaign(bench, 2, &edited(ALWAYS, "10 nmi", "1e-9 nmi")?, "")?;
                status(bench)
            },
        ),
        fails(
            "campaign-not-run",
            "A campaign none of whose cases has run.",
            (3, "0 of 2 cases have run"),
            |bench| {
                planned(bench, 2, ALWAYS, "")?;
                status(bench)
            },
        ),
        fails(
            "campaign-unverified",
            "A requirement that no case checks.",
            (3, "ALWAYS: inconclusive"),
            |bench| {
                campaign(bench, 1, ALWAYS, "verifies = []\n")?;
                status(bench)
            },
        ),
        fails(
            "campaign-error",
            "Cases that are ended because they take too long are errors.",
            (4, "it took more than its"),
            |bench| {
                campaign(bench, 1, ALWAYS, "[limits]\ntime = \"1 ms\"\n")?;
                status(bench)
            },
        ),
        fails(
            "campaign-two-results",
            "A case that came to two results: the program isn't deterministic.",
            (4, "two results"),
            |bench| {
                campaign(bench, 1, ALWAYS, "")?;
                let (folder, id) = (bench.at("campaign"), only_case(bench)?);
                let failed = |error: ResultError| format!("failed to {error}");
                let stored =
                    CampaignResults::open(&folder).map_err(failed)?.bytes(&id).map_err(failed)?;
                let mut other = stored.ok_or("find the result of the case")?.bytes;
                other.push(b'\n');
                keep(&folder, &id, &other).map_err(failed)?;
                status(bench)
            },
        ),
        fails("plan-edited", "A plan in which a seed was changed.", (2, "plan.json"), |bench| {
            campaign(bench, 1, ALWAYS, "")?;
            let text = String::from_utf8_lossy(&bench.read("campaign/plan.json")?).into_owned();
            let plan = edited(&text, "\"seed\": 1", "\"seed\": 7")?;
            bench.write("campaign/plan.json", plan)?;
            status(bench)
        }),
    ]
}

/// Replaces one part of a text, which must be in it: a case without a change would show nothing.
fn edited(text: &str, from: &str, to: &str) -> Result<String, String> {
    if text.contains(from) {
        Ok(text.replace(from, to))
    } else {
        Err(format!("change {from:?}: it isn't there"))
    }
}

/// Returns a scenario without its faults.
fn clean(text: &str) -> Result<String, String> {
    let mut parts = text.split("[[").map(str::to_owned);
    let first = parts.next().unwrap_or_default();
    let rest: Vec<String> = parts.collect();
    if !rest.iter().any(|part| part.starts_with("faults]]")) {
        return Err("leave out the faults: there is none".to_owned());
    }
    let kept = rest.iter().filter(|part| !part.starts_with("faults]]"));
    Ok(kept.fold(first, |text, part| text + "[[" + part))
}

/// Flips one bit in the middle.
fn flip(bytes: &mut [u8]) -> Result<(), String> {
    let middle = bytes.len() / 2;
    let byte = bytes.get_mut(middle).ok_or("flip a bit: there is none")?;
    *byte ^= 1;
    Ok(())
}

/// Makes a run with every sample in its recording.
fn recorded(bench: &CaseBench<'_>) -> Result<(), CaseSetupError> {
    let short = edited(&clean(SHORT)?, "duration = \"24 min\"", "duration = \"8 min\"")?;
    let short = edited(&short, "duration = \"10 min\"", "duration = \"1 min\"")?;
    bench.run(&short, &["--set", "record.samples=full"])?.summary()?;
    Ok(())
}

/// Makes a run that is signed by a new key; returns the public key.
fn evidence(bench: &CaseBench<'_>, name: &str) -> Result<String, CaseSetupError> {
    let public = key_pair(bench, name)?;
    bench.write("scenario.toml", &clean(SHORT)?)?;
    let said = bench.octant_with(
        &["run", "scenario.toml", "--out", "run", "--no-twin"],
        &[(octant_evidence::signature::KEY, &format!("{name}.key"))],
    )?;
    needs(&said, 0).map(|()| public)
}

fn key_pair(bench: &CaseBench<'_>, name: &str) -> Result<String, CaseSetupError> {
    let failed = |error| format!("make a key: {error}");
    let pair = KeyPair::generate_unencrypted_keypair().map_err(failed)?;
    let secret = pair.sk.to_box(None).map_err(failed)?.to_string();
    let file = format!("{name}.key");
    bench.write(&file, secret)?;
    bench.keep_private(&file)?;
    Ok(pair.pk.to_base64())
}

fn only_case(bench: &CaseBench<'_>) -> Result<String, CaseSetupError> {
    let plan = octant_campaign::plan::Plan::read(&bench.at("campaign/plan.json"))
        .map_err(|error| error.to_string())?;
    let case = plan.cases.first().ok_or("find a case in the plan")?;
    Ok(case.id.to_string())
}

fn status(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let said = bench.octant(&["campaign", "status", "campaign"])?;
    // "TITLE: VERDICT" is the first line.
    let verdict = said.out.lines().next().and_then(|line| line.rsplit(": ").next());
    let verdict = Verdict::ALL.into_iter().find(|known| Some(known.name()) == verdict);
    Ok(CaseOutcome { verdict, ..said.into() })
}
