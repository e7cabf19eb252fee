"""A campaign on object storage, with workers that are killed and a service that fails. See tests/rigs/objects."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from children import popen
from object_server import ObjectStore

OCTANT, TABLES_PYTHON = sys.argv[1:3]
TABLES = ["cases.parquet", "checks.parquet", "drift.parquet"]
# Minutes: only what hangs takes as long.
HANGS_S = 600
CASES = 60
SCENARIO = """schema = 1
title = "short"
[imu]
rate = "50 Hz"
[procedure.calibration]
duration = "8 min"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "45 deg" }]
[procedure.navigation]
duration = "10 min"
[[requirements]]
id = "NAV-1"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "0.05 nmi"
"""
CAMPAIGN = f"""schema = 1
title = "on objects"
replicates = {CASES}
[[scenarios]]
id = "short"
file = "short.toml"
"""
failed = []


def check(what, is_so, detail=""):
    print(f"{'ok  ' if is_so else 'FAIL'} {what}{'' if is_so else f': {detail}'}", flush=True)
    if not is_so:
        failed.append(what)


def started(*arguments, **more):
    environment = {**store.environment, **more}
    words = [str(word) for word in arguments]
    return popen([OCTANT, "campaign", *words], env=environment, text=True,
                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)


def ended(process):
    said, _ = process.communicate(timeout=HANGS_S)
    return process.returncode, said


def campaign(*arguments, **more):
    return ended(started(*arguments, **more))


def until(what, is_so):
    begun = time.monotonic()
    while not is_so():
        if time.monotonic() - begun > HANGS_S:
            check(what, False, "it never came")
            raise SystemExit(1)
        time.sleep(0.02)


def has_result(folder):
    """Whether a worker has stored a result: a part file is longer than its head."""
    return any(part.stat().st_size > 16 for part in (folder / "results").glob("*.octres"))


def segments(prefix):
    return sorted(name for name in store.objects(f"{prefix}/results/"))


def new(prefix):
    """The campaign at an address of its own."""
    status, said = campaign("bundle", work / "alone", "--out", f"s3://rig/{prefix}")
    if status != 0:
        check(f"a bundle at s3://rig/{prefix}", False, said)
    return f"s3://rig/{prefix}"


def merged(address, what):
    """The tables of an address are those of the folder."""
    status, said = campaign("merge", address)
    there = work / f"fetched {address.rsplit('/', 1)[1]}"
    shutil.rmtree(there, ignore_errors=True)
    fetched, words = campaign("unbundle", address, there)
    same = fetched == 0 and all((there / table).read_bytes() == (work / "alone" / table).read_bytes() for table in TABLES)
    check(f"{what}: the merged tables are those of a folder", status == 0 and same, said + words)
    return there


def killed_half_way():
    address = new("killed")
    worker = started("run", address, "--shard", "1/2", "--jobs", "1", "--upload-every", "0.2")
    until("a first segment", lambda: segments("killed"))
    os.kill(worker.pid, signal.SIGKILL)
    worker.communicate()
    kept = len(segments("killed"))
    status, said = campaign("run", address, "--shard", "1/2", "--jobs", "2")
    run, there = map(int, re.search(r"(\d+) cases? run, (\d+) with a result already", said).groups())
    check("a worker that was killed goes on with what it had uploaded",
          status in (0, 1) and kept >= 1 and there >= 1 and run >= 1 and run + there == CASES // 2, said)
    # A worker of other shards takes these results over too.
    status, said = campaign("run", address, "--jobs", "2")
    check("a worker of another number of shards takes them over",
          f"{CASES // 2} cases run, {CASES // 2} with a result already" in said, said)
    return merged(address, "a worker killed half way")


def two_workers():
    address = new("two")
    store.free.clear()
    workers = [started("run", address, "--jobs", "1", "--shard", "1/3", "--upload-every", "0.2") for _ in range(2)]
    until("two workers that write", lambda: store.writing == 2)
    begun = len(store.log)
    store.free.set()
    outcomes = [ended(worker) for worker in workers]
    refused = [path for method, path, status in store.log[begun:] if method == "PUT" and status == 412]
    check("two workers of a shard: the second write of a name is refused",
          len(refused) >= 1 and all(status in (0, 1) for status, _ in outcomes), f"{refused} {outcomes}")
    numbers = [int(name.rsplit("/", 1)[1].split(".")[0]) for name in segments("two")]
    check("two workers of a shard: the segments of both are there", numbers == list(range(1, len(numbers) + 1))
          and len(numbers) >= 2, numbers)
    campaign("run", address, "--jobs", "2")
    merged(address, "two workers of a shard")


def answers_lost():
    address = new("lost")
    store.losing = 2
    status, said = campaign("run", address, "--shard", "1/3", "--jobs", "2")
    check("a write whose answer is lost isn't written twice",
          status in (0, 1) and len(segments("lost")) == 1 and store.losing == 0, f"{segments('lost')} {said}")


def refused_for_a_while():
    address = new("refused")
    worker = started("run", address, "--jobs", "1", "--upload-every", "0.2")
    until("a first segment", lambda: segments("refused"))
    store.refusing = True
    begun = len(store.log)
    # Not every request after that: one that was on its way may still be answered.
    until("refused requests", lambda: sum(status == 503 for _, _, status in store.log[begun:]) >= 3)
    store.refusing = False
    status, said = ended(worker)
    tries = sum(status == 503 for _, _, status in store.log[begun:])
    check("a service that answers 503 for a while is asked again", status in (0, 1) and tries >= 3, said)
    merged(address, "a service that answers 503 for a while")


def refused_for_good():
    address = new("for good")
    folder = work / "kept results"
    worker = started("run", address, "--jobs", "1", "--upload-every", "0.2", "--work", folder,
                     OCTANT_STORAGE_RETRY_S="1")
    until("a first result", lambda: has_result(folder))
    store.refusing = True
    status, said = ended(worker)
    check("a service that refuses for good ends the worker with status 4, and names the object",
          status == 4 and "failed to write s3://rig/for good/results/1-of-1/" in said and str(folder) in said, said)
    status, said = campaign("status", address, OCTANT_STORAGE_RETRY_S="1")
    check("a command that only reads says so too", status == 4 and "failed to read s3://rig/for good/bundle.zip" in said, said)
    store.refusing = False
    status, said = campaign("run", address, "--jobs", "2", "--work", folder)
    there = int(re.search(r"(\d+) with a result already", said).group(1))
    check("the results that were kept in the folder are uploaded later", status in (0, 1) and there >= 1, said)
    merged(address, "a service that refused for good")


def forgotten():
    address, folder = new("forgotten"), work / "not forgotten"
    store.forgetting = True
    status, said = campaign("run", address, "--shard", "1/3", "--jobs", "2", "--work", folder, OCTANT_STORAGE_RETRY_S="1")
    check("a service that confirms and stores nothing is status 4, and the results stay", status == 4 and has_result(folder)
          and "the storage confirmed it, and reading it back found nothing" in said and str(folder) in said, said)
    store.forgetting = False
    status, said = campaign("run", address, "--jobs", "2", "--work", folder)
    there = int(re.search(r"(\d+) with a result already", said).group(1))
    check("they are uploaded later", status in (0, 1) and there == CASES // 3, said)
    merged(address, "a service that forgot")


def endless():
    address = new("endless")
    store.endless = True
    status, said = campaign("status", address)
    store.endless = False
    check("a list without an end is status 4", status == 4 and "expected one that ends" in said, said)


def terminated():
    address, folder = new("terminated"), work / "terminated"
    worker = started("run", address, "--shard", "1/2", "--jobs", "1", "--upload-every", "600", "--work", folder)
    until("a first result", lambda: has_result(folder))
    os.kill(worker.pid, signal.SIGTERM)
    status, said = ended(worker)
    uploaded = re.search(r"(\d+) records? uploaded", said)
    run = int(re.search(r"(\d+) cases? run", said).group(1))
    check("a worker that is terminated uploads what it has", status == 3 and run >= 1 and uploaded and
          int(uploaded.group(1)) == run and len(segments("terminated")) == 1, f"{status} {said}")


def read_in_place(there):
    """Commands that read, on the campaign that is complete."""
    address = "s3://rig/killed"
    local = campaign("status", work / "alone")
    check("status is that of a folder", campaign("status", address) == local, local)
    case = json.loads((there / "plan.json").read_text())["cases"][0]
    case = case["id"] if isinstance(case, dict) else case[0]
    result = campaign("result", address, case)
    check("a result is that of a folder", result[0] == 0 and result == campaign("result", work / "alone", case), result)
    status, said = campaign("report", address)
    reported = sorted(store.objects("killed/"))
    check("the report is put beside the results", status == local[0] and "s3://rig/killed/report.html" in said and
          {"killed/report.html", "killed/manifest.json", "killed/dispositions.toml"} <= set(reported), f"{said} {reported}")
    whole = verified(address)
    check("verify finds the folder whole", whole[0] == 0 and address in whole[1], whole[1])
    # Dispositions are a person's: fetched, and put back.
    _, text = store.asked("GET", "/rig/killed/dispositions.toml")
    filled = text.replace(b'by = ""', b'by = "A. Person"').replace(b'disposition = ""', b'disposition = "As seen."')
    store.asked("PUT", "/rig/killed/dispositions.toml", filled)
    campaign("report", address)
    check("dispositions that a person has written stay", filled != text and
          store.asked("GET", "/rig/killed/dispositions.toml")[1] == filled, text.decode())
    _, tables = store.asked("GET", "/rig/killed/checks.parquet")
    store.asked("PUT", "/rig/killed/checks.parquet", tables[:-9] + bytes([tables[-9] ^ 1]) + tables[-8:])
    changed = verified(address)
    check("verify finds a changed object", changed[0] == 1 and "checks.parquet" in changed[1], changed[1])


def verified(address):
    done = subprocess.run([OCTANT, "verify", address], env=store.environment, text=True, capture_output=True)
    return done.returncode, done.stdout + done.stderr


def refusals():
    """What can't be done is told in plain words."""
    other = work / "other"
    other.mkdir()
    (other / "short.toml").write_text(SCENARIO)
    (other / "campaign.toml").write_text(CAMPAIGN.replace(str(CASES), "2"))
    campaign("plan", other / "campaign.toml", "--out", other / "planned")
    refused = campaign("bundle", other / "planned", "--out", "s3://rig/killed")
    check("another plan isn't written over a bundle", refused[0] == 2 and "found another bundle" in refused[1], refused)
    check("the same bundle is", campaign("bundle", work / "alone", "--out", "s3://rig/killed")[0] == 0)
    for what, arguments, more, status, words in [
        ("a prefix without a campaign", ("status", "s3://rig/nothing"), {}, 2, "s3://rig/nothing/bundle.zip: found no such object"),
        ("a bucket that isn't there", ("status", "s3://nowhere/x"), {}, 2, "s3://nowhere/x/bundle.zip"),
        ("http:// without AWS_ALLOW_HTTP", ("status", "s3://rig/killed"), {"AWS_ALLOW_HTTP": ""}, 2, "AWS_ALLOW_HTTP=true"),
        ("a service that isn't there", ("status", "s3://rig/killed"),
         {"AWS_ENDPOINT_URL": "http://127.0.0.1:9", "OCTANT_STORAGE_RETRY_S": "0"}, 4, "failed to read s3://rig/killed/bundle.zip"),
        ("another scheme", ("status", "gs://rig/killed"), {}, 2, "expected s3://BUCKET/PREFIX"),
        ("--work with a folder", ("run", work / "alone", "--work", other), {}, 2, "--work: found the folder"),
        ("Slurm with an address", ("emit", "slurm", "s3://rig/killed", "--shards", "2"), {}, 2, "a folder that all nodes see"),
    ]:
        found = campaign(*arguments, **more)
        check(f"{what} is refused", found[0] == status and words in found[1], found)


