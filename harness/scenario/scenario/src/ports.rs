//! Reading of the variables of FMUs: ports of channels, settings, codes.
//!
//! A port is the name of a variable, `{ variable = "imu.w", unit = "deg/s", scale = 2.0 }`, or
//! `{ constant = "90 deg" }`; a channel of several elements takes an array of them, or the name of
//! an array variable.

use super::error::{Place, Problem};
use super::model::{ChannelElement, Code, EntryPlace, Made, Set, Setting};
use super::quantity::{self, explain};
use crate::channel::{Channel, Class};
use octant_base::names::suggestion;
use octant_toml_tree::{Node, Table, Value, join, number, parse_argument};

/// Description of the values of a port.
pub(super) fn expected_port(channel: &Channel) -> String {
    let one = "the name of a variable, or a table with variable (and unit, scale) or constant";
    if channel.elements == 1 {
        one.to_owned()
    } else {
        format!("the name of an array variable, or {} entries, each {one}", channel.elements)
    }
}

/// Example of the ports of a channel, in TOML.
pub(super) fn example_port(channel: &Channel) -> String {
    if channel.elements == 1 {
        return format!("{:?}", channel.name);
    }
    let each = (1..=channel.elements).map(|n| format!("{:?}", format!("{}[{n}]", channel.name)));
    format!("[{}]", each.collect::<Vec<_>>().join(", "))
}

/// Reads the ports of a channel: one for all elements, or one for each.
pub(super) fn ports(
    node: &Node,
    channel: &Channel,
    path: &str,
) -> Result<Vec<ChannelElement>, Problem> {
    let at =
        |node: &Node, path: &str| EntryPlace { place: node.place.clone(), path: path.to_owned() };
    let Value::Array(entries) = &node.value else {
        return Ok(vec![port(node, channel, at(node, path))?]);
    };
    if entries.len() != channel.elements {
        return Err(at(node, path).problem(format!(
            "found {} entries, expected {}",
            entries.len(),
            expected_port(channel)
        )));
    }
    let each = |(index, entry): (usize, &Node)| {
        port(entry, channel, at(entry, &format!("{path}[{index}]")))
    };
    entries.iter().enumerate().map(each).collect()
}

fn port(node: &Node, channel: &Channel, at: EntryPlace) -> Result<ChannelElement, Problem> {
    let what = match &node.value {
        Value::Text(name) if !name.trim().is_empty() => {
            Made::Variable { name: name.clone(), unit: None, scale: 1.0 }
        }
        Value::Table(table) => made(table, channel, &at)?,
        other => {
            return Err(at.problem(format!(
                "found {}, expected {}",
                other.describe(),
                expected_port(channel)
            )));
        }
    };
    Ok(ChannelElement { what, at })
}

fn made(table: &Table, channel: &Channel, at: &EntryPlace) -> Result<Made, Problem> {
    let known = ["variable", "unit", "scale", "constant"];
    for entry in &table.entries {
        if !known.contains(&entry.key.as_str()) {
            let known = suggestion(&entry.key, known.into_iter(), "known here");
            let path = join(&at.path, &entry.key);
            let at = EntryPlace { place: entry.place.clone(), path };
            return Err(at.problem(format!("unknown key, {known}")));
        }
    }
    let wrong = |key: &str, node: &Node, expected: &str| {
        let at = EntryPlace { place: node.place.clone(), path: join(&at.path, key) };
        at.problem(format!("found {}, expected {expected}", node.value.describe()))
    };
    match (table.get("variable"), table.get("constant")) {
        (Some(node), None) => {
            let Value::Text(name) = &node.value else {
                return Err(wrong("variable", node, "the name of a variable"));
            };
            let unit = match table.get("unit") {
                None => None,
                Some(node) => match (&node.value, channel.class) {
                    (Value::Text(unit), Class::Quantity(dimension)) => {
                        constant(&format!("1 {unit}"), dimension)
                            .map_err(|expected| wrong("unit", node, &expected))?;
                        Some(unit.clone())
                    }
                    (_, Class::Quantity(dimension)) => {
                        return Err(wrong(
                            "unit",
                            node,
                            &format!("a unit such as {:?}", dimension.unit),
                        ));
                    }
                    (Value::Text(unit), Class::Nanoseconds) => {
                        constant(&format!("1 {unit}"), quantity::UnitDimension::TIME)
                            .map_err(|expected| wrong("unit", node, &expected))?;
                        Some(unit.clone())
                    }
                    _ => return Err(wrong("unit", node, "none: the channel has no unit")),
                },
            };
            let scale = match table.get("scale") {
                None => 1.0,
                Some(node) => number(&node.value)
                    .filter(|scale| scale.is_finite() && *scale != 0.0)
                    .ok_or_else(|| wrong("scale", node, "a number other than 0"))?,
            };
            Ok(Made::Variable { name: name.clone(), unit, scale })
        }
        (None, Some(node)) => {
            if let Some(key) = ["unit", "scale"].into_iter().find(|key| table.get(key).is_some()) {
                return Err(
                    at.problem(format!("found {key} beside constant, expected constant alone"))
                );
            }
            let value = match (&node.value, channel.class) {
                (Value::Text(text), Class::Quantity(dimension)) => constant(text, dimension)
                    .map_err(|expected| wrong("constant", node, &expected))?,
                (Value::Boolean(value), Class::Flag) => f64::from(u8::from(*value)),
                (Value::Integer(_) | Value::Number(_), Class::Number) => {
                    number(&node.value).unwrap_or_default()
                }
                (Value::Integer(value), Class::Whole | Class::Code | Class::Nanoseconds) => {
                    *value as f64
                }
                (_, Class::Quantity(dimension)) => {
                    let expected = format!("{} such as {:?}", dimension.name, dimension.example);
                    return Err(wrong("constant", node, &expected));
                }
                (_, Class::Flag) => return Err(wrong("constant", node, "true or false")),
                (_, Class::Number) => return Err(wrong("constant", node, "a number")),
                (_, Class::Whole | Class::Code | Class::Nanoseconds) => {
                    return Err(wrong("constant", node, "a whole number"));
                }
            };
            Ok(Made::Constant(value))
        }
        _ => Err(at.problem("expected a table with either variable or constant")),
    }
}

