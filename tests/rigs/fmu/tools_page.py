#!/usr/bin/env python3
"""Runs the blocks of docs/tools.md that stand after `<!-- run in the tools -->`.

A block of Python is written to the file that its first line names. In the other blocks each line that begins with `$ `
is run by the shell, and what follows it has to be what it said, on stdout and stderr; a line `…` stands for any lines.
All blocks share one folder. `octant` is $OCTANT, and `python`, `fmpy` and `ecos` are those of the environment that runs
this script. A command whose output has a shown line in it with `[ERROR]` may fail, every other one has to end with 0.

Usage: tools_page.py
"""

import importlib.machinery
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import ecospy

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs/tools.md"
MARK = "<!-- run in the tools -->"
BLOCK = re.compile(re.escape(MARK) + r"\n\n?```([a-z]*)\n(.*?)\n```", re.S)
# Nothing is written beside the rigs.
sys.dont_write_bytecode = True
# How commands and what they said are written is the same on all pages.
documents = importlib.machinery.SourceFileLoader("documents", str(ROOT / "tests/rigs/documents")).load_module()


def main():
    text = PAGE.read_text()
    blocks = BLOCK.findall(text)
    if not blocks or len(blocks) != text.count(MARK):
        sys.exit(f"{PAGE}: a mark has no block of code after it, or there is no mark")
    octant = pathlib.Path(os.environ.get("OCTANT", ROOT / "target/release/octant")).resolve()
    commands = wrong = 0
    with tempfile.TemporaryDirectory(prefix="octant-tools-") as name:
        folder = pathlib.Path(name)
        (folder / "fixtures").symlink_to(ROOT / "fixtures")
        (folder / "tests").symlink_to(ROOT / "tests")
        programs = folder / "programs"
        programs.mkdir()
        (programs / "octant").symlink_to(octant)
        (programs / "ecos").symlink_to(pathlib.Path(ecospy.__file__).parent / "binaries/ecos")
        (programs / "ecos").resolve().chmod(0o755)
        path = os.pathsep.join([str(programs), str(pathlib.Path(sys.executable).parent), os.environ["PATH"]])
        for language, block in blocks:
            if language == "python":
                file = re.match(r"# (\S+\.py)\b", block)
                if file is None:
                    sys.exit(f"{PAGE}: found {block.splitlines()[0]!r}, expected the name of the file, as in # run.py")
                (folder / file[1]).write_text(block + "\n")
                continue
            for _, command, shown in documents.parts(block):
                child = subprocess.run(["bash", "-c", command], cwd=folder, env={**os.environ, "PATH": path},
                                       stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                       timeout=300)
                said = [line.rstrip() for line in child.stdout.decode().splitlines()]
                commands += 1
                may_fail = any("[ERROR]" in line for line in shown)
                if not documents.fits([line.rstrip() for line in shown], said) or (child.returncode and not may_fail):
                    wrong += 1
                    print(f"docs/tools.md: $ {command}\n  status {child.returncode}, said:\n    " + "\n    ".join(said[-20:]))
    print(f"  {commands} commands of docs/tools.md, {wrong} do something else than the page says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
