//! Values of the parameters of faults.

use crate::error::Problem;
use crate::read::reader::Reader;
use crate::{keys, quantity};
use octant_faults::catalogue::{FaultParameter, Takes};
use octant_faults::{Channels, Value};
use octant_toml_tree::{Node, Value as Written};

/// Value of a parameter, which the check has already accepted.
pub(super) fn value(
    table: &Reader<'_>,
    parameter: &'static FaultParameter,
) -> Result<Value, Problem> {
    let key = parameter.name;
    let missing = || table.problem(key, "missing");
    Ok(match parameter.takes {
        Takes::Quantity(dimensions, _) => {
            let quantity = quantity::parse(table.text(key)?).map_err(|_| missing())?;
            let fits = |of: &&_| quantity.is(keys::fault_dimension(of));
            let dimension = dimensions.iter().find(fits).ok_or_else(missing)?;
            Value::Quantity(quantity.si, *dimension)
        }
        Takes::Vector(dimensions) => {
            let texts = table.texts(key);
            let all: Option<Vec<_>> = texts.iter().map(|text| quantity::parse(text).ok()).collect();
            let all = all.filter(|all| all.len() == 3).ok_or_else(missing)?;
            let fits = |of: &&_| all.iter().all(|quantity| quantity.is(keys::fault_dimension(of)));
            let dimension = dimensions.iter().find(fits).ok_or_else(missing)?;
            Value::Vector(std::array::from_fn(|axis| all[axis].si), *dimension)
        }
        Takes::Integer(..) => Value::Integer(table.integer(key)?),
        Takes::Flag => Value::Flag(table.boolean(key)?),
        Takes::Choice(choices) => {
            let text = table.text(key)?;
            let found = choices.iter().find(|(name, _)| *name == text).ok_or_else(missing)?;
            Value::Choice(found.0)
        }
        Takes::Channels => {
            let names = match table.node(key) {
                Some(Node { value: Written::Array(_), .. }) => table.texts(key),
                _ => vec![table.text(key)?],
            };
            let sets: Option<Vec<_>> = names.into_iter().map(Channels::named).collect();
            let set = sets.and_then(|sets| sets.into_iter().reduce(Channels::union));
            Value::Channels(set.ok_or_else(missing)?)
        }
        Takes::Number(_) => Value::Number(table.number(key)?),
        Takes::Value | Takes::Difference(_) => {
            return Err(table.problem(key, "only connections of FMUs have such values"));
        }
    })
}
