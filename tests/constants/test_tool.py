#!/usr/bin/env python3
"""The tool that changes constants, on a program whose constants are known: one that its answers check, one that they
don't, and one that is never reached."""

import importlib.machinery
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import clopper_pearson  # noqa: E402
import elf  # noqa: E402
import reach  # noqa: E402
import shown  # noqa: E402

PROGRAM = r"""
#include <math.h>
#include <stdio.h>
#define OURS __attribute__((noinline, noclone))
double checked(double) __asm__("_ZN12octant_earth4test7checkedE");
double unchecked(double) __asm__("_ZN12octant_earth4test9uncheckedE");
double unreached(double) __asm__("_ZN12octant_earth4test9unreachedE");
double foreign(double) __asm__("_ZN5other4test7foreignE");
OURS double checked(double x) { return x * 6378137.25; }
OURS double unchecked(double x) { return x * 9.780325; }
OURS double unreached(double x) { return x * 1852.75; }
OURS double foreign(double x) { return x * 299792458.5; }
volatile double one = 1.0, quarters = 25512549.0, sink;
int main(int argc, char **argv) {
    sink = unchecked(one) + foreign(one);
    if (argc > 9) sink = unreached(one);
    int right = fabs(4.0 * checked(one) / quarters - 1.0) < 1e-9;
    printf("{\"cases\": [{\"id\": \"answers\", \"verdict\": \"%s\"}]}\n", right ? "pass" : "fail");
    return !right;
}
"""


class Tool(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        here = pathlib.Path(cls.folder.name)
        (here / "program.c").write_text(PROGRAM)
        cls.program = here / "program"
        subprocess.run(["cc", "-O1", "-g", "-o", cls.program, here / "program.c", "-lm"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_constants_of_our_functions_are_found_and_no_others(self):
        self.assertEqual(sorted(c["value"] for c in elf.constants(self.program)), [9.780325, 1852.75, 6378137.25])

    def test_a_number_is_changed_in_each_of_its_places(self):
        tool = HERE.parent / "mutate-constants"
        for change, status, words in (("6378137.25=6378138.25", 0, "1 of 1 places found"),
                                      ("299792458.5=299792459.5", 1, "NOT FOUND"), ("7.5=8.5", 2, "")):
            done = subprocess.run([sys.executable, tool, "--program", self.program, "--everywhere", change],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, status, done.stdout + done.stderr)
            self.assertIn(words, done.stdout)

    def test_what_is_executed_is_in_reach(self):
        constants = elf.constants(self.program)
        sites = {site for constant in constants for site in constant["sites"]}
        tracer = reach.Tracer(self.program, sites, pathlib.Path(self.folder.name))
        self.assertEqual(tracer.run([], pathlib.Path(self.folder.name)), 0)
        hit = [c["value"] for c in constants if any(site in tracer.hits for site in c["sites"])]
        self.assertEqual(sorted(hit), [9.780325, 6378137.25])

    def test_a_changed_constant_that_is_checked_is_found(self):
        out = pathlib.Path(self.folder.name) / "found.json"
        command = [HERE.parent / "mutate-constants", "--program", self.program, "--all-reached", "--out", out]
        done = subprocess.run(command, capture_output=True, text=True)
        # Two of three aren't found: that is too few.
        self.assertEqual(done.returncode, 1, done.stderr)
        found = {row["value"]: row["found"] for row in json.loads(out.read_text())["rows"]}
        self.assertEqual(found, {6378137.25: True, 9.780325: False, 1852.75: False})

    def test_what_was_tried_is_kept_for_the_same_program_only(self):
        loader = importlib.machinery.SourceFileLoader("mutate_constants", str(HERE.parent / "mutate-constants"))
        spec = importlib.util.spec_from_loader("mutate_constants", loader)
        tool = importlib.util.module_from_spec(spec)
        loader.exec_module(tool)
        path = pathlib.Path(self.folder.name) / "kept.partial"
        constant = {"offsets": [4711]}
        tool.Kept(path, "first").put("answers", constant, 2.5, (1, "answers-earth", None))
        with open(path, "a") as file:
            file.write('\n{"key": "first", "offs')
        self.assertEqual(tool.Kept(path, "first").get("answers", constant, 2.5), (1, "answers-earth", None))
        self.assertIsNone(tool.Kept(path, "first").get("answers", constant, 2.6))
        self.assertIsNone(tool.Kept(path, "second").get("answers", constant, 2.5))
        tool.Kept(path, "first").done()
        self.assertFalse(path.exists())

    def test_what_only_rounds_otherwise_shows_nothing_else(self):
        words = shown.words_of('{"max": 0.25, "at": "2026-11-23T07:00:00Z", "hash": "0123456789abcdef01"}')
        self.assertEqual(words, ["max", "0.25", "at", "DATE", "hash", "0123456789abcdef01"])
        self.assertFalse(shown.differ(["max", "0.25", None], ["max", "0.2500000001", "other"]))
        self.assertFalse(shown.differ(["0.094544", "73.9", "3e-9"], ["0.094545", "74", "3e-9"]))
        for other in (["max", "0.250003", ""], ["min", "0.25", ""], ["max", "0.25"], None):
            self.assertTrue(shown.differ(["max", "0.25", None], other))

    def test_the_bound_is_that_of_clopper_and_pearson(self):
        # scipy 1.17.1: beta.ppf(0.05, 285, 16).
        self.assertAlmostEqual(clopper_pearson.lower(59, 59, 0.95), 0.05 ** (1 / 59), places=6)
        self.assertAlmostEqual(clopper_pearson.lower(285, 300, 0.95), 0.9240513, places=5)


if __name__ == "__main__":
    unittest.main()
