//! Work for several students at once.

use rayon::prelude::*;

/// Does `work` for every one of `items` and gives the results in order: side by side on the rayon pool that
/// the calling thread belongs to, or one after the other on the calling thread if it belongs to none.
pub fn side_by_side<T: Send, U: Send>(items: Vec<T>, work: impl Fn(T) -> U + Sync + Send) -> Vec<U> {
    match rayon::current_thread_index() {
        Some(_) => items.into_par_iter().map(work).collect(),
        None => items.into_iter().map(work).collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::side_by_side;

    #[test]
    fn a_pool_is_used_by_its_own_threads_alone() {
        let threads = || side_by_side((0..4).collect(), |item: usize| (item, thread::current().id()));
        let here = thread::current().id();
        assert_eq!(threads(), [0, 1, 2, 3].map(|item| (item, here)));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let there = pool.install(threads);
        assert_eq!(there.iter().map(|(item, _)| *item).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert!(there.iter().all(|(_, thread)| *thread != here));
    }
}
