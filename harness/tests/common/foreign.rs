//! The FMUs of `fixtures/fmu/foreign`, compiled and packed.
//!
//! For a test of its own: `#[path = "common/foreign.rs"] mod foreign;`.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

use octant::fmu::description::{
    Causality, Description, Dimension, Experiment, Interface, Kind, Standard, Structure,
    Variability, Variable,
};
use octant::fmu::library::platforms;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Names of all of them.
pub const NAMES: [&str; 10] = [
    "gain_fmi2",
    "trouble_fmi2",
    "signals_fmi3",
    "ball_fmi2",
    "ball_fmi3",
    "vanderpol_fmi2",
    "vanderpol_fmi3",
    "dahlquist_fmi3",
    "stair_fmi3",
    "feedthrough_fmi3",
];

/// The folder with their sources.
pub fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/fmu/foreign")
}

/// Unpacked: a folder with the description and the library for this platform. It is shared between
/// tests: nobody writes there.
pub fn unpacked(name: &str) -> PathBuf {
    let place = place(name);
    let folder = place.join(name);
    if !folder.is_dir() {
        let work = tempfile::tempdir_in(place).unwrap();
        let built = work.path().join(name);
        build(name, &built);
        // Another test may have been quicker: then its folder stays.
        if std::fs::rename(&built, &folder).is_err() {
            assert!(folder.is_dir(), "{} can't be made", folder.display());
        }
    }
    folder
}

/// Packed: `NAME.fmu`. It is shared between tests: nobody writes there.
pub fn fmu(name: &str) -> PathBuf {
    let path = place(name).join(format!("{name}.fmu"));
    if !path.is_file() {
        let folder = unpacked(name);
        let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        pack(&mut archive, &folder, "");
        let bytes = archive.finish().unwrap().into_inner();
        let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap()).unwrap();
        file.write_all(&bytes).unwrap();
        file.persist(&path).unwrap();
    }
    path
}

/// A folder that belongs to these sources: with others comes another.
fn place(name: &str) -> PathBuf {
    let mut hash = blake3::Hasher::new();
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in [sources(), sources().join("models")] {
        files.extend(std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    }
    files.sort();
    for file in files.iter().filter(|file| file.is_file()) {
        hash.update(file.as_os_str().as_encoded_bytes());
        hash.update(&std::fs::read(file).unwrap());
    }
    let place = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("foreign")
        .join(format!("{}-{name}", &hash.finalize().to_hex()[..16]));
    std::fs::create_dir_all(&place).unwrap();
    place
}

/// Compiles the source that is named as the FMU, or the interface around its model.
fn build(name: &str, folder: &Path) {
    let (model, standard) = name.rsplit_once('_').unwrap();
    let platform = platforms(match standard {
        "fmi2" => Standard::Fmi2,
        _ => Standard::Fmi3,
    })[0];
    let binaries = folder.join("binaries").join(platform);
    std::fs::create_dir_all(&binaries).unwrap();
    std::fs::create_dir_all(folder.join("resources")).unwrap();
    std::fs::copy(sources().join(format!("{name}.xml")), folder.join("modelDescription.xml"))
        .unwrap();
    let own = sources().join(format!("{name}.c"));
    let library = binaries.join(format!("{name}{}", std::env::consts::DLL_SUFFIX));
    let mut gcc = Command::new("gcc");
    gcc.args(["-std=gnu11", "-O1", "-g", "-fPIC", "-shared", "-Wall", "-Wextra", "-Werror"]);
    gcc.args(["-fvisibility=default", "-Wno-infinite-recursion"]);
    if own.is_file() {
        gcc.arg(own);
    } else {
        gcc.arg(format!("-DMODEL=\"models/{model}.h\""));
        gcc.arg(sources().join(format!("continuous_{standard}.c")));
    }
    let status = gcc.arg("-o").arg(&library).arg("-lm").status();
    assert!(status.is_ok_and(|status| status.success()), "gcc has to compile {name}");
}

fn pack(archive: &mut zip::ZipWriter<std::io::Cursor<Vec<u8>>>, folder: &Path, prefix: &str) {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap()).collect();
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        let options = zip::write::SimpleFileOptions::default();
        if entry.path().is_dir() {
            archive.add_directory(format!("{name}/"), options).unwrap();
            pack(archive, &entry.path(), &format!("{name}/"));
        } else {
            archive.start_file(name, options).unwrap();
            archive.write_all(&std::fs::read(entry.path()).unwrap()).unwrap();
        }
    }
}

