//! One call of a function of an FMU: its name, its status, and the meaning of the status.

use super::super::description::Description;
use super::error::InstanceError;
use super::message::{FmuMessage, Log, status_name};
use octant_fmi::{fmi2, fmi3};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A word that holds the number of the running function, for an observer in another process.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mark(pub(crate) Option<&'static AtomicU64>);

/// No function is running.
pub(crate) const NOWHERE: u32 = 0;

/// The library is being loaded: its constructors may run.
pub(crate) const LOADING: u32 = 1;

/// The library is being unloaded: its destructors may run.
pub(crate) const UNLOADING: u32 = 2;

/// First numbers of the functions of FMI 2.0 and FMI 3.0.
const FIRST_FMI2: u32 = 1000;
const FIRST_FMI3: u32 = 2000;

impl Mark {
    /// Marks the begin of a function; [`NOWHERE`]: its end.
    pub(crate) fn set(self, function: u32) {
        if let Some(word) = self.0 {
            word.store(u64::from(function), Ordering::Relaxed);
        }
    }
}

/// Name of a function by the number in a mark.
#[cfg_attr(not(target_os = "linux"), allow(dead_code, reason = "who watches is on Linux"))]
pub(crate) fn function_name(function: u32) -> Option<&'static str> {
    let at = |names: &[&'static str], first: u32| {
        names.get(usize::try_from(function.checked_sub(first)?).ok()?).copied()
    };
    match function {
        LOADING => return Some("the loading of its library"),
        UNLOADING => return Some("the unloading of its library"),
        _ => {}
    }
    at(fmi3::NAMES, FIRST_FMI3).or_else(|| at(fmi2::NAMES, FIRST_FMI2))
}

/// Number of a function, determined at compile time.
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

/// Largest size of a state, bytes.
const STATE_MAX: usize = 1 << 30;

/// Condition of the FMU: whether it may still be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Condition {
    /// The FMU may be called.
    Sound,
    /// The FMU answered error: it can be reset, restored or freed.
    Failed,
    /// The FMU answered fatal: it must not be called again.
    Lost,
}

/// A status other than a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Fine,
    Discard,
    Pending,
}

/// Common part of every instance of both standards.
pub(crate) struct Base {
    pub(crate) name: String,
    pub(crate) description: Arc<Description>,
    pub(super) log: Arc<Log>,
    pub(crate) mark: Mark,
    pub(crate) condition: Condition,
}

impl Base {
    /// Error for a missing function.
    #[cold]
    pub(crate) fn missing(&self, function: &str) -> InstanceError {
        InstanceError::unsupported(
            &self.name,
            format!("call {function}"),
            "its library doesn't have this function",
        )
    }

    /// Refuses a call of an FMU that isn't sound (or, with `mend`, that can't be recovered).
    pub(crate) fn ready(&self, function: &str, mend: bool) -> Result<(), InstanceError> {
        match self.condition {
            Condition::Sound => Ok(()),
            Condition::Failed if mend => Ok(()),
            Condition::Failed => Err(self.order(function, "after it answered error")),
            Condition::Lost => Err(self.order(function, "after it answered fatal")),
        }
    }

    /// Error for a call at a time at which the standard forbids it.
    #[cold]
    pub(crate) fn order(&self, what: &str, when: &str) -> InstanceError {
        InstanceError::Order { fmu: self.name.clone(), what: what.into(), when: when.into() }
    }

    /// Interprets a status.
    pub(crate) fn answer(&mut self, function: &str, status: i32) -> Result<Answer, InstanceError> {
        match status {
            fmi2::OK | fmi2::WARNING => Ok(Answer::Fine),
            fmi2::DISCARD => Ok(Answer::Discard),
            fmi2::PENDING => Ok(Answer::Pending),
            fmi2::ERROR => {
                self.condition = Condition::Failed;
                Err(self.failed(function, status_name(status)))
            }
            // After an unknown status it is unknown what still works.
            _ => {
                self.condition = Condition::Lost;
                Err(self.failed(function, status_name(status)))
            }
        }
    }

    /// Interprets a status for a call that needs success. A discarded call leaves the FMU sound.
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

    /// Error for a failed function.
    #[cold]
    pub(crate) fn failed(&self, function: &str, status: &str) -> InstanceError {
        InstanceError::Failed {
            fmu: self.name.clone(),
            function: function.into(),
            status: status.into(),
            said: self.log.last(&self.description),
        }
    }

    /// Allocates memory for a state of the size that the FMU reports.
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

    /// Adds a warning of this program to the messages of the FMU.
    #[cold]
    pub(crate) fn note(&self, text: &str) {
        self.log.note(text);
    }

    /// Messages that the FMU logged.
    pub(crate) fn messages(&self) -> Vec<FmuMessage> {
        self.log.drain(&self.description)
    }
}

