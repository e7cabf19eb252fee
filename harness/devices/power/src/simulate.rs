//! A simulated instrument on a TCP port, for tests: a supply with channels, or relays.
//!
//! It knows the commands of this crate in their short form, has an error queue, and feeds a resistor with a capacitor at
//! each output. Its peculiarities are those that a driver has to stand.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Peculiarities of a simulated instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peculiarities {
    /// Largest voltage, V.
    pub voltage_max_v: f64,
    /// Resistor at each output, Ω.
    pub load_ohm: f64,
    /// Time constant with which the voltage at an output follows, s.
    pub time_constant_s: f64,
    /// True if it answers nothing.
    pub silent: bool,
    /// True if it takes `OUTP` and `ROUT` and does nothing.
    pub stuck: bool,
    /// True if its states are ON and OFF in place of 1 and 0.
    pub words: bool,
    /// True if it measures something that is no number.
    pub no_number: bool,
    /// True if its error queue never ends.
    pub endless: bool,
    /// True if its identity acts on a terminal.
    pub hostile: bool,
}

impl Default for Peculiarities {
    fn default() -> Self {
        Self {
            voltage_max_v: 60.0,
            load_ohm: 48.0,
            time_constant_s: 0.0,
            silent: false,
            stuck: false,
            words: false,
            no_number: false,
            endless: false,
            hostile: false,
        }
    }
}

/// One output of a simulated supply.
#[derive(Clone, Copy, Debug)]
struct SimulatedChannel {
    set_v: f64,
    limit_a: f64,
    on: bool,
    /// Voltage from which the present one follows, V, and since when.
    from_v: f64,
    since: Instant,
}

impl SimulatedChannel {
    fn new() -> Self {
        Self { set_v: 0.0, limit_a: 1.0, on: false, from_v: 0.0, since: Instant::now() }
    }

    fn voltage_v(&self, how: &Peculiarities) -> f64 {
        let to_v = if self.on { self.set_v.min(self.limit_a * how.load_ohm) } else { 0.0 };
        let share = match how.time_constant_s > 0.0 {
            true => (-self.since.elapsed().as_secs_f64() / how.time_constant_s).exp(),
            false => 0.0,
        };
        to_v + (self.from_v - to_v) * share
    }

    fn change(&mut self, how: &Peculiarities, change: impl FnOnce(&mut Self)) {
        self.from_v = self.voltage_v(how);
        self.since = Instant::now();
        change(self);
    }
}

/// Called with each change: a number of a channel or a relay, whether it is on, and the set voltage, V.
type OnChange = Box<dyn FnMut(u32, bool, f64) + Send>;

struct State {
    how: Peculiarities,
    channels: BTreeMap<u32, SimulatedChannel>,
    relays: BTreeSet<u32>,
    selected: u32,
    errors: VecDeque<&'static str>,
    heard: Vec<String>,
    on_change: Option<OnChange>,
}

/// A simulated instrument that listens on a TCP port of loopback, until the process ends.
#[derive(Clone)]
pub struct SimulatedInstrument {
    address: SocketAddr,
    state: Arc<Mutex<State>>,
}

impl std::fmt::Debug for SimulatedInstrument {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SimulatedInstrument").field("address", &self.address).finish()
    }
}

impl SimulatedInstrument {
    /// Starts an instrument with three channels and nine relays on any free port.
    ///
    /// # Errors
    /// If no port is free.
    pub fn start(how: Peculiarities) -> std::io::Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let channels = (1..=3).map(|channel| (channel, SimulatedChannel::new())).collect();
        let state = State {
            how,
            channels,
            relays: BTreeSet::new(),
            selected: 1,
            errors: VecDeque::new(),
            heard: Vec::new(),
            on_change: None,
        };
        let this = Self { address: listener.local_addr()?, state: Arc::new(Mutex::new(state)) };
        let shared = Arc::clone(&this.state);
        std::thread::Builder::new().name("simulated supply".into()).spawn(move || {
            for stream in listener.incoming().flatten() {
                let state = Arc::clone(&shared);
                std::thread::spawn(move || serve(&stream, &state));
            }
        })?;
        Ok(this)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Port as a plan has it.
    #[must_use]
    pub fn port(&self) -> String {
        format!("tcp:{}", self.address)
    }

    /// Lines that it has heard.
    #[must_use]
    pub fn heard(&self) -> Vec<String> {
        self.state().heard.clone()
    }

    /// Whether a channel or a relay of this number is on.
    #[must_use]
    pub fn is_on(&self, number: u32) -> bool {
        let state = self.state();
        state.relays.contains(&number)
            || state.channels.get(&number).is_some_and(|channel| channel.on)
    }

    /// Set voltage of a channel, V.
    #[must_use]
    pub fn set_v(&self, number: u32) -> f64 {
        self.state().channels.get(&number).map_or(f64::NAN, |channel| channel.set_v)
    }

    /// Gives it other peculiarities.
    pub fn becomes(&self, how: Peculiarities) {
        let mut state = self.state();
        let before = std::mem::replace(&mut state.how, how);
        for channel in state.channels.values_mut() {
            channel.change(&before, |_| {});
        }
    }

    /// Calls a function with each change of a channel or a relay.
    pub fn on_change(&self, call: impl FnMut(u32, bool, f64) + Send + 'static) {
        self.state().on_change = Some(Box::new(call));
    }
}

