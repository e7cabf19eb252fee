#!/usr/bin/env python3
"""What tests/rigs/campaign does. Usage: campaign.py OCTANT REPLICATES [cost]"""

import hashlib
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import duckdb
import pandas
import polars

import junit_reader
from children import popen

ROOT = pathlib.Path(__file__).resolve().parents[2]
OCTANT, REPLICATES = sys.argv[1], int(sys.argv[2])
COST = sys.argv[3:] == ["cost"]
CASES = 12 * REPLICATES
TABLES = ["cases", "checks", "drift"]
KILLS, PARTS = 10, 7
# Runs, kills, tables and their readers are the same at any rate of samples: those of a case at 200 Hz take four times
# as long.
RATE = "20 Hz"

# In a process that is small: one that forks counts as large as who forks it.
MEASURED = """
import resource, subprocess, sys

status = subprocess.run(sys.argv[1:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print("measured", used.ru_utime + used.ru_stime, used.ru_maxrss)
sys.exit(status)
"""

failures = []


def check(name, holds, found=""):
    """One line a check; a failure says what was found."""
    print(f"{'ok  ' if holds else 'FAIL'} {name}" + ("" if holds else f"\n     found: {found}"), flush=True)
    if not holds:
        failures.append(name)


def octant(*arguments, cpu=None, **more):
    command = [OCTANT, *map(str, arguments)]
    if cpu is not None:
        command = ["taskset", "-c", str(cpu), *command]
    return subprocess.run(command, capture_output=True, text=True, timeout=3600, **more)


def good(name, result):
    check(name, result.returncode == 0, f"status {result.returncode}: {result.stdout}{result.stderr}")


def ran(name, result):
    """All cases have run; the status is that of the verdict, which a few draws leave open."""
    check(name, result.returncode in (0, 3) and "cases run" in result.stdout + result.stderr,
          f"status {result.returncode}: {result.stdout}{result.stderr}")


def merged(folder):
    """SHA-256 of the merged tables."""
    result = octant("campaign", "merge", folder)
    if result.returncode != 0:
        return result.stderr
    return [hashlib.sha256((folder / f"{table}.parquet").read_bytes()).hexdigest() for table in TABLES]


def plan(work, name):
    """A folder with the plan."""
    folder = work / name
    result = octant("campaign", "plan", work / "campaigns" / "certification.toml", "--out", folder)
    if result.returncode != 0 or f"{CASES} cases" not in result.stdout:
        sys.exit(f"no plan: {result.stdout}{result.stderr}")
    return folder


