//! Computations under way: of the requests of one page for one part the newest wins.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::Mutex as Turn;

use crate::message::Part;

/// Most pages times parts that are remembered.
const MOST_PLACES: usize = 64;

/// The computations of all pages.
#[derive(Debug, Default)]
pub(crate) struct Jobs {
    places: Mutex<Places>,
}

#[derive(Debug, Default)]
struct Places {
    newest: HashMap<(String, Part), Job>,
    closed: bool,
}

/// A computation that a newer one stops.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    /// Set once the result is not wanted any more.
    pub(crate) stop: Arc<AtomicBool>,
    /// Held while it computes, so that a page has one computation a part.
    pub(crate) turn: Arc<Turn<()>>,
}

impl Jobs {
    /// The newest computation of a page for a part; the one before is stopped. None once all are closed.
    pub(crate) fn begin(&self, tab: &str, part: Part) -> Option<Job> {
        let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        if places.closed {
            return None;
        }
        let key = (tab.to_owned(), part);
        let turn = match places.newest.get(&key) {
            Some(older) => {
                older.stop.store(true, Ordering::Relaxed);
                Arc::clone(&older.turn)
            }
            None => Arc::default(),
        };
        if places.newest.len() >= MOST_PLACES {
            // The pages that compute keep their places.
            places.newest.retain(|_, job| Arc::strong_count(&job.stop) > 1);
        }
        let job = Job { stop: Arc::default(), turn };
        places.newest.insert(key, job.clone());
        Some(job)
    }

    /// Stops all computations, and begins no other.
    pub(crate) fn close(&self) {
        let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        places.closed = true;
        places.newest.values().for_each(|job| job.stop.store(true, Ordering::Relaxed));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_stopped(job: &Job) -> bool {
        job.stop.load(Ordering::Relaxed)
    }

    #[test]
    fn the_newest_request_of_a_page_for_a_part_wins() {
        let jobs = Jobs::default();
        let first = jobs.begin("a", Part::Hit).unwrap();
        let other_part = jobs.begin("a", Part::Steady).unwrap();
        let other_page = jobs.begin("b", Part::Hit).unwrap();
        let second = jobs.begin("a", Part::Hit).unwrap();
        assert!(is_stopped(&first));
        assert!(Arc::ptr_eq(&first.turn, &second.turn), "one computation a part");
        assert!([&other_part, &other_page, &second].into_iter().all(|job| !is_stopped(job)));
        jobs.close();
        assert!(is_stopped(&second) && jobs.begin("a", Part::Hit).is_none());
    }

    #[test]
    fn pages_that_have_gone_are_forgotten() {
        let jobs = Jobs::default();
        let kept = jobs.begin("kept", Part::Hit).unwrap();
        for page in 0..10 * MOST_PLACES {
            jobs.begin(&page.to_string(), Part::Hit);
        }
        assert!(jobs.places.lock().unwrap().newest.len() <= MOST_PLACES);
        jobs.begin("kept", Part::Hit);
        assert!(is_stopped(&kept));
    }
}
