"""Folders of evidence: runs, campaigns, nights and their history."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import Any, Union

from ._octant import InputError, RawRecording, Table, read_calibration, read_parquet

PathLike = Union[str, "os.PathLike[str]"]


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"failed to read {path}: {error.strerror}") from None
    except ValueError as error:
        raise InputError(f"failed to read {path}: {error}") from None


class Method:
    """One method of a run: the scenario's own, or its baseline.

    The recording is read when the first of its tables is asked for.

    Attributes
    ----------
    path : pathlib.Path
        Folder of the run.
    """

    def __init__(self, path: Path, recording: str, calibration: str) -> None:
        self.path = path
        self._names = (recording, calibration)

    @cached_property
    def _recording(self) -> RawRecording:
        path = self.path / self._names[0]
        if not path.is_file():
            raise InputError(f"{self.path} has no {self._names[0]}")
        return RawRecording(path)

    @cached_property
    def samples(self) -> Table:
        """Samples that reached the core.

        Increments over the interval that ends at ``time``: ``delta_theta_x`` to ``_z`` (rad, body axes)
        and ``delta_velocity_x`` to ``_z`` (m/s), exact; gimbal angles (deg); ``status`` (bits). They are
        on the recording's grid, 1 Hz by default; all of them with ``record.samples = "full"``.
        """
        return self._recording.table("samples")

    @cached_property
    def aiding(self) -> Table:
        """References that reached the core: velocity (m/s, north, east, down) or position (deg, m)."""
        return self._recording.table("aiding")

    @cached_property
    def navigation(self) -> Table:
        """Answers of the core.

        Position (deg, m), velocity over ground (m/s), attitude ``q_nb`` (takes a vector in body axes
        into north-east-down), mode, stop, commanded gimbal angles (deg), ``health`` (bits).
        """
        return self._recording.table("navigation")

    @cached_property
    def truth(self) -> Table:
        """True position, velocity, attitude and gimbal angles, where the source knows them."""
        return self._recording.table("truth")

    @cached_property
    def errors(self) -> Table:
        """Errors of the navigation solution, navigation minus truth, at each recorded truth.

        ``latitude`` and ``longitude`` (arcmin), ``north``, ``east`` and ``height`` (m), velocity (m/s),
        and the attitude error phi about north, east and down (arcmin):
        ``c_nb(computed) = (I - [phi x]) c_nb(true)``.
        """
        return self._recording.table("errors")

    @cached_property
    def parameters(self) -> Table:
        """Estimated error parameters of the sensors over time, in deg/h, ppm, arcsec, deg/h/g and ug."""
        return self._recording.table("parameters")

    @cached_property
    def sigma(self) -> Table:
        """Standard deviations (1 sigma) of the parameters over time; NaN where not estimated."""
        return self._recording.table("sigma")

    @cached_property
    def innovations(self) -> Table:
        """Normalized innovation squared of the measurements (three axes, expected 3), and rejections."""
        return self._recording.table("innovations")

    @cached_property
    def events(self) -> Table:
        """Events of the recording, as JSON: changes of mode, onsets and ends of faults, receipts."""
        return self._recording.table("events")

    @cached_property
    def covariance(self) -> Table:
        """Covariance of the parameters at the end of the calibration, by rows, with their estimates.

        Raises
        ------
        InputError
            If the calibration was refused, or the run had none: then there is no calibration table.
        """
        path = self.path / self._names[1]
        if not path.is_file():
            raise InputError(f"{self.path} has no {self._names[1]}: no calibration was accepted")
        return read_calibration(path)

    @property
    def truncated(self) -> bool:
        """Whether the recording ends in the middle, as after a kill."""
        return self._recording.truncated


class Run(Method):
    """A run: the folder that ``octant run`` or :func:`octant.run` wrote.

    Attributes
    ----------
    path : pathlib.Path
        Folder of the run.
    """

    def __init__(self, path: PathLike) -> None:
        super().__init__(Path(path), "recording.mcap", "calibration.octcal")

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Content of ``summary.json``: scores, requirements, receipts of faults."""
        return _json(self.path / "summary.json")

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """Content of ``manifest.json``: program, host, hashes of the files."""
        return _json(self.path / "manifest.json")

    @property
    def verdict(self) -> str:
        """Verdict: ``"pass"``, ``"fail"``, ``"inconclusive"`` or ``"error"``.

        Raises
        ------
        InputError
            If the run goes on or was killed: a folder without its manifest has no verdict.
        """
        if not (self.path / "manifest.json").is_file():
            raise InputError(f"{self.path} has no manifest.json: the run hasn't ended, and has no verdict")
        return self.summary["verdict"]

    @property
    def _shown_verdict(self) -> str:
        return self.verdict if (self.path / "manifest.json").is_file() else "not ended"

    @property
    def reasons(self) -> list[str]:
        """Reasons of the verdict besides requirements."""
        return self.summary["reasons"]

    @property
    def requirements(self) -> list[dict[str, Any]]:
        """Requirements with value, limit, margin and verdict."""
        return self.summary["requirements"]

    @property
    def faults(self) -> list[dict[str, Any]]:
        """Receipts of the faults: what each altered, and when."""
        return self.summary["faults"]

    @property
    def stream_hash(self) -> str:
        """BLAKE3 of the core's input and output at full rate: equal hashes are the same run."""
        return self.summary["stream_hash"]

    @cached_property
    def scenario(self) -> str:
        """The resolved scenario, TOML."""
        return (self.path / "scenario.toml").read_text(encoding="utf-8")

    @cached_property
    def baseline(self) -> Method | None:
        """The second method of the scenario, where it has a ``[baseline]``."""
        if not (self.path / "baseline.mcap").is_file():
            return None
        return Method(self.path, "baseline.mcap", "baseline.octcal")

    @property
    def report(self) -> Path:
        """File of the report."""
        return self.path / "report.html"

    def __repr__(self) -> str:
        return f"Run({str(self.path)!r}, verdict={self._shown_verdict!r})"

    def _repr_html_(self) -> str:
        from html import escape

        rows = "".join(
            f"<tr><td>{escape(row['id'])}</td><td>{escape(row['measure'])}</td><td>{row['value']}</td>"
            f"<td>{escape(row['comparison'])} {row['limit']}</td><td>{escape(row['verdict'])}</td></tr>"
            for row in self.requirements
        )
        head = "<tr><th>requirement</th><th>measure</th><th>value</th><th>limit</th><th>verdict</th></tr>"
        return f"<p>{escape(str(self.path))}: <b>{escape(self._shown_verdict)}</b></p><table>{head}{rows}</table>"


