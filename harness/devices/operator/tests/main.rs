//! Steps, answers, the desk and its ways, without a run.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

#[cfg(feature = "page")]
mod page;
#[cfg(unix)]
mod planted;

use octant_faults::trigger::Trigger;
use octant_operator::desk::DeskRefusal;
use octant_operator::mailbox::{self, DeskReply, DeskRequest, Mailbox, MailboxError};
use octant_operator::{
    Act, AnswerForm, AnswerKind, AnswerWay, Desk, OnNo, OnTimeout, OperatorRecord, OperatorStep,
    StepParts, journal, script,
};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

fn parts(id: &str) -> StepParts {
    StepParts {
        id: id.to_owned(),
        ask: "Is it?".to_owned(),
        trigger: None,
        kind: AnswerKind::Confirm,
        unit: None,
        bounds: [None; 2],
        choices: None,
        on_no: None,
        timeout_s: None,
        on_timeout: OnTimeout::Abort,
        named: false,
        holds: true,
    }
}

fn step(parts: StepParts) -> OperatorStep {
    OperatorStep::new(parts, &[], None, None).unwrap()
}

/// A desk whose step 0 is asked before sample 7.
fn asked(folder: &Path, step: OperatorStep) -> Desk {
    let desk = Desk::new(&[step], folder, None, None);
    desk.attendance().ask(0, 7);
    desk.look();
    desk
}

fn acts(records: &[OperatorRecord]) -> Vec<Act> {
    records.iter().map(|record| record.act).collect()
}

#[test]
fn an_answer_is_what_its_form_takes_and_nothing_else() {
    let number = AnswerForm::Number { unit: Some("mm".into()), least: Some(-1.0), most: Some(1e3) };
    for (text, read) in
        [("1", "1"), (" -1 ", "-1"), ("2.5 mm", "2.5"), ("1e3mm", "1e3"), ("-0", "-0")]
    {
        assert_eq!(number.read(text).unwrap(), read);
    }
    for text in [
        "", " ", "NaN", "nan", "inf", "-inf mm", "-1.0001", "1000.1", "1 m", "mm", "0x1", "1,5",
        "1\u{7}",
    ] {
        let problem = number.read(text).unwrap_err().to_string();
        assert!(problem.contains("expected a number from -1 to 1000 mm"), "{text:?}: {problem}");
    }
    for (text, read) in [("yes", "yes"), ("Y", "yes"), (" NO ", "no"), ("n", "no")] {
        assert_eq!(AnswerForm::Confirm.read(text).unwrap(), read);
        assert_eq!(AnswerForm::YesNo.read(text).unwrap(), read);
    }
    for text in ["", "ja", "yes!", "yes no", "true", "1"] {
        assert!(AnswerForm::Confirm.read(text).is_err(), "{text:?}");
    }
    let choice = AnswerForm::Choice(vec!["cable A".into(), "cable B".into()]);
    assert_eq!(choice.read("cable B").unwrap(), "cable B");
    assert!(choice.read("cable b").unwrap_err().to_string().contains("did you mean"));
    assert_eq!(AnswerForm::Text.read(" as found ").unwrap(), "as found");
    assert!(AnswerForm::Text.read("a\u{1b}[2J").is_err() && AnswerForm::Text.read("a\nb").is_err());
    assert!(AnswerForm::Text.read(&"a".repeat(1001)).is_err());
}

#[test]
fn the_first_answer_counts_and_the_second_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let desk = Arc::new(asked(folder.path(), step(parts("door"))));
    let answers: Vec<_> = (0..8)
        .map(|n| {
            let desk = Arc::clone(&desk);
            std::thread::spawn(move || {
                desk.answer("door", "yes", &format!("P{n}"), AnswerWay::Page)
            })
        })
        .map(|thread| thread.join().unwrap())
        .collect();
    let taken: Vec<&String> = answers.iter().flatten().collect();
    assert_eq!(taken.len(), 1);
    for refused in answers.iter().filter_map(|answer| answer.as_ref().err()) {
        assert_eq!(*refused, DeskRefusal::Late { id: "door".into(), answer: taken[0].clone() });
    }
    assert!(desk.attendance().is_closed(0));
    let records = desk.records_from(0);
    assert_eq!(acts(&records), [Act::Asked, Act::Answered]);
    assert_eq!(records[1].sample, Some(7));
    assert_eq!(journal::read(folder.path()).unwrap(), records);
    assert_eq!(desk.attendance().told().len(), 2);
    assert!(desk.close().is_empty());
}

