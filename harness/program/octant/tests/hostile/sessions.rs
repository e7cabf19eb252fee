//! Attacks on the session: additional or missing messages beside the answers. Over UDP, by a peer
//! that implements the wire itself.

use super::unit::{check, scenario, summary_of};
use super::{Ends, Row, breaks};
use octant_endpoint::{ServedCore, configuration};
use octant_link::device::Steps;
use octant_run::core_of;
use octant_sample::Output;
use octant_scenario::{Method, Scenario};
use octant_wire::message::*;
use octant_wire::serial::{DecodeEvent, SerialDecoder, SerialEncoder};
use std::net::UdpSocket;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Transformation of a peer's honest messages, of which there may be none.
type Script = fn(&Message, Vec<Message>) -> Vec<Say>;

enum Say {
    Message(Box<Message>),
    Bytes(Vec<u8>),
}

fn as_it_is(messages: Vec<Message>) -> Vec<Say> {
    messages.into_iter().map(|message| Say::Message(Box::new(message))).collect()
}

/// Returns the number of a sample; 0 for every other message.
fn number(message: &Message) -> u64 {
    match message {
        Message::Sample(sample) => sample.sample.sequence,
        _ => 0,
    }
}

/// Unit that answers with the wire's own messages.
struct Peer {
    core: ServedCore,
    hello: Hello,
    aiding: Option<AidingMessage>,
    revision: Option<u32>,
    /// Answers to the last sample, for repeated requests.
    last: Option<(StepNumber, Vec<Message>)>,
}

impl Peer {
    fn new(scenario: &Scenario) -> Self {
        let config = core_of(scenario, Method::Primary, scenario.seed).unwrap();
        let hello = Hello {
            role: EndRole::Device,
            capabilities: Capabilities::all(),
            sample_period_ns: config.sample_period_ns,
            configuration: configuration(&config),
            ..Hello::default()
        };
        let core = ServedCore::new(&config).unwrap();
        Self { core, hello, aiding: None, revision: None, last: None }
    }

    fn answers(&mut self, message: &Message) -> Vec<Message> {
        match message {
            Message::Hello(theirs) => {
                let pacing = theirs.pacing;
                vec![Message::Hello(Hello { session: theirs.session, pacing, ..self.hello })]
            }
            Message::Aiding(aiding) => {
                self.aiding = Some(*aiding);
                Vec::new()
            }
            Message::Sample(sample) => self.step(sample),
            _ => Vec::new(),
        }
    }

    fn step(&mut self, sample: &SampleMessage) -> Vec<Message> {
        if let Some((step, answers)) = &self.last
            && *step == sample.step
        {
            return answers.clone();
        }
        let aiding = self.aiding.take().filter(|aiding| aiding.step == sample.step);
        let mut output = Output::default();
        self.core.step(&sample.sample, aiding.as_ref().map(|a| &a.aiding), &mut output);
        let revision = output.parameters_revision;
        let parameters_follow = self.revision.replace(revision) != Some(revision);
        let step = sample.step;
        let answer = OutputMessage { step, parameters_follow, output, computing_ns: 1 };
        let mut answers = vec![Message::Output(answer)];
        if parameters_follow {
            let (parameters, sigma) = self.core.parameters();
            let segments = ParametersSegment::all(step, revision, &parameters, &sigma);
            answers.extend(segments.map(Message::Parameters));
        }
        self.last = Some((step, answers.clone()));
        answers
    }
}

/// Limit for an answer that never comes.
const NEVER: &str = "500 ms";

/// Runs against a peer with a script that answers everything.
fn run(script: Script) -> Result<octant_score::summary::Summary, String> {
    run_within(script, ["300 s"; 2])
}

/// Runs against a peer with a script, with limits for a hello and for an answer.
fn run_within(
    script: Script,
    [hello, answer]: [&str; 2],
) -> Result<octant_score::summary::Summary, String> {
    let clean = scenario("");
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_read_timeout(Some(Duration::from_millis(10))).unwrap();
    let uri = format!("udp:{}", socket.local_addr().unwrap());
    let stop = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&stop);
    let mut peer = Peer::new(&clean);
    let thread = std::thread::spawn(move || {
        let (mut encoder, mut decoder) = (SerialEncoder::new(), SerialDecoder::new());
        let mut bytes = [0; 2000];
        while !until.load(Ordering::Relaxed) {
            let Ok((count, from)) = socket.recv_from(&mut bytes) else { continue };
            let mut rest = &bytes[..count];
            while let Some(event) = decoder.next(&mut rest) {
                let DecodeEvent::Received(received) = event else { continue };
                let honest = peer.answers(&received.message);
                for say in script(&received.message, honest) {
                    // The harness may be gone.
                    let _ = match say {
                        Say::Message(message) => {
                            socket.send_to(encoder.encode(&message, ClockTime::default()), from)
                        }
                        Say::Bytes(bytes) => socket.send_to(&bytes, from),
                    };
                }
            }
        }
    });
    let text = super::unit::SCENARIO.to_owned()
        + &format!(
            "[endpoint]\nuri = {uri:?}\n[endpoint.link]\nhello = {hello:?}\nanswer = {answer:?}\nrepeat = \"20 ms\"\n"
        );
    let live = Scenario::parse(&text, "hostile.toml", Path::new(""), &[]).unwrap();
    let found = summary_of(&live);
    stop.store(true, Ordering::Relaxed);
    thread.join().unwrap();
    found
}

