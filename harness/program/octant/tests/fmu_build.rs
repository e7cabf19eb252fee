//! `octant fmu build`: the contents of the files, their agreement with the tables, and that they
//! run.

use crate::common::program::{ended, octant_in};
use octant_fmu::table::{self, Model};
use octant_fmu_build::{BuildError, Options, build};
use octant_fmu_host::archive::Archive;
use octant_fmu_host::description::{
    Causality, Description, Initial, IntervalVariability, Standard, Variability, Variable,
    VariableType, read_bytes,
};
use octant_fmu_host::instance::{self, AccessPlan, Instance, ProcessPlace, StepOutcome};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Builds the files once.
fn built() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            let folder = tempfile::tempdir().unwrap();
            build(&Options { out: folder.path().to_owned(), ..Options::default() }).unwrap();
            folder
        })
        .path()
}

/// Lists our models with the standards of their files.
fn all() -> impl Iterator<Item = (&'static Model, Standard, PathBuf)> {
    let models = [&octant_fmu::plant::table::MODEL, &octant_fmu::calibrator::table::MODEL];
    models.into_iter().flat_map(|model| {
        [(Standard::Fmi2, "fmi2"), (Standard::Fmi3, "fmi3")].map(|(standard, suffix)| {
            (model, standard, built().join(format!("{}_{suffix}.fmu", model.stem)))
        })
    })
}

/// Lists also the model on a bus, which has no table of inputs and results.
fn described() -> impl Iterator<Item = (&'static Model, Standard, PathBuf)> {
    let model = &octant_fmu::calibrator_can::table::MODEL;
    all().chain([(model, Standard::Fmi3, built().join("calibrator_can_fmi3.fmu"))])
}

fn description(path: &Path) -> Description {
    let bytes = Archive::open(path).unwrap().read("modelDescription.xml").unwrap();
    read_bytes(&bytes, "modelDescription.xml").unwrap()
}

#[test]
fn the_same_source_gives_the_same_bytes() {
    let again = tempfile::tempdir().unwrap();
    let options = Options { out: again.path().to_owned(), ..Options::default() };
    let files = build(&options).unwrap();
    assert_eq!(files.len(), 6);
    for file in files {
        let name = file.file_name().unwrap();
        let first = std::fs::read(built().join(name)).unwrap();
        assert!(first == std::fs::read(&file).unwrap(), "{} differs", name.display());
    }
}

/// Our own reader is tolerant, and finds nothing to tolerate.
#[test]
fn descriptions_say_what_the_tables_say() {
    for (model, standard, path) in described() {
        let description = description(&path);
        assert_eq!(description.tolerated, [] as [String; 0], "{}", path.display());
        assert_eq!(description.standard, standard);
        assert_eq!(description.model_name, model.name);
        assert!(description.structured_names);
        let of_library = match standard {
            Standard::Fmi2 => octant_fmu::c::ServedStandard::Fmi2,
            Standard::Fmi3 => octant_fmu::c::ServedStandard::Fmi3,
        };
        assert_eq!(description.token, octant_fmu::c::token(model, of_library));
        let interface = description.co_simulation.as_ref().unwrap();
        assert!(interface.state && interface.serialized_state);
        assert_eq!(interface.variable_step, model.is_event_driven());
        assert!(description.model_exchange.is_none() && description.scheduled_execution.is_none());
        let categories = octant_fmu::c::CATEGORIES.map(|(name, _)| name);
        assert_eq!(description.log_categories, categories);
        assert_eq!(description.default_experiment.step_s, Some(0.005));
        let mut count = usize::from(standard == Standard::Fmi3);
        for (slot, variable) in model.with_slots() {
            match standard {
                Standard::Fmi2 => {
                    for element in 0..variable.slots() {
                        let name = match variable.elements {
                            0 => variable.name.to_owned(),
                            _ => format!("{}[{}]", variable.name, element + 1),
                        };
                        let found = description.variable(&name).unwrap();
                        same(&description, found, variable, element..element + 1);
                        assert_eq!(found.reference as usize, slot + element, "{name}");
                        count += 1;
                    }
                }
                Standard::Fmi3 => {
                    let found = description.variable(variable.name).unwrap();
                    same(&description, found, variable, 0..variable.slots());
                    assert_eq!(found.reference as usize, slot, "{}", variable.name);
                    assert_eq!(found.dimensions.is_empty(), variable.elements == 0);
                    assert_eq!(description.elements(found).unwrap(), variable.slots());
                    count += 1;
                }
            }
        }
        assert_eq!(description.variables.len(), count);
    }
}

