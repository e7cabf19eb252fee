//! `SystemStructure.ssd`: systems, components, connectors, connections and parameter bindings.

pub use super::parts::{
    Binding, Connection, ConnectionEnd, Connector, ConnectorKind, ConnectorType,
    DictionaryReference, Implementation, SignalDictionary, SspSystem, SystemComponent,
    SystemElement,
};

mod nested;

use super::SspError;
use super::annotation::{self, CoSimulation};
use super::connectors::connectors;
use super::dictionary;
use super::package::Package;
use super::parameters::{self, SystemEnumeration, TRANSFORMATIONS};
use super::xml::{self, Element, SSB, SSD};
use octant_fmu_host::description::BaseUnit;
use std::cell::RefCell;

/// Maximum nesting depth of systems: far more than any design has.
const DEPTH_MAX: usize = 64;

/// A system structure.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemStructure {
    /// The file.
    pub file: String,
    /// Name.
    pub name: String,
    /// The outermost system.
    pub system: SspSystem,
    /// Units by name.
    pub units: Vec<(String, BaseUnit)>,
    /// Enumerations.
    pub enumerations: Vec<SystemEnumeration>,
    /// Start of the default experiment, s.
    pub start_s: Option<f64>,
    /// End of the default experiment, s.
    pub stop_s: Option<f64>,
    /// Settings for this program alone.
    pub co_simulation: CoSimulation,
    /// Step in the annotations of the Open Simulation Platform, or of OMSimulator, s.
    pub others_step_s: Option<f64>,
    /// Deviations from the standard that were read all the same.
    pub warnings: Vec<String>,
}

impl SystemStructure {
    /// Reads the structure of a package.
    ///
    /// # Errors
    /// If a file can't be read, or asks for something that this program can't do.
    pub fn read(package: &Package) -> Result<Self, SspError> {
        Self::read_at(package, 0)
    }

    /// Reads a structure at a depth within others.
    fn read_at(package: &Package, depth: usize) -> Result<Self, SspError> {
        let text = package.text_of(package.structure())?;
        let file = package.name_of(package.structure());
        let text = xml::declared(&text, &file, &package.warnings);
        let document = xml::parse(&text, &file)?;
        let top = (SSD, "SystemStructureDescription");
        let root = Element::root(&document, &file, &package.warnings, top)?;
        parameters::version(&root)?;
        root.only(
            &[
                "version",
                "name",
                "author",
                "fileversion",
                "copyright",
                "license",
                "generationTool",
                "generationDateAndTime",
            ],
            &[(SSD, "System"), (SSD, "Enumerations"), (SSD, "Units"), (SSD, "DefaultExperiment")],
        )?;
        let Some(system) = root.child(SSD, "System")? else {
            return Err(root.error("the element <System> is missing"));
        };
        let mut units = match root.child(SSD, "Units")? {
            Some(units) => parameters::units(&units)?,
            None => Vec::new(),
        };
        let mut enumerations = match root.child(SSD, "Enumerations")? {
            Some(enumerations) => parameters::enumerations(&enumerations)?,
            None => Vec::new(),
        };
        let (mut start_s, mut stop_s, mut osp_step_s) = (None, None, None);
        if let Some(experiment) = root.child(SSD, "DefaultExperiment")? {
            experiment.only(&["startTime", "stopTime"], &[])?;
            start_s = experiment.finite("startTime")?;
            stop_s = experiment.finite("stopTime")?;
            osp_step_s = annotation::osp_step_s(&experiment)?;
        }
        let others_step_s = match osp_step_s {
            Some(step_s) => Some(step_s),
            None => annotation::oms_step_s(&system)?,
        };
        let reader = Reader { package, units: &units, parts: RefCell::default() };
        let system = reader.system(&system, depth)?;
        let parts = reader.parts.take();
        units.extend(parts.units);
        enumerations.extend(parts.enumerations);
        Ok(Self {
            name: root.optional("name").unwrap_or_default().to_owned(),
            system,
            units,
            enumerations,
            start_s,
            stop_s,
            co_simulation: annotation::of(&root, package)?,
            others_step_s,
            warnings: package.warnings.take(),
            file: file.clone(),
        })
    }
}

/// Units and enumerations that systems within a structure define.
#[derive(Debug, Default)]
struct Definitions {
    units: Vec<(String, BaseUnit)>,
    enumerations: Vec<SystemEnumeration>,
}

/// Returns whether a component is a package or an `.ssd`; `None`: it is neither.
fn part_kind(element: &Element<'_>) -> Option<bool> {
    match element.optional("type")? {
        "application/x-ssp-definition" => Some(false),
        "application/x-ssp-package" => Some(true),
        _ => None,
    }
}

struct Reader<'p> {
    package: &'p Package,
    /// Units of the structure's file.
    units: &'p [(String, BaseUnit)],
    parts: RefCell<Definitions>,
}