#[test]
fn the_peer_itself_passes() {
    let summary = run(|_, answers| as_it_is(answers)).unwrap();
    assert_eq!(summary.verdict.exit_code(), 0, "{:?}", summary.reasons);
}

macro_rules! sessions {
    ($($name:ident: $about:literal, $ends:expr, $script:expr;)*) => {
        /// Returns the rows of the table.
        pub fn rows() -> Vec<Row> {
            vec![$(Row { group: "session", about: $about, over: "UDP", ends: $ends }),*]
        }
        $(#[test]
        fn $name() {
            let ends: Ends = $ends;
            // A host that does other work is late with what does come.
            let within = |what: &str| if ends.because == what { NEVER } else { "300 s" };
            let limits = ["no hello within", "no output to step"].map(within);
            check($about, &ends, run_within($script, limits));
        })*
    };
}

sessions! {
    says_nothing: "says nothing at all", breaks("no hello within"), |_, _| Vec::new();
    never_answers: "says hello, and answers no sample", breaks("no output to step"), |message, answers| {
        if number(message) > 0 { Vec::new() } else { as_it_is(answers) }
    };
    falls_silent: "falls silent in the middle of its navigation", breaks("no output to step"), |message, answers| {
        if number(message) > 1200 { Vec::new() } else { as_it_is(answers) }
    };
    says_bye: "says goodbye in the middle of its navigation", breaks("bye"), |message, answers| {
        if number(message) == 1200 {
            let bye = Bye { reason: Reason::DONE, text: octant_wire::Text::fitting("that is enough") };
            return as_it_is(vec![Message::Bye(bye)]);
        }
        as_it_is(answers)
    };
    another_session: "says hello to another session", breaks("no hello within"), |_, answers| {
        as_it_is(answers.into_iter().map(|message| match message {
            Message::Hello(hello) => Message::Hello(Hello { session: hello.session ^ 1, ..hello }),
            other => other,
        }).collect())
    };
    another_configuration: "is configured otherwise", breaks("give both the same scenario"), |_, answers| {
        as_it_is(answers.into_iter().map(|message| match message {
            Message::Hello(hello) => Message::Hello(Hello { configuration: [7; 32], ..hello }),
            other => other,
        }).collect())
    };
    another_period: "has another sample period", breaks("sample period"), |_, answers| {
        as_it_is(answers.into_iter().map(|message| match message {
            Message::Hello(hello) => Message::Hello(Hello { sample_period_ns: 5_000_000, ..hello }),
            other => other,
        }).collect())
    };
    another_role: "says that it is a harness itself", breaks("one of the two has to be the harness"), |_, answers| {
        as_it_is(answers.into_iter().map(|message| match message {
            Message::Hello(hello) => Message::Hello(Hello { role: EndRole::Harness, ..hello }),
            other => other,
        }).collect())
    };
    answers_the_next_step: "answers a step that nobody asked for", breaks("no output to step"), |_, answers| {
        as_it_is(answers.into_iter().map(|message| match message {
            Message::Output(output) => Message::Output(OutputMessage { step: output.step.next(), ..output }),
            other => other,
        }).collect())
    };
    parameters_that_never_come: "announces parameters, and sends none", breaks("no output to step"), |_, answers| {
        as_it_is(answers.into_iter().filter(|message| !matches!(message, Message::Parameters(_))).collect())
    };
    half_of_the_parameters: "sends all of its parameters but the last", breaks("no output to step"), |_, mut answers| {
        if answers.len() > 1 { answers.pop(); }
        as_it_is(answers)
    };
    noise_alone: "answers with noise", breaks("no output to step"), |message, answers| {
        if number(message) == 0 { return as_it_is(answers); }
        vec![Say::Bytes((0..200_u32).map(|i| (i * 97 + 13) as u8).collect())]
    };
    starts_anew: "starts anew in the middle, and says hello", breaks("session"), |message, answers| {
        if number(message) < 1200 { return as_it_is(answers); }
        as_it_is(vec![Message::Hello(Hello { role: EndRole::Device, session: 0, ..Hello::default() })])
    };
}

#[test]
fn answers_that_come_twice_or_with_noise_are_no_attack() {
    let twice = run(|_, answers| as_it_is([answers.clone(), answers].concat())).unwrap();
    assert_eq!(twice.verdict.exit_code(), 0, "{:?}", twice.reasons);
    let noisy = run(|message, answers| {
        let noise = Say::Bytes((0..40_u32).map(|i| (i * 31 + 7) as u8).collect());
        let mut all = if number(message).is_multiple_of(7) { vec![noise] } else { Vec::new() };
        all.extend(as_it_is(answers));
        all
    })
    .unwrap();
    assert_eq!(noisy.verdict.exit_code(), 0, "{:?}", noisy.reasons);
}
