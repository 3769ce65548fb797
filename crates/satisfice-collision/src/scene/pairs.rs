//! Records of the pairs of bodies whose boxes meet, found from either body without a table.
//!
//! A record belongs to two bodies, or to one and itself, and is a member of the list of each. A member is named by twice the
//! number of its record, plus one for the second body.

use super::slack::Slack;
use crate::broad::Pair;

/// The end of a list.
pub(super) const NONE: u32 = u32::MAX;

/// How far the contacts of a record can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    /// Never searched for.
    New,
    /// Those of the present frame.
    Current,
    /// Some of those of the present frame.
    Partial,
    /// Those of the last frame.
    Behind,
    /// Some of those of an earlier frame.
    Stale,
}

impl Status {
    /// Whether the contacts are part of the present answer.
    pub(super) fn is_shown(self) -> bool {
        matches!(self, Self::Current | Self::Partial)
    }
}

/// Two bodies whose boxes meet, or a body with itself.
pub(super) struct Record {
    /// The bodies of the first and of the second feature.
    pub(super) bodies: [u32; 2],
    next: [u32; 2],
    before: [u32; 2],
    pub(super) status: Status,
    /// Whether it is in the list of records to examine.
    pub(super) is_dirty: bool,
    /// Whether the exact boxes were apart when they were compared last.
    pub(super) apart: bool,
    /// Frames in a row in which a new grid found few pairs among many vertices; negative while it does not matter.
    pub(super) sparse: i16,
    /// The contacts, sorted.
    pub(super) pairs: Vec<Pair>,
    /// For the next frame under a budget.
    pub(super) slack: Option<Box<Slack>>,
}

/// The records.
#[derive(Default)]
pub(super) struct Records {
    records: Vec<Record>,
    /// The bodies of each record once more, so that looking through all of them reads little.
    bodies: Vec<[u32; 2]>,
    free: Vec<u32>,
    /// The first member of each body's list, by slot.
    heads: Vec<u32>,
    /// Records of a body with itself.
    own: usize,
    /// Records whose boxes were apart when they were compared last.
    apart: usize,
}

impl std::ops::Index<u32> for Records {
    type Output = Record;

    fn index(&self, record: u32) -> &Record {
        &self.records[record as usize]
    }
}

impl std::ops::IndexMut<u32> for Records {
    fn index_mut(&mut self, record: u32) -> &mut Record {
        &mut self.records[record as usize]
    }
}

impl Records {
    /// The number of records of two different bodies.
    pub(super) fn of_two(&self) -> usize {
        self.records.len() - self.free.len() - self.own
    }

    /// The number of records.
    pub(super) fn len(&self) -> usize {
        self.records.len() - self.free.len()
    }

    /// The number of records whose boxes are apart.
    pub(super) fn apart(&self) -> usize {
        self.apart
    }

    /// Bytes held, contacts included.
    pub(super) fn bytes(&self) -> usize {
        let contacts = self.records.iter().map(|record| record.pairs.capacity());
        self.records.capacity() * size_of::<Record>()
            + self.bodies.capacity() * size_of::<[u32; 2]>()
            + (self.free.capacity() + self.heads.capacity()) * 4
            + contacts.sum::<usize>() * size_of::<Pair>()
    }

