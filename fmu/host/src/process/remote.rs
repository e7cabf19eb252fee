//! The FMU seen from this process.

use super::super::archive::Unpacked;
use super::super::description::Description;
use super::super::instance::group::unfitting;
use super::super::instance::{
    ClockNews, FmuMessage, Instance, InstanceError, OpenOptions, StepOutcome, Stepped, Update,
    VariableGroup,
};
use super::message::{self, Answer, Reply, Request, VERSION};
use super::patience::Patience;
use super::shared::{Shared, Spin, Word, put, take};
use super::watch::{LOOK, Watch};
use std::io::{self, Read};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Largest number of different exchanges through shared memory; more go over the socket.
const PLANS_MAX: usize = 64;

/// An FMU in another process.
struct Remote {
    name: String,
    description: Arc<Description>,
    watch: Watch,
    socket: UnixStream,
    shared: Shared,
    spin: Spin,
    plans: Vec<(Vec<VariableGroup>, Vec<VariableGroup>)>,
    start_limit: Duration,
    time_limit: Duration,
    /// Dropped after the process.
    _folder: Unpacked,
}

/// Opens an unpacked FMU in a process of its own.
pub(crate) fn open(
    name: &str,
    folder: Unpacked,
    description: Arc<Description>,
    options: &OpenOptions,
) -> Result<Box<dyn Instance>, InstanceError> {
    let cannot = |e: io::Error| InstanceError::Process {
        fmu: name.into(),
        what: format!("can't be started: {e}"),
    };
    // Room for all variables at once; for unknown sizes the smallest.
    let numbers = description
        .variables
        .iter()
        .map(|variable| description.elements(variable).unwrap_or(1))
        .fold(0, usize::saturating_add);
    let (shared, memory) = Shared::create(numbers).map_err(cannot)?;
    let (socket, theirs) = UnixStream::pair().map_err(cannot)?;
    socket.set_read_timeout(Some(LOOK)).map_err(cannot)?;
    socket.set_write_timeout(Some(options.start_limit)).map_err(cannot)?;
    let path = std::path::absolute(folder.path()).map_err(cannot)?;
    let line = socket.try_clone().map_err(cannot)?;
    let watch = Watch::start(name, options, (line, theirs), memory)?;
    let mut remote = Remote {
        name: name.into(),
        description,
        watch,
        socket,
        shared,
        spin: Spin::new(),
        plans: Vec::new(),
        start_limit: options.start_limit,
        time_limit: options.time_limit,
        _folder: folder,
    };
    remote.ask(&Request::Open {
        version: VERSION.into(),
        name: name.into(),
        folder: path.as_os_str().as_bytes().to_vec(),
        options: Box::new(options.clone()),
    })?;
    Ok(Box::new(remote))
}

/// Reader with a deadline, which stops when the process has ended.
struct Patient<'a> {
    remote: &'a mut Remote,
    patience: &'a mut Patience,
    /// Reason why it stopped.
    error: Option<InstanceError>,
    request: &'a str,
}

impl Read for Patient<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.remote.socket.read(buffer) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) if e.kind() == io::ErrorKind::WouldBlock => {
                    let Remote { watch, shared, .. } = &mut *self.remote;
                    self.error = watch.look(shared);
                    if self.error.is_none() && self.patience.is_over(shared) {
                        let limit = self.patience.limit();
                        self.error = Some(watch.hangs(shared, self.request, limit));
                    }
                    if self.error.is_some() {
                        return Err(e);
                    }
                }
                other => return other,
            }
        }
    }
}

/// Sends a request and takes the value of its answer, which is of one kind.
macro_rules! ask {
    ($remote:ident, $request:expr => $answer:ident) => {
        match $remote.ask(&$request)? {
            Answer::$answer(value) => Ok(value),
            _ => $remote.confused(),
        }
    };
}

impl Remote {
    /// Reads the next message; `None`: it only woke this process.
    fn hear(
        &mut self,
        request: &str,
        patience: &mut Patience,
    ) -> Result<Option<Reply>, InstanceError> {
        let mut patient = Patient { remote: self, patience, error: None, request };
        let heard = message::read(&mut patient);
        let error = patient.error;
        match (heard, error) {
            (_, Some(error)) => Err(error),
            (Ok(heard), None) => Ok(heard),
            (Err(e), None) => Err(self.watch.lost(&self.shared, &e)),
        }
    }

    /// Sends one request over the socket, and reads its answer.
    fn ask(&mut self, request: &Request) -> Result<Answer, InstanceError> {
        self.watch.gone()?;
        let (what, limit) = match request {
            Request::Open { .. } => ("the opening", self.start_limit),
            Request::EnterInitialization { .. } | Request::ExitInitialization | Request::Reset => {
                ("the initialization", self.start_limit)
            }
            Request::Step { .. } | Request::ActivatePartition { .. } => ("a step", self.time_limit),
            Request::Quit => ("the end", self.time_limit),
            _ => ("a call", self.time_limit),
        };
        // Tells a child that polls the memory to read the socket.
        self.shared.word(Word::Plan).store(u64::MAX, Ordering::Relaxed);
        self.shared.word(Word::Request).fetch_add(1, Ordering::Release);
        if let Err(e) = message::write(&mut self.socket, request) {
            return Err(self.watch.lost(&self.shared, &e));
        }
        let mut patience = Patience::new(limit);
        loop {
            if let Some(reply) = self.hear(what, &mut patience)? {
                return reply;
            }
        }
    }

