"""Reads a junit.xml as CI systems do, for the rig of campaigns.

`faults` holds it against what Jenkins' xUnit plugin accepts: elements, attributes and forms of its junit-10.xsd, as they were
at commit 8c515de (November 2025). Jenkins' JUnit plugin accepts more. `read` reads it by junitparser, which
EnricoMi/publish-unit-test-result-action on GitHub uses.
"""

import re
import xml.etree.ElementTree

import junitparser

# By element: attributes that it may have, those that it has to have, elements that it may have. Text is for
# the outputs and the reasons alone.
REASON = ({"type", "message"}, set(), set())
OUTPUT = (set(), set(), set())
ALLOWED = {
    "testsuites": ({"name", "time", "tests", "failures", "errors"}, set(), {"testsuite"}),
    "testsuite": (
        {
            "name", "tests", "failures", "errors", "group", "time", "skipped", "timestamp", "hostname", "id", "package",
            "file", "log", "url", "version",
        },
        {"name", "tests", "failures", "errors"},
        {"testsuite", "properties", "testcase", "system-out", "system-err"},
    ),
    "properties": (set(), set(), {"property"}),
    "property": ({"name", "value"}, {"name", "value"}, set()),
    "testcase": (
        {"name", "time", "classname", "group"},
        {"name"},
        {"skipped", "error", "failure", "system-out", "system-err"},
    ),
    "skipped": REASON,
    "error": REASON,
    "failure": REASON,
    "system-out": OUTPUT,
    "system-err": OUTPUT,
}
TEXT = {"skipped", "error", "failure", "system-out", "system-err"}
TIME = re.compile(r"(([0-9]{0,3},)*[0-9]{3}|[0-9]{0,3})*(\.[0-9]{0,3})?")


def faults(path):
    """What a file has that the plugin doesn't accept."""
    found = []

    def walk(element):
        allowed = ALLOWED.get(element.tag)
        if allowed is None:
            found.append(f"<{element.tag}>")
            return
        may, must, children = allowed
        found.extend(f"<{element.tag} {name}>" for name in set(element.attrib) - may)
        found.extend(f"<{element.tag}> without {name}" for name in must - set(element.attrib))
        if element.tag in ("testsuites", "testsuite") and not TIME.fullmatch(element.get("time", "")):
            found.append(f"time {element.get('time')}")
        if element.tag not in TEXT and (element.text or "").strip():
            found.append(f"text in <{element.tag}>")
        for child in element:
            if child.tag not in children:
                found.append(f"<{child.tag}> in <{element.tag}>")
            walk(child)

    root = xml.etree.ElementTree.parse(path).getroot()
    if root.tag not in ("testsuites", "testsuite"):
        found.append(f"<{root.tag}> as root")
    walk(root)
    return found


def read(path):
    """Numbers of test cases by result, and the time in all, as junitparser has them."""
    report = junitparser.JUnitXml.fromfile(str(path))
    counts = {"pass": 0, "failure": 0, "error": 0, "skipped": 0}
    outputs = 0
    for suite in report:
        for case in suite:
            results = case.result
            kind = type(results[0]).__name__.lower() if results else "pass"
            counts[kind] += 1
            outputs += bool(case.system_out)
    return counts, outputs, report.time, {name: getattr(report, name) for name in ("tests", "failures", "errors")}
