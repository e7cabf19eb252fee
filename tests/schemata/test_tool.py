#!/usr/bin/env python3
"""The rewriting of tests/mutants: its text for each kind of mutant, and that a program that is compiled once behaves
as each mutant with the variable and as the original without."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
installed = subprocess.run(["bash", "-c", ". tests/rigs/common.sh; python_packages mutants"], cwd=ROOT).returncode
if installed != 0:
    sys.exit(installed)
sys.path += [str(HERE), *(str(path) for path in (ROOT / ".rigs/python-mutants/lib").glob("python3*/site-packages"))]
import rewrite  # noqa: E402
import run  # noqa: E402

SOURCE = """//! A toy: each function is told apart by its answer.

#[derive(Clone, Copy, Default)]
pub struct Pair { pub left: i64, pub right: i64 }

pub fn seven() -> i64 {
    let six = 6; // «é» moves the bytes, and not the columns, of what follows
    six + 1
}
pub fn mixed(a: i64, b: i64, c: i64) -> i64 { /* é */ a - b * c }
pub fn grown(mut a: i64) -> i64 {
    if a > 100 { a = 100 }
    a += 2 * 3;
    a
}
pub fn opposite(a: i64) -> i64 { -a.abs() }
pub fn kind(a: Option<i64>) -> &'static str {
    match a {
        Some(0) => "zero",
        Some(n) if n > 0 => "more",
        _ => "other",
    }
}
pub fn pair(base: Pair) -> Pair { Pair { left: 1 + 1, ..base } }
pub fn chain(a: Option<i64>) -> bool { if let Some(n) = a && n > 3 { true } else { false } }
"""
MAIN = """mod lib;
mod mutant { include!("mutant.rs"); }
use lib::*;
fn main() {
    let pair = pair(Pair { left: 8, right: 9 });
    println!(
        "{} {} {} {} {} {} {} {} {} {}", seven(), mixed(10, 2, 3), grown(1), opposite(-5), kind(Some(0)), kind(Some(4)),
        kind(Some(-4)), pair.left, pair.right, chain(Some(4))
    );
}
"""
ORIGINAL = "7 4 7 -5 zero more other 2 9 true"


def mutant(genre, near, text, replacement, after=0):
    """As cargo-mutants lists one: of a text in the line that has another one, its `after`th."""
    for number, line in enumerate(SOURCE.splitlines(), 1):
        if near in line:
            column = line.index(near) + 1
            for _ in range(after + 1):
                column = line.index(text, column) + 1
            place = {"start": {"line": number, "column": column}, "end": {"line": number, "column": column + len(text)}}
            return {"genre": genre, "span": place, "replacement": replacement}
    raise AssertionError(near)


def body_of_seven():
    """A body goes from its first statement to its last."""
    one = mutant("FnValue", "    let six", "let six", "0")
    one["span"]["end"] = mutant("FnValue", "    six + 1", "six + 1", "")["span"]["end"]
    return one


# Each with the answers of the program.
MUTANTS = [
    (body_of_seven(), "0 4 7 -5 zero more other 2 9 true"),
    (mutant("BinaryOperator", "    six + 1", "+", "*"), "6 4 7 -5 zero more other 2 9 true"),
    # 10 - 2 + 3 is not 10 - (2 + 3).
    (mutant("BinaryOperator", "a - b * c", "*", "+"), "7 11 7 -5 zero more other 2 9 true"),
    (mutant("BinaryOperator", "a - b * c", "-", "+"), "7 16 7 -5 zero more other 2 9 true"),
    (mutant("BinaryOperator", "    a += 2", "+=", "-="), "7 4 -5 -5 zero more other 2 9 true"),
    (mutant("BinaryOperator", "    a += 2", "*", "+"), "7 4 6 -5 zero more other 2 9 true"),
    (mutant("UnaryOperator", "{ -a.abs", "-", ""), "7 4 7 5 zero more other 2 9 true"),
    (mutant("MatchArm", "        Some(0)", 'Some(0) => "zero",', ""), "7 4 7 -5 other more other 2 9 true"),
    (mutant("MatchArmGuard", " if n > 0", "n > 0", "true"), "7 4 7 -5 zero more more 2 9 true"),
    (mutant("MatchArmGuard", " if n > 0", "n > 0", "false"), "7 4 7 -5 zero other other 2 9 true"),
    (mutant("BinaryOperator", " if n > 0", ">", "<"), "7 4 7 -5 zero other more 2 9 true"),
    (mutant("StructField", "Pair { left: 1", "left: 1 + 1,", ""), "7 4 7 -5 zero more other 8 9 true"),
    (mutant("BinaryOperator", "left: 1", "+", "-"), "7 4 7 -5 zero more other 0 9 true"),
    (mutant("BinaryOperator", "n > 3", ">", "<"), "7 4 7 -5 zero more other 2 9 false"),
]
IMPOSSIBLE = mutant("BinaryOperator", "= a && n", "&&", "||")


class Rewriting(unittest.TestCase):
    def text(self, *mutants):
        text, _, impossible = rewrite.rewritten(SOURCE.encode(), list(enumerate(mutants)))
        self.assertEqual(impossible, [])
        return text.decode()

    def test_texts(self):
        on = "crate::mutant::on(0)"
        for one, text in [
            (MUTANTS[0][0], f"if {on} {{ return 0; }} let six = 6;"),
            (MUTANTS[2][0], f"(if {on} {{ a - b + c }} else {{ a - b * c }})"),
            (MUTANTS[4][0], f"(if {on} {{ a -= 2 * 3 }} else {{ a += 2 * 3 }});"),
            (MUTANTS[6][0], f"(if {on} {{ a.abs() }} else {{ -a.abs() }})"),
            (MUTANTS[7][0], f'Some(0) if !{on} => "zero",'),
            (MUTANTS[8][0], f"Some(n) if (if {on} {{ true }} else {{ n > 0 }}) =>"),
            (MUTANTS[11][0], f"(if {on} {{ Pair {{  ..base }} }} else {{ Pair {{ left: 1 + 1, ..base }} }})"),
        ]:
            self.assertIn(text, self.text(one))

    def test_one_in_another_has_the_original_around_it(self):
        self.assertIn(
            "(if crate::mutant::on(0) { a -= 2 * 3 } else { a += "
            "(if crate::mutant::on(1) { 2 + 3 } else { 2 * 3 }) });",
            self.text(MUTANTS[4][0], MUTANTS[5][0]),
        )

    def test_the_plain_text_is_that_of_cargo_mutants(self):
        self.assertIn(b"/* \xc3\xa9 */ a - b + c }", rewrite.plain(SOURCE.encode(), MUTANTS[2][0]))
        self.assertIn(b"{\n    0\n}", rewrite.plain(SOURCE.encode(), MUTANTS[0][0]))

    def test_an_operator_between_conditions_that_bind_has_no_switch(self):
        text, _, impossible = rewrite.rewritten(SOURCE.encode(), [(5, IMPOSSIBLE)])
        self.assertEqual((text, impossible), (SOURCE.encode(), [5]))

    def test_an_error_blames_the_text_that_it_is_in(self):
        pairs = list(enumerate(one for one, _ in MUTANTS))
        text, regions, _ = rewrite.rewritten(SOURCE.encode(), pairs)
        at = text.index(b"a - b + c")
        self.assertEqual(rewrite.blamed(regions, [(at, at + 1)], text), [2])
        self.assertEqual(rewrite.blamed(regions, [(0, 3)], text), [])
        whole = text.index(b"(if crate::mutant::on(2)")
        self.assertEqual(rewrite.blamed(regions, [(whole, whole + 1)], text), [2, 3])
        signature = text.index(b"-> Pair")
        self.assertEqual(rewrite.blamed(regions, [(signature, signature + 7)], text), [11, 12])


class Compiled(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        here = pathlib.Path(cls.folder.name)
        text, _, impossible = rewrite.rewritten(SOURCE.encode(), list(enumerate(one for one, _ in MUTANTS)))
        assert not impossible
        (here / "lib.rs").write_bytes(text)
        module = (HERE / "mutant.rs").read_text().replace("COUNT", str(len(MUTANTS)))
        (here / "mutant.rs").write_text("\n".join(line for line in module.splitlines() if not line.startswith("//!")))
        (here / "main.rs").write_text(MAIN)
        cls.program = here / "toy"
        words = ["rustc", "--edition", "2024", "--cap-lints", "allow", "-o", cls.program, here / "main.rs"]
        subprocess.run(words, check=True)
        # Passes with the original alone, says what failed, and never ends with one of them.
        (here / "tests.rs").write_text(TESTS)
        subprocess.run(["rustc", "--edition", "2024", "--test", "-o", here / "tests", here / "tests.rs"], check=True)
        cls.tests = run.Program("toy:main", str(here / "tests"), str(here))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def answers(self, **variables):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("OCTANT_MUTANT")}
        done = subprocess.run([self.program], check=True, capture_output=True, text=True, env=environment | variables)
        return done.stdout.strip()

    def test_without_the_variable_it_is_the_original(self):
        self.assertEqual(self.answers(), ORIGINAL)

    def test_each_mutant_gives_its_own_answers(self):
        for number, (one, expected) in enumerate(MUTANTS):
            with self.subTest(one):
                self.assertEqual(self.answers(OCTANT_MUTANT=str(number)), expected)

    def test_reached_places_are_noted(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.answers(OCTANT_MUTANTS_REACHED=folder), ORIGINAL)
            self.assertEqual(sorted(map(int, os.listdir(folder))), list(range(len(MUTANTS))))

    def test_tests_tell_what_they_reach_and_which_mutants_they_catch(self):
        known = {}
        run.reach([self.tests], {"toy:main": ["left_out"]}, known, lambda: None, 1)
        self.assertEqual(
            {key: told and told["reached"] for key, told in known.items()},
            {"toy:main one": [1, 2], "toy:main two": [2], "toy:main broken": None},
        )
        outcomes = {number: run.test(number, [self.tests], known) for number in (0, 1, 2)}
        self.assertEqual((outcomes[0]["outcome"], outcomes[0]["tests"]), ("MissedMutant", 0))
        self.assertEqual((outcomes[1]["outcome"], outcomes[1]["by"]), ("CaughtMutant", "toy:main one"))
        self.assertEqual((outcomes[2]["outcome"], outcomes[2]["tests"]), ("MissedMutant", 2))

    def test_what_never_ends_is_ended(self):
        ended = run.run(self.tests, ["one"], 1, cpu_s=1, wall_s=60, mutant=3)
        self.assertEqual((ended.passed, ended.ended), (False, True))


TESTS = """
fn reached(number: usize) -> bool {
    if let Some(folder) = std::env::var_os("OCTANT_MUTANTS_REACHED") {
        std::fs::write(std::path::Path::new(&folder).join(number.to_string()), "").unwrap();
    }
    std::env::var("OCTANT_MUTANT").is_ok_and(|text| text == number.to_string())
}
#[test] fn one() {
    while std::env::var("OCTANT_MUTANT").is_ok_and(|text| text == "3") {}
    reached(2);
    assert!(!reached(1));
}
#[test] fn two() { reached(2); }
#[test] fn broken() { panic!() }
#[test] fn left_out() { panic!() }
#[test] #[ignore] fn ignored() { panic!() }
"""


if __name__ == "__main__":
    unittest.main()
