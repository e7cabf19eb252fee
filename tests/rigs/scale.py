"""Many short cases over three workers of Slurm, of Snakemake and of object storage, 5 % of whose tasks are killed.

Usage: scale.py OCTANT CASES TASKS SEED     (in the cluster of tests/rigs/slurm)
"""

import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from object_server import ObjectStore

OCTANT, CASES, TASKS, SEED = sys.argv[1], *map(int, sys.argv[2:5])
HERE = Path(__file__).parent.resolve()
SNAKEMAKE = HERE.parent.parent / ".rigs/python-snakemake/bin/snakemake"
TABLES = ["cases.parquet", "checks.parquet", "drift.parquet"]
# Minutes: only what hangs takes as long.
HANGS_S = 3600
# The shortest calibration that has a move in it.
SCENARIO = """schema = 1
title = "shortest"
[imu]
rate = "20 Hz"
[procedure.calibration]
duration = "30 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "45 deg" }]
[procedure.navigation]
duration = "10 s"
[[requirements]]
id = "NAV-1"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "1 nmi"
"""
CAMPAIGN = f"""schema = 1
title = "many"
replicates = {CASES // 4}
[[scenarios]]
id = "shortest"
file = "shortest.toml"
[[factors]]
name = "latitude"
key = "site.latitude"
values = ["0 deg", "30 deg", "45 deg", "60 deg"]
"""
failed = []


def check(what, is_so, detail=""):
    print(f"{'ok  ' if is_so else 'FAIL'} {what}{'' if is_so else f': {detail}'}", flush=True)
    if not is_so:
        failed.append(what)


def ran(*command, allowed=(0,), **more):
    """Runs a command to its end, and returns what it said."""
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          stdin=subprocess.DEVNULL, cwd=work, timeout=HANGS_S, **more)
    if done.returncode not in allowed:
        print(done.stdout[-4000:])
        raise SystemExit(f"FAIL {' '.join(map(str, command))} ended with {done.returncode}")
    return done.stdout


def campaign(*arguments, allowed=(0,), **more):
    return ran(OCTANT, "campaign", *arguments, allowed=allowed, **more)


def to_be_killed(way):
    """Parts that are killed, each after some of its results: what the environment of its tasks says."""
    drawn = random.Random(f"{SEED} {way}")
    parts = drawn.sample(range(1, TASKS + 1), max(1, round(0.05 * TASKS)))
    kills = work / f"{way} kills"
    kills.mkdir()
    for part in parts:
        # Of the first half of its results.
        (kills / str(part)).write_text(f"{17 + int(drawn.random() * 0.5 * part_bytes)}\n")
    return kills, parts, {"KILLED": OCTANT, "KILLS": str(kills), "OCTANT": str(HERE / "killed-task")}


def killed(way, kills, parts):
    listed = kills / "killed"
    found = listed.read_text().split() if listed.exists() else []
    # On a busy computer a task may end before it is killed.
    check(f"{way}: {len(found)} of {TASKS} tasks were killed with -9", 1 <= len(found) <= len(parts), parts)
    return [int(one.split("/")[0]) for one in found]


def same(way, folder, begun):
    equal = [(work / "alone" / table).read_bytes() == (folder / table).read_bytes() for table in TABLES]
    check(f"{way}: {CASES} cases in {TASKS} parts, {time.monotonic() - begun:.0f} s: the merged tables are those of one "
          "undisturbed run", all(equal), equal)


def queue():
    return ran("squeue", "-h", "-o", "%T")


def slurm():
    begun = time.monotonic()
    campaign("plan", "campaign.toml", "--out", "by slurm")
    (work / "job.sh").write_text(campaign("emit", "slurm", "by slurm", "--shards", TASKS))
    (work / "by slurm/logs").mkdir()
    kills, parts, environment = to_be_killed("slurm")
    environment = os.environ | environment
    submit = ["sbatch", "--parsable", "--output", "by slurm/logs/%A_%a.txt"]
    ran(*submit, f"--array=1-{TASKS}%3", "job.sh", env=environment)
    while queue().strip():
        time.sleep(0.2)
    lost = killed("Slurm", kills, parts)
    status = campaign("status", "by slurm", allowed=(0, 1, 3))
    check("Slurm: their cases are open", f"{CASES} of {CASES} cases" not in status, status)
    ran(*submit, f"--array={','.join(map(str, lost))}%3", "job.sh", env=environment)
    while queue().strip():
        time.sleep(0.2)
    campaign("merge", "by slurm")
    same("Slurm", work / "by slurm", begun)


def snakemake():
    begun = time.monotonic()
    campaign("plan", "campaign.toml", "--out", "by snakemake")
    (work / "Snakefile").write_text(campaign("emit", "snakemake", "by snakemake", "--shards", TASKS))
    kills, parts, environment = to_be_killed("snakemake")
    # It tries a task that is lost again by itself.
    ran(SNAKEMAKE, "--quiet", "--cores", 3, env=os.environ | environment)
    killed("Snakemake", kills, parts)
    same("Snakemake", work / "by snakemake", begun)


def objects():
    begun = time.monotonic()
    store = ObjectStore(open(work / "moto.log", "w"))
    try:
        address = "s3://rig/many"
        campaign("bundle", "alone", "--out", address, env=store.environment)
        kills, parts, environment = to_be_killed("objects")
        environment = store.environment | environment
        tasks, taking, wrong = list(range(1, TASKS + 1)), threading.Lock(), []

        def worker():
            while True:
                with taking:
                    if not tasks:
                        return
                    part = tasks.pop(0)
                folder = Path(tempfile.mkdtemp(dir=work))
                done = subprocess.run(
                    [environment["OCTANT"], "campaign", "run", address, "--shard", f"{part}/{TASKS}", "--jobs", "1", "--any-verdict"],
                    env=environment | {"TMPDIR": str(folder)}, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                # The disk of a lost pod goes with it.
                shutil.rmtree(folder)
                with taking:
                    if done.returncode == 137:
                        tasks.append(part)
                    elif done.returncode != 0:
                        wrong.append((part, done.returncode, done.stdout[-2000:]))

        workers = [threading.Thread(target=worker) for _ in range(3)]
        for one in workers:
            one.start()
        for one in workers:
            one.join()
        check("object storage: every part ended", not wrong, wrong)
        killed("object storage", kills, parts)
        campaign("merge", address, env=store.environment)
        campaign("unbundle", address, "fetched", env=store.environment)
        same("object storage", work / "fetched", begun)
    finally:
        store.end()


work = Path(tempfile.mkdtemp())
work.chmod(0o755)
try:
    (work / "shortest.toml").write_text(SCENARIO)
    (work / "campaign.toml").write_text(CAMPAIGN)
    begun = time.monotonic()
    campaign("plan", "campaign.toml", "--out", "alone")
    campaign("run", "alone", "--jobs", "2", allowed=(0, 1))
    campaign("merge", "alone")
    part_bytes = sum(part.stat().st_size for part in (work / "alone/results").iterdir()) / TASKS
    print(f"     {CASES} cases alone: {time.monotonic() - begun:.0f} s, {part_bytes / CASES * TASKS:.0f} bytes each", flush=True)
    ways = {"slurm": slurm, "snakemake": snakemake, "objects": objects}
    for way in sys.argv[5:] or ways:
        ways[way]()
finally:
    shutil.rmtree(work, ignore_errors=True)
raise SystemExit(1 if failed else 0)
