//! What the last update changed: contacts and pairs of bodies that began, persisted although recomputed, or ended.

use std::cmp::Ordering;
use std::iter::Peekable;

use super::pairs::NONE;
use super::{BodyId, Contact, World};
use crate::broad::Pair;

/// The change of a contact or of a pair of bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ChangeKind {
    /// It was not there before.
    Begun,
    /// It was there and still is; it was recomputed because one of its bodies moved.
    Persisting,
    /// It is no longer there.
    Ended,
}

/// The change of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Change {
    /// The contact.
    pub contact: Contact,
    /// Its change.
    pub kind: ChangeKind,
}

/// The change of two bodies, or of one with itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyChange {
    /// The body of the first features. For pairs of equal features the one with the lower index.
    pub body_a: BodyId,
    /// The body of the second features.
    pub body_b: BodyId,
    /// Whether they began to touch, still touch, or touch no longer.
    pub kind: ChangeKind,
    /// Their contacts now.
    pub contacts: usize,
}

/// The contacts that two bodies had before the last update examined them.
struct Entry {
    bodies: [BodyId; 2],
    /// [`NONE`] if the record was taken out.
    record: u32,
    before: Vec<Pair>,
}

/// The records that the last update examined.
#[derive(Default)]
pub(super) struct Log {
    entries: Vec<Entry>,
    /// Whether an update has ended since the first entry.
    is_over: bool,
    /// So many entries, the first ones, are forgotten. Their memory is given back by the next update, not by whoever places a body.
    void: usize,
}

impl Log {
    /// Starts a new frame and forgets the last update.
    pub(super) fn begin(&mut self) {
        if std::mem::take(&mut self.is_over) {
            self.void = self.entries.len();
        }
    }

    /// Gives back the memory of what is forgotten.
    pub(super) fn clean(&mut self) {
        self.entries.drain(..std::mem::take(&mut self.void));
    }

    /// An update has ended.
    pub(super) fn end(&mut self) {
        self.clean();
        self.is_over = true;
    }

    /// Notes which pairs there were before.
    pub(super) fn note(&mut self, bodies: [BodyId; 2], record: u32, before: Vec<Pair>) {
        self.entries.push(Entry {
            bodies,
            record,
            before,
        });
    }
}

impl World {
    /// The contacts that the last update examined: those that began or ended, and those that persist although one of their
    /// bodies moved. Contacts of bodies at rest are not among them. In the order in which bodies were examined; those of two
    /// bodies are sorted. The contacts of a body that was [replaced](World::replace) had features of another mesh: each of them
    /// ends, and those of the new mesh begin, so that a contact that both meshes have is there twice, as [`ChangeKind::Ended`] and as
    /// [`ChangeKind::Begun`]. A body that is added, removed, replaced, excluded or moved afterwards ends this: there are no changes
    /// until the next update.
    pub fn changes(&self) -> impl Iterator<Item = Change> {
        let entries = self.log.entries.iter().filter(|_| self.log.is_over);
        entries.flat_map(move |entry| {
            let [body_a, body_b] = entry.bodies;
            let merged = Merged {
                before: entry.before.iter().copied().peekable(),
                now: self.present(entry).iter().copied().peekable(),
            };
            merged.map(move |(Pair { a, b }, kind)| Change {
                contact: Contact { body_a, body_b, a, b },
                kind,
            })
        })
    }

    /// The pairs of bodies that began to touch in the last update, were examined and still touch, or touch no longer. Kinds
    /// with two different features name two bodies once for each order.
    pub fn body_changes(&self) -> impl Iterator<Item = BodyChange> {
        let entries = self.log.entries.iter().filter(|_| self.log.is_over);
        entries.filter_map(|entry| {
            let [body_a, body_b] = entry.bodies;
            let contacts = self.present(entry).len();
            let kind = match (entry.before.is_empty(), contacts == 0) {
                (true, true) => return None,
                (true, false) => ChangeKind::Begun,
                (false, false) => ChangeKind::Persisting,
                (false, true) => ChangeKind::Ended,
            };
            Some(BodyChange {
                body_a,
                body_b,
                kind,
                contacts,
            })
        })
    }

    fn present(&self, entry: &Entry) -> &[Pair] {
        match entry.record {
            NONE => &[],
            record => &self.pairs[record].pairs,
        }
    }
}

/// Two sorted sequences as one, and which of them each pair is in.
struct Merged<A: Iterator, B: Iterator> {
    before: Peekable<A>,
    now: Peekable<B>,
}

impl<A: Iterator<Item = Pair>, B: Iterator<Item = Pair>> Iterator for Merged<A, B> {
    type Item = (Pair, ChangeKind);

    fn next(&mut self) -> Option<Self::Item> {
        let order = match (self.before.peek(), self.now.peek()) {
            (Some(before), Some(now)) => before.cmp(now),
            (Some(_), None) => Ordering::Less,
            (None, _) => Ordering::Greater,
        };
        match order {
            Ordering::Less => self.before.next().map(|pair| (pair, ChangeKind::Ended)),
            Ordering::Greater => self.now.next().map(|pair| (pair, ChangeKind::Begun)),
            Ordering::Equal => {
                self.before.next();
                self.now.next().map(|pair| (pair, ChangeKind::Persisting))
            }
        }
    }
}
