"""Runs, campaigns and observability, from Python."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _octant
from ._folders import Campaign, PathLike, Run
from ._octant import BenchError, InputError
from ._scenario import Scenario, overrides, settings

Progress = bool | None | Callable[[int, int | None], None]


class _Bar:
    """A bar of tqdm, if it is installed."""

    def __init__(self, wanted: Progress, unit: str) -> None:
        self._bar: Any = None
        self._tell = wanted if callable(wanted) else None
        if wanted is True or (wanted is None and (sys.stderr.isatty() or "ipykernel" in sys.modules)):
            try:
                from tqdm.auto import tqdm
            except ImportError:
                if wanted is True:
                    raise ImportError("progress=True needs tqdm: pip install tqdm") from None
            else:
                self._bar = tqdm(unit=unit, unit_scale=True)
                self._tell = self._update

    def _update(self, done: int, total: int | None) -> None:
        if total != self._bar.total:
            self._bar.total = total
        self._bar.update(done - self._bar.n)

    @property
    def tell(self) -> Callable[[int, int | None], None] | None:
        return self._tell

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()


def run(
    scenario: PathLike | Scenario,
    *,
    out: PathLike | None = None,
    force: bool = False,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    source: str | None = None,
    endpoint: str | None = None,
    fire: Mapping[str, str] | None = None,
    only_faults: Sequence[str] | None = None,
    require: bool = False,
    realtime: bool = False,
    twin: bool = True,
    progress: Progress = None,
    **keys: Any,
) -> Run:
    """Run a scenario, as ``octant run`` does: the same bits, the same folder of evidence.

    Other Python threads go on meanwhile. Ctrl-C ends the run in order: what was recorded stays in
    ``OUT.partial``.

    Parameters
    ----------
    scenario : path or Scenario
        The scenario.
    out : path, optional
        Folder of the run; by default a new one in ``runs``.
    force : bool
        Replace a run in the folder.
    seed : int, optional
        Seed, in place of the scenario's.
    set : mapping, optional
        Changes by dotted key, such as ``{"procedure.calibration.duration": "12 h"}``.
    source, endpoint : str, optional
        URIs in place of the scenario's.
    fire : mapping, optional
        Times of faults that are triggered by hand, by id: ``{"spike": "5050 s"}``.
    only_faults : sequence of str, optional
        Ids of the faults to inject; none of them with ``[]``.
    require : bool
        Count a run of which nothing is required as inconclusive.
    realtime : bool
        Run by the clock.
    twin : bool
        Compare a run with faults with its twin without.
    progress : bool or callable, optional
        ``True`` shows a bar of tqdm, ``False`` none; by default there is one on a terminal and in a
        notebook, if tqdm is installed. A callable gets samples done and in all (None: not known).
    **keys
        Changes by key, with two underscores for a dot: ``procedure__calibration__duration="12 h"``.

    Returns
    -------
    Run
        The run. Its verdict may be any: a run that fails its requirements is no exception.

    Raises
    ------
    InputError
        If something is refused before the run.
    BenchError
        If the bench fails.
    KeyboardInterrupt
        After Ctrl-C.
    """
    asked = {
        **settings(scenario),
        "set": overrides(set, keys),
        "out": None if out is None else Path(out),
        "force": force,
        "seed": seed,
        "source": source,
        "endpoint": endpoint,
        "fire": [f"{fault}={time}" for fault, time in (fire or {}).items()],
        "only_faults": None if only_faults is None else list(only_faults),
        "require": require,
        "realtime": realtime,
        "twin": twin,
    }
    with _Bar(progress, " samples") as bar:
        return Run(_octant.run(asked, bar.tell))


def program() -> Path:
    """File of the program ``octant`` that the wheel put beside Python.

    ``OCTANT`` in the environment names another one.

    Raises
    ------
    BenchError
        If there is none.
    """
    named = os.environ.get("OCTANT")
    if named:
        return Path(named)
    name = "octant.exe" if os.name == "nt" else "octant"
    user = f"{os.name}_user"
    folders = [sysconfig.get_path("scripts")]
    if user in sysconfig.get_scheme_names():
        folders.append(sysconfig.get_path("scripts", user))
    for folder in folders:
        if (Path(folder) / name).is_file():
            return Path(folder) / name
    found = shutil.which(name)
    if found is None:
        raise BenchError("no program octant beside Python: expected the one of the wheel")
    return Path(found)


def _program(*arguments: str | os.PathLike[str], accepted: Sequence[int] = (0, 1, 3)) -> str:
    """Run the program; return what it prints."""
    with subprocess.Popen(
        [program(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8"
    ) as child:
        try:
            out, said = child.communicate()
        except KeyboardInterrupt:
            # The terminal gave the signal to the child too, and it ends in order.
            child.wait()
            raise
    if child.returncode not in accepted:
        message = said.strip().removeprefix("octant: ")
        raise (InputError if child.returncode == 2 else BenchError)(message)
    return out


def campaign(
    file: PathLike,
    out: PathLike,
    *,
    jobs: int | None = None,
    again: bool = False,
    progress: Progress = None,
) -> Campaign:
    """Plan a campaign, run the cases that have no result yet, merge and report.

    Each case is a process of its own. Ctrl-C ends it in order, and the same call goes on where it was.

    Parameters
    ----------
    file : path
        The campaign, a TOML file.
    out : path
        Folder of plan and results.
    jobs : int, optional
        Cases at a time; by default the number of processors.
    again : bool
        Run cases again that ended as errors.
    progress : bool or callable, optional
        As for :func:`run`; a callable gets cases done and in all.

    Returns
    -------
    Campaign
        With ``cases``, ``checks``, ``drift`` and ``statistics``.
    """
    folder = Path(out)
    if not (folder / "plan.json").is_file():
        _program("campaign", "plan", file, "--out", folder)
    arguments = ["campaign", "run", os.fspath(folder)]
    if jobs is not None:
        arguments += ["--jobs", str(jobs)]
    if again:
        arguments.append("--again")
    with _Bar(progress, " cases") as bar:
        _followed(arguments, folder, bar)
    _program("campaign", "merge", folder)
    _program("campaign", "report", folder)
    return Campaign(folder)


def _followed(arguments: list[str], folder: Path, bar: _Bar) -> None:
    """Run the program, and tell the bar how many cases have a result."""
    total = len(json.loads((folder / "plan.json").read_bytes())["cases"])
    with subprocess.Popen(
        [program(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8"
    ) as child:
        while True:
            try:
                _, said = child.communicate(timeout=0.5)
                break
            except subprocess.TimeoutExpired:
                if bar.tell is not None:
                    bar.tell(_results(folder), total)
            except KeyboardInterrupt:
                child.wait()
                raise
    if bar.tell is not None:
        bar.tell(_results(folder), total)
    if child.returncode not in (0, 1, 3):
        message = said.strip().removeprefix("octant: ")
        raise (InputError if child.returncode == 2 else BenchError)(message)


def _results(folder: Path) -> int:
    return sum(1 for _ in (folder / "cases").glob("*/*.json"))


def observe(
    scenario: PathLike,
    *,
    ensemble: bool = False,
    set: Mapping[str, Any] | None = None,
    **keys: Any,
) -> Any:
    """Predict observability and accuracy of a scenario's sequence, before anything is run.

    Parameters
    ----------
    scenario : path
        The scenario.
    ensemble : bool
        Predict the ensemble of the scenario's draws: sigma of every error, envelopes of the drift.
    set, **keys
        Changes, as for :func:`run`.

    Returns
    -------
    list or dict
        One entry for each method: rank, null space, states with sigma before, believed and achieved,
        drift (arcmin over hours). With ``ensemble`` what ``octant observe --ensemble --json`` prints.
    """
    changes = [word for change in overrides(set, keys) for word in ("--set", change)]
    more = ["--ensemble"] if ensemble else []
    return json.loads(_program("observe", scenario, "--json", *more, *changes))
