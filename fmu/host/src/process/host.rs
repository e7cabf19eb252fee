//! The other process: it hosts one FMU and executes requests.

use super::super::instance::call::{Mark, UNLOADING};
use super::super::instance::open::{FmuOpenError, open_folder};
use super::super::instance::{
    FmuMessage, Instance, InstanceError, StepOutcome, Stepped, VariableGroup,
};
use super::guard::FmuServeError;
use super::message::{self, Answer, Reply, Request, VERSION};
use super::remote::{DISCARDED, EARLY, EVENT, FAILED, TERMINATE};
use super::shared::{Shared, Spin, Word, put, take};
use rustix::event::{PollFd, PollFlags, poll};
use std::ffi::OsStr;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Largest number of messages held for the other process.
const MESSAGES_MAX: usize = 10_000;

/// Serves the process at the other end of the socket, until that has finished with the FMU.
///
/// # Errors
/// If no such process started this one: standard input and output are not those that it provides.
pub fn serve() -> Result<(), FmuServeError> {
    let connect = || -> io::Result<(UnixStream, Shared)> {
        let socket: OwnedFd = rustix::io::fcntl_dupfd_cloexec(io::stdin(), 3)?;
        rustix::net::sockopt::socket_type(&socket)?;
        let memory = rustix::io::fcntl_dupfd_cloexec(io::stdout(), 3)?;
        let shared = Shared::open(&memory)?;
        // From here on the FMU may use standard input and output.
        let empty = std::fs::File::open("/dev/null")?;
        rustix::stdio::dup2_stdin(&empty)?;
        rustix::stdio::dup2_stdout(io::stderr())?;
        Ok((socket.into(), shared))
    };
    let (socket, shared) = connect().map_err(|error| FmuServeError::NotStarted { error })?;
    // Without the guard nothing would end what the FMU starts.
    rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL))
        .map_err(|error| FmuServeError::Watch { error: error.into() })?;
    // The mapping stays to the end of the process: the FMU's last calls are marked there.
    let shared: &'static Shared = Box::leak(Box::new(shared));
    shared.word(Word::Process).store(u64::from(std::process::id()), Ordering::Relaxed);
    watch_parent(&socket)?;
    Host { socket, shared, spin: Spin::new(), plans: Vec::new(), messages: Vec::new() }
        .run()
        .map_err(|error| FmuServeError::Lost { error })
}

/// Ends this process when the other has ended, whatever the FMU is doing.
fn watch_parent(socket: &UnixStream) -> Result<(), FmuServeError> {
    let socket = socket.try_clone().map_err(|error| FmuServeError::Watch { error })?;
    let watch = move || {
        loop {
            // No event is requested: the only one reported is that the other end is closed.
            let mut ends = [PollFd::new(&socket, PollFlags::empty())];
            if poll(&mut ends, None).is_ok() && !ends[0].revents().is_empty() {
                // A kill, so that no code of the FMU runs any more, not even a destructor.
                let _ = rustix::process::kill_process(
                    rustix::process::getpid(),
                    rustix::process::Signal::KILL,
                );
            }
        }
    };
    let thread = std::thread::Builder::new().name("parent".into()).stack_size(64 * 1024);
    thread.spawn(watch).map(|_| ()).map_err(|error| FmuServeError::Thread { error })
}

/// An exchange: its groups, and buffers for its numbers.
struct Plan {
    set: Vec<VariableGroup>,
    get: Vec<VariableGroup>,
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

struct Host {
    socket: UnixStream,
    shared: &'static Shared,
    spin: Spin,
    plans: Vec<Plan>,
    /// Messages taken from the FMU, but not requested yet.
    messages: Vec<FmuMessage>,
}

impl Host {
    fn run(mut self) -> io::Result<()> {
        let mut instance = match self.open()? {
            Ok(instance) => {
                message::write(&mut self.socket, &Reply::Ok(Answer::Done(())))?;
                instance
            }
            Err(error) => return message::write(&mut self.socket, &Reply::Err(error)),
        };
        let mut done = self.shared.word(Word::Request).load(Ordering::Acquire);
        self.gather(&mut *instance);
        loop {
            let request = self.next(&mut done)?;
            match request {
                Some(Request::Quit) => {
                    drop(instance);
                    // Destructors that weren't run yet are run when this process ends.
                    Mark(Some(self.shared.word(Word::Function))).set(UNLOADING);
                    return message::write(&mut self.socket, &Reply::Ok(Answer::Done(())));
                }
                Some(request) => {
                    let reply = self.reply(&mut *instance, request);
                    self.gather(&mut *instance);
                    message::write(&mut self.socket, &reply)?;
                }
                None => self.exchange(&mut *instance)?,
            }
        }
    }

