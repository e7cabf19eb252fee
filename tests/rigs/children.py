"""Processes beside a rig, which end with it, however it ends.

What a rig waits for at once is started by `subprocess.run`.
"""

import concurrent.futures
import ctypes
import signal
import subprocess
import sys

PR_SET_PDEATHSIG = 1
LIBC = ctypes.CDLL(None) if sys.platform == "linux" else None
# The signal comes with the end of the thread that starts a process, so one thread that stays starts all.
STARTER = concurrent.futures.ThreadPoolExecutor(1)


def end_with_parent():
    """Makes this process end with its parent: runs in the child, before its program."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def popen(words, **options):
    """Starts a process as `subprocess.Popen` does."""
    if LIBC:
        options["preexec_fn"] = end_with_parent
    return STARTER.submit(subprocess.Popen, words, **options).result()
