//! `octant new`: a commented scenario, from flags and from questions on a terminal.

use crate::failure::Failure;
use crate::terminal::{print, write};
use clap::{Args, ValueEnum};
use octant_evidence::manifest::shell_path;
use octant_scenario::{FLICKER, GRADES, GradeSheet, Scenario};
use octant_verdict::Verdict;
use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Arguments of `octant new`.
#[derive(Clone, Debug, Args)]
pub struct NewArguments {
    /// File of the new scenario.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Instrument, by its grade.
    #[arg(long, value_enum, value_name = "GRADE")]
    pub instrument: Option<InstrumentGrade>,
    /// Motion of the case.
    #[arg(long, value_enum, value_name = "MOTION")]
    pub motion: Option<NewMotion>,
    /// Position sequence, such as six, eight or twenty-four.
    #[arg(long, value_name = "NAME")]
    pub positions: Option<String>,
    /// Duration of the calibration, such as "4 h".
    #[arg(long, value_name = "TIME")]
    pub calibration: Option<String>,
    /// Duration of the free navigation after it, such as "24 h".
    #[arg(long, value_name = "TIME")]
    pub navigation: Option<String>,
    /// Largest radial error that a requirement allows in navigation, such as "1 nmi"; without it nothing
    /// is required.
    #[arg(long, value_name = "LENGTH")]
    pub limit: Option<String>,
    /// Title, by default the name of the file.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Ask nothing: what isn't given has its default.
    #[arg(long)]
    pub defaults: bool,
    /// Replace the file if it is there already.
    #[arg(long)]
    pub force: bool,
}

/// Motion of the case.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum NewMotion {
    /// Fixed to the ground.
    Static,
    /// On a moored ship that sways.
    Dockside,
}

/// Answers from which a scenario is written.
#[derive(Clone, Debug)]
pub struct NewAnswers {
    /// Title of the scenario.
    pub title: String,
    /// Instrument, by its grade.
    pub instrument: InstrumentGrade,
    /// Motion of the case.
    pub motion: NewMotion,
    /// Name of the position sequence.
    pub positions: String,
    /// Duration of the calibration, with its unit.
    pub calibration: String,
    /// Duration of the free navigation after it, with its unit.
    pub navigation: String,
    /// Largest radial error that a requirement allows, with its unit.
    pub limit: Option<String>,
}

pub(super) fn command(arguments: &NewArguments) -> Result<Verdict, Failure> {
    // The others are answers.
    let NewArguments {
        file,
        instrument: _,
        motion: _,
        positions: _,
        calibration: _,
        navigation: _,
        limit: _,
        title: _,
        defaults,
        force,
    } = arguments;
    if file.exists() && !force {
        return Err(Failure::input(format!(
            "found {} already, expected the name of a new file; --force replaces it",
            file.display()
        )));
    }
    let asks = !defaults && std::io::stdin().is_terminal() && std::io::stderr().is_terminal();
    let answers = answers(arguments, asks.then(|| std::io::stdin().lock()))?;
    let text = scenario(&answers);
    // The text is checked as `octant run` will check it.
    let folder = file.parent().unwrap_or(Path::new(""));
    Scenario::parse(&text, &file.display().to_string(), folder, &[]).map_err(Failure::input)?;
    write(file, &text)?;
    let (named, file) = (file.display(), shell_path(file));
    print(&format!("{named}\nnext: octant observe {file}\nnext: octant run {file}\n"))?;
    Ok(Verdict::Pass)
}

/// Collects the answers: flags, questions for the rest if there is an input that answers them, and defaults.
///
/// # Errors
/// If a flag has no meaning, or the input ends before it has answered.
pub fn answers(
    arguments: &NewArguments,
    mut input: Option<impl BufRead>,
) -> Result<NewAnswers, Failure> {
    let NewArguments {
        file,
        instrument,
        motion,
        positions,
        calibration,
        navigation,
        limit,
        title,
        // The caller's.
        defaults: _,
        force: _,
    } = arguments;
    let mut text = |name: &str, given: &Option<String>, default: &str| match given {
        Some(given) => Ok(given.clone()),
        None => ask(input.as_mut(), name, default, |text| Ok::<_, String>(text.to_owned())),
    };
    let stem = file.file_stem().map_or("new".into(), |stem| stem.to_string_lossy());
    let title = text("title", title, &stem)?;
    let positions = text("position sequence (six, eight, twelve, ...)", positions, "eight")?;
    let calibration = text("duration of the calibration", calibration, "4 h")?;
    let navigation = text("duration of the navigation", navigation, "24 h")?;
    let limit = text("limit of the radial error, or none", limit, "none")?;
    let instrument = match instrument {
        Some(grade) => *grade,
        None => ask(input.as_mut(), &choice::<InstrumentGrade>("instrument"), "table-1", named)?,
    };
    let motion = match motion {
        Some(motion) => *motion,
        None => ask(input.as_mut(), &choice::<NewMotion>("motion"), "static", named)?,
    };
    let limit = Some(limit).filter(|limit| limit != "none");
    Ok(NewAnswers { title, instrument, motion, positions, calibration, navigation, limit })
}

