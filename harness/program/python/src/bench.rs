//! A run that Python steps.

use crate::epoch::{PyEpoch, PyOutput, PyTruth};
use crate::failure::{argument, failed};
use crate::parts::{Fault, Raised, Samples, Unit, name_of};
use crate::records::{SAMPLE_BYTES, commands_of, estimates_of, outputs_of, sample_bytes};
use crate::request::request;
use octant::embedded::Bench as Inner;
use octant_run::Parts;
use octant_run::stepped::AheadError;
use octant_sample::{Epoch, GimbalCommand};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Steps between two looks at Ctrl-C.
const STEPS_AT_ONCE: u64 = 4096;

/// The part of `octant.Bench` that is written in Rust.
#[pyclass(module = "octant", frozen)]
pub(crate) struct RawBench {
    inner: Mutex<State>,
    raised: Raised,
    /// Answers of a unit that is a callable.
    output: Option<Py<PyOutput>>,
    /// True if parts are callables, so that steps need the interpreter.
    in_python: bool,
}

struct State {
    bench: Option<Inner>,
    /// Epochs of the block that the unit has now.
    block: Vec<Epoch>,
}

impl RawBench {
    fn state(&self) -> PyResult<MutexGuard<'_, State>> {
        match self.inner.try_lock() {
            Ok(state) => Ok(state),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(argument("the bench is in a step: a part of it can't use it"))
            }
        }
    }

    fn with<T>(&self, act: impl FnOnce(&mut Inner, &mut Vec<Epoch>) -> T) -> PyResult<T> {
        let mut state = self.state()?;
        let State { bench, block } = &mut *state;
        let Some(bench) = bench else { return Err(argument("the bench has finished its run")) };
        Ok(act(bench, block))
    }
}

#[pymethods]
impl RawBench {
    #[new]
    #[pyo3(signature = (settings, source=None, unit=None, faults=Vec::new()))]
    fn new(
        py: Python<'_>,
        settings: &Bound<'_, PyDict>,
        source: Option<Bound<'_, PyAny>>,
        unit: Option<Bound<'_, PyAny>>,
        faults: Vec<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut request = request(settings)?;
        let raised = Raised::default();
        let mut call = vec!["python".to_owned(), "octant.Bench".to_owned()];
        call.push(request.scenario.display().to_string());
        let mut parts = Parts::default();
        let in_python = source.is_some() || unit.is_some() || !faults.is_empty();
        if let Some(source) = source {
            call.push(format!("source={}", name_of(&source)));
            parts.source = Some(Box::new(Samples::new(&source, &raised)));
        }
        let mut output = None;
        if let Some(unit) = unit {
            let name = name_of(&unit);
            call.push(format!("unit={name}"));
            let unit = Unit::new(&unit, &raised)?;
            output = Some(unit.output(py));
            parts.unit = Some((name, Box::new(unit)));
        }
        for fault in faults {
            call.push(format!("fault={}", name_of(&fault)));
            parts.faults.push(Box::new(Fault::new(&fault, &raised)));
        }
        request.call = Some(call);
        let bench = Inner::new(request, parts).map_err(failed)?;
        let inner = Mutex::new(State { bench: Some(bench), block: Vec::new() });
        Ok(Self { inner, raised, output, in_python })
    }

    /// Takes one step; False if the run is over.
    fn step(&self) -> PyResult<bool> {
        let goes_on = self.with(|bench, _| bench.stepped.step())?;
        self.raised.check()?;
        Ok(goes_on)
    }

    /// Takes up to `steps` steps; returns their number.
    fn steps(&self, py: Python<'_>, steps: u64) -> PyResult<u64> {
        let mut done = 0;
        while done < steps {
            let now = STEPS_AT_ONCE.min(steps - done);
            let several = |bench: &mut Inner, _: &mut Vec<Epoch>| {
                (0..now).take_while(|_| bench.stepped.step()).count() as u64
            };
            let taken = if self.in_python {
                self.with(several)?
            } else {
                py.detach(|| self.with(several))?
            };
            done += taken;
            self.raised.check()?;
            py.check_signals()?;
            if taken < now {
                break;
            }
        }
        Ok(done)
    }