/// Parses a quantity of a dimension, SI; the error is the expected form.
fn constant(text: &str, dimension: quantity::UnitDimension) -> Result<f64, String> {
    let expected = || format!("{} such as {:?}", dimension.name, dimension.example);
    let found = quantity::parse(text).map_err(|e| format!("{} ({})", expected(), explain(&e)))?;
    if found.is(dimension) { Ok(found.si) } else { Err(expected()) }
}

/// Reads the settings of an FMU. Nested tables are parts of a name.
pub(super) fn settings(table: &Table, path: &str) -> Result<Vec<Setting>, Problem> {
    let mut all = Vec::new();
    collect(table, "", path, &mut all)?;
    Ok(all)
}

fn collect(table: &Table, prefix: &str, path: &str, all: &mut Vec<Setting>) -> Result<(), Problem> {
    for entry in &table.entries {
        let name = join(prefix, &entry.key);
        let at = EntryPlace { place: entry.node.place.clone(), path: join(path, &entry.key) };
        match &entry.node.value {
            Value::Table(inner) => {
                collect(inner, &name, &at.path, all)?;
                continue;
            }
            Value::Array(entries) => {
                let values = entries.iter().map(|entry| set(&entry.value, &at));
                all.push(Setting { name, values: values.collect::<Result<_, _>>()?, at });
            }
            value => {
                let values = vec![set(value, &at)?];
                all.push(Setting { name, values, at });
            }
        }
    }
    Ok(())
}

fn set(value: &Value, at: &EntryPlace) -> Result<Set, Problem> {
    match value {
        Value::Integer(number) if number.unsigned_abs() > 1 << 53 => {
            Ok(Set::Whole(i128::from(*number)))
        }
        Value::Integer(number) => Ok(Set::Number(*number as f64)),
        Value::Number(number) if number.is_finite() => Ok(Set::Number(*number)),
        Value::Boolean(flag) => Ok(Set::Flag(*flag)),
        Value::Text(text) => Ok(Set::Text(text.clone())),
        other => Err(at.problem(format!(
            "found {}, expected a finite number, true or false, a text, or an array of them",
            other.describe()
        ))),
    }
}

/// Reads `NAME=VALUE` of a command line: a TOML value, or a text without quotes.
///
/// # Errors
/// If it has no `=`, or the value can't be a setting.
pub fn setting_argument(argument: &str) -> Result<Setting, Problem> {
    let whole = format!("--set {argument}");
    let place = Place::Argument(whole.clone());
    let Some((name, value)) = argument.split_once('=') else {
        let message = "expected NAME=VALUE, such as ship.mass=3.2e6".to_owned();
        return Err(Problem { place, path: String::new(), message });
    };
    let mut table = Table::default();
    table.set(name.trim(), parse_argument(value, &whole));
    let mut all = settings(&table, "")?;
    match (all.pop(), all.is_empty()) {
        (Some(setting), true) => Ok(setting),
        _ => {
            let message = format!("found a table, expected one value of {}", name.trim());
            Err(Problem { place, path: String::new(), message })
        }
    }
}

