//! Sources on the command line.

use octant::source_uri::from_here;

#[test]
fn a_source_on_the_command_line_starts_at_the_current_folder() {
    let here = std::env::current_dir().unwrap();
    let found = from_here("replay:a/b.mcap").unwrap();
    assert_eq!(found, format!("replay:{}", here.join("a/b.mcap").display()));
    let found = from_here("log:a/b.bin").unwrap();
    assert_eq!(found, format!("log:{}", here.join("a/b.bin").display()));
    for same in ["plant", "text:/c/d.txt", "text:${OCTANT_RECORDINGS}/e.txt", "replay:"] {
        assert_eq!(from_here(same).unwrap(), same);
    }
}