    /// The next samples as records, if the unit's answers have these commands (pairs of counts).
    fn ahead<'py>(&self, py: Python<'py>, commands: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        let commands = commands_of(commands)?;
        self.block_of(py, &commands)
    }

    /// The next samples as records, if the unit keeps its command.
    fn ahead_holding<'py>(&self, py: Python<'py>, samples: usize) -> PyResult<Bound<'py, PyBytes>> {
        let held = self.with(|bench, _| bench.stepped.output().gimbal_command)?;
        self.block_of(py, &vec![held; samples])
    }

    /// Takes the steps of the block with the unit's answers, as records; returns their number.
    fn play(&self, py: Python<'_>, outputs: &[u8], estimates: &[u8]) -> PyResult<usize> {
        let outputs = outputs_of(outputs)?;
        let estimates = estimates_of(estimates, &outputs)?;
        let last = estimates.last().map(|(_, estimate)| *estimate);
        let (taken, expected) = self.with(|bench, block| {
            let epochs = std::mem::take(block);
            let expected = epochs.len();
            (bench.stepped.play(&epochs, &outputs, estimates), expected)
        })?;
        if outputs.len() != expected {
            let found = outputs.len();
            return Err(argument(format!("found {found} answers, expected {expected}")));
        }
        if let (Some(output), Some(answer)) = (&self.output, taken.checked_sub(1)) {
            let mut output = output.bind(py).try_borrow_mut()?;
            output.output = outputs[answer];
            if let Some(last) = last {
                output.estimate = last;
            }
        }
        Ok(taken)
    }

    /// Records of the samples and answers of the next steps: an array for each.
    fn records<'py>(
        &self,
        py: Python<'py>,
        steps: usize,
    ) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
        let (mut samples, mut answers) = (Vec::new(), Vec::new());
        for _ in 0..steps {
            let goes_on = self.with(|bench, _| {
                let goes_on = bench.stepped.step();
                sample_bytes(bench.stepped.epoch(), &mut samples);
                crate::records::output_bytes(bench.stepped.output(), &mut answers);
                goes_on
            })?;
            self.raised.check()?;
            if !goes_on {
                break;
            }
        }
        py.check_signals()?;
        Ok((PyBytes::new(py, &samples), PyBytes::new(py, &answers)))
    }

    /// Last sample that the source delivered.
    #[getter]
    fn epoch(&self) -> PyResult<PyEpoch> {
        self.with(|bench, _| PyEpoch { epoch: *bench.stepped.epoch() })
    }

    /// Last answer of the unit.
    #[getter]
    fn output(&self) -> PyResult<PyOutput> {
        self.with(|bench, _| PyOutput {
            output: *bench.stepped.output(),
            estimate: bench.stepped.parameters(),
        })
    }

    /// Truth at the last sample, or None.
    #[getter]
    fn truth(&self) -> PyResult<Option<PyTruth>> {
        self.with(|bench, _| bench.stepped.truth().map(|truth| PyTruth { truth }))
    }

    /// Number of steps so far.
    #[getter]
    fn number(&self) -> PyResult<u64> {
        self.with(|bench, _| bench.stepped.steps())
    }

    /// Number of samples of the scenario, where it is known.
    #[getter]
    fn total(&self) -> PyResult<Option<u64>> {
        self.with(|bench, _| bench.stepped.scenario().samples())
    }

    /// Ends the run, writes its evidence, and returns its folder.
    fn finish(&self, py: Python<'_>) -> PyResult<PathBuf> {
        let Some(bench) = self.state()?.bench.take() else {
            return Err(argument("the bench has finished its run"));
        };
        let evidence = py.detach(|| bench.finish()).map_err(failed)?;
        Ok(evidence.folder)
    }
}

impl RawBench {
    fn block_of<'py>(
        &self,
        py: Python<'py>,
        commands: &[GimbalCommand],
    ) -> PyResult<Bound<'py, PyBytes>> {
        let made = self.with(|bench, block| -> Result<Vec<u8>, AheadError> {
            *block = bench.stepped.ahead(commands)?;
            let mut bytes = Vec::with_capacity(block.len() * SAMPLE_BYTES);
            block.iter().for_each(|epoch| sample_bytes(epoch, &mut bytes));
            Ok(bytes)
        })?;
        let bytes = made.map_err(|error| argument(format!("failed to {error}")))?;
        Ok(PyBytes::new(py, &bytes))
    }
}
