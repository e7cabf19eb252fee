//! The output that feeds a device: begun, cut, lowered, measured, and brought to its end state.

use crate::PowerError;
use crate::last_words::LastWords;
use crate::plan::{Outlet, PowerPlan, SupplySetting};
use crate::scpi::ScpiDialogue;
use octant_base::interrupt;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

/// Pause between two measurements while a voltage settles.
const LOOK: Duration = Duration::from_millis(20);

/// State of an output, as the instrument reports and measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerReading {
    /// True if it is on.
    pub on: bool,
    /// Voltage, V; `None`: a relay.
    pub voltage_v: Option<f64>,
    /// Current, A; `None`: a relay.
    pub current_a: Option<f64>,
}

/// One switching of an output.
#[derive(Clone, Debug, PartialEq)]
pub struct Switching {
    /// Command that switched.
    pub command: String,
    /// Time of the host at which the command was sent.
    pub at: SystemTime,
    /// Number of the sample before which it was switched; `None`: before the first or after the last.
    pub sample: Option<u64>,
    /// State before.
    pub before: PowerReading,
    /// State after, when the voltage had settled.
    pub after: PowerReading,
}

/// Voltage that is waited for.
#[derive(Clone, Copy, Debug)]
enum Wanted {
    /// Within a share of a voltage.
    Near(f64),
    /// Below the tolerance of the set voltage.
    Low,
}

/// The output that feeds a device. It is brought to its end state when it is dropped.
#[derive(Debug)]
pub struct PowerOutlet {
    plan: PowerPlan,
    dialogue: ScpiDialogue,
    switchings: Vec<Switching>,
    /// Time of the last switching.
    switched: Instant,
    ended: bool,
    last_words: Option<Arc<LastWords>>,
}

impl PowerOutlet {
    /// Opens the port of the output. Nothing is switched, not even in the end, until [`Self::begin`].
    ///
    /// # Errors
    /// If no instrument answers.
    pub fn open(plan: &PowerPlan) -> Result<Self, PowerError> {
        let dialogue = ScpiDialogue::open(&plan.port, plan.reply, plan.remote)?;
        Ok(Self {
            plan: plan.clone(),
            dialogue,
            switchings: Vec::new(),
            switched: Instant::now(),
            ended: true,
            last_words: None,
        })
    }

