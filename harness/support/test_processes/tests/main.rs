//! Children end with their test, however that ends.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "tests")]

use octant_test_processes::{Started, command, start, wait_for};
use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Stdio;

/// Whether a process has ended; one that nobody has waited for yet has.
fn is_gone(process: u32) -> bool {
    let Ok(text) = std::fs::read_to_string(format!("/proc/{process}/stat")) else { return true };
    let state = text.rsplit_once(')').unwrap().1.trim_start();
    state.starts_with(['Z', 'X'])
}

fn sleeps() -> Started {
    start(command("sleep").arg("1000"))
}

/// Numbers that a process writes, a line each.
fn numbers(child: &mut Started, count: usize) -> Vec<u32> {
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    lines.take(count).map(|line| line.unwrap().parse().unwrap()).collect()
}

#[test]
fn a_test_that_fails_ends_its_child() {
    let (sender, number) = std::sync::mpsc::channel();
    let test = std::thread::spawn(move || {
        let child = sleeps();
        sender.send(child.id()).unwrap();
        panic!("on purpose");
    });
    let number = number.recv().unwrap();
    assert!(test.join().is_err());
    assert!(!Path::new(&format!("/proc/{number}")).exists());
}

#[test]
fn the_group_of_a_child_ends_with_it() {
    let mut shell = command("sh");
    shell.args(["-c", "sleep 1000 & echo $!; wait"]).process_group(0).stdout(Stdio::piped());
    let mut shell = start(&mut shell);
    let sleeps = numbers(&mut shell, 1)[0];
    drop(shell);
    wait_for("its end", || is_gone(sleeps));
}

#[test]
fn a_child_outlives_the_thread_that_asked_for_it() {
    let mut child = std::thread::spawn(sleeps).join().unwrap();
    // Another process is started and ends meanwhile: time enough for a signal.
    assert!(command("true").status().unwrap().success());
    assert!(child.try_wait().unwrap().is_none());
}

/// Two children of a test program that is killed, one that it waits for and one beside it.
#[test]
fn a_test_program_that_is_killed_takes_its_children_with_it() {
    let mut program = command(std::env::current_exe().unwrap());
    program.args(["--exact", "leaves_two", "--ignored", "--nocapture"]);
    let mut program = start(program.stdout(Stdio::piped()));
    let mut lines = BufReader::new(program.stdout.take().unwrap()).lines().map(Result::unwrap);
    let mut next = || lines.find_map(|line| line.rsplit(' ').next()?.parse::<u32>().ok()).unwrap();
    let children = [next(), next()];
    assert!(!children.iter().any(|child| is_gone(*child)));
    program.kill().unwrap();
    wait_for("their end", || children.iter().all(|child| is_gone(*child)));
}

#[test]
#[ignore = "run by another test, in a process of its own"]
fn leaves_two() {
    let beside = sleeps();
    println!("\nprocess {}", beside.id());
    // The shell writes its number and becomes what sleeps.
    let _ = command("sh").args(["-c", "echo process $$; exec sleep 1000"]).status();
}

#[test]
fn what_cannot_be_started_is_named() {
    let found = std::panic::catch_unwind(|| start(&mut command("/there/is/none")));
    let words = found.unwrap_err().downcast::<String>().unwrap();
    assert!(words.starts_with("failed to start /there/is/none: "), "{words}");
}
