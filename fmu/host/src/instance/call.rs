//! One call of a function of an FMU: its name, its status, what it means.

use super::super::description::Description;
use super::message::{Log, status_name};
use super::{InstanceError, Message};
use octant_fmi::{fmi2, fmi3};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A word that always holds the number of the function that runs, for who watches from outside.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mark(pub(crate) Option<&'static AtomicU64>);

/// No function runs.
pub(crate) const NOWHERE: u32 = 0;

/// The library is being loaded, or goes; its constructors or destructors may run.
pub(crate) const LOADING: u32 = 1;

/// Numbers of the functions of FMI 2.0 and FMI 3.0 start here.
const FIRST_FMI2: u32 = 1000;
const FIRST_FMI3: u32 = 2000;

impl Mark {
    /// A function begins; [`NOWHERE`]: it has ended.
    pub(crate) fn set(self, function: u32) {
        if let Some(word) = self.0 {
            word.store(u64::from(function), Ordering::Relaxed);
        }
    }
}

/// The name of a function, for the number that a mark held.
#[cfg_attr(not(target_os = "linux"), allow(dead_code, reason = "who watches is on Linux"))]
pub(crate) fn function_name(function: u32) -> Option<&'static str> {
    let at = |names: &[&'static str], first: u32| {
        names.get(usize::try_from(function.checked_sub(first)?).ok()?).copied()
    };
    if function == LOADING {
        return Some("the loading of its library");
    }
    at(fmi3::NAMES, FIRST_FMI3).or_else(|| at(fmi2::NAMES, FIRST_FMI2))
}

/// The number of a function, found when the program is compiled.
pub(crate) const fn function_number(name: &str) -> u32 {
    const fn find(names: &[&str], name: &str) -> Option<u32> {
        let mut i = 0;
        while i < names.len() {
            let (a, b) = (names[i].as_bytes(), name.as_bytes());
            let mut j = 0;
            while j < a.len() && j < b.len() && a[j] == b[j] {
                j += 1;
            }
            if j == a.len() && j == b.len() {
                return Some(i as u32);
            }
            i += 1;
        }
        None
    }
    if let Some(number) = find(fmi2::NAMES, name) {
        return FIRST_FMI2 + number;
    }
    match find(fmi3::NAMES, name) {
        Some(number) => FIRST_FMI3 + number,
        None => panic!("no function of this name"),
    }
}

/// Size of a state, bytes.
const STATE_MAX: usize = 1 << 30;

/// Whether the FMU may still be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Condition {
    /// It may.
    Sound,
    /// It answered error: it can be reset, restored or freed.
    Failed,
    /// It answered fatal: it isn't touched again.
    Lost,
}

/// A status that is no failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Fine,
    Discard,
    Pending,
}

/// What every instance has, whatever its standard.
pub(crate) struct Base {
    pub(crate) name: String,
    pub(crate) description: Arc<Description>,
    pub(super) log: Arc<Log>,
    pub(crate) mark: Mark,
    pub(crate) condition: Condition,
}

impl Base {
    /// The library has no function of this name.
    #[cold]
    pub(crate) fn missing(&self, function: &str) -> InstanceError {
        InstanceError::unsupported(
            &self.name,
            format!("call {function}"),
            "its library doesn't have this function",
        )
    }

    /// Refuses a call of an FMU that isn't sound (or, with `mend`, that can't be mended).
    pub(crate) fn ready(&self, function: &str, mend: bool) -> Result<(), InstanceError> {
        match self.condition {
            Condition::Sound => Ok(()),
            Condition::Failed if mend => Ok(()),
            Condition::Failed => Err(self.order(function, "after it answered error")),
            Condition::Lost => Err(self.order(function, "after it answered fatal")),
        }
    }

    /// It is asked for at a time at which the standard forbids it.
    #[cold]
    pub(crate) fn order(&self, what: &str, when: &str) -> InstanceError {
        InstanceError::Order { fmu: self.name.clone(), what: what.into(), when: when.into() }
    }

