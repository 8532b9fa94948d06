//! What the GPU wrote, on its way back without anybody waiting for it.
//!
//! A few staging buffers take turns. In a frame one is [begun](Ring::begin) with a ticket that says what
//! was asked, the copy into it is recorded, and after the submit it is [mapped](Ring::map); whenever the
//! device says that it is there, it is [taken](Ring::arrived), frames later. If all are under way, nothing
//! is asked in that frame. The buffers are whatever the renderer has ([`Staging`]).

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Buffers of a ring: answers that are three frames old are still taken, and one is being asked for.
pub const SLOTS: usize = 4;

const IDLE: u8 = 0;
const BEGUN: u8 = 1;
const COPIED: u8 = 2;
const MAPPING: u8 = 3;
const READY: u8 = 4;
const FAILED: u8 = 5;

/// A buffer that the GPU copies into and the CPU reads.
pub trait Staging {
    /// Its size, bytes.
    fn bytes(&self) -> u64;
    /// Asks for `bytes` of it from its start on, without waiting; `done` is told, from any thread, whether they are there.
    fn map(&self, bytes: u64, done: Box<dyn FnOnce(bool) + Send>);
    /// Gives the bytes that are there to `read`; it is the GPU's again afterwards.
    fn take(&self, bytes: u64, read: &mut dyn FnMut(&[u8]));
}

struct Slot<S, T> {
    staging: S,
    ticket: Option<T>,
    bytes: u64,
    state: Arc<AtomicU8>,
    /// Counts the questions.
    number: u64,
}

impl<S, T> Slot<S, T> {
    fn is(&self, state: u8) -> bool {
        self.state.load(Ordering::Acquire) == state
    }

    fn turn(&self, state: u8) {
        self.state.store(state, Ordering::Release);
    }
}

/// Staging buffers that take turns, each with the ticket of what was asked.
pub struct Ring<S, T> {
    slots: Vec<Slot<S, T>>,
    asked: u64,
}

impl<S, T> Default for Ring<S, T> {
    fn default() -> Self {
        Self {
            slots: Vec::new(),
            asked: 0,
        }
    }
}

impl<S: Staging, T> Ring<S, T> {
    /// Begins a question whose answer has so many bytes. `make` makes a buffer of at least that size, where
    /// none that is free is large enough. Whether there was a free one: at most one question a frame.
    pub fn begin(&mut self, bytes: u64, ticket: T, make: impl FnOnce() -> S) -> bool {
        if self.begun().is_some() {
            return false;
        }
        let free = |slot: &Slot<S, T>| slot.is(IDLE);
        let fits = |slot: &Slot<S, T>| free(slot) && slot.staging.bytes() >= bytes;
        let at = if let Some(at) = self.slots.iter().position(fits) {
            at
        } else if self.slots.len() < SLOTS {
            self.slots.push(Slot {
                staging: make(),
                ticket: None,
                bytes: 0,
                state: Arc::default(),
                number: 0,
            });
            self.slots.len() - 1
        } else if let Some(at) = self.slots.iter().position(free) {
            self.slots[at].staging = make();
            at
        } else {
            return false;
        };
        let slot = &mut self.slots[at];
        self.asked += 1;
        (slot.bytes, slot.ticket, slot.number) = (bytes, Some(ticket), self.asked);
        slot.turn(BEGUN);
        true
    }

    /// The question that was begun in this frame: its buffer, bytes and ticket.
    pub fn begun(&self) -> Option<(&S, u64, &T)> {
        let slot = self.slots.iter().find(|slot| slot.is(BEGUN))?;
        Some((&slot.staging, slot.bytes, slot.ticket.as_ref()?))
    }

    /// The copy into the buffer that was begun is recorded.
    pub fn copied(&mut self) {
        for slot in self.slots.iter().filter(|slot| slot.is(BEGUN)) {
            slot.turn(COPIED);
        }
    }

    /// After the submit: asks for what was copied. A question that was begun and not recorded is dropped.
    pub fn map(&mut self) {
        for slot in &mut self.slots {
            if slot.is(BEGUN) {
                slot.ticket = None;
                slot.turn(IDLE);
            } else if slot.is(COPIED) {
                slot.turn(MAPPING);
                let state = slot.state.clone();
                let done = move |there| {
                    state.store(if there { READY } else { FAILED }, Ordering::Release);
                };
                slot.staging.map(slot.bytes, Box::new(done));
            }
        }
    }

    /// Whether anything is under way: then the device should be polled, without waiting.
    #[must_use]
    pub fn under_way(&self) -> bool {
        self.slots.iter().any(|slot| !slot.is(IDLE))
    }

