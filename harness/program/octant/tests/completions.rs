//! Completions of shells and manual pages.

use crate::common::program::ends;

#[cfg(feature = "completions")]
#[test]
fn every_shell_has_a_script_and_every_command_a_page() {
    for (shell, mark) in [
        ("bash", "complete -F _octant"),
        ("zsh", "#compdef octant"),
        ("fish", "complete -c octant"),
        ("powershell", "Register-ArgumentCompleter"),
    ] {
        let (script, _) = ends(&["completions", shell], 0);
        assert!(script.contains(mark), "{shell}");
        assert!(script.contains("only-faults"), "{shell} knows the options of run");
        assert!(!script.contains("\\u001b"), "{shell}: no control character was escaped");
    }
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man");
    ends(&["man", pages.to_str().unwrap()], 0);
    for page in ["octant.1", "octant-run.1", "octant-campaign-run.1", "octant-faults-sweep.1"] {
        let text = std::fs::read_to_string(pages.join(page)).unwrap();
        assert!(text.contains(".TH"), "{page}");
    }
    assert!(!pages.join("octant-campaign-one.1").exists(), "hidden commands have no page");
}

#[cfg(not(feature = "completions"))]
#[test]
fn a_program_without_them_says_how_to_build_it() {
    for arguments in [["completions", "bash"], ["man", "pages"]] {
        let (_, said) = ends(&arguments, 2);
        assert!(said.contains("--features octant/completions"), "{said}");
    }
}

#[test]
fn an_unknown_shell_is_told_with_the_known_ones() {
    let (_, said) = ends(&["completions", "csh"], 2);
    assert!(said.contains("bash, zsh, fish, powershell"), "{said}");
}
