//! Work on one log, on whatever cores nobody else uses.

use rayon::prelude::*;

/// Does something with each, on all cores, and gives what came of them in their order. Within a task of a pool it is done one after
/// another: a task that waited for tasks of its own would take up others of the pool meanwhile, a whole log's, and their time
/// would be counted as its own.
pub(crate) fn on_free_cores<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    if rayon::current_thread_index().is_some() {
        items.into_iter().map(work).collect()
    } else {
        items.into_par_iter().with_max_len(1).map(&work).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    #[test]
    fn a_task_of_a_pool_takes_up_no_other() {
        let done_by = |_: usize| thread::current().id();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let logs = pool.install(|| {
            let log = |_: usize| (thread::current().id(), on_free_cores((0..20).collect(), done_by));
            (0..8).into_par_iter().with_max_len(1).map(log).collect::<Vec<_>>()
        });
        for (thread, parts) in logs {
            assert!(parts.iter().all(|part| *part == thread));
        }
        let alone = on_free_cores((0..20).collect(), done_by);
        assert!(alone.iter().all(|part| *part != thread::current().id()), "the pool's threads are free");
    }

    #[test]
    fn what_comes_of_each_is_in_their_order() {
        assert_eq!(on_free_cores((0..100).collect(), |i: i32| i * i), (0..100).map(|i| i * i).collect::<Vec<_>>());
    }
}
