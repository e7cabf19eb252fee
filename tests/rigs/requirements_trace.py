"""Reads the pages that StrictDoc made of a campaign: requirement, cases and results have to be linked."""

import pathlib
import re
import sys

import bs4

folder = pathlib.Path(sys.argv[1])


def nodes(page):
    """The text of each node of a page by its UID, one piece a line."""
    soup = bs4.BeautifulSoup((folder / page).read_text(encoding="utf-8"), "html.parser")
    found = {}
    for node in soup.find_all("sdoc-node"):
        text = re.sub(r"\s*\n\s*", "\n", node.get_text())
        uid = re.search(r"^UID:\n(.+)$", text, re.M)
        if uid and uid.group(1) not in found:
            found[uid.group(1)] = text
    return found


def expect(node, *pieces):
    for piece in pieces:
        assert piece in node, f"no {piece!r} in\n{node}"


requirements = nodes("requirements.html")
expect(
    requirements["NAV-1"],
    "RELATIONS (Parent):\nSYS-1",
    # To the results of every verdict, and through the files of the cases to the test report.
    "c-six-static\n(Verifies)\nc-eight-static\n(Verifies)\nc-eight-dockside\n(Verifies)",
    "cases/c-six-static.toml",
    "cases/c-eight-dockside.toml",
    "PASS:\n95 %",
    "Owner:\nNavigation team",
)
expect(requirements["SYS-1"], "RELATIONS (Child):\nNAV-1")
assert "RELATIONS" not in requirements["DOC-1"], "DOC-1 has no case"

results = nodes("results.html")
expect(results["c-six-static"], "STATUS:\npass", "NAV-1\nLongitude over a day\n(Verifies)",
       "runs/c-six-static/recording.mcap")
expect(results["c-eight-static"], "STATUS:\nfail", "NAV-1: fail", "NAV-2: pass")
expect(results["c-eight-dockside"], "STATUS:\ninconclusive")

report = nodes("campaign.lit.junit.html")
for case, status in [("c-six-static", "PASSED"), ("c-eight-static", "FAILED"), ("c-eight-dockside", "FAILED")]:
    path = f"cases/{case}.toml"
    expect(report[path], f"STATUS:\n{status}", "verifies:\nNAV-1", f"RELATIONS (File):\n{path}")

# From the file of a case both ways: its requirements, and its result.
page = (folder.parent / "_source_files/cases/c-six-static.toml.html").read_text(encoding="utf-8")
text = bs4.BeautifulSoup(page, "html.parser").get_text()
expect(text, "NAV-1", "NAV-2", "CAL-1", "PASSED")
print("requirements, cases and results are linked both ways")