class Campaign:
    """A campaign: the folder of its plan and results.

    Attributes
    ----------
    path : pathlib.Path
        Folder of the campaign.
    """

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)

    def _table(self, name: str) -> Table:
        path = self.path / f"{name}.parquet"
        if not path.is_file():
            raise InputError(
                f"{self.path} has no {name}.parquet: expected a merged campaign, "
                f"as after octant campaign merge {self.path}"
            )
        return read_parquet(path)

    @cached_property
    def plan(self) -> dict[str, Any]:
        """Content of ``plan.json``: cases with seeds, factors and faults."""
        return _json(self.path / "plan.json")

    @cached_property
    def cases(self) -> Table:
        """One row for each case: verdict, factors, faults, and every number of its summary by path."""
        return self._table("cases")

    @cached_property
    def checks(self) -> Table:
        """One row for each requirement that a case checked."""
        return self._table("checks")

    @cached_property
    def drift(self) -> Table:
        """Drift of each case: ``hours``, latitude and longitude error (arcmin)."""
        return self._table("drift")

    @cached_property
    def statistics(self) -> dict[str, Any]:
        """Content of ``statistics.json``, which ``octant campaign report`` writes."""
        return _json(self.path / "statistics.json")

    def __repr__(self) -> str:
        return f"Campaign({str(self.path)!r})"


class Night:
    """One night of the nightly regression: a folder in ``nights`` of its history.

    Attributes
    ----------
    path : pathlib.Path
        Folder of the night.
    """

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)

    @cached_property
    def night(self) -> dict[str, Any]:
        """Content of ``night.json``: program, host, campaigns, suite."""
        return _json(self.path / "night.json")

    @cached_property
    def result(self) -> dict[str, Any]:
        """Content of ``nightly.json``: the comparison with the baseline."""
        return _json(self.path / "nightly.json")

    @property
    def verdict(self) -> str:
        """Verdict of the night."""
        return self.result["verdict"]

    @cached_property
    def campaigns(self) -> dict[str, Campaign]:
        """Campaigns of the night by name."""
        folders = sorted(path.parent for path in self.path.glob("*/plan.json"))
        return {folder.name: Campaign(folder) for folder in folders}

    def __repr__(self) -> str:
        return f"Night({str(self.path)!r})"


class History:
    """History of the nightly regression.

    Attributes
    ----------
    path : pathlib.Path
        Folder of the history.
    """

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)

    @cached_property
    def table(self) -> Table:
        """``history.parquet``: a row for each night, scenario and measure."""
        return read_parquet(self.path / "history.parquet")

    @cached_property
    def nights(self) -> dict[str, Night]:
        """Nights whose folders are still there, in the order of their names."""
        folders = sorted(path.parent for path in self.path.glob("nights/*/night.json"))
        return {folder.name: Night(folder) for folder in folders}

    def __repr__(self) -> str:
        return f"History({str(self.path)!r})"


_KINDS = (
    ("summary.json", Run),
    ("recording.mcap", Run),
    ("night.json", Night),
    ("history.parquet", History),
    ("plan.json", Campaign),
    ("cases.parquet", Campaign),
)


def open(path: PathLike) -> Run | Campaign | Night | History:
    """Open a folder of evidence.

    Parameters
    ----------
    path : path
        Folder of a run, a campaign, a night or a history of nights. Files are read when something
        is asked of them.

    Returns
    -------
    Run, Campaign, Night or History

    Raises
    ------
    InputError
        If the folder is none of them.

    Examples
    --------
    >>> run = octant.open("runs/quick")
    >>> abs(run.errors["longitude"]).max()
    """
    folder = Path(path)
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder: expected that of a run, a campaign or a night")
    for name, kind in _KINDS:
        if (folder / name).is_file():
            return kind(folder)
    names = ", ".join(name for name, _ in _KINDS)
    raise InputError(f"{folder} holds no evidence: expected one of {names} in it")