    /// Opens the FMU of the first request.
    fn open(&mut self) -> io::Result<Result<Box<dyn Instance>, InstanceError>> {
        loop {
            match message::read(&mut self.socket)? {
                None => {}
                Some(Request::Open { version, name, folder, options }) if version == VERSION => {
                    let folder = Path::new(OsStr::from_bytes(&folder));
                    let mark = Mark(Some(self.shared.word(Word::Function)));
                    return Ok(open_folder(&name, folder, &options, mark).map_err(|e| match e {
                        FmuOpenError::Instance(error) => error,
                        other => InstanceError::load(&name, other.to_string()),
                    }));
                }
                Some(_) => return Err(io::Error::other("it is another version of octant")),
            }
        }
    }

    /// Reads the next request; `None`: an exchange through shared memory.
    fn next(&mut self, done: &mut u64) -> io::Result<Option<Request>> {
        let word = self.shared.word(Word::Request);
        loop {
            if !self.spin.until_changed(word, *done) {
                // Either the other process sees that this one sleeps, or this one sees the request.
                let sleeps = self.shared.word(Word::ChildSleeps);
                sleeps.store(1, Ordering::SeqCst);
                let mut heard = None;
                if word.load(Ordering::SeqCst) == *done {
                    heard = message::read(&mut self.socket)?;
                }
                sleeps.store(0, Ordering::Relaxed);
                if let Some(request) = heard {
                    *done = word.load(Ordering::Acquire);
                    return Ok(Some(request));
                }
            }
            let now = word.load(Ordering::Acquire);
            if now == *done {
                continue;
            }
            *done = now;
            if self.shared.word(Word::Plan).load(Ordering::Relaxed) != u64::MAX {
                return Ok(None);
            }
            loop {
                if let Some(request) = message::read(&mut self.socket)? {
                    return Ok(Some(request));
                }
            }
        }
    }

    /// Executes one exchange through shared memory.
    fn exchange(&mut self, instance: &mut dyn Instance) -> io::Result<()> {
        let shared = self.shared;
        let number = shared.word(Word::Plan).load(Ordering::Relaxed);
        let plan = usize::try_from(number).ok().and_then(|number| self.plans.get_mut(number));
        let Some(plan) = plan else {
            return Err(io::Error::other("an exchange that was never planned"));
        };
        take(shared.inputs(), &mut plan.inputs);
        let time_s = f64::from_bits(shared.word(Word::Time).load(Ordering::Relaxed));
        let step_s = f64::from_bits(shared.word(Word::Step).load(Ordering::Relaxed));
        let Plan { set, get, inputs, outputs } = plan;
        let stepped = instance.exchange(set, inputs, time_s, step_s, get, outputs);
        let error = match stepped {
            Ok(stepped) => {
                put(shared.outputs(), outputs);
                shared.word(Word::Outcome).store(bits(&stepped), Ordering::Relaxed);
                shared.word(Word::Reached).store(stepped.time_s.to_bits(), Ordering::Relaxed);
                None
            }
            Err(error) => {
                shared.word(Word::Outcome).store(FAILED, Ordering::Relaxed);
                Some(error)
            }
        };
        self.gather(instance);
        // Either the other process sees the answer, or this one sees that the other sleeps.
        shared.word(Word::Answer).fetch_add(1, Ordering::SeqCst);
        if shared.word(Word::ParentSleeps).load(Ordering::SeqCst) != 0 {
            message::wake(&mut self.socket)?;
        }
        match error {
            Some(error) => message::write(&mut self.socket, &Reply::Err(error)),
            None => Ok(()),
        }
    }

