#!/usr/bin/env python3
"""The tool that runs steps, on commands that leave processes behind, on signals, and on an end by force."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from children import popen

HERE = pathlib.Path(__file__).resolve().parent
# The tool, with as long a grace for what is left behind as a test wants, and little time between request and force.
TOOL = "import sys; sys.path.insert(0, sys.argv.pop(1)); import step; step.GRACE_S, step.ENDING_S = {}, 0.5; step.main(sys.argv[1:])"
# Ends a wait that hangs, and decides nothing.
HANGS_S = 300.0


def is_gone(process):
    """Whether a process has ended; one that nobody has taken in yet has."""
    try:
        text = pathlib.Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return True
    return text.rpartition(")")[2].split()[0] in "ZX"


def until(condition):
    begun = time.monotonic()
    while not condition():
        assert time.monotonic() - begun < HANGS_S, "it hangs"
        time.sleep(0.01)


@unittest.skipUnless(sys.platform == "linux", "descendants are found on Linux")
class Step(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.work = pathlib.Path(self.folder.name)
        self.log = self.work / "log"

    def tearDown(self):
        self.folder.cleanup()

    def tool(self, *arguments, grace_s=0.0):
        return popen(
            [sys.executable, "-c", TOOL.format(grace_s), str(HERE), *map(str, arguments)],
            stdout=subprocess.PIPE,
            cwd=self.work,
            text=True,
        )

    def ended(self, *arguments, grace_s=0.0):
        said, _ = (tool := self.tool(*arguments, grace_s=grace_s)).communicate(timeout=HANGS_S)
        return tool.returncode, said

    def process(self, name):
        """The number that a command has written to a file."""
        until(lambda: (self.work / name).exists() and (self.work / name).read_text().endswith("\n"))
        return int((self.work / name).read_text())

    def test_status_and_output_are_those_of_the_command(self):
        for status in (0, 3, 77):
            script = f"echo out; echo error >&2; exit {status}"
            self.assertEqual(self.ended("--live", self.log, "bash", "-c", script), (status, "out\nerror\n"))
            self.assertEqual(self.log.read_text(), "out\nerror\n")
            self.assertEqual(self.ended(self.log, "bash", "-c", script), (status, ""))
            self.assertEqual(self.log.read_text(), "out\nerror\n")
        self.assertEqual(self.ended(self.log, "bash", "-c", "kill -9 $$")[0], 137)

    def test_a_daemon_that_holds_the_output_is_named_and_ended(self):
        # In a session of its own, an orphan, with the output open, and deaf to a request.
        script = """setsid bash -c 'trap "" TERM HUP; echo $$ >pid; while :; do sleep 1000; done' &
            until [ -s pid ]; do sleep 0.01; done; echo passed"""
        for status, ends in ((1, ""), (1, "; exit 77"), (4, "; exit 4")):
            (self.work / "pid").unlink(missing_ok=True)
            found, said = self.ended("--live", self.log, "bash", "-c", script + ends)
            process = self.process("pid")
            self.assertEqual(found, status)
            self.assertIn(f"passed\nleft running: {process} bash -c trap", said)
            self.assertEqual(self.log.read_text(), said)
            self.assertTrue(is_gone(process))

    def test_a_guard_may_end_after_its_command(self):
        script = "mkfifo line; (cat <line; exit 0) & exec 3>line; echo passed"
        self.assertEqual(self.ended(self.log, "bash", "-c", script, grace_s=HANGS_S), (0, ""))
        self.assertEqual(self.log.read_text(), "passed\n")

    def test_a_step_is_a_process_group_in_the_session_of_its_caller(self):
        script = "read -r _ _ _ _ group session _ </proc/$$/stat; echo $(($$ - group)) $session"
        self.assertEqual(self.ended("--live", self.log, "bash", "-c", script), (0, f"0 {os.getsid(0)}\n"))

    def test_a_failure_is_shown_while_the_step_goes_on(self):
        tool = self.tool("--live", self.log, "bash", "-c", "echo FAILED one; until [ -e go ]; do sleep 0.01; done")
        self.assertEqual(tool.stdout.readline(), "FAILED one\n")
        self.assertIsNone(tool.poll())
        (self.work / "go").touch()
        self.assertEqual(tool.communicate(timeout=HANGS_S)[0], "")
        self.assertEqual(tool.returncode, 0)

    def test_a_signal_ends_everything_that_was_started(self):
        script = """echo $$ >first; setsid bash -c 'echo $$ >second; sleep 1000' & echo started; wait; echo on; sleep 1000"""
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            for name in ("first", "second"):
                (self.work / name).unlink(missing_ok=True)
            tool = self.tool(self.log, "bash", "-c", script)
            processes = [self.process(name) for name in ("first", "second")]
            tool.send_signal(number)
            tool.communicate(timeout=HANGS_S)
            self.assertEqual(tool.returncode, 128 + number)
            self.assertTrue(all(map(is_gone, processes)))

    def test_the_whole_ended_by_force_ends_its_steps(self):
        step = [sys.executable, HERE / "step.py", self.log, "bash", "-c", "echo $$ >pid; sleep 1000"]
        whole = self.tool("--whole", *step)
        process = self.process("pid")
        whole.kill()
        whole.communicate(timeout=HANGS_S)
        until(lambda: is_gone(process))
        # No further step begins.
        said = subprocess.run(
            [sys.executable, HERE / "step.py", self.log, "echo", "begun"],
            env={"OCTANT_TESTS_RUN": str(whole.pid)},
            check=False,
        )
        self.assertNotEqual(said.returncode, 0)
        self.assertEqual(self.log.read_text(), "")

    def test_the_whole_has_the_signal_s_status(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            (self.work / "pid").unlink(missing_ok=True)
            whole = self.tool("--whole", "bash", "-c", "(echo $BASHPID >pid; exec sleep 1000) & wait")
            process = self.process("pid")
            whole.send_signal(number)
            whole.communicate(timeout=HANGS_S)
            self.assertEqual(whole.returncode, -number)
            self.assertTrue(is_gone(process))


if __name__ == "__main__":
    unittest.main()
