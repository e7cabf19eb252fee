//! Parts of a run that are Python callables: unit under test, faults, source.

use crate::epoch::{PyEpoch, PyOutput, PyTruth};
use crate::failure::argument;
use octant_endpoint::{Endpoint, EndpointError};
use octant_run::Interferes;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, GimbalCommand, Output, Parameters, Truth};
use octant_source::{Source, SourceError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Exception that a callable raised, until the call of the bench returns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Raised(Arc<(AtomicBool, Mutex<Option<PyErr>>)>);

impl Raised {
    /// Keeps the first exception.
    fn keep(&self, error: PyErr) -> String {
        let text = error.to_string();
        let (there, slot) = &*self.0;
        slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        there.store(true, Ordering::Release);
        text
    }

    /// Raises the exception, if there was one.
    pub(crate) fn check(&self) -> PyResult<()> {
        let (there, slot) = &*self.0;
        if !there.swap(false, Ordering::Acquire) {
            return Ok(());
        }
        slot.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }
}

/// Name of a callable in messages and receipts.
pub(crate) fn name_of(callable: &Bound<'_, PyAny>) -> String {
    let named = callable.getattr("__name__").and_then(|name| name.extract::<String>());
    named.unwrap_or_else(|_| {
        callable.get_type().name().map_or_else(|_| "callable".to_owned(), |name| name.to_string())
    })
}

/// Unit under test: a callable that takes an epoch and fills in its answer.
pub(crate) struct Unit {
    callable: Py<PyAny>,
    output: Py<PyOutput>,
    name: String,
    raised: Raised,
}

impl Unit {
    pub(crate) fn new(callable: &Bound<'_, PyAny>, raised: &Raised) -> PyResult<Self> {
        let py = callable.py();
        Ok(Self {
            callable: callable.clone().unbind(),
            output: Py::new(py, PyOutput::first())?,
            name: name_of(callable),
            raised: raised.clone(),
        })
    }

    /// Answers, shared with the blocks.
    pub(crate) fn output(&self, py: Python<'_>) -> Py<PyOutput> {
        self.output.clone_ref(py)
    }

    fn gone(&self, error: PyErr) -> EndpointError {
        EndpointError::Gone { uri: self.uri(), reason: self.raised.keep(error) }
    }
}

impl Endpoint for Unit {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        let stepped = Python::attach(|py| {
            self.output.bind(py).try_borrow_mut()?.begin(&epoch.sample);
            let given = Bound::new(py, PyEpoch { epoch: *epoch })?;
            self.callable.bind(py).call1((given, self.output.bind(py)))?;
            *output = self.output.bind(py).try_borrow()?.output;
            Ok(())
        });
        stepped.map_err(|error| self.gone(error))
    }

    fn uri(&self) -> String {
        format!("python:{}", self.name)
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        let refused = |reason: String| EndpointError::Restart { uri: self.uri(), reason };
        let restarted = Python::attach(|py| {
            let unit = self.callable.bind(py);
            if !unit.hasattr("restart")? {
                return Ok(false);
            }
            unit.call_method1("restart", (offset.map(|offset| offset.to_array().to_vec()),))?;
            *self.output.bind(py).try_borrow_mut()? = PyOutput::first();
            Ok(true)
        });
        match restarted {
            Ok(true) => Ok(()),
            Ok(false) => Err(refused("it has no method restart(offset)".to_owned())),
            Err(error) => Err(refused(self.raised.keep(error))),
        }
    }

    fn parameters(&self) -> ParameterEstimate {
        let first = PyOutput::first().estimate;
        Python::attach(|py| self.output.bind(py).try_borrow().map_or(first, |o| o.estimate))
    }
}

/// Fault: a callable that acts on the epochs of a step.
pub(crate) struct Fault {
    callable: Py<PyAny>,
    id: String,
    raised: Raised,
}

impl Fault {
    pub(crate) fn new(callable: &Bound<'_, PyAny>, raised: &Raised) -> Self {
        let id = name_of(callable);
        Self { callable: callable.clone().unbind(), id, raised: raised.clone() }
    }

    /// Passes one epoch to the callable, and collects what it makes of it.
    fn one(&self, number: u64, epoch: Epoch, into: &mut Vec<Epoch>) -> PyResult<()> {
        Python::attach(|py| {
            let given = Bound::new(py, PyEpoch { epoch })?;
            let made = self.callable.bind(py).call1((&given, number))?;
            if made.is_none() {
                into.push(given.try_borrow()?.epoch);
            } else if let Ok(one) = made.extract::<PyEpoch>() {
                into.push(one.epoch);
            } else {
                let several = made.extract::<Vec<PyEpoch>>().map_err(|_| {
                    let expected = "expected None, an Epoch or a list of them";
                    argument(format!("fault {} returned {made}, {expected}", self.id))
                })?;
                into.extend(several.into_iter().map(|one| one.epoch));
            }
            Ok(())
        })
    }
}

impl Interferes for Fault {
    fn id(&self) -> &str {
        &self.id
    }

    fn act(&mut self, number: u64, _: &Output, delivered: &mut Vec<Epoch>) {
        let mut made = Vec::with_capacity(delivered.len());
        for epoch in delivered.iter() {
            if let Err(error) = self.one(number, *epoch, &mut made) {
                self.raised.keep(error);
                return;
            }
        }
        *delivered = made;
    }
}

/// Source: a callable that takes the set point of the gimbals and returns an epoch, or None at its end.
pub(crate) struct Samples {
    callable: Py<PyAny>,
    name: String,
    raised: Raised,
}

impl Samples {
    pub(crate) fn new(callable: &Bound<'_, PyAny>, raised: &Raised) -> Self {
        let name = name_of(callable);
        Self { callable: callable.clone().unbind(), name, raised: raised.clone() }
    }
}

impl Source for Samples {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        let target = command.target;
        let made = Python::attach(|py| {
            let command = (target.azimuth_rad(), target.roll_rad());
            let made = self.callable.bind(py).call1((command,))?;
            if made.is_none() {
                return Ok(None);
            }
            let made = made.extract::<PyEpoch>().map_err(|_| {
                argument(format!("source {} returned {made}, expected an Epoch or None", self.name))
            })?;
            Ok(Some(made.epoch))
        });
        match made {
            Ok(made) => Ok(epoch.take(made)),
            Err(error) => Err(SourceError::Gone {
                uri: format!("python:{}", self.name),
                reason: self.raised.keep(error),
            }),
        }
    }

    fn truth(&self) -> Option<Truth> {
        Python::attach(|py| {
            let source = self.callable.bind(py);
            if !source.hasattr("truth").unwrap_or(false) {
                return None;
            }
            let made = source.call_method0("truth").and_then(|truth| {
                if truth.is_none() {
                    Ok(None)
                } else {
                    truth.extract::<PyTruth>().map(Some).map_err(PyErr::from)
                }
            });
            made.map_err(|error| self.raised.keep(error)).ok().flatten().map(|truth| truth.truth)
        })
    }

    fn samples_total(&self) -> Option<u64> {
        None
    }
}
