//! An end to decisions by integers, which take seconds where coordinates differ by hundreds of digits.

/// Asked now and then during a decision by integers whether to leave it.
#[derive(Clone, Copy)]
pub(super) struct Deadline<'s>(Option<&'s dyn Fn() -> bool>);

/// A decision was left before its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CutShort;

impl<'s> Deadline<'s> {
    /// Every decision is made.
    pub(super) const NONE: Self = Self(None);

    /// Decisions are left once `stop` says so.
    pub(super) fn until(stop: &'s dyn Fn() -> bool) -> Self {
        Self(Some(stop))
    }

    /// # Errors
    /// [`CutShort`] if it is time to leave.
    pub(super) fn check(self) -> Result<(), CutShort> {
        match self.0 {
            Some(stop) if stop() => Err(CutShort),
            _ => Ok(()),
        }
    }
}
