//! Tasks on several threads, their results in order.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, Scope, ScopedJoinHandle};

/// Does tasks 0 to `count`, at most `jobs` at a time. Each result stands in its task's place: `None` for a
/// task that gave none, or was not begun because `is_cancelled`.
///
/// The work of a task shows in no other one, so the results don't depend on `jobs`.
///
/// # Errors
/// The failure of the first task in order. After a failure no further task is begun.
pub fn in_order<T: Send, E: Send>(
    jobs: usize,
    count: usize,
    is_cancelled: impl Fn() -> bool + Sync,
    work: impl Fn(usize) -> Result<Option<T>, E> + Sync,
) -> Result<Vec<Option<T>>, E> {
    in_order_with(jobs, count, is_cancelled, || (), |(), task| work(task))
}

/// Does tasks as [`in_order`] does. Each thread makes something once, and gives it to all of its tasks: a
/// process that does them, for example. It is dropped on its thread when no task is left.
///
/// # Errors
/// As [`in_order`].
pub fn in_order_with<S, T: Send, E: Send>(
    jobs: usize,
    count: usize,
    is_cancelled: impl Fn() -> bool + Sync,
    of_thread: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> Result<Option<T>, E> + Sync,
) -> Result<Vec<Option<T>>, E> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Result<Option<T>, E>>> =
        Mutex::new((0..count).map(|_| Ok(None)).collect());
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, count.max(1)) {
            spawn(scope, || {
                let mut own = of_thread();
                while !is_cancelled() {
                    let task = next.fetch_add(1, Ordering::Relaxed);
                    if task >= count {
                        break;
                    }
                    let result = work(&mut own, task);
                    if result.is_err() {
                        next.fetch_max(count, Ordering::Relaxed);
                    }
                    results.lock().unwrap_or_else(PoisonError::into_inner)[task] = result;
                }
            });
        }
    });
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect()
}

/// Tasks that are still to be done; a task can add others.
#[derive(Debug)]
pub struct Waiting<T> {
    state: Mutex<WaitingState<T>>,
    changed: Condvar,
    most: usize,
}

#[derive(Debug)]
struct WaitingState<T> {
    tasks: VecDeque<T>,
    /// Tasks that were added by others, to be done before `tasks`.
    added: VecDeque<T>,
    /// Tasks being done, which can add others.
    doing: usize,
}

impl<T> Waiting<T> {
    fn lock(&self) -> MutexGuard<'_, WaitingState<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a task. It comes back where enough are waiting, so that a few at a time take memory: the
    /// caller then does it.
    pub fn add(&self, task: T) -> Option<T> {
        let mut state = self.lock();
        if state.added.len() >= self.most {
            return Some(task);
        }
        state.added.push_back(task);
        self.changed.notify_one();
        None
    }

    fn next(&self) -> Option<T> {
        let mut state = self.lock();
        loop {
            let task = state.added.pop_front().or_else(|| state.tasks.pop_front());
            if task.is_some() {
                state.doing += 1;
                return task;
            }
            if state.doing == 0 {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn done(&self) {
        self.lock().doing -= 1;
        self.changed.notify_all();
    }
}

/// Does tasks and those that they add, at most `jobs` at a time, in no order that counts.
pub fn with_added<T: Send>(
    jobs: usize,
    tasks: impl IntoIterator<Item = T>,
    work: impl Fn(T, &Waiting<T>) + Sync,
) {
    let jobs = jobs.max(1);
    let state =
        WaitingState { tasks: tasks.into_iter().collect(), added: VecDeque::new(), doing: 0 };
    // With one job, whoever adds a task does it at once.
    let waiting = Waiting { state: Mutex::new(state), changed: Condvar::new(), most: jobs - 1 };
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            spawn(scope, || {
                while let Some(task) = waiting.next() {
                    let _done = Done(&waiting);
                    work(task, &waiting);
                }
            });
        }
    });
}

/// Counts a task as done when it is dropped: after a panic too, or the others would wait for ever.
struct Done<'a, T>(&'a Waiting<T>);

impl<T> Drop for Done<'_, T> {
    fn drop(&mut self) {
        self.0.done();
    }
}

/// Stack of a thread that runs cores, bytes: that of a main thread. A core is some 100 KiB, and passes by
/// value where it is made, copied and ended.
const STACK: usize = 8 << 20;

/// Starts a thread of a scope, with a stack on which cores can be made and copied.
///
/// # Panics
/// If the system has no thread, as [`Scope::spawn`].
pub fn spawn<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> ScopedJoinHandle<'scope, T> {
    let started = Builder::new().stack_size(STACK).spawn_scoped(scope, work);
    started.unwrap_or_else(|error| panic!("failed to start a thread: {error}"))
}

/// Processors that this process may use, at least 1.
#[must_use]
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn results_are_in_order_and_the_first_failure_is_told() {
        let doubled = in_order(3, 50, || false, |i| Ok::<_, usize>(Some(2 * i))).unwrap();
        assert!(doubled.iter().enumerate().all(|(i, d)| *d == Some(2 * i)));
        let failed = in_order(3, 50, || false, |i| if i % 7 == 3 { Err(i) } else { Ok(Some(i)) });
        assert_eq!(failed, Err(3));
        assert_eq!(in_order(3, 0, || false, |_| Ok::<Option<u8>, ()>(None)), Ok(Vec::new()));
    }

    #[test]
    fn each_thread_has_its_own() {
        let made = AtomicUsize::new(0);
        let make = || made.fetch_add(1, Ordering::Relaxed);
        let mut done = [0; 3];
        let work = |own: &mut usize, _| Ok::<_, ()>(Some(*own));
        let results = in_order_with(3, 60, || false, make, work).unwrap();
        results.into_iter().flatten().for_each(|own| done[own] += 1);
        assert_eq!((made.load(Ordering::Relaxed), done.iter().sum::<usize>()), (3, 60));
    }

    #[test]
    fn nothing_is_begun_after_a_failure_or_a_cancellation() {
        let begun = AtomicUsize::new(0);
        let count = |_| {
            begun.fetch_add(1, Ordering::Relaxed);
            Err::<Option<u8>, _>("broken")
        };
        assert_eq!(in_order(1, 1000, || false, count), Err("broken"));
        assert_eq!(begun.load(Ordering::Relaxed), 1);
        let is_full = || begun.load(Ordering::Relaxed) >= 5;
        let work = |i| {
            begun.fetch_add(1, Ordering::Relaxed);
            Ok::<_, ()>(Some(i))
        };
        let done = in_order(1, 1000, is_full, work).unwrap();
        assert_eq!(done.iter().flatten().count(), 4);
        assert_eq!(done[..5], [Some(0), Some(1), Some(2), Some(3), None]);
    }

    #[test]
    fn added_tasks_are_done_once_and_by_whoever_has_time() {
        for jobs in [1, 2, 5] {
            let done = Mutex::new(Vec::new());
            with_added(jobs, [1_usize, 2, 3], |task, waiting| {
                let mut own = vec![task];
                while let Some(task) = own.pop() {
                    done.lock().unwrap().push(task);
                    if task < 100 {
                        own.extend((0..10).filter_map(|k| waiting.add(10 * task + k)));
                    }
                }
            });
            let mut done = done.into_inner().unwrap();
            done.sort_unstable();
            let all = (1..4).chain(10..40).chain(100..400);
            assert_eq!(done, all.collect::<Vec<_>>(), "{jobs}");
        }
    }
}
