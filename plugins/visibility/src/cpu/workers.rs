//! Work shared out between threads.

use std::sync::{Mutex, PoisonError};
use std::thread;

/// Gives items in their order to as many threads as there are states, whichever is free; returns when all is done.
///
/// What an item's work leaves must not depend on the thread: then the number of threads changes nothing.
///
/// * `states`: what each thread works with, such as memory that it keeps; nothing is done if there are none.
pub fn share_out<T: Send, S: Send>(
    items: impl Iterator<Item = T> + Send,
    states: &mut [S],
    work: impl Fn(&mut S, T) + Sync,
) {
    let items = Mutex::new(items);
    let work_on = |state: &mut S| {
        loop {
            let item = items.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(item) = item else { return };
            work(state, item);
        }
    };
    let Some((own, others)) = states.split_first_mut() else {
        return;
    };
    thread::scope(|scope| {
        let work_on = &work_on;
        for state in others {
            // Without a thread the others do its work.
            let _ = thread::Builder::new()
                .name("splats".into())
                .spawn_scoped(scope, move || work_on(state));
        }
        work_on(own);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once() {
        for thread_count in [1, 3] {
            let mut states = vec![0_u64; thread_count];
            share_out(1..=100_u64, &mut states, |sum, item| *sum += item);
            assert_eq!(states.iter().sum::<u64>(), 5_050);
        }
    }
}
