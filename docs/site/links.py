#!/usr/bin/env python3
"""Checks the links of the built site: every file and every anchor that a page links to exists.

Usage: docs/site/links.py FOLDER [--external]     (--external also lists the addresses on the web, which nobody fetches)
"""

import argparse
import collections
import html.parser
import pathlib
import re
import sys
from urllib.parse import unquote, urlsplit

# Attributes that name another file; what follows `href` of these is fetched to show the page.
LINKS = {"href", "src", "poster", "data", "action"}
FETCHED = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("object", "data")}


class Page(html.parser.HTMLParser):
    """Links and anchors of a page."""

    def __init__(self, text):
        super().__init__()
        self.links = []
        self.anchors = collections.Counter()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.update({value for name in ("id", "name") if (value := values.get(name)) and (name == "id" or tag == "a")})
        # An address of the page itself, not a link.
        if tag == "link" and values.get("rel") in ("canonical", "preconnect"):
            values.pop("href", None)
        for name in LINKS & values.keys():
            if tag != "form" and values[name] is not None:
                self.links.append((self.getpos()[0], tag, name, values[name]))
        for part in (values.get("srcset") or "").split(","):
            if part.strip():
                self.links.append((self.getpos()[0], tag, "src", part.split()[0]))


def broken(root, page, link, pages):
    """Why a link leads nowhere, or None."""
    parts = urlsplit(link)
    if parts.path.startswith("/"):
        return "it begins at the root of a server: from the disk it leads nowhere"
    to = page if not parts.path else (page.parent / unquote(parts.path)).resolve()
    if to != root and root not in to.parents:
        return "it leads out of the site"
    if not to.is_file():
        return "there is no such file" if not to.is_dir() else "it leads to a folder, which only a server shows"
    anchor = unquote(parts.fragment)
    # `#top` is the beginning of every page, and the theme's scripts make `__` ones.
    if not anchor or anchor == "top":
        return None
    if to not in pages:
        return "it names an anchor of a file that has none"
    return None if pages[to].anchors[anchor] else "there is no such anchor"


def outside(link):
    return urlsplit(link).scheme in ("http", "https") or link.startswith("//")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--external", action="store_true")
    arguments = parser.parse_args()
    root = arguments.folder.resolve()
    pages = {page: Page(page.read_text(encoding="utf-8")) for page in sorted(root.rglob("*.html"))}
    if not pages:
        raise SystemExit(f"there is no page in {root}")
    found, external, checked = [], collections.Counter(), 0
    for page, read in pages.items():
        name = page.relative_to(root)
        found += [f"{name}: the anchor {anchor} is there {times} times"
                  for anchor, times in read.anchors.items() if times > 1 and not anchor.startswith("__")]
        for line, tag, attribute, link in read.links:
            if link.startswith(("data:", "mailto:", "javascript:")):
                continue
            checked += 1
            if outside(link):
                external[link] += 1
                if (tag, attribute) in FETCHED:
                    found.append(f"{name}:{line}: {link}: the page would ask the web for it")
            elif why := broken(root, page, link, pages):
                found.append(f"{name}:{line}: {link}: {why}")
    for sheet in sorted(root.rglob("*.css")):
        for link in re.findall(r"url\(['\"]?([^'\")]+)", sheet.read_text(encoding="utf-8")):
            if link.startswith("data:") or link.startswith("#"):
                continue
            checked += 1
            if outside(link) or not (sheet.parent / unquote(urlsplit(link).path)).is_file():
                found.append(f"{sheet.relative_to(root)}: {link}: it isn't in the site")
    if arguments.external:
        for link, times in sorted(external.items()):
            print(f"{times:5d}  {link}")
    for one in found:
        print(one, file=sys.stderr)
    print(f"{len(pages)} pages, {checked} links, {len(external)} addresses outside, {len(found)} broken")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
