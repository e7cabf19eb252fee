//! Files that a scenario names: listed, and read from other places than those that it names.

use super::keys::key;
use super::model::{DescriptionChoice, FileName, Scenario};
use octant_toml_tree::{Table, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const SOURCE: &str = key!(source.uri);
const ENDPOINT: &str = key!(endpoint.uri);
const DIALECT: &str = key!(turntable.drive.dialect);
const OF_PORT: &str = key!(source.live.description);
const OF_LOG: &str = key!(source.log.description);

/// Keys whose text is the name of a file, or a URI with one.
const KEYS: [&str; 12] = [
    SOURCE,
    ENDPOINT,
    key!(source.trajectory.file),
    key!(source.text.gyro.file),
    key!(source.text.accelerometer.file),
    key!(source.reference.file),
    key!(source.live.database),
    key!(source.live.mapping),
    OF_PORT,
    OF_LOG,
    DIALECT,
    key!(procedure.initial_parameters.table),
];

/// Places of files by their names as a scenario writes them: the scenario stays the same text when its
/// files are somewhere else.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FilePlaces(BTreeMap<String, PathBuf>);

impl FilePlaces {
    /// Returns the place of a file; `None` if it is where its name says.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<&Path> {
        self.0.get(name).map(PathBuf::as_path)
    }
}

impl FromIterator<(String, PathBuf)> for FilePlaces {
    fn from_iter<I: IntoIterator<Item = (String, PathBuf)>>(places: I) -> Self {
        Self(places.into_iter().collect())
    }
}

impl Scenario {
    /// Lists the files that the scenario names, as written, each once.
    #[must_use]
    pub fn files(&self) -> Vec<FileName> {
        let mut names: Vec<FileName> = Vec::new();
        // Nothing is replaced in the copy.
        replace(&mut self.document.clone(), |name| {
            if !names.iter().any(|known| known.0 == name) {
                names.push(FileName(name.to_owned()));
            }
            None
        });
        names
    }

    /// Lists the devices and programs outside of this one that a run of the scenario talks to, by their
    /// URIs.
    #[must_use]
    pub fn devices(&self) -> Vec<String> {
        let source = self.source.instrument().map(|instrument| instrument.uri.to_string());
        let source = source.or_else(|| Some(self.solution_line()?.uri.to_string()));
        let endpoint = self.endpoint.device().map(|live| live.uri.to_string());
        let table = self.drive.as_ref().map(|drive| drive.port.clone());
        source.into_iter().chain(endpoint).chain(table).collect()
    }
}

/// Puts the places of files into a document.
pub(crate) fn put_places(document: &mut Table, places: &FilePlaces) {
    replace(document, |name| places.of(name).map(|place| place.display().to_string()));
}

/// Replaces the names of files in a document by what `place` returns for them.
pub(crate) fn replace(document: &mut Table, mut place: impl FnMut(&str) -> Option<String>) {
    for key in KEYS {
        let Some(found) = document.at(key).cloned() else { continue };
        let Value::Text(written) = &found.value else { continue };
        let (scheme, file) = match (key, written.split_once(':')) {
            (DIALECT, _) if written == octant_turntable::Dialect::BUILT_IN => {
                continue;
            }
            (OF_PORT | OF_LOG, _) if !DescriptionChoice::is_file(written) => {
                continue;
            }
            (SOURCE | ENDPOINT, None) => continue,
            // A port, which is no file.
            (SOURCE, Some(_)) if octant_link::Uri::is_one(written) => continue,
            (SOURCE, Some(("solution", port))) if octant_link::Uri::is_one(port) => continue,
            (ENDPOINT, Some((scheme, _))) if scheme != "fmu" => continue,
            (SOURCE | ENDPOINT, Some((scheme, file))) => (Some(scheme), file),
            _ => (None, written.as_str()),
        };
        if file.is_empty() {
            continue;
        }
        if let Some(place) = place(file) {
            let text = scheme.map_or_else(|| place.clone(), |scheme| format!("{scheme}:{place}"));
            let mut node = found.clone();
            node.value = Value::Text(text);
            document.set_at(key, node);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1
title = \"files\"
[source]
uri = \"fmu:../ship.fmu\"
[source.fmu.map]
[endpoint]
uri = \"fmu:core.fmu\"
[procedure.navigation]
duration = \"1 min\"
";

    #[test]
    fn files_are_listed_as_written_and_found_in_other_places() {
        let mut document = octant_toml_tree::parse(TEXT).unwrap();
        let mut names = Vec::new();
        replace(&mut document, |name| {
            names.push(name.to_owned());
            None
        });
        assert_eq!(names, ["../ship.fmu", "core.fmu"]);
        let text = |document: &Table, key: &str| match &document.at(key).unwrap().value {
            Value::Text(text) => text.clone(),
            other => panic!("{other:?}"),
        };
        assert_eq!(text(&document, "source.uri"), "fmu:../ship.fmu");
        let places = [("core.fmu".to_owned(), PathBuf::from("/b c/core.fmu"))];
        put_places(&mut document, &places.into_iter().collect());
        assert_eq!(text(&document, "source.uri"), "fmu:../ship.fmu");
        assert_eq!(text(&document, "endpoint.uri"), "fmu:/b c/core.fmu");
    }

    #[test]
    fn devices_and_built_in_names_are_no_files() {
        for uri in ["serial:/dev/ttyUSB0", "udp:127.0.0.1:9000", "plant"] {
            let text = format!("[source]\nuri = \"{uri}\"\n[endpoint]\nuri = \"exec:./core\"\n");
            let mut document = octant_toml_tree::parse(&text).unwrap();
            replace(&mut document, |name| panic!("{name}"));
        }
        let text = "[source]\n[source.log]\ndescription = \"kvh-1775-rate\"\n[source.live]\ndescription = \"own.toml\"\n";
        let mut names = Vec::new();
        replace(&mut octant_toml_tree::parse(text).unwrap(), |name| {
            names.push(name.to_owned());
            None
        });
        assert_eq!(names, ["own.toml"]);
    }
}
