//! Runs and scenarios, as Python asks for them.

use crate::failure::{argument, failed};
use octant::embedded::{self, Evidence, Failure, RunRequest};
use octant_base::control::Control;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Time between two looks at Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// Makes a request of the settings in a dictionary. Unknown settings are refused.
pub(crate) fn request(settings: &Bound<'_, PyDict>) -> PyResult<RunRequest> {
    let mut request = RunRequest::default();
    for (key, value) in settings {
        let key: String = key.extract()?;
        match key.as_str() {
            "scenario" => request.scenario = value.extract()?,
            "text" => request.text = value.extract()?,
            "set" => request.set = value.extract()?,
            "out" => request.out = value.extract()?,
            "force" => request.force = value.extract()?,
            "seed" => request.seed = value.extract()?,
            "source" => request.source = value.extract()?,
            "endpoint" => request.endpoint = value.extract()?,
            "fire" => request.fire = value.extract()?,
            "only_faults" => request.only_faults = value.extract()?,
            "require" => request.require = value.extract()?,
            "realtime" => request.realtime = value.extract()?,
            "twin" => request.no_twin = !value.extract::<bool>()?,
            _ => return Err(argument(format!("unknown setting {key:?}"))),
        }
    }
    Ok(request)
}

/// Runs a scenario, and writes its evidence.
///
/// `progress(done, total)` is called with the samples so far and in all, None where it isn't known.
/// Returns the folder of the run.
#[pyfunction]
#[pyo3(signature = (settings, progress=None))]
pub(crate) fn run(
    py: Python<'_>,
    settings: &Bound<'_, PyDict>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<PathBuf> {
    let request = request(settings)?;
    let (done, total) = (AtomicU64::new(0), AtomicU64::new(0));
    let cancel = AtomicBool::new(false);
    let look = |controls: &[Control], epochs: Option<u64>| {
        let passed = controls.iter().map(|control| control.epochs.load(Ordering::Relaxed)).sum();
        done.store(passed, Ordering::Relaxed);
        total.store(epochs.unwrap_or(0), Ordering::Relaxed);
        if cancel.load(Ordering::Relaxed) {
            controls.iter().for_each(|control| control.cancel.store(true, Ordering::Relaxed));
        }
    };
    let progress = progress.map(Bound::unbind);
    let told = || -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            if let Some(progress) = &progress {
                let all = Some(total.load(Ordering::Relaxed)).filter(|all| *all > 0);
                progress.bind(py).call1((done.load(Ordering::Relaxed), all))?;
            }
            Ok(())
        })
    };
    let (evidence, stopped) = py.detach(|| follow(&request, &look, &told, &cancel));
    match (evidence, stopped) {
        // An exception ended the run: what was recorded is kept.
        (_, Some(stopped)) => Err(stopped),
        (Ok(evidence), None) => Ok(evidence.folder),
        (Err(failure), None) => Err(failed(failure)),
    }
}

/// Runs on a thread of its own, and looks at Python's signals meanwhile.
fn follow(
    request: &RunRequest,
    look: &(dyn Fn(&[Control], Option<u64>) + Sync),
    told: &(dyn Fn() -> PyResult<()> + Sync),
    cancel: &AtomicBool,
) -> (Result<Evidence, Failure>, Option<PyErr>) {
    let mut stopped = None;
    let evidence = std::thread::scope(|scope| {
        let (ended, end) = channel();
        scope.spawn(move || {
            let _ = ended.send(embedded::run(request, look));
        });
        loop {
            match end.recv_timeout(LOOK) {
                Ok(evidence) => return Some(evidence),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => {
                    if stopped.is_none()
                        && let Err(error) = told()
                    {
                        stopped = Some(error);
                        cancel.store(true, Ordering::Relaxed);
                    }
                }
            }
        }
    });
    match evidence {
        Some(evidence) => (evidence, stopped.or_else(|| told().err())),
        // The thread panicked, and the scope passes that on before it gets here.
        None => (Err(Failure::bench("failed to run the scenario: its thread ended")), stopped),
    }
}

/// Checks a scenario. Returns its title and its seed.
#[pyfunction]
pub(crate) fn check_scenario(settings: &Bound<'_, PyDict>) -> PyResult<(String, u64)> {
    let scenario = embedded::scenario(&request(settings)?).map_err(failed)?;
    Ok((scenario.title.clone(), scenario.seed))
}

/// Converts TOML to JSON.
#[pyfunction]
pub(crate) fn toml_to_json(text: &str) -> PyResult<String> {
    let value: toml::Table = text.parse().map_err(argument)?;
    serde_json::to_string(&value).map_err(argument)
}

/// Converts JSON to TOML. TOML has no null.
#[pyfunction]
pub(crate) fn json_to_toml(text: &str) -> PyResult<String> {
    let value: toml::Table = serde_json::from_str(text).map_err(argument)?;
    toml::to_string(&value).map_err(argument)
}

/// The JSON Schema of scenarios.
#[pyfunction]
pub(crate) fn schema() -> String {
    octant_scenario::schema().to_string()
}