/// The description of one of them, as far as these tests need it.
pub fn description(name: &str) -> Description {
    let text = std::fs::read_to_string(sources().join(format!("{name}.xml"))).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let root = document.root_element();
    let standard = match root.attribute("fmiVersion") {
        Some("2.0") => Standard::Fmi2,
        _ => Standard::Fmi3,
    };
    let child = |tag: &str| root.children().find(|node| node.has_tag_name(tag));
    let interface = |tag: &str| {
        let node = child(tag)?;
        let has = |name: &str| node.attribute(name) == Some("true");
        Some(Interface {
            model_identifier: node.attribute("modelIdentifier").unwrap().into(),
            variable_step: has("canHandleVariableCommunicationStepSize"),
            state: has("canGetAndSetFMUstate") || has("canGetAndSetFMUState"),
            serialized_state: has("canSerializeFMUstate") || has("canSerializeFMUState"),
            event_mode: has("hasEventMode"),
            might_return_early: has("mightReturnEarlyFromDoStep"),
            intermediate_update: has("providesIntermediateUpdate"),
            ..Interface::default()
        })
    };
    let attribute = |name: &str| root.attribute(name).unwrap_or_default().to_owned();
    let indicators = root.attribute("numberOfEventIndicators").map_or_else(
        || root.descendants().filter(|node| node.has_tag_name("EventIndicator")).count(),
        |count| count.parse().unwrap(),
    );
    let experiment = child("DefaultExperiment");
    let seconds = |name: &str| experiment.and_then(|node| node.attribute(name)?.parse().ok());
    let variables = child("ModelVariables").unwrap();
    let mut variables: Vec<Variable> = variables
        .children()
        .filter(roxmltree::Node::is_element)
        .map(|node| variable(node, standard))
        .collect();
    if standard == Standard::Fmi2 {
        let references: Vec<u32> = variables.iter().map(|variable| variable.reference).collect();
        for variable in &mut variables {
            if let Some(index) = &mut variable.derivative_of {
                *index = references[*index as usize - 1];
            }
        }
    }
    Description {
        standard,
        fmi_version: attribute("fmiVersion"),
        model_name: attribute("modelName"),
        token: attribute("guid") + &attribute("instantiationToken"),
        description: attribute("description"),
        generation_tool: String::new(),
        structured_names: false,
        co_simulation: interface("CoSimulation"),
        model_exchange: interface("ModelExchange"),
        scheduled_execution: false,
        log_categories: Vec::new(),
        default_experiment: Experiment {
            start_s: seconds("startTime"),
            stop_s: seconds("stopTime"),
            tolerance: seconds("tolerance"),
            step_s: seconds("stepSize"),
        },
        units: Vec::new(),
        enumerations: Vec::new(),
        variables,
        structure: Structure::default(),
        event_indicators: indicators,
        tolerated: Vec::new(),
    }
}

fn variable(node: roxmltree::Node, standard: Standard) -> Variable {
    let typed = match standard {
        Standard::Fmi2 => node.first_element_child().unwrap(),
        Standard::Fmi3 => node,
    };
    let kind = match typed.tag_name().name() {
        "Real" | "Float64" => Kind::Float64,
        "Integer" | "Int32" => Kind::Int32,
        "Float32" => Kind::Float32,
        "Int8" => Kind::Int8,
        "UInt8" => Kind::UInt8,
        "Int16" => Kind::Int16,
        "UInt16" => Kind::UInt16,
        "UInt32" => Kind::UInt32,
        "Int64" => Kind::Int64,
        "UInt64" => Kind::UInt64,
        "Boolean" => Kind::Boolean,
        "String" => Kind::String,
        "Binary" => Kind::Binary,
        "Enumeration" => Kind::Enumeration,
        "Clock" => Kind::Clock,
        other => panic!("{other}"),
    };
    let causality = match node.attribute("causality") {
        Some("structuralParameter") => Causality::StructuralParameter,
        Some("parameter") => Causality::Parameter,
        Some("input") => Causality::Input,
        Some("output") => Causality::Output,
        Some("independent") => Causality::Independent,
        _ => Causality::Local,
    };
    let variability = match node.attribute("variability") {
        Some("fixed") => Variability::Fixed,
        Some("tunable") => Variability::Tunable,
        Some("continuous") => Variability::Continuous,
        _ => Variability::Discrete,
    };
    let dimension = |node: roxmltree::Node| match node.attribute("valueReference") {
        Some(reference) => Dimension::Of(reference.parse().unwrap()),
        None => Dimension::Fixed(node.attribute("start").unwrap().parse().unwrap()),
    };
    let number = |name: &str| typed.attribute(name).map(|text| text.parse().unwrap());
    Variable {
        name: node.attribute("name").unwrap().into(),
        reference: node.attribute("valueReference").unwrap().parse().unwrap(),
        description: String::new(),
        kind,
        enumeration: None,
        causality,
        variability,
        initial: None,
        dimensions: node
            .children()
            .filter(|node| node.has_tag_name("Dimension"))
            .map(dimension)
            .collect(),
        start: typed.attribute("start").into_iter().map(Into::into).collect(),
        min: number("min"),
        max: number("max"),
        nominal: number("nominal"),
        unit: None,
        display_unit: None,
        derivative_of: typed.attribute("derivative").map(|text| text.parse().unwrap()),
        clocks: node
            .attribute("clocks")
            .into_iter()
            .flat_map(|text| text.split(' ').map(|text| text.parse().unwrap()))
            .collect(),
        interval_variability: node.attribute("intervalVariability").map(Into::into),
        mime_type: None,
        line: 0,
    }
}
