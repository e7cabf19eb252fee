"""What the runs and reports of `runs.txt` show, and whether a changed program shows something else.

Something else is another word, or a number that differs by more than a millionth of itself, the smallest change of a
constant: what only rounds otherwise isn't a wrong number, and a single count that rounds otherwise moves an estimate by a
ten-millionth. So hashes don't count, of streams neither: they move with the last bit; nor do sizes of files. Nor does what differs between two
runs of the unchanged program: times, its own hash. The second of the two has a byte more at its end, which changes its hash
and nothing else. Nor does what rounding alone moves by more, a rank statistic of nearly equal values for instance: a third
program, in which a term of a series that is far below a count has another digit, tells what that is.
"""

import glob
import math
import re
import shlex
import shutil
import subprocess
import threading
import time

# Recordings and tables are known by hashes and by the results that they are made of.
TEXTS = {".json", ".html", ".xml", ".csv", ".txt", ".toml", ".md", ".svg", ".jsonl"}
WORD = re.compile(r"[^\s,:;\"'<>(){}\[\]=&/]+")
HASH = re.compile(r"[0-9a-fA-F]{16,}$")
ROUNDING = 1e-6
# Points of a series are rounded to these, numbers in a report's text to fewer.
DECIMALS = 6
# Of errors that are zero but for rounding.
ZERO = 1e-12
DATE = re.compile(r"\d{4}-\d\d-\d\d[T_ ]?[-0-9:.]*Z?")
# The slowest takes a tenth of it.
LIMIT_S = 600
# What a change is tried with by itself takes about as long in all.
QUICK_S = 5
# A child that another thread is about to start has what is open for writing, and a file that is can't be run.
STARTING = threading.Lock()


def words_of(text):
    return WORD.findall(DATE.sub("DATE", text))


def groups(root):
    """The commands of each paragraph: their line, their words, and the exit statuses that they may have. A line with an
    asterisk is a paragraph for each file that it matches."""
    text = (root / "tests" / "constants" / "runs.txt").read_text()
    for paragraph in re.split(r"\n\s*\n", text):
        commands = []
        for line in paragraph.splitlines():
            words = shlex.split(line, comments=True)
            if not words:
                continue
            expected = {0}
            if words[0].startswith("status="):
                expected = {int(s) for s in words.pop(0)[len("status="):].split(",")}
            words = [word.replace("@", str(root)) for word in words]
            star = next((at for at, word in enumerate(words) if "*" in word), None)
            if star is None:
                commands.append((line.strip(), words, expected))
                continue
            for file in sorted(glob.glob(words[star])):
                yield [(line.strip(), [*words[:star], file, *words[star + 1:]], expected)]
        if commands:
            yield commands


def texts(folder, seen):
    """Files that are new or have changed since they were seen, by their name without a date: their words."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.suffix not in TEXTS or not path.is_file():
            continue
        stamp = path.stat().st_mtime_ns
        if seen.get(path) == stamp:
            continue
        seen[path] = stamp
        found[DATE.sub("DATE", str(path.relative_to(folder)))] = words_of(path.read_text(errors="replace"))
    return found


def told(program, words, folder):
    """Exit status and what was said; None and nothing of a command that didn't end."""
    with STARTING:
        child = subprocess.Popen([program, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, start_new_session=True)
    try:
        out, _ = child.communicate(timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
        return None, []
    return child.returncode, words_of(out.decode(errors="replace"))


def step(program, words, folder, seen):
    """One command: its status, and all that it shows."""
    status, said = told(program, words, folder)
    return status, {"said": said, **texts(folder, seen)}


class Baseline:
    """What the unchanged program shows, without what is never the same twice."""

    def __init__(self, program, rounded, root, folder):
        other = folder / "octant-longer"
        shutil.copy2(program, other)
        with open(other, "ab") as file:
            file.write(b"\0")
        self.groups, self.took_s = [], []
        homes = folder / "shown-1", folder / "shown-2", folder / "shown-3"
        seen = {}, {}, {}
        self.rounding = 0
        for home in homes:
            home.mkdir()
        for commands in groups(root):
            steps, begun = [], time.monotonic()
            for line, words, expected in commands:
                status, first = step(program, words, homes[0], seen[0])
                _, second = step(other, words, homes[1], seen[1])
                _, third = step(rounded, words, homes[2], seen[2])
                if status not in expected:
                    raise SystemExit(f"octant {line} ended with {status}, not {expected}: {' '.join(first['said'])[-1500:]}")
                steady = {}
                for name, of in first.items():
                    again, near = second.get(name, []), third.get(name, [])
                    if len(of) == len(again) == len(near):
                        labels = ["", *of]
                        steady[name] = [
                            word if word == same and not HASH.match(word) and label != "bytes" else None
                            for word, same, label in zip(of, again, labels)]
                        moved = [word is not None and word != now and not is_rounding(word, now)
                                 for word, now in zip(steady[name], near)]
                        self.rounding += sum(moved)
                        steady[name] = [None if by_rounding else word for word, by_rounding in zip(steady[name], moved)]
                steps.append((words, status, steady))
            self.groups.append(steps)
            self.took_s.append((time.monotonic() - begun) / len(homes))
        for home in homes:
            shutil.rmtree(home)

    def quick(self, among):
        """Of these groups the quickest, of a few seconds in all."""
        chosen, left_s = set(), QUICK_S
        for group in sorted(among, key=lambda group: self.took_s[group]):
            left_s -= self.took_s[group]
            if left_s < 0 and chosen:
                break
            chosen.add(group)
        return chosen

    def words(self):
        """How many words are compared."""
        return sum(word is not None for steps in self.groups for _, _, steady in steps for of in steady.values() for word in of)

    def differs(self, program, folder, among):
        """The first command that shows something else, or None. Only the groups of `among` are tried: the others don't
        execute what was changed."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        seen = {}
        try:
            for group in sorted(among, key=lambda group: self.took_s[group]):
                for words, status, steady in self.groups[group]:
                    now, found = step(program, words, folder, seen)
                    if now != status or any(differ(of, found.get(name)) for name, of in steady.items()):
                        return " ".join(words)
            return None
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def differ(of, found):
    return found is None or len(of) != len(found) or any(
        word is not None and word != now and not is_rounding(word, now) for word, now in zip(of, found))


def is_rounding(word, now):
    """Within a millionth, or by a unit of the last of a few decimals that both are written with."""
    try:
        first, second = float(word), float(now)
    except ValueError:
        return False
    if math.isclose(first, second, rel_tol=ROUNDING, abs_tol=ZERO):
        return True
    decimals = [len(text.partition(".")[2]) for text in (word, now)]
    few = "e" not in word + now and 0 < max(decimals) <= DECIMALS
    return few and abs(first - second) <= 1.01 * 10.0 ** -max(decimals)
