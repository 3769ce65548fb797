//! Where memory ends: one line and exit code 2 instead of an abort.

#![expect(
    unsafe_code,
    reason = "an allocator cannot be written without; every call goes to the system's"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::{failure, output};

/// The system's allocator for a program that runs a [`Command`](crate::Command): where memory ends, the program says so in one
/// line on stderr and exits with code 2. Files written until then are whole. (Rust's own answer is several lines and SIGABRT;
/// a stable hook for it does not exist.)
///
/// ```
/// #[global_allocator]
/// static ALLOCATOR: satisfice_cli::Allocator = satisfice_cli::Allocator;
/// # fn main() {}
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Allocator;

thread_local! {
    /// Whether this thread does without the memory that it asks for.
    static CAN_DO_WITHOUT: Cell<bool> = const { Cell::new(false) };
}

static HAS_ENDED: AtomicBool = AtomicBool::new(false);

/// Does what can do without the memory that it asks for, such as `try_reserve`: the program goes on if there is none.
pub(crate) fn fallibly<T>(ask: impl FnOnce() -> T) -> T {
    let before = CAN_DO_WITHOUT.replace(true);
    let answer = ask();
    CAN_DO_WITHOUT.set(before);
    answer
}

/// Passes on what the system gave, and ends the program if that is nothing.
fn checked(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() && !CAN_DO_WITHOUT.get() {
        end(bytes);
    }
    memory
}

#[cold]
fn end(bytes: usize) -> ! {
    if HAS_ENDED.swap(true, Ordering::SeqCst) {
        // Another thread is ending the program.
        loop {
            thread::sleep(Duration::from_secs(1));
        }
    }
    fallibly(|| {
        // Neither needs memory.
        drop(writeln!(
            std::io::stderr(),
            "error: memory ended, {bytes} more bytes were needed: ask for less, or allow more memory"
        ));
        output::try_remove_partial_files();
    });
    std::process::exit(i32::from(failure::ERROR))
}

// SAFETY: every call goes to the system's allocator with the caller's arguments, and its answer goes back unchanged. The
// program may end in between, which unwinds nothing.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as promised by the caller.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as promised by the caller.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        // SAFETY: as promised by the caller.
        checked(unsafe { System.realloc(memory, layout, bytes) }, bytes)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as promised by the caller.
        unsafe { System.dealloc(memory, layout) }
    }
}
