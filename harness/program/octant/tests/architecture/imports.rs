//! The graph of the files inside a crate: which file takes something from which, by the paths in their text.
//!
//! A name that a file takes by the `use` of another is taken from both: from the one whose path it writes, and from the
//! one in which the name is defined. A `pub use` of a child hands a name on and takes nothing, unless the file uses the
//! name itself.

use super::{Graph, product, sources};
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Names on the way to a module or an item, from the root of the crate.
type Names = Vec<String>;

/// What one leaf of a `use` brings into its file.
struct Binding {
    /// Where it comes from, from the root of the crate.
    from: Names,
    /// The name in this file; none of `*` and `_`.
    name: Option<String>,
    /// All that is public there.
    is_glob: bool,
    /// For others too.
    is_public: bool,
}

/// What the text of a file tells, without its comments and its tests.
struct File {
    bindings: Vec<Binding>,
    /// Names of items that are defined in it.
    defines: BTreeSet<String>,
    /// Names that begin a path in it, outside of `use`.
    uses: BTreeSet<String>,
    /// Paths of more than one name, outside of `use`.
    paths: BTreeSet<Names>,
}

/// What makes the name behind it one that is defined.
const DEFINE: [&str; 10] =
    ["struct", "enum", "trait", "type", "union", "fn", "const", "static", "mod", "macro_rules"];

impl File {
    /// Looks through a text without comments and `use`.
    ///
    /// A name begins a path where it is no field, no method and no part of a longer path. One in small letters, which
    /// may be a variable's, counts where it is called or leads on.
    fn of(text: &str, bindings: Vec<Binding>) -> File {
        let mut file = File {
            bindings,
            defines: BTreeSet::new(),
            uses: BTreeSet::new(),
            paths: BTreeSet::new(),
        };
        let is_part = |character: char| character.is_ascii_alphanumeric() || character == '_';
        let (mut rest, mut last, mut path) = (text, "", Names::new());
        while let Some(start) = rest.find(is_part) {
            let (between, from) = rest.split_at(start);
            let name = &from[..from.find(|character| !is_part(character)).unwrap_or(from.len())];
            rest = &from[name.len()..];
            let after = rest.trim_start();
            if between != "::" {
                let is_member = between.ends_with('.') && !between.ends_with("..");
                let is_small = name.starts_with(|first: char| first.is_ascii_lowercase());
                let leads = ["(", "::", "!"].iter().any(|next| after.starts_with(next));
                if !is_member && !between.ends_with("::") && (!is_small || leads) {
                    file.uses.insert(name.to_owned());
                }
                if DEFINE.contains(&last) && between.chars().all(|c| c.is_whitespace() || c == '!')
                {
                    file.defines.insert(name.to_owned());
                }
            }
            path.push(name.to_owned());
            last = name;
            if !rest.starts_with("::") || !rest[2..].starts_with(is_part) {
                let path = std::mem::take(&mut path);
                if path.len() > 1 {
                    file.paths.insert(path);
                }
            }
        }
        file
    }
}

/// The files of a crate by their modules.
struct Crate {
    files: BTreeMap<Names, File>,
}

/// Which file of a crate takes something from which, below the folder of its source: `lib` is the root of the crate, and
/// the others are named by their modules.
pub(super) fn imports(source: &Path) -> Graph {
    let name = |module: &Names| match module.is_empty() {
        true => "lib".to_owned(),
        false => module.join("::"),
    };
    let read = Crate::read(source);
    read.files
        .keys()
        .map(|module| (name(module), read.taken_by(module).iter().map(name).collect()))
        .collect()
}

/// Module path of a file below `src`; that of the crate's root is empty.
fn module(source: &Path, file: &Path) -> Names {
    let below = file.strip_prefix(source).unwrap().with_extension("");
    let mut names: Names =
        below.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod" || name == "lib") {
        names.pop();
    }
    names
}

/// Leaves of a tree of `use`, each with the name that it is given by `as`.
fn leaves(tree: &str, before: &[String], found: &mut Vec<(Names, Option<String>)>) {
    let tree = tree.trim();
    if let Some((path, list)) = tree.split_once('{') {
        let mut before = before.to_vec();
        before.extend(
            path.split("::").map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned),
        );
        let list = list.strip_suffix('}').unwrap_or_else(|| panic!("no end of the list: {tree}"));
        let (mut depth, mut start) = (0, 0);
        for (at, character) in list.char_indices() {
            match character {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    leaves(&list[start..at], &before, found);
                    start = at + 1;
                }
                _ => {}
            }
        }
        leaves(&list[start..], &before, found);
    } else if !tree.is_empty() {
        let (path, name) = match tree.split_once(" as ") {
            Some((path, name)) => (path, Some(name.trim().to_owned())),
            None => (tree, None),
        };
        let mut names = before.to_vec();
        names.extend(path.split("::").map(|name| name.trim().to_owned()));
        if names.last().is_some_and(|name| name == "self") {
            names.pop();
        }
        found.push((names, name));
    }
}