/// Reads the values that stand for a mode; `None` if one is invalid.
pub(super) fn codes(value: &Value) -> Option<Vec<Code>> {
    let one = |value: &Value| match value {
        Value::Integer(number) => Some(Code::Number(*number)),
        Value::Text(name) => Some(Code::Name(name.clone())),
        _ => None,
    };
    match value {
        Value::Array(entries) => entries.iter().map(|entry| one(&entry.value)).collect(),
        value => one(value).map(|code| vec![code]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channel::{answer, sample};

    fn node(text: &str) -> Node {
        let mut table = octant_toml_tree::parse(&format!("x = {text}")).unwrap();
        table.entries.remove(0).node
    }

    #[test]
    fn ports_are_names_tables_and_constants() {
        let read = |text: &str| ports(&node(text), &sample::RATE, "map.gyro.rate");
        let variable = |name: &str, unit: Option<&str>, scale| Made::Variable {
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
            scale,
        };
        let one = read("\"imu.w\"").unwrap();
        assert_eq!(one.len(), 1);
        assert_eq!(one[0].what, variable("imu.w", None, 1.0));
        let three = read(
            "[\"-wy\", { variable = \"wx\", unit = \"deg/s\", scale = -2 }, { constant = \"180 deg/s\" }]",
        )
        .unwrap();
        assert_eq!(three[0].what, variable("-wy", None, 1.0));
        assert_eq!(three[1].what, variable("wx", Some("deg/s"), -2.0));
        assert_eq!(three[2].what, Made::Constant(std::f64::consts::PI));
        assert_eq!(three[2].at.path, "map.gyro.rate[2]");
    }

    #[test]
    fn what_is_no_port_is_told() {
        for (text, expected) in [
            ("3", "found the bare number 3, expected the name of an array variable"),
            ("[\"a\"]", "found 1 entries, expected the name of an array variable, or 3 entries"),
            ("[\"a\", \"b\", 1]", "found the bare number 1"),
            ("{ variabel = \"a\" }", "unknown key, did you mean \"variable\"?"),
            ("{}", "either variable or constant"),
            ("{ variable = \"a\", constant = \"1 deg/s\" }", "either variable or constant"),
            ("{ variable = \"a\", unit = \"m\" }", "expected an angular rate such as"),
            ("{ variable = \"a\", unit = \"furlong\" }", "unknown unit \"furlong\""),
            ("{ variable = \"a\", scale = 0 }", "a number other than 0"),
            ("{ constant = 3 }", "found the bare number 3, expected an angular rate"),
            ("{ constant = \"1 deg/s\", unit = \"deg/s\" }", "constant alone"),
        ] {
            let error = ports(&node(text), &sample::RATE, "p").unwrap_err();
            assert!(error.message.contains(expected), "{text}: {}", error.message);
        }
        let error = ports(&node("{ variable = \"a\", unit = \"deg\" }"), &answer::HEALTH, "p");
        assert!(error.unwrap_err().message.contains("the channel has no unit"));
    }

    #[test]
    fn settings_may_be_nested_and_are_flat_in_the_end() {
        let text = "\"ship.mass\" = 3.2e6\nship.name = \"a\"\nship.on = true\nx = [1, 2]\n";
        let all = settings(&octant_toml_tree::parse(text).unwrap(), "parameters").unwrap();
        let found: Vec<_> = all.iter().map(|s| (s.name.as_str(), s.values.as_slice())).collect();
        assert_eq!(found.len(), 4);
        assert!(found.contains(&("ship.mass", &[Set::Number(3.2e6)])));
        assert!(found.contains(&("ship.name", &[Set::Text("a".to_owned())])));
        assert!(found.contains(&("ship.on", &[Set::Flag(true)])));
        assert!(found.contains(&("x", &[Set::Number(1.0), Set::Number(2.0)])));
        let error = settings(&octant_toml_tree::parse("x = [[1]]").unwrap(), "p").unwrap_err();
        assert!(error.message.contains("found an array of 1"), "{}", error.message);
    }

    #[test]
    fn codes_are_numbers_or_names() {
        assert_eq!(codes(&node("3").value), Some(vec![Code::Number(3)]));
        let both = codes(&node("[1, \"busy\"]").value);
        assert_eq!(both, Some(vec![Code::Number(1), Code::Name("busy".to_owned())]));
        assert_eq!(codes(&node("true").value), None);
    }
}
