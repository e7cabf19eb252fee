"""Puts all mutants of a sample into one build: which of them the compiler takes, and the programs of the tests."""

import json
import os
import pathlib
import subprocess

import rewrite

HERE = pathlib.Path(__file__).resolve().parent
COMMON = "tests/rigs/common.sh"


class Build:
    """A clone whose source is rewritten, and the target folder that nobody else uses."""

    def __init__(self, tree, target, jobs):
        self.tree, self.target = tree, target
        self.environment = dict(os.environ, CARGO_TARGET_DIR=str(target), CARGO_BUILD_JOBS=str(jobs), CARGO_INCREMENTAL="1")
        self.regions = {}
        self.written = {}

    def source(self, file):
        done = subprocess.run(["git", "-C", self.tree, "show", f"HEAD:{file}"], check=True, capture_output=True)
        return done.stdout

    def put(self, file, text):
        """A file whose text is the same keeps its time: cargo looks at that."""
        path = self.tree / file
        if not path.exists() or path.read_bytes() != text:
            path.write_bytes(text)
        self.written[file] = text

    def rewrite(self, numbered):
        """Writes the mutants into the clone; numbers of those that can't be switched."""
        impossible, texts = [], {}
        self.regions = {}
        for file in sorted({mutant["file"] for _, mutant in numbered}):
            mine = [(number, mutant) for number, mutant in numbered if mutant["file"] == file]
            texts[file], self.regions[file], cannot = rewrite.rewritten(self.source(file), mine)
            impossible += cannot
        count = 1 + max(number for number, _ in numbered)
        for crate in sorted({mutant["crate"] for _, mutant in numbered}):
            library = f"{crate}/src/lib.rs"
            text = texts.get(library, self.source(library))
            # Lints that deny what a mutant may do: an arithmetic of constants that overflows.
            texts[library] = b"#![allow(arithmetic_overflow, unconditional_panic)] " + text + b"\nmod mutant;\n"
            module = (HERE / "mutant.rs").read_text().replace("COUNT", str(count))
            texts[f"{crate}/src/mutant.rs"] = module.encode()
        for file in set(self.written) - set(texts):
            self.put(file, self.source(file))
        for file, text in texts.items():
            self.put(file, text)
        return impossible

    def restore(self):
        """The source of the commit again: tests read it."""
        subprocess.run(["git", "-C", self.tree, "checkout", "--quiet", "--force", "HEAD", "--", "."], check=True)
        subprocess.run(["git", "-C", self.tree, "clean", "--quiet", "--force", "-d"], check=True)
        self.written = {}

    def check(self, packages):
        """Errors of the compiler, each as the places it names: file, first and last byte; the primary one comes first."""
        words = ["cargo", "check", "--release", "--lib", "--quiet", "--keep-going", "--message-format=json"]
        words += [word for package in sorted(packages) for word in ("--package", package)]
        done = subprocess.run(words, cwd=self.tree, env=self.environment, capture_output=True, text=True)
        errors = []
        for line in done.stdout.splitlines():
            message = json.loads(line)
            if message["reason"] != "compiler-message" or message["message"]["level"] != "error":
                continue
            spans = sorted(message["message"]["spans"], key=lambda span: not span["is_primary"])
            if spans:
                places = [(span["file_name"], span["byte_start"], span["byte_end"]) for span in spans]
                errors.append((message["message"]["message"], places))
        if done.returncode != 0 and not errors:
            raise SystemExit(f"the compiler ended without a place:\n{done.stderr[-4000:]}")
        return errors

    def refused(self, numbered, packages):
        """Numbers of the mutants that the compiler doesn't take as switches, found by taking out the blamed ones."""
        out = set(self.rewrite(numbered))
        while True:
            left = [(number, mutant) for number, mutant in numbered if number not in out]
            self.rewrite(left)
            errors = self.check(packages)
            if not errors:
                return out
            blamed = set()
            for message, places in errors:
                for file in dict.fromkeys(file for file, _, _ in places if file in self.regions):
                    spans = [(start, end) for of, start, end in places if of == file]
                    numbers = rewrite.blamed(self.regions[file], spans, self.written[file])
                    if numbers:
                        blamed.update(numbers)
                        break
            print(f"{len(errors)} errors of the compiler, {len(blamed)} mutants taken out", flush=True)
            if not blamed - out:
                raise SystemExit(f"no mutant is to blame for \"{errors[0][0]}\" at {errors[0][1][0]}")
            out |= blamed

    def viable(self, mutant):
        """Whether the compiler takes one mutant as cargo-mutants writes it."""
        self.restore()
        self.put(mutant["file"], rewrite.plain(self.source(mutant["file"]), mutant))
        accepted = not self.check({mutant["package"]})
        self.put(mutant["file"], self.source(mutant["file"]))
        return accepted

    def tests(self):
        """Builds the tests; program by folder of the package and kind ("lib", "main")."""
        profile = subprocess.run(
            ["bash", "-c", f'. {COMMON}; printf "%s\\n" "${{test_profile[@]}}"'],
            cwd=self.tree, check=True, capture_output=True, text=True,
        ).stdout.split()
        words = ["cargo", "test", *profile, "--lib", "--test", "main", "--no-run", "--quiet", "--message-format=json"]
        done = subprocess.run(words, cwd=self.tree, env=self.environment, stdout=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise SystemExit("the tests with all mutants can't be built")
        found = {}
        for line in done.stdout.splitlines():
            message = json.loads(line)
            if message["reason"] != "compiler-artifact" or not message.get("executable"):
                continue
            folder = pathlib.Path(message["manifest_path"]).parent
            kind = "lib" if "lib" in message["target"]["kind"] else message["target"]["name"]
            if message["profile"]["test"]:
                found[(str(folder), kind)] = message["executable"]
        return found
