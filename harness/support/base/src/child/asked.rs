//! Processes that are asked line by line: each question is a line on standard input, each answer a
//! line on standard output.

use super::limited::{ChildEnded, LOOK, RunClock};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Byte by which a process separates on its standard error the messages of one question from those
/// of the one before: the record separator of ASCII.
pub const SEPARATOR: u8 = 0x1e;
/// Time that a process gets to end by itself after its last question.
const END_MAX: Duration = Duration::from_secs(1);

/// Process that answers questions. Dropping it ends it.
///
/// The thread that starts it must be the one that asks it, as for every process that ends together
/// with this one.
#[derive(Debug)]
pub struct AskedChild {
    child: Child,
    /// `None` once the process has to end.
    questions: Option<Sender<Vec<u8>>>,
    answers: Receiver<String>,
    words: Arc<Mutex<Vec<u8>>>,
    /// Time since the last question.
    clock: RunClock,
    /// Reads standard error; ends with the process.
    listener: Option<JoinHandle<()>>,
}

/// Reply of a process.
#[derive(Debug)]
pub enum AskedReply {
    /// A line, without its end.
    Line(String),
    /// The process has ended, or was ended; with its standard error since the last [`SEPARATOR`].
    Ended(ChildEnded, String),
}

impl AskedChild {
    /// Starts a process. At most `most` bytes of its standard error are kept for a question.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn start(command: &mut Command, most: usize) -> io::Result<Self> {
        let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn()?;
        let (questions, to_ask) = channel::<Vec<u8>>();
        let (answered, answers) = channel();
        let words = Arc::new(Mutex::new(Vec::new()));
        // The pipes are served at the same time: a full one would block the process, or this one if
        // the process doesn't read its input. The threads end with the pipes.
        if let Some(mut stdin) = child.stdin.take() {
            std::thread::spawn(move || {
                // If the process has ended already, its status tells.
                for question in to_ask {
                    if stdin.write_all(&question).and_then(|()| stdin.flush()).is_err() {
                        break;
                    }
                }
            });
        }
        if let Some(stdout) = child.stdout.take() {
            std::thread::spawn(move || {
                for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                    if answered.send(line).is_err() {
                        break;
                    }
                }
            });
        }
        let listener = child.stderr.take().map(|stderr| {
            let words = Arc::clone(&words);
            std::thread::spawn(move || listen(stderr, &words, most))
        });
        let (questions, clock) = (Some(questions), RunClock::start());
        Ok(Self { child, questions, answers, words, clock, listener })
    }

    /// Sends a question, which has no line end in it. A process that has ended says so in its reply.
    pub fn ask(&mut self, mut question: Vec<u8>) {
        question.push(b'\n');
        self.clock = RunClock::start();
        if let Some(questions) = &self.questions {
            let _ = questions.send(question);
        }
    }

    /// Waits for the next line of the process; ends it on request, or when it ran for longer than
    /// `limit` since the last question. Time in which either process is stopped doesn't count.
    ///
    /// # Errors
    /// If the operating system can't wait for it.
    pub fn reply(&mut self, limit: Duration, cancel: &AtomicBool) -> io::Result<AskedReply> {
        let mut is_closed = false;
        loop {
            if is_closed {
                std::thread::sleep(LOOK);
            } else {
                match self.answers.recv_timeout(LOOK) {
                    Ok(line) => return Ok(AskedReply::Line(line)),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => is_closed = true,
                }
            }
            if let Some(ended) = self.clock.look(&mut self.child, limit, cancel)? {
                // Its last answer may have come just before its end.
                if let (ChildEnded::Status(_) | ChildEnded::Outside(_), Ok(line)) =
                    (&ended, self.answers.recv_timeout(LOOK))
                {
                    return Ok(AskedReply::Line(line));
                }
                return Ok(AskedReply::Ended(ended, self.words()));
            }
        }
    }

    /// Returns the standard error of a process that has ended, since the last separator.
    fn words(&mut self) -> String {
        // A process that this one had started may hold the pipe for longer.
        let until = Instant::now() + END_MAX;
        while self.listener.as_ref().is_some_and(|listener| !listener.is_finished())
            && Instant::now() < until
        {
            std::thread::sleep(LOOK);
        }
        let words = self.words.lock().unwrap_or_else(PoisonError::into_inner);
        String::from_utf8_lossy(&words).into_owned()
    }
}