/// Calls a function of an FMU's table with its instance first, and returns what its status means:
/// [`Answer`], or an error, also if the function is missing or must not be called. With `mend`: also
/// after the FMU answered error.
macro_rules! ask {
    (mend $unit:ident.$name:ident($($argument:expr),* $(,)?)) => {
        $crate::instance::call::status!($unit $name true ($($argument),*))
            .and_then(|status| $unit.base.answer(stringify!($name), status))
    };
    ($unit:ident.$name:ident($($argument:expr),* $(,)?)) => {
        $crate::instance::call::status!($unit $name false ($($argument),*))
            .and_then(|status| $unit.base.answer(stringify!($name), status))
    };
}
pub(crate) use ask;

/// Calls a function as [`ask!`] does, and takes a discarded or pending call as an error too.
macro_rules! call {
    (mend $unit:ident.$name:ident($($argument:expr),* $(,)?)) => {
        $crate::instance::call::status!($unit $name true ($($argument),*))
            .and_then(|status| $unit.base.check(stringify!($name), status))
    };
    ($unit:ident.$name:ident($($argument:expr),* $(,)?)) => {
        $crate::instance::call::status!($unit $name false ($($argument),*))
            .and_then(|status| $unit.base.check(stringify!($name), status))
    };
}
pub(crate) use call;

/// Calls a function and returns its status.
macro_rules! status {
    ($unit:ident $name:ident $mend:literal ($($argument:expr),*)) => {
        match $unit.functions.$name {
            None => Err($unit.base.missing(stringify!($name))),
            Some(function) => $unit.base.ready(stringify!($name), $mend).map(|()| {
                $unit.base.mark.set(const { $crate::instance::call::function_number(stringify!($name)) });
                // SAFETY: the instance is alive and sound, every pointer is to memory of the length
                // that is given with it, and the function has the signature of the standard; what
                // the FMU's own code does is the FMU's.
                let status = unsafe { function($unit.instance, $($argument),*) };
                $unit.base.mark.set($crate::instance::call::NOWHERE);
                status
            }),
        }
    };
}
pub(crate) use status;

/// The functions of [`super::unit::Unit`] that differ between the standards in their names alone.
macro_rules! functions_of_both {
    (
        $exit_initialization:ident $terminate:ident $reset:ident $enter_event_mode:ident
        $get_state:ident $set_state:ident $free_state:ident
        $state_size:ident $serialize:ident $deserialize:ident
    ) => {
        fn base(&self) -> &Base {
            &self.base
        }

        fn exit_initialization(&mut self) -> Result<(), InstanceError> {
            call!(self.$exit_initialization())
        }

        fn terminate(&mut self) -> Result<(), InstanceError> {
            call!(self.$terminate())
        }

        fn reset(&mut self) -> Result<(), InstanceError> {
            call!(mend self.$reset())?;
            self.base.condition = Condition::Sound;
            Ok(())
        }

        fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
            call!(self.$enter_event_mode())
        }

        fn state(&mut self) -> Result<RawState, InstanceError> {
            let mut state = ptr::null_mut();
            call!(self.$get_state(&mut state))?;
            Ok(state)
        }

        fn set_state(&mut self, state: RawState) -> Result<(), InstanceError> {
            call!(mend self.$set_state(state))?;
            self.base.condition = Condition::Sound;
            Ok(())
        }

        fn free_state(&mut self, mut state: RawState) -> Result<(), InstanceError> {
            call!(mend self.$free_state(&mut state))
        }

        fn serialize(&mut self, state: RawState) -> Result<Vec<u8>, InstanceError> {
            let mut size = 0;
            call!(self.$state_size(state, &mut size))?;
            let mut bytes = self.base.state_buffer(size)?;
            call!(self.$serialize(state, bytes.as_mut_ptr().cast(), size))?;
            Ok(bytes)
        }

        fn deserialize(&mut self, bytes: &[u8]) -> Result<RawState, InstanceError> {
            let mut state = ptr::null_mut();
            call!(self.$deserialize(bytes.as_ptr().cast(), bytes.len(), &mut state))?;
            Ok(state)
        }
    };
}
pub(crate) use functions_of_both;

/// Frees an instance of either standard when it is dropped, unless the FMU is lost: then it isn't
/// called again, and the objects that it may still use have to stay.
macro_rules! free_on_drop {
    ($free:ident, $($kept:ident),*) => {
        impl Drop for Component {
            fn drop(&mut self) {
                if self.base.condition == Condition::Lost {
                    std::mem::forget((
                        $(Arc::clone(&self.$kept),)*
                        Arc::clone(&self.base.log),
                    ));
                    return;
                }
                if let Some(free) = self.functions.$free {
                    self.base.mark.set(function_number(stringify!($free)));
                    // SAFETY: the instance is alive, and this is the last that is done with it.
                    unsafe { free(self.instance) };
                    // The library may be unloaded next, which runs its destructors.
                    self.base.mark.set(UNLOADING);
                }
            }
        }
    };
}
pub(crate) use free_on_drop;

#[cfg(test)]
mod tests {
    use super::{LOADING, NOWHERE, UNLOADING, function_name, function_number};
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
        assert!(function_name(LOADING).is_some() && function_name(UNLOADING).is_some());
    }
}