#[test]
fn a_no_ends_the_run_and_leaves_it_standing() {
    let folder = tempfile::tempdir().unwrap();
    let desk = asked(folder.path(), step(parts("door")));
    desk.answer("door", "no", "Ada", AnswerWay::Command).unwrap();
    // Not closed: the thread of the samples doesn't go on before it sees the end.
    assert!(!desk.attendance().is_closed(0));
    assert_eq!(desk.aborted().unwrap(), "the answer to step \"door\" was no, Ada");
    assert!(desk.answer("door", "yes", "Bob", AnswerWay::Command).is_err());
    assert!(
        desk.hold("Bob", AnswerWay::Command).is_err()
            && desk.abort("Bob", AnswerWay::Command).is_err()
    );
    assert_eq!(desk.close(), ["aborted: the answer to step \"door\" was no, Ada"]);

    let folder = tempfile::tempdir().unwrap();
    let desk = asked(folder.path(), step(StepParts { kind: AnswerKind::YesNo, ..parts("door") }));
    desk.answer("door", "no", "", AnswerWay::Terminal).unwrap();
    assert!(desk.attendance().is_closed(0) && desk.aborted().is_none());
}

#[test]
fn a_timeout_is_never_an_answer() {
    let timed = |on_timeout| step(StepParts { timeout_s: Some(0.02), on_timeout, ..parts("door") });
    let folder = tempfile::tempdir().unwrap();
    let desk = asked(folder.path(), timed(OnTimeout::Wait));
    for _ in 0..3 {
        std::thread::sleep(Duration::from_millis(30));
        desk.look();
    }
    assert!(!desk.attendance().is_closed(0) && desk.aborted().is_none());
    assert_eq!(acts(&desk.records_from(0)), [Act::Asked, Act::Overdue]);
    desk.answer("door", "yes", "", AnswerWay::Page).unwrap();
    assert!(desk.attendance().is_closed(0));

    let folder = tempfile::tempdir().unwrap();
    let desk = asked(folder.path(), timed(OnTimeout::Abort));
    std::thread::sleep(Duration::from_millis(30));
    desk.look();
    assert!(!desk.attendance().is_closed(0));
    assert_eq!(desk.aborted().unwrap(), "nobody answered step \"door\" in time");
    let reasons = desk.close();
    assert_eq!(reasons.len(), 2, "{reasons:?}");
}

#[test]
fn what_the_disk_does_not_take_does_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let desk = asked(&folder.path().join("gone"), step(parts("door")));
    assert!(desk.aborted().unwrap().contains("operator.jsonl"));
    assert!(desk.answer("door", "yes", "", AnswerWay::Page).is_err());
    assert!(!desk.attendance().is_closed(0));
}

#[test]
fn what_nobody_asked_or_answered_is_named_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let steps =
        [step(parts("a")), step(StepParts { trigger: Some(Trigger::Epoch(5)), ..parts("b") })];
    let desk = Desk::new(&steps, folder.path(), None, None);
    desk.attendance().ask(0, 0);
    desk.look();
    assert_eq!(desk.records_from(0)[0].sample, None);
    assert!(matches!(
        desk.answer("b", "yes", "", AnswerWay::Page),
        Err(DeskRefusal::NotYet { .. })
    ));
    assert!(matches!(
        desk.answer("c", "yes", "", AnswerWay::Page),
        Err(DeskRefusal::Unknown { .. })
    ));
    let reasons = desk.close();
    assert!(
        reasons[0].contains("\"a\" was not answered") && reasons[1].contains("\"b\" was asked"),
        "{reasons:?}"
    );
    let all = [Act::Asked, Act::Unanswered, Act::NeverAsked];
    assert_eq!(acts(&desk.records_from(0)), all);
    desk.look();
    assert!(desk.answer("a", "yes", "", AnswerWay::Page).is_err());
    assert_eq!(desk.records_from(0).len(), 3);
}

#[test]
fn a_name_is_needed_where_the_step_says_so_and_is_plain_text() {
    let folder = tempfile::tempdir().unwrap();
    let desk = asked(folder.path(), step(StepParts { named: true, ..parts("door") }));
    for name in ["", "  ", "a\u{1b}b", &"a".repeat(201)] {
        let refused = desk.answer("door", "yes", name, AnswerWay::Page);
        assert!(matches!(refused, Err(DeskRefusal::Unfit { .. })), "{name:?}");
    }
    desk.answer("door", "yes", " Ada ", AnswerWay::Page).unwrap();
    assert_eq!(desk.records_from(1)[0].by.as_deref(), Some("Ada"));
}

#[test]
fn a_run_that_can_not_stand_is_not_held() {
    let folder = tempfile::tempdir().unwrap();
    let desk = Desk::new(&[], folder.path(), Some("they leave by the clock".into()), None);
    assert!(desk.hold("", AnswerWay::Page).unwrap_err().to_string().contains("by the clock"));
    assert!(!desk.attendance().is_held() && !desk.is_held());
    let desk = Desk::new(&[], folder.path(), None, None);
    desk.hold("", AnswerWay::Page).unwrap();
    assert!(desk.attendance().is_held());
    desk.attendance().stand(9);
    desk.resume("", AnswerWay::Page).unwrap();
    assert!(!desk.attendance().is_held());
    assert_eq!(desk.records_from(1)[0].sample, Some(9));
}

