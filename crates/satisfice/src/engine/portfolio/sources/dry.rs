//! Sources that have nothing new for a batch.

use crate::engine::portfolio::source::PLACES;

const _: () = assert!(PLACES <= u16::BITS as usize, "a bit for every source");

/// Which sources gave no candidate in this batch, by their indices among the names of all, and which of them are left out for that.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Dry {
    noted: u16,
    left_out: u16,
}

impl Dry {
    /// Notes that a choice of this source gave nothing.
    pub(super) fn note(&mut self, place: usize) {
        self.noted |= 1 << place;
    }

    /// Leaves out the sources that were noted; `false` if all of them are left out already.
    pub(super) fn leave_out(&mut self) -> bool {
        let is_more = self.noted & !self.left_out != 0;
        self.left_out |= self.noted;
        is_more
    }

    /// Whether a source is left out.
    pub(super) fn has(&self, place: usize) -> bool {
        self.left_out & 1 << place != 0
    }

    /// Whether any source is left out.
    pub(super) fn has_any(&self) -> bool {
        self.left_out != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_left_out_once_they_were_noted() {
        let mut dry = Dry::default();
        assert!(!dry.leave_out() && !dry.has_any());
        dry.note(3);
        dry.note(PLACES - 1);
        assert!(!dry.has(3));
        assert!(dry.leave_out() && dry.has_any());
        assert!(dry.has(3) && dry.has(PLACES - 1) && !dry.has(4));
        dry.note(3);
        assert!(!dry.leave_out());
        dry.note(4);
        assert!(dry.leave_out() && dry.has(4));
    }
}