    /// All records with their numbers.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, &Record)> {
        (0..)
            .zip(&self.records)
            .filter(|(_, record)| record.bodies[0] != NONE)
    }

    /// No record has this number or a greater one.
    pub(super) fn end(&self) -> u32 {
        self.records.len() as u32
    }

    /// Adds a record, of a body with itself if both are one.
    pub(super) fn add(&mut self, bodies: [u32; 2]) -> u32 {
        let record = Record {
            bodies,
            next: [NONE; 2],
            before: [NONE; 2],
            status: Status::New,
            is_dirty: false,
            apart: false,
            sparse: 0,
            pairs: Vec::new(),
            slack: None,
        };
        let id = match self.free.pop() {
            Some(id) => {
                self.records[id as usize] = record;
                self.bodies[id as usize] = bodies;
                id
            }
            None => {
                super::push(&mut self.records, record);
                super::push(&mut self.bodies, bodies);
                self.records.len() as u32 - 1
            }
        };
        let most = bodies[0].max(bodies[1]) as usize + 1;
        if self.heads.len() < most {
            self.heads.resize(most, NONE);
        }
        self.own += usize::from(bodies[0] == bodies[1]);
        for side in 0..sides(bodies) {
            let head = std::mem::replace(&mut self.heads[bodies[side] as usize], 2 * id + side as u32);
            self.records[id as usize].next[side] = head;
            if head != NONE {
                self.records[head as usize / 2].before[head as usize % 2] = 2 * id + side as u32;
            }
        }
        id
    }

    /// Removes a record and returns its contacts.
    pub(super) fn remove(&mut self, id: u32) -> Vec<Pair> {
        let record = &mut self.records[id as usize];
        let (bodies, next, before) = (record.bodies, record.next, record.before);
        record.bodies = [NONE; 2];
        self.bodies[id as usize] = [NONE; 2];
        record.slack = None;
        let pairs = std::mem::take(&mut record.pairs);
        self.own -= usize::from(bodies[0] == bodies[1]);
        self.apart -= usize::from(record.apart);
        for side in 0..sides(bodies) {
            match before[side] {
                NONE => self.heads[bodies[side] as usize] = next[side],
                member => self.records[member as usize / 2].next[member as usize % 2] = next[side],
            }
            if next[side] != NONE {
                self.records[next[side] as usize / 2].before[next[side] as usize % 2] = before[side];
            }
        }
        self.free.push(id);
        pairs
    }

    /// Whether the record exists.
    pub(super) fn contains(&self, id: u32) -> bool {
        self.records
            .get(id as usize)
            .is_some_and(|record| record.bodies[0] != NONE)
    }

    /// The bodies of a record, if it exists.
    pub(super) fn bodies_of(&self, id: u32) -> Option<[u32; 2]> {
        self.bodies
            .get(id as usize)
            .copied()
            .filter(|bodies| bodies[0] != NONE)
    }

    /// The bodies of the records from this one on; [`NONE`] for those that do not exist.
    pub(super) fn bodies_from(&self, first: u32) -> &[[u32; 2]] {
        self.bodies.get(first as usize..).unwrap_or_default()
    }

    /// The first member of a body's list.
    pub(super) fn first(&self, body: u32) -> u32 {
        self.heads.get(body as usize).copied().unwrap_or(NONE)
    }

    /// The member after another one.
    pub(super) fn next(&self, member: u32) -> u32 {
        self.records[member as usize / 2].next[member as usize % 2]
    }

    /// The records of a body.
    pub(super) fn of(&self, body: u32) -> impl Iterator<Item = u32> {
        let mut member = self.first(body);
        std::iter::from_fn(move || {
            let id = member / 2;
            (member != NONE).then(|| {
                member = self.next(member);
                id
            })
        })
    }

    /// Notes whether the exact boxes of a record are apart.
    pub(super) fn set_apart(&mut self, id: u32, apart: bool) {
        let known = std::mem::replace(&mut self.records[id as usize].apart, apart);
        self.apart = self.apart + usize::from(apart) - usize::from(known);
    }
}

/// The number of lists that a record is a member of.
fn sides(bodies: [u32; 2]) -> usize {
    1 + usize::from(bodies[0] != bodies[1])
}

impl Record {
    /// One of the bodies has moved. Returns whether the contacts are those of the last frame now.
    #[inline]
    pub(super) fn has_moved(&mut self) -> bool {
        if self.status == Status::Current {
            self.status = Status::Behind;
        }
        self.status == Status::Behind
    }

    /// Notes whether a new grid found few pairs; `None` changes nothing.
    pub(super) fn note_sparse(&mut self, sparse: Option<bool>) {
        self.sparse = match sparse {
            Some(true) => self.sparse.saturating_add(1),
            Some(false) => self.sparse.min(0),
            None => self.sparse,
        };
    }
}
