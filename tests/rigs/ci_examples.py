"""The CI examples of docs/nightly, executed: the scripts that are in the files, in the shells that the services run them
in, against a server that fails (ci_server.py), interrupted, and twice at once. What is stored is lost in no case, and a
night that isn't stored ends its job.

The nights are real ones of the program, of one short case. Not of the files: a job's `sleep` is short; `octant selftest`,
which the rig runs by itself, does nothing here; the step that installs octant, and the actions that bring the checkout and
take the artifacts, are the rig's.

Usage: ci_examples.py OCTANT
"""

import concurrent.futures
import io
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import time

from children import popen
from ci_server import TOKEN, Server
from ruamel.yaml import YAML

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BRANCH = "refs/heads/octant-nightly"
LIMIT_S = 600

SCENARIO = """schema = 1
title = "short"
seed = 1
imu.rate = "20 Hz"
[procedure.calibration]
positions = "eight"
duration = "12 min"
[procedure.navigation]
duration = "1 min"
[[requirements]]
id = "NAV-1"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "10 nmi"
"""
PROJECT = {
    "scenarios/short.toml": SCENARIO,
    "campaigns/nightly.toml": 'schema = 1\ntitle = "night"\nreplicates = 1\n[[scenarios]]\nid = "short"\n'
                              'file = "../scenarios/short.toml"\n',
    "suites/nightly.toml": 'schema = 1\n[[cases]]\nscenario = "../scenarios/short.toml"\nexpect = "pass"\n',
}


def git(*words, cwd=None):
    environment = {**os.environ, "GIT_CONFIG_GLOBAL": "/dev/null"}
    options = ["-c", "user.name=rig", "-c", "user.email=rig@localhost", "-c", "init.defaultBranch=main"]
    done = subprocess.run(["git", *options, *words], cwd=cwd, env=environment, stdout=subprocess.PIPE, check=True)
    return done.stdout.decode().strip()


def tools(folder, octant):
    """Programs of a job's PATH. The program waits while the file $HOLD is there, after it has said that it does."""
    folder.mkdir()
    (folder / "sleep").write_text("#!/bin/sh\nexec /bin/sleep 0.01\n")
    (folder / "octant").write_text(f"""#!/bin/sh
if [ "$1" = selftest ]; then touch selftest.json; exit; fi
touch begun
while [ -e "$HOLD" ]; do /bin/sleep 0.02; done
exec {octant} "$@"
""")
    for tool in folder.iterdir():
        tool.chmod(0o755)


