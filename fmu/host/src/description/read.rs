//! Parts that both standards share: the head of the description, units and interfaces.

use super::attributes::optional;
use super::schema::{self, Breaks};
use super::xml::{Element, File};
use super::{
    BaseUnit, Causality, DefaultExperiment, Description, DescriptionError, DisplayUnit, Initial,
    ModelStructure, Standard, UnitDefinition, VariableType, fmi2, fmi3, text,
};
use std::collections::BTreeSet;

/// Reads a model description from the bytes of its file; `file` is its name in messages.
///
/// # Errors
/// If the encoding is unknown; otherwise as [`read`].
pub fn read_bytes(bytes: &[u8], file: &str) -> Result<Description, DescriptionError> {
    if text::is_of_fmi_1(bytes) {
        return Err(of_fmi_1(file));
    }
    let (text, mut tolerated) = text::decode(bytes, file)?;
    let mut description = read(&text, file)?;
    tolerated.append(&mut description.tolerated);
    description.tolerated = tolerated;
    Ok(description)
}

/// Error for an FMU of FMI 1.0, before anything else is said of it.
#[must_use]
pub fn of_fmi_1(file: &str) -> DescriptionError {
    DescriptionError {
        file: file.to_owned(),
        line: None,
        place: "fmiModelDescription fmiVersion".to_owned(),
        found: "an FMU of FMI 1.0, which this program doesn't run".to_owned(),
        expected: "FMI 2.0 or 3.0: most tools export the model anew in one of them".to_owned(),
    }
}

/// Reads a model description of FMI 2.0 or FMI 3.0; `file` is its name in messages.
///
/// # Errors
/// If the text isn't XML, is of another version, or contains a part without a meaning: element and
/// attribute, the text found and the text expected.
pub fn read(text: &str, file: &str) -> Result<Description, DescriptionError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let tree = text.trim_start();
    let found_blanks = tree.len() < text.len() && tree.starts_with("<?xml ");
    // The declaration has to be first. Blanks replace it, so that line numbers stay right.
    let mut text = std::borrow::Cow::Borrowed(text);
    if found_blanks && let Some(end) = text.find("?>").map(|end| end + 2) {
        let blanks = text[..end].replace(|c: char| c != '\n', " ");
        text = (blanks + &text[end..]).into();
    }
    let file = File::new(file, &text);
    if found_blanks {
        file.tolerate("blanks before XML", 1, || "blanks before the XML declaration".into());
    }
    let document = file.parse(&text)?;
    let root = Element::root(&file, &document);
    if root.name() != "fmiModelDescription" {
        let found = format!("the root element is {:?}", root.name());
        return Err(root.error(None, found, "fmiModelDescription"));
    }
    let standard = standard(root)?;
    let mut description = Description {
        file: file.name().to_owned(),
        standard,
        fmi_version: root.required("fmiVersion")?.to_owned(),
        model_name: optional(root, "modelName"),
        token: String::new(),
        description: optional(root, "description"),
        version: optional(root, "version"),
        generation_tool: optional(root, "generationTool"),
        structured_names: root
            .one_of("variableNamingConvention", &[("flat", false), ("structured", true)])?
            .unwrap_or(false),
        co_simulation: None,
        model_exchange: None,
        scheduled_execution: None,
        log_categories: Vec::new(),
        default_experiment: DefaultExperiment::default(),
        units: Vec::new(),
        enumerations: Vec::new(),
        variables: Vec::new(),
        structure: ModelStructure::default(),
        event_indicators: 0,
        tolerated: Vec::new(),
    };
    if root.text("modelName").is_none() {
        root.tolerate("missing modelName", || "modelName is missing".into());
    }
    for element in root.children() {
        match element.name() {
            "UnitDefinitions" => description.units = units(element)?,
            "LogCategories" => {
                description.log_categories = element
                    .children()
                    .filter_map(|category| category.text("name"))
                    .map(str::to_owned)
                    .collect();
            }
            "DefaultExperiment" => {
                description.default_experiment = DefaultExperiment {
                    start_s: element.real("startTime")?,
                    stop_s: element.real("stopTime")?,
                    tolerance: element.real("tolerance")?,
                    step_s: element.real("stepSize")?,
                };
            }
            _ => {}
        }
    }
    match standard {
        Standard::Fmi2 => fmi2::read(root, &mut description)?,
        Standard::Fmi3 => fmi3::read(root, &mut description)?,
    }
    if description.co_simulation.is_none()
        && description.model_exchange.is_none()
        && description.scheduled_execution.is_none()
    {
        let expected = match standard {
            Standard::Fmi2 => "CoSimulation or ModelExchange",
            Standard::Fmi3 => "CoSimulation, ModelExchange or ScheduledExecution",
        };
        return Err(root.error(None, "no interface", expected));
    }
    names_and_units(root, &description);
    unknown(root, standard);
    description.tolerated = file.tolerated();
    Ok(description)
}

