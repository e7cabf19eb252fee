#!/usr/bin/env python3
"""Checks that the pages of the site read as their sources read by CommonMark with tables, as on GitHub.

The two readers differ: a paragraph of a list item has to be indented by four spaces here, and a line that begins with a
number is the item of a list. What one of them makes of a page, and the other doesn't, is an error of the page.

Usage: docs/site/alike.py SOURCE HTML
"""

import html.parser
import pathlib
import sys

from markdown_it import MarkdownIt

SHAPES = {"li", "tr", "td", "th", "pre", "code", "h1", "h2", "h3", "h4", "blockquote", "img", "em", "strong"}
VOID = {"img", "br", "hr", "wbr", "input", "meta", "link"}


class Reading(html.parser.HTMLParser):
    """The text of a page without blanks, with its elements in their order."""

    def __init__(self, text, inside=None):
        super().__init__()
        # Elements that the theme adds are left out: of each, how many elements deep.
        self.inside, self.depth, self.left_out, self.taken = inside, 0, 0, inside is None
        self.parts = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        classes = dict(attributes).get("class") or ""
        if tag == self.inside:
            self.taken = True
        if tag in VOID:
            if tag == "img" and self.taken and not self.left_out:
                self.parts.append("<img>")
            return
        if self.left_out or "headerlink" in classes or tag in ("nav", "button", "aside"):
            self.left_out += 1
        elif self.taken and tag in SHAPES:
            self.parts.append(f"<{tag}>")

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        if self.left_out:
            self.left_out -= 1
        if tag == self.inside:
            self.taken = False

    def handle_data(self, data):
        if self.taken and not self.left_out:
            self.parts.append("".join(data.split()))

    def read(self):
        return "".join(self.parts)


def built(source, page, site):
    """The built page of a source."""
    name = "index.html" if page.name == "README.md" else page.with_suffix(".html").name
    return site / page.relative_to(source).with_name(name)


def main(source, site):
    source, site = pathlib.Path(source), pathlib.Path(site)
    reader = MarkdownIt("commonmark").enable("table")
    pages = [page for page in sorted(source.rglob("*.md")) if not page.name.endswith(".src.md")]
    found = 0
    for page in pages:
        wanted = Reading(reader.render(page.read_text(encoding="utf-8"))).read()
        shown = Reading(built(source, page, site).read_text(encoding="utf-8"), "article").read()
        if wanted != shown:
            at = next((at for at, pair in enumerate(zip(wanted, shown)) if pair[0] != pair[1]), min(len(wanted), len(shown)))
            here = slice(max(at - 40, 0), at + 60)
            print(f"{page.relative_to(source)}: found {shown[here]!r}, expected {wanted[here]!r}", file=sys.stderr)
            found += 1
    print(f"{len(pages)} pages against CommonMark, {found} differ")
    return 1 if found or not pages else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    sys.exit(main(*sys.argv[1:]))