class Job:
    """One job: its folder, its environment, the processes of its scripts, and what it has said."""

    def __init__(self, folder, path, **variables):
        self.folder, self.said, self.cancelled, self.child = folder, "", False, None
        self.hold = folder.parent / f"{folder.name}.hold"
        home = folder.parent / f"{folder.name}.home"
        home.mkdir()
        (home / ".curlrc").write_text("retry-delay = 1\n")
        kept = {name: value for name, value in os.environ.items() if not name.lower().endswith("_proxy")}
        self.environment = {**kept, "PATH": f"{path}:{os.environ['PATH']}", "HOME": str(home), "CURL_HOME": str(home),
                            "HOLD": str(self.hold), "GIT_CONFIG_GLOBAL": "/dev/null", "GIT_TERMINAL_PROMPT": "0",
                            "CI": "true", **variables}

    def script(self, shell, text, cwd=None, **variables):
        file = self.folder.parent / f"{self.folder.name}.sh"
        file.write_text(text)
        self.child = popen([*shell, str(file)], cwd=cwd or self.folder, env={**self.environment, **variables},
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      start_new_session=True)
        try:
            said, _ = self.child.communicate(timeout=LIMIT_S)
        finally:
            # A job's container ends with it.
            try:
                os.killpg(self.child.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.said += said.decode(errors="replace")
        return self.child.returncode

    def cancel(self):
        self.cancelled = True
        os.killpg(self.child.pid, signal.SIGTERM)


class GitLab:
    """docs/nightly/gitlab.yml, whose script runs in one shell, and whose after_script in another."""

    failing, storing = "GET /api", "PUT /api"

    def __init__(self, folder, octant, shell):
        self.folder, self.shell = folder, shell
        self.job = YAML(typ="safe").load((ROOT / "docs/nightly/gitlab.yml").read_text())["nightly"]
        folder.mkdir()
        self.tools = folder / "bin"
        tools(self.tools, octant)

    def server(self, history=None):
        return Server(self.folder, history)

    def stored(self, server):
        return server.stored

    def damaged(self, history):
        return history[: len(history) // 2]

    def names(self, history):
        return tarfile.open(fileobj=io.BytesIO(history)).getnames()

    def new(self, name, server, **asked):
        work = self.folder / name
        for file, text in PROJECT.items():
            (work / file).parent.mkdir(parents=True, exist_ok=True)
            (work / file).write_text(text)
        given = {"CI_API_V4_URL": f"{server.url}/api/v4", "CI_PROJECT_ID": "7", "CI_JOB_TOKEN": TOKEN,
                 "CI_PIPELINE_SOURCE": "schedule", **{name.upper(): "true" for name in asked}}
        for key, value in self.job["variables"].items():
            given[key] = re.sub(r"\$(\w+)", lambda found: given[found[1]], value)
        given["PATIENCE"] = "1"
        return Job(work, self.tools, **given)

    def run(self, job):
        strict = "set -eo pipefail\n" if self.shell == "bash" else "set -e\n"
        status = job.script([self.shell], strict + "\n".join(self.job["script"]) + "\n")
        job.script([self.shell], strict + "\n".join(self.job["after_script"]) + "\n")
        return status


class GitHub:
    """docs/nightly/github.yml, each step of which is a shell of its own."""

    failing, storing = "git-upload-pack", "git-receive-pack"

    def __init__(self, folder, octant):
        self.folder = folder
        self.job = YAML(typ="safe").load((ROOT / "docs/nightly/github.yml").read_text())["jobs"]["night"]
        folder.mkdir()
        self.tools = folder / "bin"
        tools(self.tools, octant)
        self.count = 0

    def server(self, history=None):
        self.count += 1
        folder = self.folder / f"server-{self.count}"
        if history is None:
            work = folder / "work"
            for file, text in PROJECT.items():
                (work / file).parent.mkdir(parents=True, exist_ok=True)
                (work / file).write_text(text)
            git("init", "--quiet", cwd=work)
            git("add", ".", cwd=work)
            git("commit", "--quiet", "-m", "project", cwd=work)
            git("clone", "--quiet", "--bare", str(work), str(folder / "project.git"))
        else:
            shutil.copytree(history, folder / "project.git")
        git("config", "http.receivepack", "true", cwd=folder / "project.git")
        return Server(folder)

    def stored(self, server):
        """The repository where the history's branch is in it; its content is compared by its commits."""
        folder = server.repositories / "project.git"
        found = subprocess.run(["git", "rev-parse", "--quiet", "--verify", BRANCH], cwd=folder, stdout=subprocess.PIPE)
        return Repository(folder, found.stdout.decode().strip()) if found.returncode == 0 else None

    def names(self, history):
        return git("ls-tree", "-r", "--name-only", history.commit, cwd=history.folder).splitlines()

    def new(self, name, server, **asked):
        work = self.folder / name
        git("clone", "--quiet", "--depth", "1", f"file://{server.repositories}/project.git", str(work))
        git("remote", "set-url", "origin", f"{server.url}/git/project.git", cwd=work)
        job = Job(work, self.tools)
        job.inputs = {"first": False, "accept": False, **asked}
        return job

    def run(self, job):
        outside = job.folder.parent / f"{job.folder.name}.runner"
        outside.mkdir()
        steps, failed = {}, False

        def value(text):
            def named(found):
                scope, _, name = found[1].partition(".")
                if scope == "inputs":
                    return str(job.inputs[name]).lower()
                if scope == "steps":
                    step, _, output = name.partition(".outputs.")
                    return steps[step]["outputs"].get(output, "")
                raise SystemExit(f"the rig knows no {found[0]}")

            return re.sub(r"\$\{\{ ([\w.]+) \}\}", named, str(text))

        def holds(condition):
            if condition is None:
                return not failed and not job.cancelled
            text = str(condition).removeprefix("${{").removesuffix("}}")
            # Without a function of the state, success() is asked for too.
            asks = re.search(r"\b(?:cancelled|always|failure|success)\(\)", text)
            text = text.replace("cancelled()", str(job.cancelled)).replace("always()", "True")
            text = text.replace("&&", " and ").replace("||", " or ")
            text = re.sub(r"!(?!=)", " not ", text)
            text = re.sub(r"inputs\.(\w+)", lambda found: str(job.inputs[found[1]]), text)
            text = re.sub(r"steps\.(\w+)\.outcome", lambda found: repr(steps[found[1]]["outcome"]), text)
            return eval(text) and (asks is not None or (not failed and not job.cancelled))  # noqa: S307

        for number, step in enumerate(self.job["steps"]):
            kept = steps.setdefault(step.get("id", number), {"outcome": "skipped", "outputs": {}})
            if "uses" in step or step.get("name") == "Install octant" or not holds(step.get("if")):
                continue
            shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail"] if step.get("shell") == "bash" else ["bash", "-e"]
            output = outside / f"output-{number}"
            output.touch()
            variables = {name: value(text) for name, text in {**self.job.get("env", {}), **step.get("env", {})}.items()}
            variables.update(GITHUB_OUTPUT=str(output), RUNNER_TEMP=str(outside),
                             GITHUB_STEP_SUMMARY=str(outside / "summary"), GIT_HTTP_LOW_SPEED_TIME="1")
            status = job.script(shell, step["run"], **variables)
            kept["outcome"] = "success" if status == 0 else "failure"
            kept["outputs"] = dict(line.split("=", 1) for line in output.read_text().splitlines())
            failed = failed or status != 0
        return 1 if failed or job.cancelled else 0


class Repository:
    """A bare repository with the history's branch at a commit."""

    def __init__(self, folder, commit):
        self.folder, self.commit = folder, commit

    def __fspath__(self):
        return str(self.folder)

    def __eq__(self, other):
        return isinstance(other, Repository) and self.commit == other.commit


FAILED = []


def check(what, holds, job):
    print(f"{'ok  ' if holds else 'FAIL'} {what}")
    if not holds:
        FAILED.append(what)
        print("     " + job.said.replace("\n", "\n     "))


def night(service, name, failures=(), history=None, asked=(), during=None):
    """Runs a job of its own server; its status, the job, and what is stored after it."""
    server = service.server(history)
    for failure in failures:
        server.fail(*failure)
    job = service.new(name.replace(" ", "-"), server, **dict.fromkeys(asked, True))
    if during is None:
        status = service.run(job)
    else:
        job.hold.touch()
        with concurrent.futures.ThreadPoolExecutor() as pool:
            running = pool.submit(service.run, job)
            wait_for(job.folder / "begun", running)
            during(server, job)
            job.hold.unlink(missing_ok=True)
            status = running.result()
    stored = service.stored(server)
    server.close()
    return status, job, stored


def wait_for(file, running):
    while not file.exists() and not running.done():
        time.sleep(0.02)


def try_service(title, service, few):
    """All that can happen to the nights of a service."""
    status, job, history = night(service, "first", asked=["first"])
    is_there = history is not None and any(name.endswith("baseline.json") for name in service.names(history))
    check(f"{title}: the first night starts a history", status == 0 and is_there, job)
    if not is_there:
        return
    listed = service.names(history)
    check(f"{title}: folders of nights aren't in it", not any(f"nights/" in name for name in listed), job)

    def grows(name, **how):
        status, job, stored = night(service, name, history=history, **how)
        check(f"{title}: {name}", status == 0 and stored is not None and stored != history, job)

    def stays(name, word=None, of=history, **how):
        status, job, stored = night(service, name, history=of, **how)
        said = word is None or word in job.said
        check(f"{title}: {name}", status not in (0, 3) and stored == of and said, job)

    def other_stores(server, job):
        other = service.new(job.folder.name + "-other", server)
        check(f"{title}: of two nights at once the one that ends first is stored", service.run(other) == 0, other)

    def two(name):
        server = service.server(history)
        job = service.new("late", server)
        job.hold.touch()
        with concurrent.futures.ThreadPoolExecutor() as pool:
            running = pool.submit(service.run, job)
            wait_for(job.folder / "begun", running)
            other_stores(server, job)
            between = service.stored(server)
            job.hold.unlink()
            status = running.result()
        stored = service.stored(server)
        server.close()
        check(f"{title}: {name}", status not in (0, 3) and stored == between and "another night" in job.said, job)

    tried = [lambda: grows("a night is added to the history"),
             lambda: stays("a history that can't be read is not replaced", "can't be",
                           failures=[(service.failing, "502")])]
    if not few:
        tried += [
            lambda: grows("one 502 while the history is read", failures=[(service.failing, "502", 1)]),
            lambda: grows("a history that is cut off once", failures=[(service.failing, "cut", 1)]),
            lambda: grows("a server that says nothing once", failures=[(service.failing, "silence", 1)]),
            lambda: grows("one 502 while the history is stored", failures=[(service.storing, "502", 1)]),
            lambda: grows("a connection that is lost while the history is stored",
                          failures=[(service.storing, "cut", 1)]),
            lambda: stays("a history that can't be stored ends the job", "isn't stored" if service.storing[0] == "g"
                          else "can't be stored", failures=[(service.storing, "502")]),
            lambda: stays("a night without a history ends the job", "there is no history", of=None),
            lambda: stays("a night that is interrupted leaves the history as it is",
                          during=lambda _, job: job.cancel()),
            lambda: two("the one that ends later doesn't replace it, and says so"),
        ]
        if hasattr(service, "damaged"):
            tried += [
                lambda: stays("a storage that only says that it has stored is noticed", "isn't stored",
                              failures=[(service.storing, "lies")]),
                lambda: stays("a damaged history is not replaced", "damaged", of=service.damaged(history)),
            ]
    # They wait more than they work.
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for done in [pool.submit(one) for one in tried]:
            done.result()


def main():
    octant = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory(prefix="octant-ci-examples-") as folder:
        folder = pathlib.Path(folder)
        try_service("gitlab.yml in bash", GitLab(folder / "bash", octant, "bash"), few=False)
        try_service("gitlab.yml in sh", GitLab(folder / "sh", octant, "sh"), few=True)
        try_service("github.yml", GitHub(folder / "github", octant), few=False)
    return 1 if FAILED else 0


if __name__ == "__main__":
    sys.exit(main())