/// Children that every element of a system may have.
const ELEMENT: [(&str, &str); 2] = [(SSD, "Connectors"), (SSD, "ParameterBindings")];

impl Reader<'_> {
    fn system(&self, element: &Element<'_>, depth: usize) -> Result<SspSystem, SspError> {
        if depth > DEPTH_MAX {
            return Err(element.error(format!("systems are more than {DEPTH_MAX} levels deep")));
        }
        let mut elements = ELEMENT.to_vec();
        elements.extend([(SSD, "Elements"), (SSD, "Connections"), (SSD, "SignalDictionaries")]);
        element.only(&["name"], &elements)?;
        let mut system = SspSystem {
            name: element.optional("name").unwrap_or_default().to_owned(),
            connectors: connectors(element, self.units, false)?,
            elements: Vec::new(),
            connections: Vec::new(),
            bindings: self.bindings(element, None)?,
            dictionaries: self.dictionaries(element)?,
            line: element.line(),
        };
        if let Some(parts) = element.child(SSD, "Elements")? {
            parts.only(
                &[],
                &[(SSD, "Component"), (SSD, "System"), (SSD, "SignalDictionaryReference")],
            )?;
            for part in parts.children() {
                let part_read = match part.name() {
                    "Component" => match part_kind(&part) {
                        Some(is_package) => {
                            SystemElement::System(self.nested(&part, is_package, depth + 1)?)
                        }
                        None => SystemElement::Component(self.component(&part)?),
                    },
                    "System" => {
                        part.required("name")?;
                        SystemElement::System(self.system(&part, depth + 1)?)
                    }
                    "SignalDictionaryReference" => {
                        SystemElement::Dictionary(self.reference(&part)?)
                    }
                    _ => continue,
                };
                if part_read.name().is_empty() {
                    return Err(part.error("the name is empty"));
                }
                if system.elements.iter().any(|known| known.name() == part_read.name()) {
                    return Err(part.error("the name is taken by another element of the system"));
                }
                system.elements.push(part_read);
            }
        }
        if let Some(list) = element.child(SSD, "Connections")? {
            list.only(&[], &[(SSD, "Connection")])?;
            for connection in list.children().filter(|child| child.is(SSD, "Connection")) {
                system.connections.push(self::connection(&connection)?);
            }
        }
        Ok(system)
    }

    /// Reads the dictionaries that a system defines.
    fn dictionaries(&self, system: &Element<'_>) -> Result<Vec<SignalDictionary>, SspError> {
        let mut dictionaries: Vec<SignalDictionary> = Vec::new();
        let Some(list) = system.child(SSD, "SignalDictionaries")? else {
            return Ok(dictionaries);
        };
        list.only(&[], &[(SSD, "SignalDictionary")])?;
        for element in list.children().filter(|child| child.is(SSD, "SignalDictionary")) {
            element.only(&["name", "type", "source"], &[(SSB, "SignalDictionary")])?;
            let name = element.required("name")?;
            if dictionaries.iter().any(|known| known.name == name) {
                return Err(element.error("found a second time, expected unique names"));
            }
            let mut dictionary = self.part(
                &element,
                Some(element),
                ("SignalDictionary", "application/x-ssp-signal-dictionary"),
                None,
                dictionary::dictionary,
            )?;
            name.clone_into(&mut dictionary.name);
            dictionaries.push(dictionary);
        }
        Ok(dictionaries)
    }

    fn reference(&self, element: &Element<'_>) -> Result<DictionaryReference, SspError> {
        element.only(&["name", "dictionary"], &ELEMENT)?;
        Ok(DictionaryReference {
            name: element.required("name")?.to_owned(),
            dictionary: element.required("dictionary")?.to_owned(),
            connectors: connectors(element, self.units, true)?,
            bindings: self.bindings(element, None)?,
            line: element.line(),
        })
    }

    fn component(&self, element: &Element<'_>) -> Result<SystemComponent, SspError> {
        element.only(&["name", "type", "source", "implementation"], &ELEMENT)?;
        match element.optional("type").unwrap_or("application/x-fmu-sharedlibrary") {
            "application/x-fmu-sharedlibrary" => {}
            other => {
                return Err(element.error(format!(
                    "the type {other:?} was found, expected application/x-fmu-sharedlibrary, \
                     application/x-ssp-definition or application/x-ssp-package: FMUs and systems of \
                     them can be run"
                )));
            }
        }
        let Some(source) = element.optional("source") else {
            return Err(element.error("it has no source: there is no FMU to be run"));
        };
        let file =
            self.package.resolve(source).map_err(|error| element.error(error.to_string()))?;
        let implementation = match element.optional("implementation").unwrap_or("any") {
            "any" => Implementation::Any,
            "CoSimulation" => Implementation::CoSimulation,
            "ModelExchange" => Implementation::ModelExchange,
            other => {
                return Err(element.error(format!(
                    "implementation is {other:?}, expected any, CoSimulation or ModelExchange"
                )));
            }
        };
        Ok(SystemComponent {
            name: element.required("name")?.to_owned(),
            source: source.to_owned(),
            implementation,
            connectors: connectors(element, self.units, false)?,
            bindings: self.bindings(element, Some(source))?,
            line: element.line(),
            file,
        })
    }

    /// Reads the bindings of an element; `component` is the source of the component, to which some
    /// sources are relative.
    fn bindings(
        &self,
        element: &Element<'_>,
        component: Option<&str>,
    ) -> Result<Vec<Binding>, SspError> {
        let mut bindings = Vec::new();
        let lists = element.several(SSD, "ParameterBindings");
        for list in &lists {
            list.only(&[], &[(SSD, "ParameterBinding")])?;
        }
        let all = lists.iter().flat_map(Element::children);
        for binding in all.filter(|child| child.is(SSD, "ParameterBinding")) {
            binding.only(
                &["type", "source", "sourceBase", "prefix"],
                &[(SSD, "ParameterValues"), (SSD, "ParameterMapping")],
            )?;
            let values = self.part(
                &binding,
                binding.child(SSD, "ParameterValues")?,
                ("ParameterValues", "application/x-ssp-parameter-set"),
                component,
                |root| {
                    // The units of the structure are those of its own file alone.
                    let is_inline = root.file == binding.file;
                    parameters::parameter_set(root, if is_inline { self.units } else { &[] })
                },
            )?;
            let mapping = match binding.child(SSD, "ParameterMapping")? {
                Some(mapping) => {
                    mapping.only(
                        &["type", "source", "sourceBase"],
                        &[(xml::SSM, "ParameterMapping")],
                    )?;
                    Some(self.part(
                        &mapping,
                        Some(mapping),
                        ("ParameterMapping", "application/x-ssp-parameter-mapping"),
                        component,
                        parameters::mapping,
                    )?)
                }
                None => None,
            };
            bindings.push(Binding {
                values,
                mapping,
                prefix: binding.optional("prefix").unwrap_or_default().to_owned(),
                line: binding.line(),
            });
        }
        Ok(bindings)
    }

    /// Reads a parameter set or mapping: from the file that `element` names, or from `inline`.
    fn part<T>(
        &self,
        element: &Element<'_>,
        inline: Option<Element<'_>>,
        (name, mime): (&str, &str),
        component: Option<&str>,
        read: impl Fn(&Element<'_>) -> Result<T, SspError>,
    ) -> Result<T, SspError> {
        if let Some(found) = element.optional("type").filter(|found| *found != mime) {
            return Err(element.error(format!("the type {found:?} was found, expected {mime}")));
        }
        let inside = inline.as_ref().and_then(|inline| inline.children().next());
        let Some(source) = element.optional("source") else {
            return match inside {
                Some(inside) => read(&inside),
                None => Err(element.error(format!("neither a source nor a <{name}> was found"))),
            };
        };
        if inside.is_some() {
            return Err(element.error(format!("both a source and a <{name}> were found")));
        }
        match element.optional("sourceBase").unwrap_or("SSD") {
            "SSD" => {}
            "component" => {
                let of = component.map_or_else(String::new, |source| format!(" {source}"));
                return Err(element.error(format!(
                    "sourceBase \"component\" is not part of this version: put the file beside the \
                     FMU{of}"
                )));
            }
            other => {
                let message = format!("sourceBase is {other:?}, expected SSD or component");
                return Err(element.error(message));
            }
        }
        let path =
            self.package.resolve(source).map_err(|error| element.error(error.to_string()))?;
        let text = self.package.text_of(&path)?;
        let file = self.package.name_of(&path);
        let text = xml::declared(&text, &file, &self.package.warnings);
        let document = xml::parse(&text, &file)?;
        let warnings = &self.package.warnings;
        read(&Element { node: document.root_element(), file: &file, warnings })
    }
}

fn connection(element: &Element<'_>) -> Result<Connection, SspError> {
    element.only(
        &["startElement", "startConnector", "endElement", "endConnector", "suppressUnitConversion"],
        &TRANSFORMATIONS,
    )?;
    let end = |of: &str, connector: &str| {
        let name = element.optional(of);
        if name == Some("") {
            element.warn(format!("{of} is empty: it is read as left out, which is the system"));
        }
        Ok(ConnectionEnd {
            element: name.filter(|name| !name.is_empty()).map(str::to_owned),
            connector: element.required(connector)?.to_owned(),
        })
    };
    Ok(Connection {
        start: end("startElement", "startConnector")?,
        end: end("endElement", "endConnector")?,
        suppress_unit_conversion: element.boolean("suppressUnitConversion")?.unwrap_or(false),
        transformation: parameters::transformation(element)?,
        line: element.line(),
    })
}