/// Reads the standard from `fmiVersion`.
fn standard(root: Element<'_, '_>) -> Result<Standard, DescriptionError> {
    let version = root.required("fmiVersion")?;
    match version.trim() {
        "2.0" => Ok(Standard::Fmi2),
        "3.0" => Ok(Standard::Fmi3),
        other => {
            let numbers: Option<Vec<u32>> =
                other.split('.').map(|part| part.parse().ok()).collect();
            let standard = match numbers.as_deref() {
                Some([2, 0, ..]) => Some(Standard::Fmi2),
                // Minor versions add parts that importers of 3.0 may ignore.
                Some([3, ..]) => Some(Standard::Fmi3),
                _ => None,
            };
            let Some(standard) = standard else {
                return Err(root.error(Some("fmiVersion"), format!("{version:?}"), "2.0 or 3.0"));
            };
            root.tolerate("version", || {
                let read = if standard == Standard::Fmi2 { "2.0" } else { "3.0" };
                format!("fmiVersion {version:?} is read as {read}")
            });
            Ok(standard)
        }
    }
}

/// Reads units with their factors.
fn units(list: Element<'_, '_>) -> Result<Vec<UnitDefinition>, DescriptionError> {
    let mut units: Vec<UnitDefinition> = Vec::new();
    let mut names = BTreeSet::new();
    for element in list.children().filter(|child| child.name() == "Unit") {
        let name = element.required("name")?.to_owned();
        if !names.insert(name.clone()) {
            element.tolerate("unit twice", || "the unit is defined twice, the first counts".into());
            continue;
        }
        let base = match element.child("BaseUnit") {
            Some(child) => base_unit(child)?,
            None => None,
        };
        let mut display = Vec::new();
        for child in element.children().filter(|child| child.name() == "DisplayUnit") {
            let name = child.required("name")?.to_owned();
            if let Some((factor, offset)) = conversion(child)? {
                display.push(DisplayUnit {
                    name,
                    factor,
                    offset,
                    inverse: child.boolean("inverse")?,
                });
            }
        }
        units.push(UnitDefinition { name, base, display });
    }
    Ok(units)
}

fn base_unit(element: Element<'_, '_>) -> Result<Option<BaseUnit>, DescriptionError> {
    let mut exponents = [0; 8];
    for (exponent, name) in exponents.iter_mut().zip(super::units::BASE_NAMES) {
        *exponent = element.whole(name)?.unwrap_or(0);
    }
    let base = |(factor, offset)| BaseUnit { exponents, factor, offset };
    Ok(conversion(element)?.map(base))
}

/// Reads factor and offset; `None` if they can't be used for conversion.
fn conversion(element: Element<'_, '_>) -> Result<Option<(f64, f64)>, DescriptionError> {
    let factor = element.real("factor")?.unwrap_or(1.0);
    let offset = element.real("offset")?.unwrap_or(0.0);
    if factor == 0.0 || !factor.is_finite() || !offset.is_finite() {
        element.tolerate("unit without a meaning", || {
            format!("factor {factor} and offset {offset} convert nothing, left out")
        });
        return Ok(None);
    }
    Ok(Some((factor, offset)))
}

/// Notes elements and attributes that are not in the standard: they are ignored.
fn unknown(root: Element<'_, '_>, standard: Standard) {
    let schema = match standard {
        Standard::Fmi2 => &schema::FMI2,
        Standard::Fmi3 => &schema::FMI3,
    };
    schema::walk(root, schema, &mut |violation| {
        // A start attribute that should be an element is read all the same.
        if violation.place.ends_with(", start") {
            return;
        }
        let kind = match violation.breaks {
            Breaks::UnknownElement => "unknown element",
            Breaks::UnknownAttribute => "unknown attribute",
            // Other violations were noted when they were read.
            _ => return,
        };
        root.file().tolerate(kind, violation.line, || {
            format!("{}: {}, left out", violation.place, violation.found)
        });
    });
}

/// Notes names that occur twice and units that aren't defined.
fn names_and_units(root: Element<'_, '_>, description: &Description) {
    let mut names = BTreeSet::new();
    let units: BTreeSet<&str> = description.units.iter().map(|unit| unit.name.as_str()).collect();
    let file = root.file();
    for variable in &description.variables {
        let aliases = variable.aliases.iter().map(|alias| &alias.name);
        for name in std::iter::once(&variable.name).chain(aliases) {
            if !names.insert(name.as_str()) {
                file.tolerate("name twice", variable.line, || {
                    format!("the name {name:?} is there twice, the first counts")
                });
            }
        }
        if let Some(unit) = &variable.unit
            && !units.contains(unit.as_str())
        {
            file.tolerate("unit not defined", variable.line, || {
                format!("the unit {unit:?} of {:?} is not defined", variable.name)
            });
        }
        let start = !variable.start.is_empty();
        if start && variable.initial == Some(Initial::Calculated) {
            file.tolerate("start of a calculated variable", variable.line, || {
                format!("{:?} is calculated, but has a start value", variable.name)
            });
        }
        let needs_start = matches!(variable.initial, Some(Initial::Exact | Initial::Approx))
            || variable.causality == Causality::Input;
        if !start && needs_start && variable.kind != VariableType::Clock {
            file.tolerate("missing start", variable.line, || {
                format!("{:?} has no start value", variable.name)
            });
        }
    }
}