/// Question with its possible answers.
fn choice<T: ValueEnum>(name: &str) -> String {
    let values = T::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    let names: Vec<String> = values.map(|value| value.get_name().to_owned()).collect();
    format!("{name} ({})", names.join(", "))
}

/// Value of a name.
fn named<T: ValueEnum>(text: &str) -> Result<T, String> {
    T::from_str(text, false)
}

/// Asks until an answer is taken; an empty one is the default, which is taken without asking if there
/// is nobody to ask.
fn ask<T, E>(
    mut input: Option<&mut impl BufRead>,
    question: &str,
    default: &str,
    read: impl Fn(&str) -> Result<T, E>,
) -> Result<T, Failure> {
    loop {
        let mut line = String::new();
        if let Some(input) = input.as_mut() {
            // A terminal that has gone is noticed by the reading.
            let mut terminal = std::io::stderr().lock();
            let _ = write!(terminal, "{question} [{default}]: ").and_then(|()| terminal.flush());
            let count = input
                .read_line(&mut line)
                .map_err(|error| Failure::bench(format!("failed to read the answer: {error}")))?;
            if count == 0 {
                return Err(Failure::input("found the end of the input, expected an answer"));
            }
        }
        let answer = if line.trim().is_empty() { default } else { line.trim() };
        match read(answer) {
            Ok(value) => return Ok(value),
            Err(_) if input.is_some() => {}
            Err(_) => return Err(Failure::input(format!("{question}: found {answer:?}"))),
        }
    }
}

/// Renders a text as a TOML string.
fn quoted(text: &str) -> String {
    // Strings of JSON are strings of TOML too.
    serde_json::Value::from(text).to_string()
}

/// Renders a scenario with its comments.
#[must_use]
pub fn scenario(answers: &NewAnswers) -> String {
    let sheet = answers.instrument.sheet();
    let motion = match answers.motion {
        NewMotion::Static => "static",
        NewMotion::Dockside => "dockside",
    };
    let mut text = format!(
        "# Written by octant new. Keys that are not here have their defaults: docs/scenario.md.\n\
         schema = 1\n\
         title = {}\n\
         seed = 1  # of all random draws: the same seed gives the same bytes\n\n\
         [site]\n\
         latitude = \"30.5 deg\"\n\n\
         [motion]\n\
         kind = \"{motion}\"  # \"static\", or \"dockside\": on a moored ship that sways\n\n\
         # Source: {}.\n",
        quoted(&answers.title),
        sheet.source
    );
    for limit in sheet.limits {
        text += &format!("# {limit}\n");
    }
    text += "[imu]\n";
    let is_left_out = |key: &str| !sheet.without_flicker.is_empty() && key.ends_with(FLICKER);
    for (key, value, meaning) in sheet.imu.iter().filter(|(key, ..)| !is_left_out(key)) {
        text += &format!("{key} = {value}  # {meaning}\n");
    }
    for line in sheet.without_flicker {
        text += &format!("# {line}\n");
    }
    for (key, value, meaning) in sheet.imu.iter().filter(|(key, ..)| is_left_out(key)) {
        text += &format!("# {key} = {value}  # {meaning}\n");
    }
    text += &format!(
        "\n[procedure.calibration]\n\
         positions = {}  # octant observe tells what a sequence can estimate\n\
         duration = {}\n",
        quoted(&answers.positions),
        quoted(&answers.calibration)
    );
    if !sheet.prior.is_empty() {
        text += "\n# Standard deviations that the filter starts from: those of the instrument.\n\
                 [procedure.calibration.prior]\n";
        for (key, value) in sheet.prior {
            text += &format!("{key} = {value}\n");
        }
    }
    text += &format!("\n[procedure.navigation]\nduration = {}\n\n", quoted(&answers.navigation));
    let requirement = |limit: &str| {
        format!(
            "[[requirements]]\nid = \"NAV-1\"\ntext = \"The radial error stays within {limit}.\"\n\
             measure = \"navigation.radial_error_nmi.max\"\nlimit = \"{limit}\"\n"
        )
    };
    match &answers.limit {
        Some(limit) => text += &requirement(&limit.replace(['"', '\\'], "")),
        None => {
            text += "# Without a requirement the verdict is \"none\". Take the # away to require this:\n";
            requirement("1 nmi").lines().for_each(|line| text += &format!("# {line}\n"));
        }
    }
    text
}

/// Grade of an instrument, in the order of [`GRADES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum InstrumentGrade {
    /// Laser gyros, the reference instrument of the method's paper.
    #[value(name = "table-1")]
    Table1,
    /// Laser gyros, navigation grade: Honeywell HG9900.
    NavigationLaser,
    /// Fibre-optic gyros, navigation grade: the inertial grade of Yazdi, Ayazi and Najafi.
    NavigationFibreOptic,
    /// Fibre-optic gyros, tactical grade: Northrop Grumman LN-200.
    TacticalFibreOptic,
    /// MEMS gyros, tactical grade: Sensonor STIM300.
    TacticalMems,
}

impl InstrumentGrade {
    /// Data of this grade.
    #[must_use]
    pub fn sheet(self) -> &'static GradeSheet {
        GRADES[self as usize]
    }
}
