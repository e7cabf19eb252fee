//! Plain text of XHTML, in which superscripts, lists and tables keep their meaning.
//!
//! | XHTML | plain text |
//! |---|---|
//! | `10<sup>-5</sup>`, `x<sub>i</sub>` | `10^-5`, `x_i` |
//! | deleted text: `del`, `s`, `strike`, a style with `line-through` | left out |
//! | `li` of `ul` and of `ol` | a line with `- `, and with `1. ` |
//! | `tr` | a line, in which ` | ` stands between the cells |

use roxmltree::Node;

/// Plain text of the content of an element; with deleted text, if it is to be kept.
pub(super) fn plain(value: Node<'_, '_>, keeps_deleted: bool) -> String {
    let mut writer = PlainWriter::default();
    // Not recursive, because a file may be nested to any depth.
    let mut next = value.first_child();
    while let Some(node) = next {
        let is_skipped = is_deleted(node) && !keeps_deleted;
        if is_skipped {
            writer.skip();
        } else {
            writer.begin(node);
        }
        if let Some(child) = node.first_child().filter(|_| !is_skipped) {
            next = Some(child);
            continue;
        }
        let mut done = node;
        next = loop {
            if !(is_skipped && done == node) {
                writer.end(done);
            }
            if let Some(sibling) = done.next_sibling() {
                break Some(sibling);
            }
            match done.parent() {
                Some(parent) if parent != value => done = parent,
                _ => break None,
            }
        };
    }
    let lines: Vec<&str> = writer.out.split('\n').map(str::trim_end).collect();
    lines.join("\n").trim().to_owned()
}

/// Returns whether an element is deleted text.
pub(super) fn is_deleted(node: Node<'_, '_>) -> bool {
    matches!(node.tag_name().name(), "del" | "s" | "strike") || has_style(node, "line-through")
}

fn has_style(node: Node<'_, '_>, words: &str) -> bool {
    node.is_element() && node.attribute("style").is_some_and(|style| style.contains(words))
}

/// Sign of a raised or lowered text.
fn shift(node: Node<'_, '_>) -> Option<char> {
    match node.tag_name().name() {
        "sup" => Some('^'),
        "sub" => Some('_'),
        "span" if has_style(node, "super") => Some('^'),
        "span" if has_style(node, "vertical-align") && has_style(node, "sub") => Some('_'),
        _ => None,
    }
}

fn is_block(name: &str) -> bool {
    matches!(
        name,
        "div"
            | "p"
            | "h1"
            | "h2"
            | "h3"
            | "h4"
            | "h5"
            | "h6"
            | "table"
            | "caption"
            | "pre"
            | "blockquote"
            | "address"
            | "dl"
            | "dt"
            | "dd"
            | "hr"
    )
}

#[derive(Default)]
struct PlainWriter {
    out: String,
    /// Open lists: the number of the last item of an ordered one.
    lists: Vec<Option<usize>>,
    /// Numbers of cells in the open rows.
    rows: Vec<usize>,
    /// Number of open cells.
    cells: usize,
    /// Number of open `pre`.
    verbatim: usize,
    /// Beginnings of open raised and lowered texts.
    shifts: Vec<usize>,
    /// Beginning and end of the raised or lowered text that was written last.
    shifted: Option<(usize, usize)>,
    /// Length of the text with the marker of an item or cell that has no text yet.
    marker: Option<usize>,
    /// True if the next text begins a block.
    ends_block: bool,
    /// True if deleted text was left out since the last text.
    skipped: bool,
}

impl PlainWriter {
    fn begin(&mut self, node: Node<'_, '_>) {
        if node.is_text() {
            let text = node.text().unwrap_or_default();
            if self.verbatim > 0 {
                self.verbatim(text)
            } else {
                self.flow(text)
            }
            return;
        }
        match node.tag_name().name() {
            "br" if self.cells > 0 => self.space(),
            "br" => {
                self.ends_block = false;
                self.out.push('\n');
            }
            "ul" | "ol" => {
                if self.lists.is_empty() {
                    self.block();
                }
                self.lists.push((node.tag_name().name() == "ol").then_some(0));
            }
            "li" => self.item(),
            "tr" => {
                self.line();
                self.rows.push(0);
            }
            "td" | "th" => self.cell(),
            "pre" => {
                self.block();
                self.verbatim += 1;
            }
            name if is_block(name) => self.block(),
            _ => {}
        }
        if shift(node).is_some() {
            self.shifts.push(self.out.len());
        }
    }