    /// What a status means.
    pub(crate) fn answer(&mut self, function: &str, status: i32) -> Result<Answer, InstanceError> {
        match status {
            fmi2::OK | fmi2::WARNING => Ok(Answer::Fine),
            fmi2::DISCARD => Ok(Answer::Discard),
            fmi2::PENDING => Ok(Answer::Pending),
            fmi2::ERROR => {
                self.condition = Condition::Failed;
                Err(self.failed(function, status_name(status)))
            }
            // A status that the standard doesn't have says nothing of what still works.
            _ => {
                self.condition = Condition::Lost;
                Err(self.failed(function, status_name(status)))
            }
        }
    }

    /// What a status means where only success will do. A discarded call leaves the FMU sound.
    #[inline]
    pub(crate) fn check(&mut self, function: &str, status: i32) -> Result<(), InstanceError> {
        if status == fmi2::OK { Ok(()) } else { self.look_closer(function, status) }
    }

    #[cold]
    fn look_closer(&mut self, function: &str, status: i32) -> Result<(), InstanceError> {
        match self.answer(function, status)? {
            Answer::Fine => Ok(()),
            Answer::Discard | Answer::Pending => Err(self.failed(function, status_name(status))),
        }
    }

    /// A function failed.
    #[cold]
    pub(crate) fn failed(&self, function: &str, status: &str) -> InstanceError {
        InstanceError::Failed {
            fmu: self.name.clone(),
            function: function.into(),
            status: status.into(),
            said: self.log.last(&self.description),
        }
    }

    /// Memory for a state of the size that the FMU says.
    pub(crate) fn state_buffer(&self, size: usize) -> Result<Vec<u8>, InstanceError> {
        let mut bytes = Vec::new();
        if size > STATE_MAX || bytes.try_reserve_exact(size).is_err() {
            return Err(InstanceError::State {
                fmu: self.name.clone(),
                reason: format!("has {size} bytes, more than can be held"),
            });
        }
        bytes.resize(size, 0);
        Ok(bytes)
    }

    /// What it logged.
    pub(crate) fn messages(&self) -> Vec<Message> {
        self.log.drain(&self.description)
    }
}

/// Calls a function of an FMU's table with its instance first; gives its status, or the error that
/// it is not there or must not be called. With `mend`: also after the FMU answered error.
macro_rules! call {
    ($unit:ident.$field:ident $name:literal ($($argument:expr),* $(,)?)) => {
        $crate::instance::call::call!(@ $unit $field $name false ($($argument),*))
    };
    (mend $unit:ident.$field:ident $name:literal ($($argument:expr),* $(,)?)) => {
        $crate::instance::call::call!(@ $unit $field $name true ($($argument),*))
    };
    (@ $unit:ident $field:ident $name:literal $mend:literal ($($argument:expr),*)) => {{
        const NUMBER: u32 = $crate::instance::call::function_number($name);
        let function = $unit.functions.$field.ok_or_else(|| $unit.base.missing($name))?;
        $unit.base.ready($name, $mend)?;
        $unit.base.mark.set(NUMBER);
        // SAFETY: the instance is alive and sound, every pointer is to memory of the length that is
        // given with it, and the function has the signature of the standard; what the FMU's own
        // code does is the FMU's.
        let status = unsafe { function($unit.instance, $($argument),*) };
        $unit.base.mark.set($crate::instance::call::NOWHERE);
        status
    }};
}
pub(crate) use call;

#[cfg(test)]
mod tests {
    use super::{LOADING, NOWHERE, function_name, function_number};
    use octant_fmi::{fmi2, fmi3};

    #[test]
    fn every_function_has_its_number() {
        for name in fmi2::NAMES.iter().chain(fmi3::NAMES) {
            assert_eq!(function_name(function_number(name)), Some(*name));
        }
    }

    #[test]
    fn other_numbers_are_no_function() {
        for number in [NOWHERE, 999, 1999, 5000, u32::MAX] {
            assert_eq!(function_name(number), None);
        }
        assert!(function_name(LOADING).is_some());
    }
}