    /// Gives what has arrived to `read`, in the order in which it was asked.
    pub fn take_arrived(&mut self, mut read: impl FnMut(T, &[u8])) {
        loop {
            let ready = self.slots.iter_mut().filter(|slot| slot.is(READY));
            let Some(slot) = ready.min_by_key(|slot| slot.number) else {
                break;
            };
            let mut ticket = slot.ticket.take();
            slot.staging.take(slot.bytes, &mut |bytes| {
                if let Some(ticket) = ticket.take() {
                    read(ticket, bytes);
                }
            });
            slot.turn(IDLE);
        }
        for slot in self.slots.iter_mut().filter(|slot| slot.is(FAILED)) {
            slot.ticket = None;
            slot.turn(IDLE);
        }
    }

    /// What has arrived, in the order in which it was asked.
    pub fn arrived(&mut self) -> Vec<(T, Vec<u8>)> {
        let mut arrived = Vec::new();
        self.take_arrived(|ticket, bytes| arrived.push((ticket, bytes.to_vec())));
        arrived
    }

    /// Drops the tickets of what is under way: nothing of it will be given to anybody.
    pub fn forget(&mut self) {
        for slot in &mut self.slots {
            slot.ticket = None;
        }
    }

    /// Number of questions that were begun.
    #[must_use]
    pub const fn asked(&self) -> u64 {
        self.asked
    }

    /// Number of buffers that were made and are kept.
    #[must_use]
    pub fn buffers(&self) -> usize {
        self.slots.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    type Waiting = Arc<Mutex<Vec<Box<dyn FnOnce(bool) + Send>>>>;

    /// A device that answers when it is told to.
    struct Made {
        size: u64,
        waiting: Waiting,
    }

    impl Staging for Made {
        fn bytes(&self) -> u64 {
            self.size
        }

        fn map(&self, _: u64, done: Box<dyn FnOnce(bool) + Send>) {
            self.waiting.lock().unwrap().push(done);
        }

        fn take(&self, bytes: u64, read: &mut dyn FnMut(&[u8])) {
            read(&vec![1; bytes as usize]);
        }
    }

    fn frame(ring: &mut Ring<Made, u32>, waiting: &Waiting, number: u32, bytes: u64) -> bool {
        let make = || Made {
            size: bytes,
            waiting: waiting.clone(),
        };
        let begun = ring.begin(bytes, number, make);
        ring.copied();
        ring.map();
        begun
    }

    fn answer(waiting: &Waiting, there: bool) {
        let done = waiting.lock().unwrap().remove(0);
        done(there);
    }

    #[test]
    fn answers_come_in_order_and_nobody_waits() {
        let (mut ring, waiting) = (Ring::default(), Waiting::default());
        for number in 0..SLOTS as u32 {
            assert!(frame(&mut ring, &waiting, number, 8));
        }
        assert!(!frame(&mut ring, &waiting, 9, 8), "all are under way");
        assert_eq!(ring.asked(), SLOTS as u64);
        assert!(ring.arrived().is_empty());
        answer(&waiting, true);
        answer(&waiting, true);
        let arrived = ring.arrived();
        assert_eq!(arrived, [(0, vec![1; 8]), (1, vec![1; 8])]);
        // The first buffer is free again and is asked last: it comes after those before it.
        assert!(frame(&mut ring, &waiting, 4, 8));
        for _ in 0..3 {
            answer(&waiting, true);
        }
        let tickets: Vec<u32> = ring
            .arrived()
            .into_iter()
            .map(|(ticket, _)| ticket)
            .collect();
        assert_eq!(tickets, [2, 3, 4]);
        assert!(!ring.under_way());
        assert_eq!(ring.buffers(), SLOTS);
    }

    #[test]
    fn a_lost_answer_frees_its_buffer_and_a_larger_question_gets_a_larger_one() {
        let (mut ring, waiting) = (Ring::default(), Waiting::default());
        assert!(frame(&mut ring, &waiting, 0, 8));
        answer(&waiting, false);
        assert!(ring.arrived().is_empty() && !ring.under_way());
        for number in 1..=SLOTS as u32 {
            assert!(frame(&mut ring, &waiting, number, 16));
            answer(&waiting, true);
        }
        assert_eq!(ring.arrived().len(), SLOTS);
        assert!(frame(&mut ring, &waiting, 7, 4), "a larger one will do");
        assert!(ring.buffers() <= SLOTS);
    }

    #[test]
    fn what_is_forgotten_is_given_to_nobody() {
        let (mut ring, waiting) = (Ring::default(), Waiting::default());
        assert!(frame(&mut ring, &waiting, 0, 8));
        ring.forget();
        answer(&waiting, true);
        assert!(ring.arrived().is_empty() && !ring.under_way());
    }

    #[test]
    fn a_question_that_was_not_recorded_is_dropped() {
        let (mut ring, waiting) = (Ring::default(), Waiting::default());
        let make = || Made {
            size: 4,
            waiting: waiting.clone(),
        };
        assert!(ring.begin(4, 1, make));
        assert!(!ring.begin(4, 2, make), "one a frame");
        assert_eq!(ring.begun().map(|(.., ticket)| *ticket), Some(1));
        ring.map();
        assert!(ring.begun().is_none() && !ring.under_way());
    }
}
