//! Which mutant of this crate is on: the one that OCTANT_MUTANT names. With OCTANT_MUTANTS_REACHED a file is left in that
//! folder for each mutant whose place is reached.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static ON: OnceLock<(usize, Option<PathBuf>)> = OnceLock::new();
static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];

#[inline]
pub(crate) fn on(id: usize) -> bool {
    let (chosen, folder) = ON.get_or_init(|| {
        let chosen = std::env::var("OCTANT_MUTANT").ok().and_then(|text| text.parse().ok());
        (chosen.unwrap_or(usize::MAX), std::env::var_os("OCTANT_MUTANTS_REACHED").map(PathBuf::from))
    });
    if let Some(folder) = folder {
        note(id, folder);
    }
    id == *chosen
}

#[cold]
fn note(id: usize, folder: &std::path::Path) {
    if !REACHED[id].swap(true, Ordering::Relaxed) {
        // A note that is lost would make a mutant look as if no test reached it.
        std::fs::write(folder.join(id.to_string()), "").expect("the folder of OCTANT_MUTANTS_REACHED");
    }
}