impl Drop for AskedChild {
    fn drop(&mut self) {
        // The end of its input ends the process.
        self.questions = None;
        let until = Instant::now() + END_MAX;
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < until {
            std::thread::sleep(LOOK);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Keeps the first bytes of a pipe since the last separator.
fn listen(mut pipe: ChildStderr, words: &Mutex<Vec<u8>>, most: usize) {
    let mut buffer = [0; 4096];
    // Output that can't be read counts as absent.
    while let Ok(read @ 1..) = pipe.read(&mut buffer) {
        let read = &buffer[..read];
        let mut words = words.lock().unwrap_or_else(PoisonError::into_inner);
        let new = match read.iter().rposition(|byte| *byte == SEPARATOR) {
            Some(at) => {
                words.clear();
                &read[at + 1..]
            }
            None => read,
        };
        let room = most.saturating_sub(words.len());
        words.extend_from_slice(&new[..new.len().min(room)]);
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    fn shell(script: &str) -> AskedChild {
        AskedChild::start(super::super::command("sh").args(["-c", script]), 8).unwrap()
    }

    fn reply(child: &mut AskedChild, limit_ms: u64) -> AskedReply {
        child.reply(Duration::from_millis(limit_ms), &AtomicBool::new(false)).unwrap()
    }

    #[test]
    fn each_question_has_its_answer_and_the_words_are_those_of_the_last() {
        let mut child = shell(
            "while read line; do printf 'of %s\\n\\036' \"$line\" >&2; echo \"$line!\"; \
             [ \"$line\" = c ] && { printf 'long words' >&2; exit 7; }; done; exit 0",
        );
        for question in ["a", "b"] {
            child.ask(question.into());
            let reply = reply(&mut child, 300_000);
            assert!(matches!(&reply, AskedReply::Line(line) if *line == format!("{question}!")));
        }
        child.ask("c".into());
        assert!(matches!(reply(&mut child, 300_000), AskedReply::Line(line) if line == "c!"));
        let ended = reply(&mut child, 300_000);
        let AskedReply::Ended(ChildEnded::Status(status), words) = ended else {
            panic!("{ended:?}")
        };
        assert_eq!((status.code(), words.as_str()), (Some(7), "long wor"));
    }

    #[test]
    fn a_process_that_does_not_answer_is_ended() {
        let mut child = shell("exec sleep 1000");
        child.ask(vec![b'x'; 1 << 20]);
        let ended = reply(&mut child, 100);
        assert!(matches!(ended, AskedReply::Ended(ChildEnded::TooLong, _)), "{ended:?}");
        let mut child = shell("exec sleep 1000");
        let ended = child.reply(Duration::MAX, &AtomicBool::new(true)).unwrap();
        assert!(matches!(ended, AskedReply::Ended(ChildEnded::Cancelled, _)), "{ended:?}");
        let mut child = shell("kill -9 $$");
        let ended = reply(&mut child, 300_000);
        assert!(
            matches!(&ended, AskedReply::Ended(ChildEnded::Outside(by), _) if by == "SIGKILL"),
            "{ended:?}"
        );
    }

    /// The end of its input ends it; one that goes on is ended.
    #[test]
    fn a_dropped_process_is_gone() {
        for script in ["cat >/dev/null", "exec sleep 1000"] {
            let child = shell(script);
            let id = child.child.id();
            drop(child);
            assert!(!std::path::Path::new(&format!("/proc/{id}")).exists(), "{script}");
        }
    }
}
