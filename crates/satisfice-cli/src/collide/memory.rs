//! Lists that grow with the answer: where memory ends, an error says so instead of an abort.

use anyhow::Context;

/// Appends an element.
///
/// # Errors
/// If there is no memory for it.
pub(super) fn push<T>(list: &mut Vec<T>, element: T) -> anyhow::Result<()> {
    if list.len() == list.capacity() {
        // Doubles, as `push` does, but does not abort; a smaller step where so much is not free.
        let most = list.len().max(1024);
        list.try_reserve_exact(most)
            .or_else(|_| list.try_reserve_exact(most / 8))
            .with_context(|| {
                format!(
                    "memory ends after {} pairs: ask for fewer by --max-pairs N",
                    list.len()
                )
            })?;
    }
    list.push(element);
    Ok(())
}