    /// Error for an answer that doesn't fit the request.
    fn confused<T>(&mut self) -> Result<T, InstanceError> {
        Err(self.watch.lost(&self.shared, &io::Error::other("an answer to another question")))
    }

    /// Number of an exchange with these groups; `None`: it doesn't go through shared memory.
    fn plan(
        &mut self,
        set: &[VariableGroup],
        get: &[VariableGroup],
    ) -> Result<Option<usize>, InstanceError> {
        if let Some(plan) = self.plans.iter().position(|(a, b)| a == set && b == get) {
            return Ok(Some(plan));
        }
        let elements = |groups: &[VariableGroup]| -> usize {
            groups.iter().map(|group| group.elements).fold(0, usize::saturating_add)
        };
        if self.plans.len() == PLANS_MAX
            || elements(set) > self.shared.inputs().len()
            || elements(get) > self.shared.outputs().len()
        {
            return Ok(None);
        }
        let (set, get) = (set.to_vec(), get.to_vec());
        ask!(self, Request::Plan { set: set.clone(), get: get.clone() } => Done)?;
        self.plans.push((set, get));
        Ok(Some(self.plans.len() - 1))
    }

    /// Waits for the answer to an exchange; returns true if it succeeded.
    fn wait(&mut self, before: u64) -> Result<bool, InstanceError> {
        if !self.spin.until_changed(self.shared.word(Word::Answer), before) {
            // Either the child sees that this process sleeps, or this process sees the answer.
            self.shared.word(Word::ParentSleeps).store(1, Ordering::SeqCst);
            let mut patience = Patience::new(self.time_limit);
            while self.shared.word(Word::Answer).load(Ordering::SeqCst) == before {
                if let Some(reply) = self.hear("a step", &mut patience)? {
                    self.shared.word(Word::ParentSleeps).store(0, Ordering::Relaxed);
                    return reply.and_then(|_| self.confused());
                }
            }
            self.shared.word(Word::ParentSleeps).store(0, Ordering::Relaxed);
        }
        Ok(self.shared.word(Word::Outcome).load(Ordering::Relaxed) & FAILED == 0)
    }
}

/// Bits of the outcome of an exchange.
pub(super) const FAILED: u64 = 1;
pub(super) const EARLY: u64 = 2;
pub(super) const DISCARDED: u64 = 4;
pub(super) const EVENT: u64 = 8;
pub(super) const TERMINATE: u64 = 16;

impl Instance for Remote {
    fn name(&self) -> &str {
        &self.name
    }

    fn description(&self) -> &Description {
        &self.description
    }

    fn exchange(
        &mut self,
        set: &[VariableGroup],
        inputs: &[f64],
        time_s: f64,
        step_s: f64,
        get: &[VariableGroup],
        outputs: &mut [f64],
    ) -> Result<Stepped, InstanceError> {
        self.watch.gone()?;
        let count =
            |groups: &[VariableGroup]| groups.iter().map(|group| group.elements).sum::<usize>();
        if inputs.len() != count(set) {
            return Err(unfitting(&self.name, set, inputs.len()));
        }
        if outputs.len() != count(get) {
            return Err(unfitting(&self.name, get, outputs.len()));
        }
        let Some(plan) = self.plan(set, get)? else {
            return by_parts(self, set, inputs, time_s, step_s, get, outputs);
        };
        let shared = &self.shared;
        put(shared.inputs(), inputs);
        shared.word(Word::Plan).store(plan as u64, Ordering::Relaxed);
        shared.word(Word::Time).store(time_s.to_bits(), Ordering::Relaxed);
        shared.word(Word::Step).store(step_s.to_bits(), Ordering::Relaxed);
        let before = shared.word(Word::Answer).load(Ordering::Relaxed);
        // Either the child sees the request, or this process sees that the child sleeps.
        shared.word(Word::Request).fetch_add(1, Ordering::SeqCst);
        if shared.word(Word::ChildSleeps).load(Ordering::SeqCst) != 0
            && let Err(e) = message::wake(&mut self.socket)
        {
            return Err(self.watch.lost(&self.shared, &e));
        }
        if !self.wait(before)? {
            let mut patience = Patience::new(self.time_limit);
            loop {
                if let Some(reply) = self.hear("a step", &mut patience)? {
                    return reply.and_then(|_| self.confused());
                }
            }
        }
        take(self.shared.outputs(), outputs);
        let bits = self.shared.word(Word::Outcome).load(Ordering::Relaxed);
        Ok(Stepped {
            time_s: f64::from_bits(self.shared.word(Word::Reached).load(Ordering::Relaxed)),
            outcome: if bits & DISCARDED != 0 {
                StepOutcome::Discarded
            } else if bits & EARLY != 0 {
                StepOutcome::Early
            } else {
                StepOutcome::Done
            },
            event: bits & EVENT != 0,
            terminate: bits & TERMINATE != 0,
        })
    }

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError> {
        ask!(self, Request::EnterInitialization { start_s, stop_s, tolerance } => Done)
    }