/// Compares one variable of a description with the elements of the table's variable.
fn same(
    description: &Description,
    found: &Variable,
    variable: &table::DeclaredVariable,
    elements: std::ops::Range<usize>,
) {
    let name = &found.name;
    let fmi3 = description.standard == Standard::Fmi3;
    assert!(found.description.starts_with(variable.description), "{name}");
    let kind = match variable.kind {
        table::ElementType::Real => VariableType::Float64,
        table::ElementType::Boolean => VariableType::Boolean,
        table::ElementType::Integer => VariableType::Int32,
        table::ElementType::Count if fmi3 => VariableType::UInt64,
        table::ElementType::Count => VariableType::Float64,
        table::ElementType::Enumeration(_) if fmi3 => VariableType::Enumeration,
        table::ElementType::Enumeration(_) => VariableType::Int32,
        table::ElementType::Binary(_) => VariableType::Binary,
        table::ElementType::Clock(_) => VariableType::Clock,
    };
    assert_eq!(found.kind, kind, "{name}");
    let causality = match variable.causality {
        table::DeclaredCausality::Parameter => Causality::Parameter,
        table::DeclaredCausality::CalculatedParameter => Causality::CalculatedParameter,
        table::DeclaredCausality::Input => Causality::Input,
        table::DeclaredCausality::Output => Causality::Output,
        table::DeclaredCausality::Local => Causality::Local,
    };
    assert_eq!(found.causality, causality, "{name}");
    let variability = match variable.variability {
        table::DeclaredVariability::Fixed => Variability::Fixed,
        table::DeclaredVariability::Tunable => Variability::Tunable,
        table::DeclaredVariability::Discrete => Variability::Discrete,
    };
    assert_eq!(found.variability, variability, "{name}");
    if let table::ElementType::Binary(binary) = variable.kind {
        assert_eq!(found.mime_type.as_deref(), Some(binary.mime_type), "{name}");
        let clock = description.variable(binary.clock).unwrap();
        assert_eq!(found.clocks, [clock.reference], "{name}");
        assert_eq!(found.start, vec![String::new(); found.start.len()], "{name}");
        return;
    }
    if let table::ElementType::Clock(ticks) = variable.kind {
        let expected = match ticks {
            table::Ticks::Triggered => IntervalVariability::Triggered,
            table::Ticks::Countdown => IntervalVariability::Countdown,
        };
        assert_eq!(found.clock.unwrap().interval_variability, expected, "{name}");
        return;
    }
    let given = matches!(causality, Causality::Parameter | Causality::Input);
    let expected = if given { Initial::Exact } else { Initial::Calculated };
    assert!(found.initial.is_none_or(|initial| initial == expected), "{name}");
    let start: Vec<f64> = found.start.iter().map(|text| number(text)).collect();
    let expected: Vec<f64> =
        elements.filter(|_| given).map(|element| variable.start_of(element).unwrap()).collect();
    assert_eq!(start, expected, "{name}");
    if let (Some(quantity), VariableType::Float64) = (variable.quantity, kind) {
        assert_eq!(found.unit.as_deref(), Some(quantity.unit.name), "{name}");
        assert_eq!(found.display_unit.as_deref(), quantity.display, "{name}");
        let unit = description.unit(quantity.unit.name).unwrap();
        assert_eq!(unit.base.map(|base| base.exponents), quantity.unit.exponents, "{name}");
        assert_eq!(
            unit.base.map_or(quantity.unit.factor, |base| base.factor),
            quantity.unit.factor
        );
        let found: Vec<_> =
            unit.display.iter().map(|d| (d.name.as_str(), d.factor, d.offset, d.inverse)).collect();
        let made: Vec<_> = quantity
            .unit
            .display
            .iter()
            .map(|(name, factor)| (*name, *factor, 0.0, false))
            .collect();
        assert_eq!(found, made);
    }
    if kind == VariableType::Float64 {
        assert_eq!(found.max, variable.max, "{name}");
        assert_eq!(found.nominal, variable.nominal, "{name}");
    }
}

fn number(text: &str) -> f64 {
    match text {
        "true" => 1.0,
        "false" => 0.0,
        _ => text.parse().unwrap(),
    }
}

