"""Runs tests with mutants that the environment switches on."""

import concurrent.futures
import dataclasses
import os
import pathlib
import re
import resource
import signal
import subprocess
import tempfile
import time

# A mutant's tests may take so many times what they take without it, and so much more.
TIMES, MORE_S = 20, 20
# A mutant that fills the memory is ended before others notice.
MEMORY = 4 << 30


@dataclasses.dataclass
class Program:
    """A program of tests, and the folder of its package, in which cargo starts it."""

    name: str
    path: str
    folder: str


@dataclasses.dataclass
class Ended:
    """How a program of tests ended: names of what failed, whether it was ended, and its time."""

    passed: bool
    failed: list
    ended: bool
    seconds: float


def names_of(program, skipped):
    """Tests of a program that aren't ignored and whose name has none of some parts."""
    def listed(*words):
        done = subprocess.run([program.path, "--list", *words], check=True, capture_output=True, text=True, cwd=program.folder)
        return [line.removesuffix(": test") for line in done.stdout.splitlines() if line.endswith(": test")]
    ignored = set(listed("--ignored"))
    return [name for name in listed() if name not in ignored and not any(part in name for part in skipped)]


def run(program, names, threads, cpu_s=None, wall_s=None, mutant=None, reached=None):
    """Runs tests of one program, with a limit of processor time for each process and one of the clock."""
    environment = {name: value for name, value in os.environ.items() if name != "RUST_BACKTRACE"}
    # Proptest keeps what it found, and would change the tree.
    environment |= {"CARGO_MANIFEST_DIR": program.folder, "PROPTEST_DISABLE_FAILURE_PERSISTENCE": "1"}
    if mutant is not None:
        environment["OCTANT_MUTANT"] = str(mutant)
    if reached is not None:
        environment["OCTANT_MUTANTS_REACHED"] = str(reached)

    def limits():
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if cpu_s is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (int(cpu_s) + 1, int(cpu_s) + 3))

    began = time.monotonic()
    words = [program.path, "--exact", *names, "--test-threads", str(threads)]
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen(
            words, cwd=program.folder, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
            start_new_session=True, preexec_fn=limits,
        )
        try:
            code, ended = child.wait(wall_s), False
        except subprocess.TimeoutExpired:
            code, ended = None, True
        # What a test left behind goes with it.
        try:
            os.killpg(child.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        child.wait()
        out.seek(0)
        text = out.read().decode(errors="replace")
    ended = ended or code in (-signal.SIGXCPU, -signal.SIGKILL)
    failed = re.findall(r"^test (\S+)(?: - should panic)? \.\.\. FAILED$", text, re.M)
    return Ended(code == 0, [name for name in names if name in failed], ended, time.monotonic() - began)


def alone(program, name):
    """One test without a mutant: time and the mutants that it reaches, or None where it doesn't pass."""
    with tempfile.TemporaryDirectory() as folder:
        ended = run(program, [name], 1, wall_s=900, reached=folder)
        if not ended.passed:
            ended = run(program, [name], 1, wall_s=900, reached=folder)
        if not ended.passed:
            return None
        return {"seconds": round(ended.seconds, 3), "reached": sorted(int(file.name) for file in pathlib.Path(folder).iterdir())}


def reach(programs, skipped, known, keep, workers):
    """Every test without a mutant, into `known` by program and name."""
    wanted = [(program, name) for program in programs for name in names_of(program, skipped.get(program.name, ()))]
    wanted = [(program, name) for program, name in wanted if f"{program.name} {name}" not in known]
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        jobs = {pool.submit(alone, program, name): f"{program.name} {name}" for program, name in wanted}
        for count, job in enumerate(concurrent.futures.as_completed(jobs), 1):
            known[jobs[job]] = job.result()
            if job.result() is None:
                print(f"does not pass without a mutant: {jobs[job]}", flush=True)
            if count % 50 == 0 or count == len(jobs):
                print(f"{count} of {len(jobs)} tests run without a mutant", flush=True)
                keep()
    keep()


def chunks(tests):
    """Tests of one program after another, cheapest first; the first ones few, then more at a time."""
    limit_s, chunk, used = 1.0, [], 0.0
    for program, name, seconds in tests:
        if chunk and (chunk[0][0] is not program or used + seconds > limit_s):
            yield chunk
            chunk, used, limit_s = [], 0.0, min(2 * limit_s, 30.0)
        chunk.append((program, name, seconds))
        used += seconds
    if chunk:
        yield chunk


def test(number, programs, known):
    """One mutant: its outcome, and the test that caught it."""
    by_name = {program.name: program for program in programs}
    reaching = []
    for key, told in known.items():
        if told and number in told["reached"]:
            program, name = key.split(" ", 1)
            reaching.append((by_name[program], name, told["seconds"]))
    total = {}
    for program, _, seconds in reaching:
        total[program.name] = total.get(program.name, 0.0) + seconds
    # Programs with little to run come first.
    reaching.sort(key=lambda one: (total[one[0].name], one[0].name, one[2]))
    began = time.monotonic()
    found = {"outcome": "MissedMutant", "tests": len(reaching)}
    for chunk in chunks(reaching):
        by = failing(number, chunk)
        if by:
            found |= by
            break
    return found | {"seconds": round(time.monotonic() - began, 1)}


def failing(number, chunk):
    """What a chunk of tests says of a mutant; a test that fails has to fail twice."""
    program, seconds = chunk[0][0], sum(one[2] for one in chunk)
    limits = {"cpu_s": TIMES * seconds + MORE_S, "wall_s": 2 * TIMES * seconds + 6 * MORE_S, "mutant": number}
    ended = run(program, [name for _, name, _ in chunk], 2, **limits)
    if ended.passed:
        return None
    if ended.ended:
        return {"outcome": "Timeout", "by": f"{program.name} {chunk[0][1]}" if len(chunk) == 1 else f"{program.name}"}
    # A program that ended at once names nobody: each test is asked alone.
    for name in ended.failed or [name for _, name, _ in chunk]:
        again = run(program, [name], 1, **limits)
        if not again.passed:
            return {"outcome": "Timeout" if again.ended else "CaughtMutant", "by": f"{program.name} {name}"}
    return None