    fn exit_initialization(&mut self) -> Result<bool, InstanceError> {
        ask!(self, Request::ExitInitialization => Truth)
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        ask!(self, Request::Set { group: group.clone(), values: values.to_vec() } => Done)
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        if values.len() != group.elements {
            let groups = std::slice::from_ref(group);
            return Err(unfitting(&self.name, groups, values.len()));
        }
        match self.ask(&Request::Get { group: group.clone() })? {
            Answer::Numbers(numbers) if numbers.len() == values.len() => {
                values.copy_from_slice(&numbers);
                Ok(())
            }
            _ => self.confused(),
        }
    }

    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError> {
        ask!(self, Request::SetStrings { group: group.clone(), values: values.to_vec() } => Done)
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        ask!(self, Request::GetStrings { group: group.clone() } => Strings)
    }

    fn set_binaries(
        &mut self,
        group: &VariableGroup,
        values: &[Vec<u8>],
    ) -> Result<(), InstanceError> {
        ask!(self, Request::SetBinaries { group: group.clone(), values: values.to_vec() } => Done)
    }

    fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
        ask!(self, Request::GetBinaries { group: group.clone() } => Binaries)
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        ask!(self, Request::Step { time_s, step_s } => Stepped)
    }

    fn handle_events(&mut self) -> Result<bool, InstanceError> {
        ask!(self, Request::HandleEvents => Truth)
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        ask!(self, Request::EnterEventMode => Done)
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        ask!(self, Request::UpdateDiscreteStates => Update)
    }

    fn leave_event_mode(&mut self) -> Result<(), InstanceError> {
        ask!(self, Request::LeaveEventMode => Done)
    }

    fn activate_partition(&mut self, clock: u32, time_s: f64) -> Result<ClockNews, InstanceError> {
        ask!(self, Request::ActivatePartition { clock, time_s } => ClockNews)
    }

    fn partition_interval_s(&mut self, clock: u32) -> Result<Option<f64>, InstanceError> {
        ask!(self, Request::PartitionInterval(clock) => Interval)
    }

    fn keep_state(&mut self) -> Result<u64, InstanceError> {
        ask!(self, Request::KeepState => Number)
    }

    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError> {
        ask!(self, Request::RestoreState(state) => Done)
    }

    fn forget_state(&mut self, state: u64) -> Result<(), InstanceError> {
        ask!(self, Request::ForgetState(state) => Done)
    }

    fn state_to_bytes(&mut self, state: u64) -> Result<Vec<u8>, InstanceError> {
        ask!(self, Request::StateToBytes(state) => Bytes)
    }

    fn state_from_bytes(&mut self, bytes: &[u8]) -> Result<u64, InstanceError> {
        ask!(self, Request::StateFromBytes(bytes.to_vec()) => Number)
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        ask!(self, Request::Reset => Done)
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        ask!(self, Request::Terminate => Done)
    }

    fn finish(&mut self) -> Result<(), InstanceError> {
        ask!(self, Request::Quit => Done)?;
        self.watch.end_of_child(&self.shared, self.time_limit)
    }

    /// Returns no messages from a process that has ended.
    fn messages(&mut self) -> Vec<FmuMessage> {
        if self.watch.gone().is_err()
            || self.shared.word(Word::MessagesWait).load(Ordering::Relaxed) == 0
        {
            return Vec::new();
        }
        match self.ask(&Request::Messages) {
            Ok(Answer::Messages(messages)) => messages,
            _ => Vec::new(),
        }
    }
}

/// Makes an exchange whose numbers don't go through shared memory.
fn by_parts(
    remote: &mut Remote,
    set: &[VariableGroup],
    mut inputs: &[f64],
    time_s: f64,
    step_s: f64,
    get: &[VariableGroup],
    mut outputs: &mut [f64],
) -> Result<Stepped, InstanceError> {
    for group in set {
        let (these, others) = inputs.split_at(group.elements);
        remote.set(group, these)?;
        inputs = others;
    }
    let stepped = remote.advance(time_s, step_s)?;
    for group in get {
        let (these, others) = outputs.split_at_mut(group.elements);
        remote.get(group, these)?;
        outputs = others;
    }
    Ok(stepped)
}

impl Drop for Remote {
    fn drop(&mut self) {
        if self.watch.gone().is_ok() {
            // The child frees the FMU and ends; if it doesn't, it is killed.
            self.shared.word(Word::Plan).store(u64::MAX, Ordering::Relaxed);
            self.shared.word(Word::Request).fetch_add(1, Ordering::Release);
            let _ = message::write(&mut self.socket, &Request::Quit);
            self.watch.finish(self.time_limit);
        }
    }
}