def run_and_kill(folder, part, dice, kills):
    """Kills a part of the campaign so many times at random moments, then lets it end."""
    arguments = ["campaign", "run", folder, "--shard", f"{part}/{PARTS}", "--jobs", 2]

    def results():
        state = json.loads(octant("campaign", "status", folder, "--json").stdout)
        return state["cases"] - state["open"]

    for _ in range(kills):
        # Counted in results and not in seconds alone: a part has ten cases or more, which a fast host has soon.
        enough = results() + dice.randrange(4 - kills)
        campaign = popen(
            [OCTANT, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        while results() < enough and campaign.poll() is None:
            time.sleep(0.01)
        try:
            campaign.wait(dice.uniform(0.0, 0.2))
            check(f"part {part} is there to be killed", False, "it had ended")
        except subprocess.TimeoutExpired:
            campaign.send_signal(signal.SIGINT if dice.random() < 0.3 else signal.SIGKILL)
            campaign.wait()
    ran(f"part {part} of {PARTS}, gone on with after {kills} kills", octant(*arguments))


def in_every_way(work):
    """One case at a time on one processor; and beside it two at a time, in parts that are killed."""
    one, parts = plan(work, "one"), plan(work, "parts")

    def in_parts():
        dice = random.Random(7)
        order = list(range(1, PARTS + 1))
        dice.shuffle(order)
        for place, part in enumerate(order):
            run_and_kill(parts, part, dice, (KILLS + place) // PARTS)

    beside = threading.Thread(target=in_parts)
    beside.start()
    cpu = min(os.sched_getaffinity(0))
    ran("on one processor", octant("campaign", "run", one, "--jobs", 1, cpu=cpu))
    beside.join()
    expected = merged(one)
    name = f"on two processors, in {PARTS} parts, after {KILLS} kills: the same bytes"
    check(name, merged(parts) == expected, merged(parts))
    said = octant("campaign", "status", parts).stdout
    check("after kills: no case came to two results", said and "two results" not in said, said)
    files = sorted(path.name for path in parts.glob("results/*"))
    check(f"after kills: at most two files of results for each of {PARTS} parts", len(files) <= 2 * PARTS, files)
    return one


def measured(*arguments):
    """What a campaign says, its seconds of processor, and the memory of the largest of its processes, KiB."""
    command = [sys.executable, "-S", "-c", MEASURED, OCTANT, "campaign", "run", *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=7200)
    cpu_s, largest_kib = map(float, result.stdout.split("measured ")[-1].split())
    return result, cpu_s, largest_kib


def on_two_processors(work):
    """What the campaign costs."""
    folder = plan(work, "two")
    # So few of them that what gathers them is no larger than a case.
    _, _, case_kib = measured(plan(work, "few"), "--shard", f"1/{CASES // 2}")
    started = time.monotonic()
    result, cpu_s, largest_kib = measured(folder, "--jobs", 2)
    took = time.monotonic() - started
    # Some of the instruments break a requirement with the fault that they get: that is a result too.
    check("on two processors", result.returncode in (0, 1) and f"{CASES} cases run" in result.stdout + result.stderr,
          f"status {result.returncode}: {result.stdout}{result.stderr}")
    print(f"     {CASES} cases: {took:.0f} s, {CASES / took:.2f} a second, {cpu_s / CASES:.2f} s of processor each; "
          f"a case had {case_kib / 1024:.0f} MB, what gathers them {largest_kib / 1024:.0f} MB")
    check("together less than 500 MB", largest_kib + 2 * case_kib < 500 * 1024, f"{largest_kib} and {case_kib} KiB")
    return folder


def read_by_others(folder):
    """DuckDB, pandas and polars agree, and the queries of the docs run."""
    path = {table: str(folder / f"{table}.parquet") for table in TABLES}
    measure = "navigation.radial_error_nmi.max"
    by_pandas, by_polars = pandas.read_parquet(path["cases"]), polars.read_parquet(path["cases"])
    by_duckdb = duckdb.sql(f"""SELECT count(*), avg("{measure}") FROM '{path["cases"]}'""").fetchall()[0]
    check("DuckDB, pandas and polars count the cases", len(by_pandas) == len(by_polars) == by_duckdb[0] == CASES)
    means = [by_pandas[measure].mean(), by_polars[measure].mean(), by_duckdb[1]]
    check(f"they agree on {measure}", max(means) - min(means) < 1e-12 * max(means), means)
    planned = [case["id"] for case in json.loads((folder / "plan.json").read_text())["cases"]]
    check("the cases are in the order of the plan", by_pandas["case"].tolist() == planned)
    spiked = by_pandas[by_pandas["factor.fault"] == "spike-1"]
    fired = spiked["faults.spike-1.fired"]
    check("every spike that was drawn fired", len(spiked) > 0 and bool(fired.all()), fired.tolist())
    docs = (ROOT / "docs" / "campaigns.md").read_text()
    queries = re.findall(r"```sql\n(.*?)```", docs, re.S)
    check("the docs have queries", len(queries) >= 4)
    os.chdir(folder)
    for query in queries:
        rows = duckdb.sql(query).fetchall()
        check(f"query: {query.splitlines()[0].lstrip('- ')}", len(rows) > 0, rows)


def for_schedulers(folder):
    """The job of Kubernetes against its schema, the script of Slurm as a shell reads it."""
    import kubernetes_validate
    import yaml

    job = octant("campaign", "emit", "k8s", folder, "--shards", 16, "--image", "registry/octant:1")
    document = yaml.safe_load(job.stdout)
    try:
        kubernetes_validate.validate(document, "1.31", strict=True)
        wrong = ""
    except kubernetes_validate.ValidationError as error:
        wrong = str(error)
    check("the job of Kubernetes is one", job.returncode == 0 and not wrong, wrong + job.stderr)
    check("it has 16 completions", document["spec"]["completions"] == 16)
    script = octant("campaign", "emit", "slurm", folder, "--shards", 16)
    shell = subprocess.run(["sh", "-n"], input=script.stdout, text=True, capture_output=True)
    check("the script of Slurm is a shell's", script.returncode == shell.returncode == 0, shell.stderr)


def read_by_ci(folder):
    """The JUnit of the campaign and that of a run, by what CI systems read them with."""
    report = octant("campaign", "report", folder)
    check("the campaign is reported", report.returncode in (0, 1, 3), report.stdout + report.stderr)
    run = folder.parent / "run-for-ci"
    result = octant("run", ROOT / "fixtures/scenarios/lockstep.toml", "--out", run)
    check("a run for CI", result.returncode in (0, 1), result.stdout + result.stderr)
    for name, path in [("campaign", folder / "junit.xml"), ("run", run / "junit.xml")]:
        found = junit_reader.faults(path)
        check(f"the JUnit of the {name} is within the schema of Jenkins' xUnit plugin", not found, found[:5])
        counts, outputs, time_s, said = junit_reader.read(path)
        text = path.read_text()
        check(f"junitparser reads every test case of the {name}", sum(counts.values()) == said["tests"] > 0, (counts, said))
        same = counts["failure"] == said["failures"] and counts["error"] == said["errors"]
        check(f"and their results in the {name}", same, (counts, said))
        check(f"and their properties in the {name}", outputs == text.count("<system-out>") and (outputs > 0 or name == "run"), outputs)
        check(f"the {name} has its time", time_s and time_s > 0, time_s)


def evidence(work):
    """A signed run: minisign verifies it, and every change is found."""
    keys = [work / "key.pub", work / "key", work / "other.pub", work / "other"]
    for public, secret in [keys[:2], keys[2:]]:
        made = subprocess.run(["minisign", "-G", "-W", "-p", public, "-s", secret], capture_output=True, text=True)
        check("minisign makes a key", made.returncode == 0, made.stderr)
    run = work / "run"
    result = octant("run", ROOT / "fixtures/scenarios/lockstep.toml", "--out", run,
                    env={**os.environ, "OCTANT_SIGNING_KEY": str(keys[1]), "OCTANT_OPERATOR": "A. Tester"})
    good("a run is signed", result)
    stock = subprocess.run(["minisign", "-V", "-m", run / "manifest.json", "-p", keys[0]], capture_output=True, text=True)
    check("minisign verifies it", stock.returncode == 0, stock.stderr)
    good("octant verifies it", octant("verify", run, "--key", keys[0]))
    check("the manifest names the operator", json.loads((run / "manifest.json").read_text())["operator"] == "A. Tester")

    def found(name, status=1):
        result = octant("verify", run, "--key", keys[0])
        check(name, result.returncode == status, f"status {result.returncode}: {result.stdout}{result.stderr}")

    dice = random.Random(3)
    for path in sorted(path for path in run.rglob("*") if path.is_file()):
        whole = path.read_bytes()
        bit = dice.randrange(8 * len(whole))
        changed = bytearray(whole)
        changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        result = octant("verify", run, "--key", keys[0])
        check(f"a change of bit {bit} of {path.name} is found", result.returncode in (1, 2), result.stdout)
        path.write_bytes(whole)
        path.rename(work / "aside")
        result = octant("verify", run, "--key", keys[0])
        check(f"that {path.name} is missing is found", result.returncode in (1, 2), result.stdout)
        (work / "aside").rename(path)
    for name in ["more.txt", ".hidden", "sub"]:
        path = run / name
        path.mkdir() if name == "sub" else path.write_text("")
        if name == "sub":
            (path / "deep.txt").write_text("")
        found(f"{name} is found")
        shutil.rmtree(path) if name == "sub" else path.unlink()
    wrong = octant("verify", run, "--key", keys[2])
    check("another key is told", wrong.returncode == 1 and "different from public key" in wrong.stdout, wrong.stdout)
    good("all is well again", octant("verify", run, "--key", keys[0]))


SHORT = """
schema = 1
title = "short"
replicates = 12

[[scenarios]]
id = "static"
file = "static.toml"
set = { "procedure.calibration.duration" = "10 min", "procedure.navigation.duration" = "10 min", "faults" = [] }
"""


def full_disk(work):
    """A disk that fills in the middle of a campaign: an error in words, no result lost, none made up."""
    mount = work / "disk"
    mount.mkdir()

    def with_options(options):
        return subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", mount], capture_output=True, text=True)

    file = work / "campaigns" / "short.toml"
    file.write_text(SHORT)
    free = work / "short"
    good(f"planned into {free.name}", octant("campaign", "plan", file, "--out", free))
    good("with room: all is run", octant("campaign", "run", free))
    # Room for the plan and half of the results.
    sizes = [(free / "plan.json").stat().st_size, sum(path.stat().st_size for path in free.glob("results/*")) // 2]
    pages = sum(-(-size // 4096) for size in sizes)
    mounted = with_options(f"size={4 * pages}k")
    if mounted.returncode != 0:
        print(f"SKIP disk full: no tmpfs can be mounted here: {mounted.stderr.strip()}")
        return
    try:
        full = mount / "short"
        good(f"planned into {full.name}", octant("campaign", "plan", file, "--out", full))
        result = octant("campaign", "run", full)
        check("disk full: status 4, named", result.returncode == 4 and "No space left" in result.stderr,
              f"status {result.returncode}: {result.stderr}")
        state = json.loads(octant("campaign", "status", full, "--json").stdout)
        cases = [case["id"] for case in json.loads((full / "plan.json").read_text())["cases"]]
        kept = [result.stdout for result in (octant("campaign", "result", full, case) for case in cases) if not result.returncode]
        check("disk full: some cases are kept, each of them whole",
              0 < len(kept) < 12 and len(kept) == 12 - state["open"] and all(json.loads(text)["summary"] for text in kept),
              f"{len(kept)}, {state}")
        parts = {path: path.read_bytes() for path in full.glob("results/*")}
        with_options("remount,size=8m")
        good("with room: the rest is run", octant("campaign", "run", full))
        check("with room: what was there is untouched",
              all(path.read_bytes().startswith(bytes_) for path, bytes_ in parts.items()))
        expected = merged(free)
        check("with room: the same bytes", merged(full) == expected, merged(full))
        tables = {path: path.read_bytes() for path in full.glob("*.parquet")}
        filler = mount / "filler"
        try:
            filler.write_bytes(bytes(16 << 20))
        except OSError:
            pass
        result = octant("campaign", "merge", full)
        check("disk full: tables that can't be written are told", result.returncode == 4 and "No space left" in result.stderr,
              f"status {result.returncode}: {result.stderr}")
        check("disk full: tables that were there stay", all(path.read_bytes() == text for path, text in tables.items()))
        check("disk full: a plan that can't be written is told",
              octant("campaign", "plan", file, "--out", mount / "other").returncode == 4)
    finally:
        subprocess.run(["umount", mount], check=True)


with tempfile.TemporaryDirectory() as name:
    work = pathlib.Path(name)
    shutil.copytree(ROOT / "fixtures" / "campaigns", work / "campaigns")
    file = work / "campaigns" / "certification.toml"
    file.write_text(file.read_text().replace("replicates = 84", f"replicates = {REPLICATES}"))
    for case in [] if COST else ["static.toml", "dockside.toml"]:
        case = work / "campaigns" / case
        # A spike is as long in seconds as it is at 200 Hz.
        text = case.read_text().replace('"100 samples"', '"0.5 s"')
        case.write_text(f'{text}\n[imu]\nrate = "{RATE}"\n')
    evidence(work)
    full_disk(work)
    folder = on_two_processors(work) if COST else in_every_way(work)
    if COST:
        merged(folder)
    for_schedulers(folder)
    read_by_ci(folder)
    read_by_others(folder)
    os.chdir("/")
sys.exit(f"{len(failures)} failed: {failures}" if failures else 0)