    /// Reply to `*IDN?`.
    #[must_use]
    pub fn identity(&self) -> &str {
        self.dialogue.identity()
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &PowerPlan {
        &self.plan
    }

    /// All switchings so far.
    #[must_use]
    pub fn switchings(&self) -> &[Switching] {
        &self.switchings
    }

    /// Time since the last switching.
    #[must_use]
    pub fn since_switched(&self) -> Duration {
        self.switched.elapsed()
    }

    /// The dialogue, for commands by hand.
    pub fn dialogue(&mut self) -> &mut ScpiDialogue {
        &mut self.dialogue
    }

    /// Reads state, voltage and current.
    ///
    /// # Errors
    /// If the instrument doesn't answer.
    pub fn read(&mut self) -> Result<PowerReading, PowerError> {
        match self.plan.outlet {
            Outlet::Relay(relay) => {
                let on = self.dialogue.state(&format!("ROUT:CLOS? (@{relay})"))?;
                Ok(PowerReading { on, voltage_v: None, current_a: None })
            }
            Outlet::Supply(supply) => {
                self.select(&supply)?;
                Ok(PowerReading {
                    on: self.dialogue.state("OUTP?")?,
                    voltage_v: Some(self.dialogue.number("MEAS:VOLT?")?),
                    current_a: Some(self.dialogue.number("MEAS:CURR?")?),
                })
            }
        }
    }

    /// Reads the set voltage, V, and the current limit, A; `None`: a relay.
    ///
    /// # Errors
    /// If the instrument doesn't answer.
    pub fn settings(&mut self) -> Result<Option<(f64, f64)>, PowerError> {
        let Outlet::Supply(supply) = self.plan.outlet else { return Ok(None) };
        self.select(&supply)?;
        Ok(Some((self.dialogue.number("VOLT?")?, self.dialogue.number("CURR?")?)))
    }

    /// Begins a run: the output is off for the time of rest, gets its settings, is switched on, and has its lead. From
    /// here on it is brought to its end state.
    ///
    /// # Errors
    /// If the instrument refuses, or the voltage doesn't come.
    pub fn begin(&mut self) -> Result<(), PowerError> {
        let (mut end, last) = self.commands(self.plan.end_on);
        if let (Outlet::Supply(supply), true) = (self.plan.outlet, self.plan.end_on) {
            // It may have been lowered.
            end.pop();
            end.extend([
                format!("VOLT {}", supply.voltage_v),
                format!("CURR {}", supply.current_limit_a),
                last,
            ]);
        }
        let line = self.dialogue.line().writer();
        let line = line.map_err(|error| PowerError::Gone {
            port: self.plan.port.clone(),
            reason: error.to_string(),
        })?;
        self.last_words = Some(LastWords::register(line, &end));
        self.ended = false;
        if !self.plan.rest.is_zero() {
            self.switch(false, None)?;
            self.hold(self.plan.rest)?;
        }
        self.set()?;
        self.switch(true, None)?;
        self.hold(self.plan.lead)
    }

    /// Sets voltage and current limit; a relay has none.
    ///
    /// # Errors
    /// If the instrument refuses.
    pub fn set(&mut self) -> Result<(), PowerError> {
        let Outlet::Supply(supply) = self.plan.outlet else { return Ok(()) };
        self.set_some(Some(supply.voltage_v), Some(supply.current_limit_a))
    }

    /// Sets a voltage, V, or a current limit, A, and leaves the output as it is.
    ///
    /// # Errors
    /// If it is a relay, or the instrument refuses.
    pub fn set_some(
        &mut self,
        voltage_v: Option<f64>,
        current_limit_a: Option<f64>,
    ) -> Result<(), PowerError> {
        let Outlet::Supply(supply) = self.plan.outlet else {
            return Err(PowerError::Relay { port: self.plan.port.clone() });
        };
        self.select(&supply)?;
        for (name, value) in [("VOLT", voltage_v), ("CURR", current_limit_a)] {
            if let Some(value) = value {
                self.dialogue.command(&format!("{name} {value}"))?;
            }
        }
        Ok(())
    }

    /// Switches the output before the sample of this number, and waits until the measured voltage shows it.
    ///
    /// # Errors
    /// If the instrument refuses, or the voltage doesn't come or go.
    pub fn switch(&mut self, on: bool, sample: Option<u64>) -> Result<(), PowerError> {
        let (commands, last) = self.commands(on);
        let wanted = match self.plan.outlet {
            Outlet::Supply(supply) if supply.tolerance.is_infinite() => None,
            Outlet::Supply(supply) if on => Some(Wanted::Near(supply.voltage_v)),
            Outlet::Supply(_) => Some(Wanted::Low),
            Outlet::Relay(_) => None,
        };
        self.act(&commands, &last, sample, (on, wanted))
    }

    /// Sets another voltage before the sample of this number, with the output on.
    ///
    /// # Errors
    /// If it is a relay, the instrument refuses, or the voltage doesn't come.
    pub fn lower(&mut self, voltage_v: f64, sample: Option<u64>) -> Result<(), PowerError> {
        let Outlet::Supply(supply) = self.plan.outlet else {
            return Err(PowerError::Relay { port: self.plan.port.clone() });
        };
        let last = format!("VOLT {voltage_v}");
        let mut commands = selected(&supply);
        commands.push(last.clone());
        self.act(&commands, &last, sample, (true, Some(Wanted::Near(voltage_v))))
    }

    /// Waits until this much time has passed since the last switching.
    ///
    /// # Errors
    /// If an interrupt comes.
    pub fn hold(&self, time: Duration) -> Result<(), PowerError> {
        loop {
            let left = time.saturating_sub(self.switched.elapsed());
            if left.is_zero() {
                return Ok(());
            }
            self.interruptible()?;
            std::thread::sleep(left.min(LOOK));
        }
    }

    /// Returns an error if an interrupt came.
    ///
    /// # Errors
    /// If an interrupt came.
    pub fn interruptible(&self) -> Result<(), PowerError> {
        if interrupt::seen() { Err(PowerError::Interrupted) } else { Ok(()) }
    }

    /// Brings the output to its end state.
    ///
    /// # Errors
    /// If the instrument doesn't take it, even on a connection of its own.
    pub fn end(&mut self) -> Result<(), PowerError> {
        if std::mem::replace(&mut self.ended, true) {
            return Ok(());
        }
        let first = self.left_as_planned();
        let first = match first {
            // The line may be the problem, and not the instrument.
            Err(
                PowerError::Gone { .. } | PowerError::Silent { .. } | PowerError::Nonsense { .. },
            ) => {
                let plan = &self.plan;
                match ScpiDialogue::open(&plan.port, plan.reply, plan.remote) {
                    Ok(dialogue) => {
                        self.dialogue = dialogue;
                        self.left_as_planned()
                    }
                    Err(_) => first,
                }
            }
            first => first,
        };
        if first.is_err()
            && let Some(words) = &self.last_words
        {
            words.write();
        }
        self.last_words = None;
        first
    }

    fn left_as_planned(&mut self) -> Result<(), PowerError> {
        if self.plan.end_on {
            self.set()?;
        }
        if self.read()?.on != self.plan.end_on {
            self.switch(self.plan.end_on, None)?;
        }
        Ok(())
    }

    fn select(&mut self, supply: &SupplySetting) -> Result<(), PowerError> {
        selected(supply).iter().try_for_each(|command| self.dialogue.command(command))
    }

    /// Commands that switch the output, and the last of them.
    fn commands(&self, on: bool) -> (Vec<String>, String) {
        let (mut all, last) = match self.plan.outlet {
            Outlet::Relay(relay) => {
                (Vec::new(), format!("ROUT:{} (@{relay})", if on { "CLOS" } else { "OPEN" }))
            }
            Outlet::Supply(supply) => {
                (selected(&supply), format!("OUTP {}", if on { "ON" } else { "OFF" }))
            }
        };
        all.push(last.clone());
        (all, last)
    }

    fn act(
        &mut self,
        commands: &[String],
        last: &str,
        sample: Option<u64>,
        (on, wanted): (bool, Option<Wanted>),
    ) -> Result<(), PowerError> {
        let before = self.read()?;
        let at = SystemTime::now();
        self.switched = Instant::now();
        commands.iter().try_for_each(|command| self.dialogue.command(command))?;
        let after = self.settled(last, on, wanted);
        // A switching that failed is told too, with what can still be read.
        let shown = match &after {
            Ok(after) => Some(*after),
            Err(_) => self.read().ok(),
        };
        if let Some(after) = shown {
            let command = last.to_owned();
            self.switchings.push(Switching { command, at, sample, before, after });
        }
        after.map(drop)
    }

    /// Reads the output until its voltage is as wanted.
    fn settled(
        &mut self,
        sent: &str,
        on: bool,
        wanted: Option<Wanted>,
    ) -> Result<PowerReading, PowerError> {
        let port = self.plan.port.clone();
        let words = |on: bool| if on { "on" } else { "off" };
        let begun = Instant::now();
        loop {
            let found = self.read()?;
            if found.on != on {
                let (found, expected) = (words(found.on), words(on));
                return Err(PowerError::State { port, sent: sent.to_owned(), found, expected });
            }
            let (Some(wanted), Outlet::Supply(supply), Some(found_v)) =
                (wanted, self.plan.outlet, found.voltage_v)
            else {
                return Ok(found);
            };
            let band_v = supply.tolerance * supply.voltage_v;
            let (done, expected) = match wanted {
                Wanted::Near(voltage_v) => (
                    (found_v - voltage_v).abs() <= band_v,
                    format!("{voltage_v} V within {band_v:.3} V"),
                ),
                Wanted::Low => (found_v.abs() <= band_v, format!("at most {band_v:.3} V")),
            };
            if done {
                return Ok(found);
            }
            if begun.elapsed() >= self.plan.settle {
                let (sent, within) = (sent.to_owned(), self.plan.settle);
                return Err(PowerError::Voltage { port, sent, found_v, expected, within });
            }
            std::thread::sleep(LOOK);
        }
    }
}

/// Commands that select the channel of a supply.
fn selected(supply: &SupplySetting) -> Vec<String> {
    supply.channel.iter().map(|channel| format!("INST:NSEL {channel}")).collect()
}

impl Drop for PowerOutlet {
    fn drop(&mut self) {
        // Without anyone to tell; whoever wants to know calls `end`.
        let _ = self.end();
    }
}
