//! The `fmi` crate.

use crate::reference::{Kind, Reference, STEP_S, Steps};
use crate::{Anything, map};
use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::Common as _;
use fmi::fmi2::schema::ScalarVariableElement;
use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::schema::VariableType;
use fmi::fmi3::{Common as _, Fmi3Model as _};
use fmi::schema::MajorVersion;
use fmi::schema::traits::FmiModelDescription as _;
use fmi::traits::FmiImport;
use std::path::Path;

/// Steps an FMU over its reference inputs and compares the results.
pub fn check(path: &Path) -> Anything<String> {
    match fmi::import::peek_descr_path(path)?.major_version()? {
        MajorVersion::FMI2 => {
            let import: Fmi2Import = fmi::import::from_path(path)?;
            let files = Reference::of(import.archive_path(), "fmi2")?;
            let variables = &import.model_description().model_variables.variables;
            let find = |name: &str| {
                let variable = variables.iter().find(|variable| variable.name == name)?;
                let kind = match variable.elem {
                    ScalarVariableElement::Real(_) => Kind::Real,
                    ScalarVariableElement::Boolean(_) => Kind::Boolean,
                    _ => Kind::Integer,
                };
                Some((variable.value_reference, kind))
            };
            let mut instance = import.instantiate_cs("importer", false, false)?;
            instance.setup_experiment(None, 0.0, None)?;
            instance.enter_initialization_mode()?;
            instance.exit_initialization_mode()?;
            files.compare(&find, &mut Second(&mut instance))
        }
        MajorVersion::FMI3 => {
            let import: Fmi3Import = fmi::import::from_path(path)?;
            let files = Reference::of(import.archive_path(), "fmi3")?;
            let variables = &import.model_description().model_variables;
            let text = std::fs::read_to_string(import.archive_path().join("modelDescription.xml"))?;
            let find = |name: &str| {
                if let Some(variable) = variables.iter_abstract().find(|v| v.name() == name) {
                    let kind = match variable.data_type() {
                        VariableType::FmiFloat64 => Kind::Real,
                        VariableType::FmiBoolean => Kind::Boolean,
                        VariableType::FmiUInt64 => Kind::Count,
                        _ => Kind::Integer,
                    };
                    return Some((variable.value_reference(), kind));
                }
                // This crate leaves enumerations out: what is in the file is asked instead.
                let (_, rest) =
                    text.split_once(&format!("<Enumeration name=\"{name}\" valueReference=\""))?;
                Some((rest.split('"').next()?.parse().ok()?, Kind::Enumeration))
            };
            let mut instance =
                import.instantiate_cs("importer", false, false, false, false, &[])?;
            instance.enter_initialization_mode(None, 0.0, None)?;
            instance.exit_initialization_mode()?;
            files.compare(&find, &mut Third(&mut instance))
        }
        version => Err(format!("FMI {version:?}").into()),
    }
}

struct Second<'a, T>(&'a mut T);

impl<T: fmi::fmi2::instance::CoSimulation> Steps for Second<'_, T> {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()> {
        match kind {
            Kind::Real => self.0.set_real(&[reference], values)?,
            Kind::Boolean => self.0.set_boolean(&[reference], &[values[0] as i32])?,
            _ => self.0.set_integer(&[reference], &[values[0] as i32])?,
        };
        Ok(())
    }

    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()> {
        let mut integer = [0];
        match kind {
            Kind::Real => {
                self.0.get_real(&[reference], values)?;
                return Ok(());
            }
            Kind::Boolean => self.0.get_boolean(&[reference], &mut integer)?,
            _ => self.0.get_integer(&[reference], &mut integer)?,
        };
        values[0] = f64::from(integer[0]);
        Ok(())
    }

    fn step(&mut self, time_s: f64) -> Anything<()> {
        self.0.do_step(time_s, STEP_S, true)?;
        Ok(())
    }
}

struct Third<'a, T>(&'a mut T);

impl<T: fmi::fmi3::CoSimulation> Steps for Third<'_, T> {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()> {
        match kind {
            Kind::Real => self.0.set_float64(&[reference], values)?,
            Kind::Integer => self.0.set_int32(&[reference], &map(values, |v| v as i32))?,
            Kind::Count => self.0.set_uint64(&[reference], &map(values, |v| v as u64))?,
            Kind::Boolean => self.0.set_boolean(&[reference], &map(values, |v| v != 0.0))?,
            Kind::Enumeration => self.0.set_int64(&[reference], &map(values, |v| v as i64))?,
        };
        Ok(())
    }

    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()> {
        let count = values.len();
        let mut put = |found: Vec<f64>| values.copy_from_slice(&found);
        match kind {
            Kind::Real => {
                self.0.get_float64(&[reference], values)?;
            }
            Kind::Integer => {
                let mut found = vec![0; count];
                self.0.get_int32(&[reference], &mut found)?;
                put(map(&found, f64::from));
            }
            Kind::Count => {
                let mut found = vec![0; count];
                self.0.get_uint64(&[reference], &mut found)?;
                put(map(&found, |v| v as f64));
            }
            Kind::Boolean => {
                let mut found = vec![false; count];
                self.0.get_boolean(&[reference], &mut found)?;
                put(map(&found, |v| f64::from(u8::from(v))));
            }
            Kind::Enumeration => {
                let mut found = vec![0; count];
                self.0.get_int64(&[reference], &mut found)?;
                put(map(&found, |v| v as f64));
            }
        }
        Ok(())
    }

    fn step(&mut self, time_s: f64) -> Anything<()> {
        let [mut event, mut terminate, mut early] = [false; 3];
        let mut last = 0.0;
        self.0.do_step(time_s, STEP_S, true, &mut event, &mut terminate, &mut early, &mut last)?;
        if event || terminate || early {
            return Err(format!(
                "at {time_s} s: event {event}, terminate {terminate}, early {early}"
            )
            .into());
        }
        Ok(())
    }
}