def kubernetes():
    """The job against its schema, and the command of its pod in a root of its own."""
    address = new("pods")
    status, job = campaign("emit", "k8s", address, "--shards", 3, "--image", "registry/octant:1", "--secret", "storage")
    (work / "job.yaml").write_text(job)
    script = """
import json, sys, yaml, kubernetes_validate
job = yaml.safe_load(open(sys.argv[1]))
kubernetes_validate.validate(job, "1.31", strict=True)
print(json.dumps(job))"""
    done = subprocess.run([TABLES_PYTHON, "-c", script, work / "job.yaml"], text=True, capture_output=True)
    check("the job is one of Kubernetes", status == 0 and done.returncode == 0, job + done.stderr)
    job = json.loads(done.stdout)["spec"]
    [container] = job["template"]["spec"]["containers"]
    check("its credentials are those of the secret", container["envFrom"] == [{"secretRef": {"name": "storage"}}], container)
    if os.getuid() != 0:
        print("     not root: the command of the pod runs without a root of its own", flush=True)
    root = work / "root"
    libraries = subprocess.run(["ldd", OCTANT], text=True, capture_output=True, check=True).stdout
    for path in [*re.findall(r"(/\S+) \(0x", libraries)]:
        (root / path[1:]).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, root / path[1:])
    for folder in ["usr/bin", "tmp", "proc", "dev"]:
        (root / folder).mkdir(parents=True, exist_ok=True)
    shutil.copy(OCTANT, root / "usr/bin/octant")
    (root / "tmp").chmod(0o777)
    # What Kubernetes and the secret give a pod.
    given = {name: store.environment[name] for name in store.environment if name.startswith("AWS_")}
    given |= {one["name"]: one["value"] for one in container["env"]} | {"PATH": "/usr/bin"}
    statuses = []
    for index in range(job["completions"]):
        command = container["command"]
        if os.getuid() == 0:
            # An engine gives /proc and /dev.
            command = ["unshare", "--mount", "--pid", "--fork", f"--mount-proc={root / 'proc'}", "sh", "-c",
                       'mount --rbind /dev "$0/dev" && exec chroot --userspec=1000:1000 "$0" "$@"', root, *command]
        else:
            command = [OCTANT, *command[1:]]
        done = subprocess.run(command, env=given | {"JOB_COMPLETION_INDEX": str(index), "PATH": os.environ["PATH"]},
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        statuses.append(done.returncode)
        if done.returncode != 0:
            print(done.stdout)
    failing = campaign("status", address)[0]
    check("pods whose cases fail have done their part", statuses == [0, 0, 0] and failing == 1, (statuses, failing))
    merged(address, "pods in a root with the program alone")
    # Bad input fails the whole job; that is the policy for status 2.
    rules = job["podFailurePolicy"]["rules"]
    values = [rule["onExitCodes"]["values"] for rule in rules if rule["action"] == "FailJob"]
    check("bad input ends the job, and it alone", values == [[2]], rules)


work = Path(tempfile.mkdtemp())
store = ObjectStore(open(work / "moto.log", "w"))
try:
    (work / "short.toml").write_text(SCENARIO)
    (work / "campaign.toml").write_text(CAMPAIGN)
    for command in [("plan", work / "campaign.toml", "--out", work / "alone"), ("run", work / "alone", "--jobs", "2"),
                    ("merge", work / "alone")]:
        status, said = campaign(*command)
        if status > 1:
            check("a campaign in a folder", False, said)
            raise SystemExit(1)
    check("some cases pass and some fail", re.search(r"[1-9]\d* pass, [1-9]\d* fail", campaign("status", work / "alone")[1]),
          campaign("status", work / "alone"))
    there = killed_half_way()
    two_workers()
    answers_lost()
    refused_for_a_while()
    refused_for_good()
    forgotten()
    endless()
    terminated()
    refusals()
    kubernetes()
    read_in_place(there)
finally:
    store.end()
    shutil.rmtree(work, ignore_errors=True)
raise SystemExit(1 if failed else 0)
