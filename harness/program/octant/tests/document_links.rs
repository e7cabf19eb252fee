//! Links of the project's documents: each file and each heading that is linked exists. Web
//! addresses are not fetched.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").canonicalize().unwrap()
}

/// Lists all documents, except in hidden folders and in those of build products, installed packages
/// and runs.
fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !(name.starts_with('.')
                || ["target", "node_modules", "runs"].contains(&name.as_str()))
            {
                documents(&path, found);
            }
        } else if path.extension().is_some_and(|ending| ending == "md") {
            found.push(path);
        }
    }
}

/// Links of a document with their lines, and its anchors.
#[derive(Default)]
struct Document {
    links: Vec<(usize, String)>,
    anchors: BTreeSet<String>,
}

fn read(text: &str) -> Document {
    let mut document = Document::default();
    let mut heading: Option<String> = None;
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    for (event, at) in Parser::new_ext(text, Options::all()).into_offset_iter() {
        let line = text[..at.start].lines().count().max(1);
        match event {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                document.links.push((line, dest_url.into_string()));
            }
            Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
            Event::End(TagEnd::Heading(_)) => {
                let anchor = anchor(&heading.take().unwrap_or_default());
                let count = times.entry(anchor.clone()).or_default();
                let numbered = if *count == 0 { anchor } else { format!("{anchor}-{count}") };
                *count += 1;
                document.anchors.insert(numbered);
            }
            Event::Text(text) | Event::Code(text) => {
                if let Some(heading) = &mut heading {
                    heading.push_str(&text);
                }
            }
            Event::Html(html) | Event::InlineHtml(html) => {
                let values = |name: &str| {
                    let parts: Vec<String> =
                        html.split(&format!("{name}=\"")).skip(1).map(str::to_owned).collect();
                    parts.into_iter().filter_map(|part| Some(part.split_once('"')?.0.to_owned()))
                };
                document.anchors.extend(values("id").chain(values("name")));
                document.links.extend(values("href").chain(values("src")).map(|link| (line, link)));
            }
            _ => {}
        }
    }
    document
}

/// Returns the anchor that GitHub gives a heading.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading
        .trim()
        .to_lowercase()
        .chars()
        .filter(kept)
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// Decodes bytes that are written as `%20`.
fn decoded(link: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = link.as_bytes();
    while let [first, more @ ..] = rest {
        let code = (*first == b'%')
            .then(|| {
                std::str::from_utf8(more.get(..2)?)
                    .ok()
                    .and_then(|hex| u8::from_str_radix(hex, 16).ok())
            })
            .flatten();
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &more[2..] } else { more };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Describes why a link leads nowhere.
fn broken(from: &Path, link: &str, all: &BTreeMap<PathBuf, Document>) -> Option<String> {
    let elsewhere = ["https://", "http://", "mailto:"];
    if elsewhere.iter().any(|start| link.starts_with(start)) {
        return None;
    }
    let link = decoded(link);
    let (path, anchor) =
        link.split_once('#').map_or((link.as_str(), None), |(path, anchor)| (path, Some(anchor)));
    let to = if path.is_empty() { from.to_owned() } else { from.parent()?.join(path) };
    let Ok(to) = to.canonicalize() else { return Some("there is no such file".to_owned()) };
    if !to.starts_with(root()) {
        return Some("it leads out of the project".to_owned());
    }
    let anchor = anchor?;
    match all.get(&to) {
        None => Some("it names a heading of a file that has none".to_owned()),
        Some(document) if !document.anchors.contains(anchor) => {
            Some("there is no such heading".to_owned())
        }
        Some(_) => None,
    }
}

#[test]
fn every_link_of_every_document_leads_somewhere() {
    let mut paths = Vec::new();
    documents(&root(), &mut paths);
    assert!(paths.len() > 50, "{}", paths.len());
    let all: BTreeMap<PathBuf, Document> = paths
        .into_iter()
        .map(|path| (path.clone(), read(&std::fs::read_to_string(path).unwrap())))
        .collect();
    let links: usize = all.values().map(|document| document.links.len()).sum();
    assert!(links > 300, "{links}");
    let mut found = Vec::new();
    for (path, document) in &all {
        for (line, link) in &document.links {
            if let Some(why) = broken(path, link, &all) {
                found.push(format!(
                    "{}:{line}: {link}: {why}",
                    path.strip_prefix(root()).unwrap().display()
                ));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn what_leads_nowhere_is_found() {
    let folder = root().join("docs");
    let from = folder.join("testing.md");
    let text = "# A `b` & σ\n[x](#a-b--σ) [y](#gone) [z](gone.md) ![i](images/gone.svg)\n# Twice\n# Twice\n\
                [t](#twice-1) <a href=\"gone.html\">h</a> [w](https://example.org/gone) [o](../../x)\n\
                `[c](gone.md)` [r](README.md#no-such) [f](../Cargo.toml#x)\n";
    let mut all = BTreeMap::from([(from.clone(), read(text))]);
    let readme = folder.join("README.md");
    all.insert(readme.clone(), read("# Documents\n"));
    let links = &all[&from].links;
    let bad: Vec<&str> = links
        .iter()
        .filter(|(_, link)| broken(&from, link, &all).is_some())
        .map(|(_, link)| link.as_str())
        .collect();
    let expected = [
        "#gone",
        "gone.md",
        "images/gone.svg",
        "gone.html",
        "../../x",
        "README.md#no-such",
        "../Cargo.toml#x",
    ];
    assert_eq!(bad, expected);
    assert_eq!(links.len(), expected.len() + 3);
}