    fn end(&mut self, node: Node<'_, '_>) {
        if let Some(sign) = shift(node) {
            self.shift(sign);
        }
        match node.tag_name().name() {
            "ul" | "ol" => {
                self.lists.pop();
                self.ends_block = true;
            }
            "li" => {
                if let Some(at) = self.marker.take().filter(|at| *at == self.out.len()) {
                    let begin = self.out[..at].rfind('\n').map_or(0, |line| line + 1);
                    self.out.truncate(begin);
                }
                self.ends_block = true;
            }
            "tr" => {
                self.rows.pop();
                self.ends_block = true;
            }
            "td" | "th" => self.cells = self.cells.saturating_sub(1),
            "pre" => {
                self.verbatim = self.verbatim.saturating_sub(1);
                self.ends_block = true;
            }
            name if is_block(name) => self.ends_block = true,
            _ => {}
        }
    }

    /// Notes that deleted text was left out here.
    fn skip(&mut self) {
        self.skipped = true;
    }

    /// Begins a block on a line of its own, after an empty one if there is text before it; in a cell of a table
    /// it stays on the line.
    fn block(&mut self) {
        if self.breaks() {
            while !self.out.ends_with("\n\n") {
                self.out.push('\n');
            }
        }
    }

    /// Begins a line.
    fn line(&mut self) {
        if self.breaks() && !self.out.ends_with('\n') {
            self.out.push('\n');
        }
    }

    /// Ends what stands on the line; false where none may begin: there is no text before it, or it is in a cell.
    fn breaks(&mut self) -> bool {
        self.ends_block = false;
        if self.marker == Some(self.out.len()) {
            return false;
        }
        if self.cells > 0 {
            self.space();
            return false;
        }
        self.trim();
        !self.out.is_empty()
    }

    fn trim(&mut self) {
        self.out.truncate(self.out.trim_end_matches([' ', '\t']).len());
    }

    fn space(&mut self) {
        if !self.is_at_begin() && !self.out.ends_with(' ') {
            self.out.push(' ');
        }
    }

    /// Returns whether nothing stands before the next text on its line, or in its cell.
    fn is_at_begin(&self) -> bool {
        self.out.is_empty() || self.out.ends_with('\n') || self.marker == Some(self.out.len())
    }

    fn item(&mut self) {
        self.line();
        let depth = self.lists.len().saturating_sub(1);
        if self.cells == 0 {
            self.out.extend(std::iter::repeat_n("  ", depth));
        }
        match self.lists.last_mut() {
            Some(Some(number)) => {
                *number += 1;
                self.out.push_str(&format!("{number}. "));
            }
            _ => self.out.push_str("- "),
        }
        self.marker = Some(self.out.len());
    }

    fn cell(&mut self) {
        self.ends_block = false;
        if let Some(cells) = self.rows.last_mut() {
            *cells += 1;
            if *cells > 1 {
                self.trim();
                self.out.push_str(" | ");
            }
        }
        self.marker = Some(self.out.len());
        self.cells += 1;
    }

    /// Marks the text since its beginning as raised or lowered.
    fn shift(&mut self, sign: char) {
        let Some(begin) = self.shifts.pop() else { return };
        let Some(text) = self.out.get(begin..).map(str::trim).filter(|text| !text.is_empty())
        else {
            return;
        };
        let digits = text.strip_prefix(['+', '-', '−', '–']).unwrap_or(text);
        let is_plain = text.chars().count() == 1
            || !digits.is_empty() && digits.chars().all(char::is_alphanumeric);
        let text = if is_plain { format!("{sign}{text}") } else { format!("{sign}({text})") };
        self.out.truncate(begin);
        self.out.push_str(&text);
        self.shifted = is_plain.then_some((begin, self.out.len()));
    }

    /// Adds running text. Space with a line break in it is indentation and becomes one space; other space
    /// stays.
    fn flow(&mut self, text: &str) {
        let mut rest = text;
        if !rest.trim_start().is_empty() {
            if self.ends_block {
                self.block();
            }
            // A letter after a raised text would belong to it.
            let ends = self.shifted.take().filter(|(_, end)| *end == self.out.len());
            if let Some((begin, end)) = ends
                && rest.starts_with(char::is_alphanumeric)
            {
                self.out.insert(end, ')');
                self.out.insert(begin + 1, '(');
            }
            if self.is_at_begin() || self.skipped && self.out.ends_with(' ') {
                rest = rest.trim_start();
            }
            self.skipped = false;
        } else if self.is_at_begin() || self.ends_block || self.skipped && self.out.ends_with(' ') {
            return;
        }
        while let Some(at) = rest.find(SPACE) {
            self.out.push_str(&rest[..at]);
            rest = &rest[at..];
            let end = rest.find(|c| !SPACE.contains(&c)).unwrap_or(rest.len());
            let space = &rest[..end];
            if !space.contains('\n') {
                self.out.push_str(space);
            } else if !self.out.ends_with('\n') && !self.out.is_empty() {
                self.out.push(' ');
            }
            rest = &rest[end..];
        }
        self.out.push_str(rest);
    }

    /// Adds text whose lines stay.
    fn verbatim(&mut self, text: &str) {
        self.shifted = None;
        self.out.push_str(text);
    }
}

/// Characters that are space in XML.
const SPACE: [char; 4] = [' ', '\t', '\n', '\r'];
