//! End states of outputs, for a program that can't go on.
//!
//! Each outlet has a further handle of its port and the bytes of its end state. They are written without waiting for a
//! reply or for a lock of the dialogue.

use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Duration;

/// Number of times that the bytes are written: a line can lose some.
const TIMES: u32 = 2;
/// Pause after writing. A socket that is closed with unread replies in it can take its last bytes along.
const PAUSE: Duration = Duration::from_millis(50);

/// Handle and bytes of one outlet.
pub(crate) struct LastWords {
    line: Mutex<Box<dyn Write + Send>>,
    bytes: Vec<u8>,
}

impl std::fmt::Debug for LastWords {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LastWords").field("bytes", &self.bytes).finish_non_exhaustive()
    }
}

static REGISTER: Mutex<Vec<Weak<LastWords>>> = Mutex::new(Vec::new());

impl LastWords {
    /// Registers the end state of an outlet, until the value is dropped.
    pub(crate) fn register(line: Box<dyn Write + Send>, commands: &[String]) -> Arc<Self> {
        // The end of a line that was cut in the middle.
        let bytes = format!("\n{}\n", commands.join("\n")).into_bytes();
        let words = Arc::new(Self { line: Mutex::new(line), bytes });
        let mut register = REGISTER.lock().unwrap_or_else(PoisonError::into_inner);
        register.retain(|weak| weak.strong_count() > 0);
        register.push(Arc::downgrade(&words));
        words
    }

    /// Writes the end state; true if the port took it.
    pub(crate) fn write(&self) -> bool {
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        let mut written = false;
        for _ in 0..TIMES {
            written |= line.write_all(&self.bytes).and_then(|()| line.flush()).is_ok();
            std::thread::sleep(PAUSE);
        }
        written
    }
}

/// Writes the end states of all outlets of this program, for an end without order. Returns their number.
pub fn write_all_ends() -> usize {
    let register = REGISTER.lock().unwrap_or_else(PoisonError::into_inner);
    let all: Vec<Arc<LastWords>> = register.iter().filter_map(Weak::upgrade).collect();
    drop(register);
    all.iter().filter(|words| words.write()).count()
}