/// Inputs and results in an FMU.
struct Table {
    names: Vec<String>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

fn csv(path: &Path, what: &str) -> Table {
    let stem = path.file_stem().unwrap().to_str().unwrap();
    let name = format!("documentation/{stem}_{what}.csv");
    let text = String::from_utf8(Archive::open(path).unwrap().read(&name).unwrap()).unwrap();
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').skip(1).map(|name| name.trim_matches('"').into());
    let names = names.collect();
    let (mut times, mut rows) = (Vec::new(), Vec::new());
    for line in lines {
        let mut cells = line.split([',', ' ']).map(|cell| cell.parse().unwrap());
        times.push(cells.next().unwrap());
        rows.push(cells.collect());
    }
    Table { names, times, rows }
}

fn plan(instance: &dyn Instance, names: &[String]) -> AccessPlan {
    let description = instance.description();
    let variables: Vec<&Variable> =
        names.iter().map(|name| description.variable(name).unwrap()).collect();
    AccessPlan::new(description, &variables).unwrap()
}

/// The library in the FMU, stepped as any other, gives the reference that is packed with it.
#[test]
fn references_are_what_the_libraries_give() {
    for (_, standard, path) in all() {
        for event_mode in [false, true] {
            if event_mode && standard == Standard::Fmi2 {
                continue;
            }
            let (inputs, results) = (csv(&path, "in"), csv(&path, "ref"));
            let options = instance::OpenOptions {
                place: ProcessPlace::ThisProcess,
                event_mode,
                ..instance::OpenOptions::default()
            };
            let mut instance = octant_fmu_host::open(&path, &options).unwrap();
            let instance = &mut *instance;
            let (set, get) = (plan(instance, &inputs.names), plan(instance, &results.names));
            instance.enter_initialization(0.0, None, None).unwrap();
            instance.exit_initialization().unwrap();
            let mut outputs = vec![0.0; get.elements];
            let mut rest = outputs.as_mut_slice();
            for group in &get.groups {
                let (these, others) = rest.split_at_mut(group.elements);
                instance.get(group, these).unwrap();
                rest = others;
            }
            let mut expected = results.times.iter().zip(&results.rows);
            let mut row = expected.next();
            let mut compared = 0;
            for (step, (time_s, values)) in inputs.times.iter().zip(&inputs.rows).enumerate() {
                assert!((time_s - step as f64 * 0.005).abs() < 1e-12);
                if let Some((at, cells)) = row.filter(|(at, _)| (*at - time_s).abs() < 1e-9) {
                    let mut cells = cells.iter();
                    for (name, place) in results.names.iter().zip(&get.places) {
                        for (found, expected) in outputs[place.clone()].iter().zip(&mut cells) {
                            let same = found.to_bits() == expected.to_bits()
                                || found.is_nan() && expected.is_nan();
                            assert!(same, "{name} at {at} s: {found}, expected {expected}");
                            compared += 1;
                        }
                    }
                    row = expected.next();
                }
                if row.is_none() {
                    break;
                }
                let mut numbers = vec![0.0; set.elements];
                let mut cells = values.iter();
                for place in &set.places {
                    for (number, cell) in numbers[place.clone()].iter_mut().zip(&mut cells) {
                        *number = *cell;
                    }
                }
                let stepped = instance
                    .exchange(&set.groups, &numbers, *time_s, 0.005, &get.groups, &mut outputs)
                    .unwrap();
                assert_eq!(stepped.outcome, StepOutcome::Done);
            }
            assert!(row.is_none() && compared == 701 * get.elements, "{}", path.display());
        }
    }
}

/// The parts that FMI-LS-BUS requires are there, and our own checker finds no problem.
#[test]
fn the_one_on_a_bus_follows_the_layered_standard() {
    let (model, _, path) = described().last().unwrap();
    assert!(model.needs_clocks());
    let checked = octant_fmu_check::check(&path).unwrap();
    let report = checked.report();
    assert!(report.findings.is_empty(), "{:#?}", report.findings);
    let manifest = "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml";
    assert!(Archive::open(&path).unwrap().read(manifest).is_ok());
    // The stepping program ticks its clocks; without a harness on the bus it only says hello.
    let options = instance::OpenOptions {
        place: ProcessPlace::ThisProcess,
        event_mode: true,
        ..instance::OpenOptions::default()
    };
    let mut instance = octant_fmu_host::open(&path, &options).unwrap();
    instance.enter_initialization(0.0, None, None).unwrap();
    instance.exit_initialization().unwrap();
    let get = plan(&*instance, &["can.waiting".to_owned(), "time".to_owned()]);
    let mut outputs = vec![f64::NAN; get.elements];
    for step in 0..10 {
        let time_s = f64::from(step) * 0.1;
        instance.exchange(&[], &[], time_s, 0.1, &get.groups, &mut outputs).unwrap();
    }
    let mut found: Vec<f64> = outputs.clone();
    found.sort_by(f64::total_cmp);
    assert_eq!(found[0], 0.0, "all was sent");
    assert!((found[1] - 1.0).abs() < 1e-9);
}

/// Parameter values of a scenario, as files.
#[test]
fn parameters_of_a_scenario_are_written_with_all_their_bits() {
    let folder = tempfile::tempdir().unwrap();
    let scenario =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/scenarios/lockstep.toml");
    let scenario = octant_scenario::Scenario::load(&scenario, &[]).unwrap();
    let method = octant_scenario::Method::Primary;
    let (_, core, _) = octant_source::configure::configurations(&scenario, method, 1).unwrap();
    let options = Options {
        out: folder.path().to_owned(),
        scenario: Some(("lockstep".into(), scenario)),
        ..Options::default()
    };
    build(&options).unwrap();
    let expected: Vec<u64> = octant_fmu::calibrator::start_values(&core)
        .into_iter()
        .flat_map(|(_, values)| values)
        .map(f64::to_bits)
        .collect();
    let mut reader = csv::Reader::from_path(folder.path().join("calibrator_lockstep.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let values: Vec<u64> = rows.iter().map(|row| number(&row[3]).to_bits()).collect();
    assert!(values == expected);
    let dwell = rows.iter().find(|row| &row[0] == "procedure.navigation.dwell").unwrap();
    assert_eq!((&dwell[3], &dwell[4]), ("20", "s"));

    let text = std::fs::read_to_string(folder.path().join("calibrator_lockstep.ssv")).unwrap();
    let file = roxmltree::Document::parse(&text).unwrap();
    let parameters = file.descendants().filter(|node| node.has_tag_name_ns("Parameter"));
    let values: Vec<u64> = parameters
        .map(|node| {
            let value = node.first_element_child().unwrap().attribute("value").unwrap();
            number(value).to_bits()
        })
        .collect();
    assert!(values == expected);
}

trait Named {
    fn has_tag_name_ns(&self, name: &str) -> bool;
}

impl Named for roxmltree::Node<'_, '_> {
    fn has_tag_name_ns(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

fn fails(options: Options) -> BuildError {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let error = build(&Options { out: out.clone(), ..options }).unwrap_err();
    assert!(!out.exists(), "files of a build that failed");
    error
}

#[test]
fn what_can_not_be_built_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let library = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Options { libraries: vec![path], ..Options::default() }
    };
    let error = fails(library("text.so", b"not a library")).to_string();
    assert!(error.contains("text.so") && error.contains("no shared library"), "{error}");
    // A program isn't one of our libraries.
    let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
    let error = fails(library("program.so", &program)).to_string();
    assert!(error.contains("program.so") && error.contains("fmi2Instantiate"), "{error}");
    let gone = Options { libraries: vec![folder.path().join("gone.so")], ..Options::default() };
    let error = fails(gone).to_string();
    assert!(error.contains("failed to read") && error.contains("gone.so"), "{error}");
    let target = Options { targets: vec!["z80-unknown-cpm".into()], ..Options::default() };
    let error = fails(target).to_string();
    assert!(error.contains("z80-unknown-cpm") && error.contains("knows no target"), "{error}");
}

#[test]
fn the_command_builds_without_references_and_lists_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["fmu", "build", "--out", "here", "--without-reference", "--json"];
    let (said, _) = ended(octant_in(folder.path(), &words), 0);
    let found: serde_json::Value = serde_json::from_str(&said).unwrap();
    let files = found["files"].as_array().unwrap();
    assert!(files.iter().any(|file| file == "here/calibrator_fmi3.fmu"), "{found}");
    for file in files {
        assert!(folder.path().join(file.as_str().unwrap()).is_file(), "{file}");
    }
    let size = |folder: &Path| folder.join("calibrator_fmi3.fmu").metadata().unwrap().len();
    assert!(size(&folder.path().join("here")) < size(built()));
}