    /// Takes the FMU's messages, and reports whether there are some to request.
    fn gather(&mut self, instance: &mut dyn Instance) {
        let mut new = instance.messages();
        if !new.is_empty() {
            new.truncate(MESSAGES_MAX.saturating_sub(self.messages.len()));
            self.messages.append(&mut new);
            self.shared.word(Word::MessagesWait).store(1, Ordering::Relaxed);
        }
    }

    /// Executes a request and makes its answer.
    fn reply(&mut self, instance: &mut dyn Instance, request: Request) -> Reply {
        Ok(match request {
            Request::EnterInitialization { start_s, stop_s, tolerance } => {
                Answer::Done(instance.enter_initialization(start_s, stop_s, tolerance)?)
            }
            Request::ExitInitialization => Answer::Truth(instance.exit_initialization()?),
            Request::Set { group, values } => Answer::Done(instance.set(&group, &values)?),
            Request::Get { group } => {
                let mut values = vec![0.0; group.elements];
                instance.get(&group, &mut values)?;
                Answer::Numbers(values)
            }
            Request::SetStrings { group, values } => {
                Answer::Done(instance.set_strings(&group, &values)?)
            }
            Request::GetStrings { group } => Answer::Strings(instance.get_strings(&group)?),
            Request::SetBinaries { group, values } => {
                Answer::Done(instance.set_binaries(&group, &values)?)
            }
            Request::GetBinaries { group } => Answer::Binaries(instance.get_binaries(&group)?),
            Request::Step { time_s, step_s } => Answer::Stepped(instance.step(time_s, step_s)?),
            Request::Plan { set, get } => {
                let room = |groups: &[VariableGroup]| {
                    vec![0.0; groups.iter().map(|group| group.elements).sum::<usize>()]
                };
                let (inputs, outputs) = (room(&set), room(&get));
                self.plans.push(Plan { set, get, inputs, outputs });
                Answer::Done(())
            }
            Request::HandleEvents => Answer::Truth(instance.handle_events()?),
            Request::EnterEventMode => Answer::Done(instance.enter_event_mode()?),
            Request::UpdateDiscreteStates => Answer::Update(instance.update_discrete_states()?),
            Request::LeaveEventMode => Answer::Done(instance.leave_event_mode()?),
            Request::ActivatePartition { clock, time_s } => {
                Answer::ClockNews(instance.activate_partition(clock, time_s)?)
            }
            Request::PartitionInterval(clock) => {
                Answer::Interval(instance.partition_interval_s(clock)?)
            }
            Request::KeepState => Answer::Number(instance.keep_state()?),
            Request::RestoreState(state) => Answer::Done(instance.restore_state(state)?),
            Request::ForgetState(state) => Answer::Done(instance.forget_state(state)?),
            Request::StateToBytes(state) => Answer::Bytes(instance.state_to_bytes(state)?),
            Request::StateFromBytes(bytes) => Answer::Number(instance.state_from_bytes(&bytes)?),
            Request::Reset => Answer::Done(instance.reset()?),
            Request::Terminate => Answer::Done(instance.terminate()?),
            Request::Messages => {
                self.shared.word(Word::MessagesWait).store(0, Ordering::Relaxed);
                Answer::Messages(std::mem::take(&mut self.messages))
            }
            // The first and the last request are handled elsewhere.
            Request::Open { .. } | Request::Quit => Answer::Done(()),
        })
    }
}

/// Encodes the result of a step in the bits of a word.
fn bits(stepped: &Stepped) -> u64 {
    let outcome = match stepped.outcome {
        StepOutcome::Done => 0,
        StepOutcome::Early => EARLY,
        StepOutcome::Discarded => DISCARDED,
    };
    let event = if stepped.event { EVENT } else { 0 };
    outcome | event | if stepped.terminate { TERMINATE } else { 0 }
}
