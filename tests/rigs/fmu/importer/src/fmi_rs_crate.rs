//! The `fmi-rs` crate, which has its own findings of a description too: there may be none.

use crate::reference::{Kind, Reference, STEP_S, Steps};
use crate::{Anything, map};
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{CS, FMU2};
use fmi_rs::fmi3::FMU3;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;
use fmi_rs::model_description::{FMIMajorVersion, ValidationError, fmi2, fmi3};
use std::path::Path;
use std::sync::Arc;

/// Steps an FMU over its reference inputs and compares the results.
pub fn check(path: &Path) -> Anything<String> {
    let folder = tempfile::tempdir()?;
    fmi_rs::zip::extract_zip_archive(path, folder.path())?;
    match fmi_rs::model_description::peek_fmi_major_version(
        &folder.path().join("modelDescription.xml"),
    )? {
        FMIMajorVersion::V2 => {
            let builder = FMU2Builder::new(&path)?;
            without_findings(&builder.model_description.validate())?;
            let files = Reference::of(builder.unzipdir.path(), "fmi2")?;
            let find = |name: &str| {
                let variable = builder.model_description.variable_by_name(name).ok()?;
                let kind = match variable.variableType {
                    fmi2::VariableType::Real { .. } => Kind::Real,
                    fmi2::VariableType::Boolean { .. } => Kind::Boolean,
                    _ => Kind::Integer,
                };
                Some((variable.valueReference, kind))
            };
            let fmu = builder.instantiate_cs("importer")?;
            second(fmu.setupExperiment(None, 0.0, None))?;
            second(fmu.enterInitializationMode())?;
            second(fmu.exitInitializationMode())?;
            files.compare(&find, &mut Second(fmu))
        }
        FMIMajorVersion::V3 => {
            let mut builder = FMU3Builder::new(&path)?;
            builder.eventModeUsed = false;
            builder.earlyReturnAllowed = false;
            without_findings(&builder.model_description.validate())?;
            let files = Reference::of(builder.unzipdir.path(), "fmi3")?;
            let find = |name: &str| {
                let all = &builder.model_description.modelVariables;
                let variable = all.iter().find(|variable| variable.name == name)?;
                let kind = match variable.variableType {
                    fmi3::VariableType::Float64 { .. } => Kind::Real,
                    fmi3::VariableType::Boolean { .. } => Kind::Boolean,
                    fmi3::VariableType::UInt64 { .. } => Kind::Count,
                    fmi3::VariableType::Enumeration { .. } => Kind::Enumeration,
                    _ => Kind::Integer,
                };
                Some((variable.valueReference, kind))
            };
            let fmu = builder.instantiate_cs("importer")?;
            third(fmu.enterInitializationMode(None, 0.0, None))?;
            third(fmu.exitInitializationMode())?;
            files.compare(&find, &mut Third(fmu))
        }
    }
}

fn without_findings(found: &[ValidationError]) -> Anything<()> {
    let found: Vec<&str> = found.iter().map(|finding| finding.message.as_str()).collect();
    if found.is_empty() { Ok(()) } else { Err(found.join("; ").into()) }
}

fn second(status: fmi2Status) -> Anything<()> {
    if status == fmi2Status::Ok { Ok(()) } else { Err(format!("status {}", status as i32).into()) }
}

fn third(status: fmi3Status) -> Anything<()> {
    if status == fmi3Status::Ok { Ok(()) } else { Err(format!("status {}", status as i32).into()) }
}

struct Second(Arc<FMU2<CS>>);

impl Steps for Second {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()> {
        let integers = map(values, |v| v as i32);
        second(match kind {
            Kind::Real => self.0.setReal(&[reference], values),
            Kind::Boolean => self.0.setBoolean(&[reference], &integers),
            _ => self.0.setInteger(&[reference], &integers),
        })
    }

    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()> {
        if kind == Kind::Real {
            return second(self.0.getReal(&[reference], values));
        }
        let mut integers = vec![0; values.len()];
        second(match kind {
            Kind::Boolean => self.0.getBoolean(&[reference], &mut integers),
            _ => self.0.getInteger(&[reference], &mut integers),
        })?;
        values.copy_from_slice(&map(&integers, f64::from));
        Ok(())
    }

    fn step(&mut self, time_s: f64) -> Anything<()> {
        second(self.0.doStep(time_s, STEP_S, 1))
    }
}

struct Third(Arc<FMU3>);

impl Steps for Third {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()> {
        let reference = [reference];
        third(match kind {
            Kind::Real => self.0.setFloat64(&reference, values),
            Kind::Integer => self.0.setInt32(&reference, &map(values, |v| v as i32)),
            Kind::Count => self.0.setUInt64(&reference, &map(values, |v| v as u64)),
            Kind::Boolean => self.0.setBoolean(&reference, &map(values, |v| v != 0.0)),
            Kind::Enumeration => self.0.setInt64(&reference, &map(values, |v| v as i64)),
        })
    }

    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()> {
        let (reference, count) = ([reference], values.len());
        let found = match kind {
            Kind::Real => return third(self.0.getFloat64(&reference, values)),
            Kind::Integer => {
                let mut found = vec![0; count];
                third(self.0.getInt32(&reference, &mut found))?;
                map(&found, f64::from)
            }
            Kind::Count => {
                let mut found = vec![0; count];
                third(self.0.getUInt64(&reference, &mut found))?;
                map(&found, |v| v as f64)
            }
            Kind::Boolean => {
                let mut found = vec![false; count];
                third(self.0.getBoolean(&reference, &mut found))?;
                map(&found, |v| f64::from(u8::from(v)))
            }
            Kind::Enumeration => {
                let mut found = vec![0; count];
                third(self.0.getInt64(&reference, &mut found))?;
                map(&found, |v| v as f64)
            }
        };
        values.copy_from_slice(&found);
        Ok(())
    }

    fn step(&mut self, time_s: f64) -> Anything<()> {
        let [mut event, mut terminate, mut early] = [false; 3];
        let mut last = 0.0;
        third(self.0.doStep(
            time_s,
            STEP_S,
            true,
            &mut event,
            &mut terminate,
            &mut early,
            &mut last,
        ))?;
        if event || terminate || early {
            return Err(format!(
                "at {time_s} s: event {event}, terminate {terminate}, early {early}"
            )
            .into());
        }
        Ok(())
    }
}
