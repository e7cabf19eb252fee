#!/usr/bin/env python3
"""Puts together what the site is built from, as tests/site wants it.

The pages keep their places in the repository, so that links between them stay as they are. A file or a folder of the
repository that a page links to becomes a page that shows it: the site is read without the repository.

Usage: docs/site/stage.py PROGRAM FOLDER     (writes FOLDER/mkdocs.yml and FOLDER/source)
"""

import json
import os
import pathlib
import re
import shutil
import sys
from urllib.parse import unquote

import reference

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "harness/devices/wire/README.md"]
PICTURES = {".svg", ".png"}
LANGUAGES = {".rs": "rust", ".toml": "toml", ".py": "python", ".c": "c", ".h": "c", ".yml": "yaml", ".json": "json",
             ".sh": "bash", "": "bash"}
# Code has no links: a fence to its end, or a span.
CODE = re.compile(r"^(?P<fence>[ >]*(`{3,}|~{3,})).*?^[ >]*\2[`~]*[ ]*$|(?<!`)(`+)(?!`).+?(?<!`)\3(?!`)", re.S | re.M)
# A place to be filled in, such as `<commit>`: neither a comment, nor an address, nor a line break.
PLACEHOLDER = re.compile(r"<(?!!--|https?:|br>)")
LINK = re.compile(r"(\]\()([^)\s]+)(\))")


def pages():
    """All pages of the site that the repository has, by their places in it."""
    found = [ROOT / page for page in PAGES]
    for page in sorted((ROOT / "docs").rglob("*.md")):
        if HERE not in page.parents:
            found.append(page)
    return [page.relative_to(ROOT) for page in found]


class Stage:
    """The folder that MkDocs reads."""

    def __init__(self, folder):
        self.source = folder / "source"
        self.pages = set(pages())
        self.shown = set()

    def page(self, page):
        """Copies a page; links to files of the repository lead to the pages that show them."""
        text = (ROOT / page).read_text(encoding="utf-8")
        out, last = [], 0
        for block in CODE.finditer(text):
            out += [self.relinked(page, text[last:block.start()]), block[0]]
            last = block.end()
        out.append(self.relinked(page, text[last:]))
        self.write(page, "".join(out))

    def relinked(self, page, text):
        text = LINK.sub(lambda found: found[1] + self.target(page, found[2]) + found[3], text)
        return PLACEHOLDER.sub("&lt;", text)

    def target(self, page, link):
        if re.match(r"[a-z]+:|#", link):
            return link
        path, _, anchor = link.partition("#")
        to = pathlib.Path(os.path.normpath(ROOT / page.parent / unquote(path)))
        if ROOT not in to.parents or not to.exists():
            raise SystemExit(f"{page}: the link {link} leads to nothing in the repository")
        inside = to.relative_to(ROOT)
        if inside in self.pages:
            return link
        if to.suffix in PICTURES:
            self.copy(inside)
            return link
        self.show(inside)
        return path.rstrip("/") + ".src.md" + (f"#{anchor}" if anchor else "")

    def show(self, inside):
        """A page with the text of a file, or with the list of a folder."""
        if inside in self.shown:
            return
        self.shown.add(inside)
        file = ROOT / inside
        if file.is_dir():
            names = sorted(one.name + ("/" if one.is_dir() else "") for one in file.iterdir())
            body = "".join(f"- `{name}`\n" for name in names)
        elif file.suffix == ".ipynb":
            body = notebook(file)
        else:
            body = fenced(file.read_text(encoding="utf-8"), LANGUAGES.get(file.suffix, "text"))
        head = f"---\nsearch: {{exclude: true}}\ntitle: {file.name}\n---\n\n# `{inside}`\n\n"
        self.write(inside.parent / (file.name + ".src.md"), head + body)

    def copy(self, inside):
        to = self.source / inside
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / inside, to)

    def write(self, inside, text):
        to = self.source / inside
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_text(text, encoding="utf-8")


def fenced(text, language):
    ticks = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{ticks}{language}\n{text.rstrip()}\n{ticks}\n"


def notebook(file):
    """The cells of a notebook as Markdown, with its headings a level deeper; the notebooks are kept without output."""
    parts = []
    for cell in json.loads(file.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        if cell.get("outputs"):
            raise SystemExit(f"{file.relative_to(ROOT)}: found a cell with output, expected none")
        is_text = cell["cell_type"] == "markdown"
        parts.append(re.sub("^#", "##", text, flags=re.M) + "\n" if is_text else fenced(text, "python"))
    return "\n".join(parts)


def configuration(kinds):
    """The configuration, with the pages of all kinds of faults by family at `- KINDS`."""
    text = (HERE / "mkdocs.yml").read_text(encoding="utf-8")
    (line,) = re.findall(r"^ *- KINDS$", text, re.M)
    indent = line[:line.index("-")]
    nav = []
    for family, members in reference.families(kinds).items():
        with_page = [kind["name"] for kind in members if (ROOT / "docs/faults" / f"{kind['name']}.md").exists()]
        if with_page:
            nav.append(f"{indent}- {family[0].upper()}{family[1:]}:")
            nav += [f"{indent}    - docs/faults/{name}.md" for name in with_page]
    return text.replace(line, "\n".join(nav))


def main(program, folder):
    folder = pathlib.Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    stage = Stage(folder)
    for page in stage.pages:
        stage.page(page)
    shutil.copytree(HERE / "assets", stage.source / "assets")
    kinds = reference.write(stage.source / "reference", reference.Program(program))
    (folder / "mkdocs.yml").write_text(configuration(kinds), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    try:
        main(*sys.argv[1:])
    except reference.AnswerError as error:
        raise SystemExit(f"the reference can't be made: {error}") from error
