//! Work that is held back until there is room for it.
//!
//! Promise: what runs at one time costs no more than the budget together, but for one piece that costs more by itself, which then
//! runs alone; every piece runs once; the dearest that fits goes first, so that it does not come last. Pieces never wait inside of
//! the pool, where one that waits would keep a thread from what it waits for.

use std::sync::{Condvar, Mutex, PoisonError};

/// What is free of a budget.
struct Room {
    free: Mutex<u64>,
    grown: Condvar,
}

/// Runs every piece in the pool that this is called beside. `costs` are those of the pieces by their number.
pub(crate) fn run(budget: u64, costs: &[u64], pool: &rayon::ThreadPool, piece: &(dyn Fn(usize) + Sync)) {
    let budget = budget.max(1);
    // One that costs more takes all.
    let cost = |index: usize| costs[index].clamp(1, budget);
    let mut waiting: Vec<usize> = (0..costs.len()).collect();
    waiting.sort_by_key(|index| (std::cmp::Reverse(cost(*index)), *index));
    let room = Room { free: Mutex::new(budget), grown: Condvar::new() };
    pool.in_place_scope(|scope| {
        while !waiting.is_empty() {
            let mut free = room.free.lock().unwrap_or_else(PoisonError::into_inner);
            let place = loop {
                // Costs stand from the greatest to the least.
                let place = waiting.partition_point(|index| cost(*index) > *free);
                if place < waiting.len() {
                    break place;
                }
                free = room.grown.wait(free).unwrap_or_else(PoisonError::into_inner);
            };
            let index = waiting.remove(place);
            *free -= cost(index);
            drop(free);
            let room = &room;
            let cost = cost(index);
            scope.spawn(move |_| {
                piece(index);
                *room.free.lock().unwrap_or_else(PoisonError::into_inner) += cost;
                room.grown.notify_one();
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::run;

    #[test]
    fn what_runs_at_one_time_stays_within_the_budget() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        let costs = [5, 1, 9, 3, 3, 3, 200, 1, 1, 1, 0, 4];
        let (running, most) = (AtomicU64::new(0), AtomicU64::new(0));
        let ran: Vec<AtomicU64> = costs.iter().map(|_| AtomicU64::new(0)).collect();
        run(10, &costs, &pool, &|index| {
            let cost = costs[index].clamp(1, 10);
            most.fetch_max(running.fetch_add(cost, Ordering::SeqCst) + cost, Ordering::SeqCst);
            // Work inside of the pool, where another piece may be taken up while this one waits.
            rayon::join(std::thread::yield_now, std::thread::yield_now);
            running.fetch_sub(cost, Ordering::SeqCst);
            ran[index].fetch_add(1, Ordering::SeqCst);
        });
        assert!(ran.iter().all(|count| count.load(Ordering::SeqCst) == 1));
        assert!(most.load(Ordering::SeqCst) <= 10);
    }
}