fn serve(stream: &TcpStream, state: &Mutex<State>) {
    let mut out = stream;
    for line in BufReader::new(stream).lines() {
        let Ok(line) = line else { return };
        let reply = state.lock().unwrap_or_else(PoisonError::into_inner).take(line.trim());
        if let Some(reply) = reply
            && out.write_all(format!("{reply}\r\n").as_bytes()).is_err()
        {
            return;
        }
    }
}

/// Number in a list of one channel, `(@N)`.
fn listed(text: &str) -> Option<u32> {
    let number = text.strip_prefix("(@")?.strip_suffix(')')?.parse().ok()?;
    (1..=9).contains(&number).then_some(number)
}

impl State {
    /// Takes a line and returns the reply, where it has one.
    fn take(&mut self, line: &str) -> Option<String> {
        if line.is_empty() {
            return None;
        }
        self.heard.push(line.to_owned());
        let reply = self.answer(line);
        reply.filter(|_| !self.how.silent)
    }

    fn error(&mut self, words: &'static str) -> Option<String> {
        self.errors.push_back(words);
        None
    }

    fn word(&self, on: bool) -> String {
        let word = match (on, self.how.words) {
            (true, true) => "ON",
            (false, true) => "OFF",
            (true, false) => "1",
            (false, false) => "0",
        };
        word.to_owned()
    }

    fn answer(&mut self, line: &str) -> Option<String> {
        let (header, value) = line.split_once(' ').unwrap_or((line, ""));
        let how = self.how;
        let selected = self.selected;
        let channel = self.channels.get(&selected).copied().unwrap_or(SimulatedChannel::new());
        match header {
            "*IDN?" if how.hostile => {
                Some("Octant,\u{1b}[2Jsupply\u{7},\u{9b}31m0,1.0\u{202e}".to_owned())
            }
            "*IDN?" => Some("Octant,simulated supply,0,1.0".to_owned()),
            "*CLS" => {
                self.errors.clear();
                None
            }
            "*RST" => {
                for channel in self.channels.values_mut() {
                    *channel = SimulatedChannel::new();
                }
                self.relays.clear();
                None
            }
            "SYST:REM" => None,
            "SYST:ERR?" if how.endless => Some("-350,\"Queue overflow\"".to_owned()),
            "SYST:ERR?" => Some(self.errors.pop_front().unwrap_or("+0,\"No error\"").to_owned()),
            "INST:NSEL" => match value.parse().ok().filter(|n| self.channels.contains_key(n)) {
                Some(number) => {
                    self.selected = number;
                    None
                }
                None => self.error("-222,\"Data out of range\""),
            },
            "VOLT?" => Some(format!("{:.4E}", channel.set_v)),
            "CURR?" => Some(format!("{:.4E}", channel.limit_a)),
            "OUTP?" => Some(self.word(channel.on)),
            "MEAS:VOLT?" if how.no_number => Some("9.91E37".to_owned()),
            "MEAS:VOLT?" => Some(format!("{:+.6E}", channel.voltage_v(&how))),
            "MEAS:CURR?" => Some(format!("{:+.6E}", channel.voltage_v(&how) / how.load_ohm)),
            "VOLT" | "CURR" => match value.parse::<f64>() {
                Ok(v) if header == "VOLT" && (0.0..=how.voltage_max_v).contains(&v) => {
                    self.channel(|channel| channel.set_v = v)
                }
                Ok(a) if header == "CURR" && (0.0..=10.0).contains(&a) => {
                    self.channel(|channel| channel.limit_a = a)
                }
                Ok(_) => self.error("-222,\"Data out of range\""),
                Err(_) => self.error("-104,\"Data type error\""),
            },
            "OUTP" => match value {
                "ON" | "OFF" if how.stuck => None,
                "ON" | "OFF" => self.channel(|channel| channel.on = value == "ON"),
                _ => self.error("-224,\"Illegal parameter value\""),
            },
            "ROUT:CLOS" | "ROUT:OPEN" => match listed(value) {
                Some(_) if how.stuck => None,
                Some(number) => {
                    let closed = header == "ROUT:CLOS";
                    match closed {
                        true => self.relays.insert(number),
                        false => self.relays.remove(&number),
                    };
                    self.tell(number, closed, 0.0);
                    None
                }
                None => self.error("-222,\"Data out of range\""),
            },
            "ROUT:CLOS?" => match listed(value) {
                Some(number) => Some(self.word(self.relays.contains(&number))),
                None => self.error("-222,\"Data out of range\""),
            },
            _ => self.error("-113,\"Undefined header\""),
        }
    }

    fn channel(&mut self, change: impl FnOnce(&mut SimulatedChannel)) -> Option<String> {
        let (how, selected) = (self.how, self.selected);
        if let Some(channel) = self.channels.get_mut(&selected) {
            channel.change(&how, change);
            let (on, set_v) = (channel.on, channel.set_v);
            self.tell(selected, on, set_v);
        }
        None
    }

    fn tell(&mut self, number: u32, on: bool, set_v: f64) {
        if let Some(call) = &mut self.on_change {
            call(number, on, set_v);
        }
    }
}

/// Waits until a condition holds; false: it didn't within the time.
#[must_use]
pub fn within(time: Duration, mut holds: impl FnMut() -> bool) -> bool {
    let begun = Instant::now();
    while !holds() {
        if begun.elapsed() >= time {
            return false;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    true
}
