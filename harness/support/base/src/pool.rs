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

/// Does tasks 0 to `count` on at most `jobs` threads, and gives their results in order to `take`, on the thread
/// of the caller. Few results wait at a time, so that memory doesn't depend on `count`. Each thread makes
/// something once, as for [`in_order_with`].
///
/// # Errors
/// The failure of the first task in order, or the first one of `take`. No later result is taken.
pub fn each_in_order<S, T: Send, E: Send>(
    jobs: usize,
    count: usize,
    of_thread: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> Result<T, E> + Sync,
    mut take: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let jobs = jobs.min(count);
    if jobs <= 1 {
        let mut own = of_thread();
        return (0..count).try_for_each(|task| take(work(&mut own, task)?));
    }
    let ordered = Ordered { state: Mutex::default(), changed: Condvar::new(), most: 2 * jobs };
    std::thread::scope(|scope| {
        let _end = EndOnPanic(&ordered);
        for _ in 0..jobs {
            spawn(scope, || {
                let _end = EndOnPanic(&ordered);
                let mut own = of_thread();
                while let Some(task) = ordered.begin(count) {
                    ordered.put(task, work(&mut own, task));
                }
            });
        }
        let taken = (0..count).try_for_each(|_| ordered.first().map_or(Ok(()), |r| take(r?)));
        ordered.end();
        taken
    })
}

/// Results of tasks that are taken in order.
struct Ordered<R> {
    state: Mutex<OrderedState<R>>,
    changed: Condvar,
    /// Largest number of tasks that are begun and not taken.
    most: usize,
}

struct OrderedState<R> {
    /// Results from the first one that isn't taken; `None`: it is being made.
    results: VecDeque<Option<R>>,
    /// Task of the first of them.
    first: usize,
    ended: bool,
}

impl<R> Default for OrderedState<R> {
    fn default() -> Self {
        Self { results: VecDeque::new(), first: 0, ended: false }
    }
}

impl<R> Ordered<R> {
    fn lock(&self) -> MutexGuard<'_, OrderedState<R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins the next task, when few enough are waiting; `None`: there is none.
    fn begin(&self, count: usize) -> Option<usize> {
        let mut state = self.lock();
        loop {
            let task = state.first + state.results.len();
            if state.ended || task >= count {
                return None;
            }
            if state.results.len() < self.most {
                state.results.push_back(None);
                return Some(task);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn put(&self, task: usize, result: R) {
        let mut state = self.lock();
        let place = task - state.first;
        if let Some(slot) = state.results.get_mut(place) {
            *slot = Some(result);
        }
        self.changed.notify_all();
    }

    /// Begins no further task, and waits for none.
    fn end(&self) {
        self.lock().ended = true;
        self.changed.notify_all();
    }

    /// Waits for the next result in order; `None`: a thread has panicked.
    fn first(&self) -> Option<R> {
        let mut state = self.lock();
        loop {
            if let Some(result) = state.results.front_mut().and_then(Option::take) {
                state.results.pop_front();
                state.first += 1;
                self.changed.notify_all();
                return Some(result);
            }
            if state.ended {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Ends the tasks after a panic: the other threads would wait for ever.
struct EndOnPanic<'a, R>(&'a Ordered<R>);

impl<R> Drop for EndOnPanic<'_, R> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.end();
        }
    }
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
pub const STACK: usize = 8 << 20;

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
    fn results_are_taken_in_order_and_few_wait() {
        for jobs in [1, 2, 5] {
            let (begun, mut taken) = (AtomicUsize::new(0), Vec::new());
            let work = |(): &mut (), task: usize| {
                begun.fetch_add(1, Ordering::Relaxed);
                Ok::<_, usize>(task)
            };
            let take = |task| {
                assert!(begun.load(Ordering::Relaxed) <= taken.len() + 2 * jobs + 1);
                taken.push(task);
                Ok(())
            };
            each_in_order(jobs, 1000, || (), work, take).unwrap();
            assert!(taken.iter().copied().eq(0..1000), "{jobs}");
            let mut count = 0;
            let fails = |(): &mut (), task| if task % 70 == 50 { Err(task) } else { Ok(task) };
            let counted = |_| {
                count += 1;
                Ok(())
            };
            assert_eq!(each_in_order(jobs, 1000, || (), fails, counted), Err(50));
            assert_eq!(count, 50);
            let refuse = |task| if task == 7 { Err(task) } else { Ok(()) };
            assert_eq!(each_in_order(jobs, 1000, || (), work, refuse), Err(7));
        }
        assert_eq!(each_in_order(3, 0, || (), |(), _| Ok::<_, ()>(()), |()| Err(())), Ok(()));
    }

    #[test]
    fn a_panic_of_a_task_is_one_of_the_caller() {
        let panics = |(): &mut (), task: usize| {
            assert_ne!(task, 30, "this task panics");
            Ok::<_, ()>(task)
        };
        let all = || each_in_order(2, 1000, || (), panics, |_| Ok(()));
        assert!(std::panic::catch_unwind(all).is_err());
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