#[test]
fn requests_of_another_process_are_replied_to_and_bad_ones_refused() {
    let folder = tempfile::tempdir().unwrap();
    let patience = Duration::from_millis(200);
    let answer = DeskRequest::Answer { id: "door".into(), value: "yes".into(), by: "Ada".into() };
    let nobody = mailbox::request(folder.path(), &answer, patience);
    assert!(matches!(nobody, Err(MailboxError::Nobody(_))));
    let desk = asked(folder.path(), step(parts("door")));
    let open = Mailbox::open(folder.path()).unwrap();
    assert!(matches!(
        mailbox::request(folder.path(), &answer, patience),
        Err(MailboxError::Silent { .. })
    ));
    // What was given up doesn't count later.
    assert!(open.serve(|request| request.apply(&desk, AnswerWay::Command)).is_empty());
    assert!(!desk.attendance().is_closed(0));
    let (path, asked) = (folder.path().to_owned(), answer.clone());
    let other =
        std::thread::spawn(move || mailbox::request(&path, &asked, Duration::from_secs(300)));
    while !other.is_finished() {
        assert!(open.serve(|request| request.apply(&desk, AnswerWay::Command)).is_empty());
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        matches!(other.join().unwrap(), Ok(DeskReply::Taken(words)) if words == "yes by Ada (command)")
    );
    assert!(desk.attendance().is_closed(0));
    let mails = folder.path().join(mailbox::FOLDER);
    for (name, text) in [
        ("ask-1", "{"),
        ("ask-2", r#"{"do":"answer"}"#),
        ("ask-3", r#"{"do":"go"}"#),
        ("other", ""),
    ] {
        std::fs::write(mails.join(name), text).unwrap();
    }
    assert_eq!(open.serve(|_| panic!("it can't be read")).len(), 3);
    for name in ["told-1", "told-2", "told-3"] {
        assert!(std::fs::read_to_string(mails.join(name)).unwrap().contains("can't be read"));
        std::fs::remove_file(mails.join(name)).unwrap();
    }
    assert!(mails.join("other").exists() && !mails.join("ask-1").exists());
    drop(open);
    assert!(!mails.exists());
}

#[test]
fn a_journal_that_was_altered_is_refused_and_one_that_was_cut_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let desk = asked(folder.path(), step(parts("door")));
    desk.answer("door", "yes", "Ada", AnswerWay::Terminal).unwrap();
    let path = folder.path().join(journal::FILE_NAME);
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(journal::parse(&text[..text.len() - 1]).unwrap().len(), 1);
    let lines: Vec<&str> = text.lines().collect();
    for (altered, words) in [
        (format!("{}\n", lines[1]), "found record 2, expected 1"),
        (text.replacen("\"schema\":1", "\"schema\":2", 1), "schema 2"),
        (text.replacen("answered", "guessed", 1), "no record"),
    ] {
        let (_, problem) = journal::parse(&altered).unwrap_err();
        assert!(problem.contains(words), "{problem}");
    }
    assert!(journal::read(Path::new("nowhere")).unwrap().is_empty());
}

#[test]
fn a_file_of_answers_is_checked_against_the_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.toml");
    let steps = [step(StepParts { on_no: Some(OnNo::AskAgain), ..parts("door") })];
    std::fs::write(&path, "[[answer]]\nid = \"door\"\nvalue = \"no\"\n").unwrap();
    assert!(script::read(&path, &steps).unwrap_err().to_string().contains("asked again"));
    std::fs::write(&path, "[[answer]]\nid = \"door\"\nvalue = \"Yes\"\nbye = \"Ada\"\n").unwrap();
    let error = script::read(&path, &steps).unwrap_err().to_string();
    assert!(error.contains("line 4, column 1: unknown field `bye`, expected"), "{error}");
    std::fs::write(&path, "[[answer]]\nid = \"door\"\nvalue = yes\n").unwrap();
    let error = script::read(&path, &steps).unwrap_err().to_string();
    assert!(error.contains("line 3, column 9: "), "{error}");
    std::fs::write(&path, "[[answer]]\nid = \"door\"\nvalue = \"Yes\"\n").unwrap();
    let answers = script::read(&path, &steps).unwrap();
    assert_eq!((answers[0].value.as_str(), &answers[0].by), ("yes", &None));
    let desk = Desk::new(&steps, folder.path(), None, Some(answers));
    desk.attendance().ask(0, 0);
    desk.look();
    assert!(desk.attendance().is_closed(0));
    assert_eq!(desk.records_from(1)[0].way, Some(AnswerWay::File));

    // The journal of this run answers the same questions, and no others.
    let journal = folder.path().join("operator.jsonl");
    assert_eq!(script::read(&journal, &steps).unwrap()[0].value, "yes");
    let other = StepParts { ask: "Is the window shut?".to_owned(), ..parts("door") };
    let error = script::read(&journal, &[step(other)]).unwrap_err().to_string();
    assert!(error.contains("it was asked") && error.contains("Is the window shut?"), "{error}");
}
