//! Arguments of a command line that change a document: `--set` and `--fire`.

use super::error::{Place, Problem};
use super::keys::{Kind, SCENARIO};
use octant_base::names::suggestion;
use octant_toml_tree::{Node, Table, Value, controls_of_argument, parse_argument};

/// Applies a `--set KEY=VALUE` to a document: KEY is a dotted path, VALUE is TOML or a text without
/// quotes.
pub fn override_set(document: &mut Table, argument: &str) -> Result<(), Problem> {
    let whole = format!("--set {argument}");
    let problem = |path: &str, message: String| Problem {
        place: Place::Argument(whole.clone()),
        path: path.to_owned(),
        message,
    };
    let Some((path, value)) = argument.split_once('=') else {
        let message = "expected KEY=VALUE, such as procedure.calibration.duration=12 h".to_owned();
        return Err(problem("", message));
    };
    let path = path.trim();
    let node = parse_argument(value, &whole);
    if let Some(problem) = controls_of_argument(path, &node) {
        return Err(problem);
    }
    if let Some((id, key)) = path.strip_prefix("faults.").and_then(|rest| rest.split_once('.')) {
        // The keys of a fault depend on its kind: they are checked with those of the file.
        let fault = fault_of(document, id).map_err(|message| problem(path, message))?;
        fault.set_at(key, parse_argument(value, &whole));
        return Ok(());
    }
    let mut section = SCENARIO;
    let mut names = path.split('.').peekable();
    while let Some(name) = names.next() {
        let Some(key) = section.key(name) else {
            let known = suggestion(name, section.names(), "known here");
            return Err(problem(path, format!("unknown key {name:?}, {known}")));
        };
        if names.peek().is_some() {
            if matches!(key.kind, Kind::Settings) {
                // The rest of the path is the name of a variable.
                document.set_at(path, parse_argument(value, &whole));
                return Ok(());
            }
            section = key.kind.section().ok_or_else(|| {
                problem(path, format!("{name} has no keys of its own; set it as a whole"))
            })?;
        }
    }
    // Giving a sequence in one form removes the other form with its name, and giving a group's values removes its
    // distribution.
    let exclusive: &[&str] = match path.rsplit_once('.').map_or(path, |(_, name)| name) {
        "stops" => &["positions"],
        "positions" => &["stops", "name"],
        _ if section.one_of => &["normal", "uniform", "constant"],
        _ => &[],
    };
    if let Some((parent, _)) = path.rsplit_once('.') {
        for name in exclusive {
            document.remove_at(&format!("{parent}.{name}"));
        }
    }
    document.set_at(path, parse_argument(value, &whole));
    Ok(())
}

/// Table of the fault with an id.
fn fault_of<'a>(document: &'a mut Table, id: &str) -> Result<&'a mut Table, String> {
    let id_of = |node: &Node| match &node.value {
        Value::Table(table) => match &table.get("id")?.value {
            Value::Text(id) => Some(id.clone()),
            _ => None,
        },
        _ => None,
    };
    let Some(Node { value: Value::Array(faults), .. }) = document.get_mut("faults") else {
        return Err("the scenario has no faults".to_owned());
    };
    let ids: Vec<String> = faults.iter().filter_map(id_of).collect();
    match faults.iter_mut().find(|node| id_of(node).is_some_and(|found| found == id)) {
        Some(Node { value: Value::Table(fault), .. }) => Ok(fault),
        _ => {
            let known = suggestion(id, ids.iter().map(String::as_str), "faults");
            Err(format!("no fault has the id {id:?}, {known}"))
        }
    }
}

/// Applies a `--fire ID=TIME`: adds the time to those of a manual trigger.
pub(crate) fn fire(document: &mut Table, argument: &str) -> Result<(), Problem> {
    let whole = format!("--fire {argument}");
    let place = Place::Argument(whole.clone());
    let problem = |message: String| Problem { place: place.clone(), path: String::new(), message };
    let Some((id, time)) = argument.rsplit_once('=') else {
        return Err(problem("expected ID=TIME, such as spike-1=\"5050 s\"".to_owned()));
    };
    let fault = fault_of(document, id).map_err(problem)?;
    let Some(Node { value: Value::Table(trigger), .. }) = fault.get_mut("trigger") else {
        return Err(problem(format!("fault {id:?} has no trigger that can be fired by hand")));
    };
    if trigger.get("manual").is_none() {
        return Err(problem(format!("the trigger of fault {id:?} is not manual")));
    }
    let node = parse_argument(time, &whole);
    let node = Node { place: place.clone(), ..node };
    match trigger.get_mut("fire") {
        Some(Node { value: Value::Array(times), .. }) => times.push(node),
        _ => trigger.set("fire", Node { value: Value::Array(vec![node]), place }),
    }
    Ok(())
}
