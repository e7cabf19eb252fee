"""Keeps what `tests/run --results DIR` did: a log a step, index.json and index.md.

    results.py DIR RIGS STATUS <STEPS     STEPS: lines of name, title and command, with tabs between them

RIGS is the folder of the rigs (.rigs), STATUS the exit status of all of it.
"""

import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
# What takes part, and how each tells its version.
TOOLS = {
    "rustc": ["rustc", "--version", "--verbose"],
    "cargo": ["cargo", "--version"],
    "cc": ["cc", "--version"],
    "python3": ["python3", "--version"],
    "node": ["node", "--version"],
    "npm": ["npm", "--version"],
    "git": ["git", "--version"],
    "valgrind": ["valgrind", "--version"],
    "qemu": ["qemu-system-arm", "--version"],
    "slurm": ["sinfo", "--version"],
}


def said(words):
    """What a command prints; None where there is no such command, or it fails."""
    try:
        done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None


def steps(rigs, out):
    """Each step of tests/run, whether it was run or not."""
    found = []
    for line in sys.stdin.read().splitlines():
        name, title, command = line.split("\t")
        step = {"name": name, "title": title, "command": command.strip(), "result": "not run"}
        ended = rigs / "steps" / f"{name}.ended"
        log = rigs / "steps" / f"{name}.log"
        if ended.exists():
            status, seconds, begun, end, processor = ended.read_text().split()
            status = int(status)
            step["result"] = {0: "passed", 77: "skipped"}.get(status, "failed")
            step |= {"exit_status": status, "seconds": int(seconds), "processor_seconds": float(processor), "begun": begun, "ended": end}
        elif log.exists():
            step["result"] = "failed"
            step["reason"] = "it did not end"
        if step["result"] == "skipped":
            reason = rigs / "steps" / f"{name}.skip"
            step["reason"] = reason.read_text().strip() if reason.exists() else "no reason given"
        if log.exists():
            shutil.copy(log, out / f"{name}.log")
            step |= {"log": f"{name}.log", "log_sha256": sha256(out / f"{name}.log")}
        found.append(step)
    return found


def tests_counted(out):
    """Tests that passed, failed or were left out, as the programs of tests told it."""
    counts = {"passed": 0, "failed": 0, "ignored": 0}
    log = out / "tests.log"
    if not log.exists():
        return None
    pattern = r"test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored"
    for found in re.finditer(pattern, log.read_text(errors="replace")):
        for key, number in zip(counts, found.groups()):
            counts[key] += int(number)
    return counts


def packages(rigs):
    """What the rigs installed, with versions."""
    found = {}
    for pip in sorted(rigs.glob("python*/bin/pip")):
        listed = said([str(pip.absolute()), "freeze"])
        found[pip.parent.parent.name] = (listed or "").splitlines()
    if (rigs / "npm/installed").exists():
        found["npm"] = [f"tests/rigs/package-lock.json {sha256(rigs / 'npm/installed')}"]
    return found


def markdown(index):
    program, host = index["program"], index["host"]
    lines = [
        "# Results of the tests", "",
        f"**{index['result']}**: {index['counts']['passed']} steps passed, {index['counts']['failed']} failed, "
        f"{index['counts']['skipped']} skipped, {index['counts']['not run']} not run.", "",
        "| | |", "|---|---|",
        f"| Commit | {index['commit']}{', with changes that no commit has' if index['changes'] else ''} |",
        f"| Program | {program['version'] or 'not built'}, SHA-256 {program['sha256'] or '-'} |",
        f"| Crates | SHA-256 of Cargo.lock {index['lock_sha256']} |",
        f"| Computer | {host['system']}, {host['processor']}, {host['processors']} processors |",
        f"| Begun, ended | {index['begun'] or '-'}, {index['ended'] or '-'} (UTC) |",
    ]
    if index["tests"]:
        tests = index["tests"]
        lines.append(
            f"| Tests of the step `tests` | {tests['passed']} passed, {tests['failed']} failed, {tests['ignored']} "
            "left to other steps and studies |"
        )
    lines += [""]
    short = [step for step in index["steps"] if step["result"] in ("skipped", "failed", "not run")]
    if short:
        lines += ["## Not shown", ""]
        lines += [f"- **{step['name']}** {step['result']}: {step.get('reason', step['title'])}" for step in short]
        lines += [""]
    lines += ["## Steps", "", "| step | | result | exit status | begun | s | log, SHA-256 |", "|---|---|---|---|---|---|---|"]
    for step in index["steps"]:
        log = f"[{step['log']}]({step['log']}) {step['log_sha256'][:16]}…" if "log" in step else ""
        lines.append(
            f"| {step['name']} | {step['title']} | {step['result']} | {step.get('exit_status', '')} | "
            f"{step.get('begun', '')} | {step.get('seconds', '')} | {log} |"
        )
    lines += ["", "## Done with", "", "| tool | version |", "|---|---|"]
    for tool, version in index["tools"].items():
        lines.append(f"| {tool} | {(version or 'not there').splitlines()[0]} |")
    lines += ["", "Packages of the rigs are in `index.json`."]
    return "\n".join(lines) + "\n"


def main():
    out, rigs, status = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
    all_steps = steps(rigs, out)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    octant = Path(os.environ.get("OCTANT", target / "release/octant"))
    counts = {result: sum(step["result"] == result for step in all_steps)
              for result in ("passed", "failed", "skipped", "not run")}
    ran = [step for step in all_steps if "begun" in step]
    index = {
        "schema": 1,
        # Everything has to have run for a release to be shown by it.
        "result": "failed" if status else "passed in part" if counts["skipped"] + counts["not run"] else "passed",
        "exit_status": status,
        "counts": counts,
        "commit": said(["git", "rev-parse", "HEAD"]),
        "changes": bool(said(["git", "status", "--porcelain", "--untracked-files=no"])),
        "begun": min((step["begun"] for step in ran), default=None),
        "ended": max((step["ended"] for step in ran), default=None),
        "program": {"path": str(octant), "sha256": sha256(octant), "version": said([str(octant), "--version"])},
        "lock_sha256": sha256(ROOT / "Cargo.lock"),
        "host": {
            "name": platform.node(), "system": platform.platform(), "processors": os.cpu_count(),
            "processor": next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                               if line.startswith("model name")), platform.machine())
            if Path("/proc/cpuinfo").exists() else platform.machine(),
        },
        "ci": os.environ.get("CI") == "true",
        "tests": tests_counted(out),
        "tools": {tool: said(words) for tool, words in TOOLS.items()},
        "packages": packages(rigs),
        "steps": all_steps,
    }
    (out / "index.json").write_text(json.dumps(index, indent=1) + "\n")
    (out / "index.md").write_text(markdown(index))
    print(f"results are in {out}: {index['result']}")


main()