impl Crate {
    fn read(source: &Path) -> Crate {
        let mut all = Vec::new();
        sources(source, &mut all);
        let modules: BTreeSet<Names> = all.iter().map(|file| module(source, file)).collect();
        let used = Regex::new(r"(?m)^ *(pub(?:\([^)]*\))? +)?use\s+([^;]+);").unwrap();
        // A path that says who may see an item takes nothing.
        let visible = Regex::new(r"pub\(in [^)]*\)").unwrap();
        let files = all.iter().map(|file| {
            let module = module(source, file);
            let text = product(file);
            let code = text.lines().map(|line| line.split("//").next().unwrap());
            let text = code.collect::<Vec<_>>().join("\n");
            let mut bindings = Vec::new();
            for found in used.captures_iter(&text) {
                let mut here = Vec::new();
                leaves(&found[2], &[], &mut here);
                for (mut names, other) in here {
                    let is_glob = names.last().is_some_and(|name| name == "*");
                    if is_glob {
                        names.pop();
                    }
                    let Some(from) = absolute(&names, &module, &modules) else { continue };
                    let last = names.last().filter(|_| !is_glob).cloned();
                    let name = other.or(last).filter(|name| name != "_");
                    bindings.push(Binding {
                        from,
                        name,
                        is_glob,
                        is_public: found.get(1).is_some(),
                    });
                }
            }
            let text = used.replace_all(&text, "");
            let file = File::of(&visible.replace_all(&text, ""), bindings);
            (module, file)
        });
        Crate { files: files.collect() }
    }

    /// A path, cut behind the file that it names.
    fn cut<'a>(&self, path: &'a [String]) -> (&'a [String], &'a [String]) {
        let mut length = path.len();
        while length > 0 && !self.files.contains_key(&path[..length]) {
            length -= 1;
        }
        path.split_at(length)
    }

    /// Files in which what a path names is defined: the one that it names, or those from which that one has it.
    fn defining(&self, path: &[String], seen: &mut BTreeSet<Names>, found: &mut BTreeSet<Names>) {
        if !seen.insert(path.to_vec()) {
            return;
        }
        let (module, rest) = self.cut(path);
        let mut is_elsewhere = false;
        if let (Some(name), Some(file)) = (rest.first(), self.files.get(module)) {
            for binding in file.bindings.iter().filter(|_| !file.defines.contains(name)) {
                let from = binding.from.as_slice();
                let further = if binding.name.as_ref() == Some(name) {
                    [from, &rest[1..]].concat()
                } else if binding.is_glob && self.has(&binding.from, name, &mut BTreeSet::new()) {
                    [from, rest].concat()
                } else {
                    continue;
                };
                self.defining(&further, seen, found);
                is_elsewhere = true;
            }
        }
        if !is_elsewhere {
            found.insert(module.to_vec());
        }
    }

    /// Whether a module defines a name, or has it through a `use`.
    fn has(&self, module: &Names, name: &str, seen: &mut BTreeSet<Names>) -> bool {
        let Some(file) = self.files.get(module).filter(|_| seen.insert(module.clone())) else {
            return false;
        };
        file.defines.contains(name)
            || file.bindings.iter().any(|binding| {
                binding.name.as_deref() == Some(name)
                    || binding.is_glob && self.has(&binding.from, name, seen)
            })
    }

    /// Files that a module takes something from, as far as its text tells it.
    fn taken_by(&self, module: &Names) -> BTreeSet<Names> {
        let file = &self.files[module];
        let modules: BTreeSet<Names> = self.files.keys().cloned().collect();
        let mut taken = BTreeSet::new();
        let mut take = |path: &[String]| {
            taken.insert(self.cut(path).0.to_vec());
            self.defining(path, &mut BTreeSet::new(), &mut taken);
        };
        for binding in &file.bindings {
            let is_of_child = binding.from.len() > module.len() && binding.from.starts_with(module);
            let is_name_only = binding.is_public && is_of_child;
            if !is_name_only || binding.name.as_ref().is_some_and(|name| file.uses.contains(name)) {
                take(&binding.from);
            }
            // What comes by `*` is found by its name.
            if binding.is_glob {
                for name in &file.uses {
                    if self.has(&binding.from, name, &mut BTreeSet::new()) {
                        take(&[binding.from.as_slice(), std::slice::from_ref(name)].concat());
                    }
                }
            }
        }
        for names in &file.paths {
            if let Some(path) = absolute(names, module, &modules) {
                take(&path);
            } else if let Some(binding) =
                file.bindings.iter().find(|binding| binding.name.as_ref() == Some(&names[0]))
            {
                take(&[binding.from.as_slice(), &names[1..]].concat());
            }
        }
        taken.remove(module);
        taken
    }
}

/// A path in a module from the root of the crate; none where it leads out of the crate, or begins with a name that
/// the module has from elsewhere.
fn absolute(names: &[String], module: &Names, modules: &BTreeSet<Names>) -> Option<Names> {
    let mut at = module.clone();
    let mut rest = names;
    while let Some(first) = rest.first() {
        match first.as_str() {
            "crate" => at.clear(),
            "super" => drop(at.pop()),
            "self" => {}
            _ => break,
        }
        rest = &rest[1..];
    }
    if rest.len() == names.len() {
        let mut child = module.clone();
        child.push(rest.first()?.clone());
        if !modules.contains(&child) {
            return None;
        }
    }
    at.extend(rest.iter().cloned());
    Some(at)
}
