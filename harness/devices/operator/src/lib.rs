//! What a person does in the procedure of a run: swaps a cable, levels the plate, confirms that a door is shut.
//!
//! A [`OperatorStep`] of a scenario says when somebody is asked, for what, and what follows. The [`Desk`] of a run has
//! the open questions: it takes answers, of which the first counts, and requests to hold, resume and abort. All ways
//! to a person go to the desk: the terminal, [other processes](mailbox), a file of [answers](script), and the page. It
//! writes a [record](OperatorRecord) of each event to a [journal] in the folder of the run before anybody is
//! told that it counts.
//!
//! The thread of the samples takes no lock: it and the desk have an [`Attendance`](octant_base::attendance::Attendance) in common.

pub mod answer;
pub mod desk;
#[cfg(feature = "page")]
mod http;
pub mod journal;
pub mod mailbox;
mod mails;
#[cfg(feature = "page")]
pub mod page;
pub mod record;
pub mod script;
pub mod step;

pub use answer::{AnswerForm, AnswerKind};
pub use desk::Desk;
pub use record::{Act, AnswerWay, OperatorRecord};
pub use step::{OnNo, OnTimeout, OperatorStep, StepParts};
