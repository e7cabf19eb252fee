"""Scenarios as objects."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, MutableMapping
from pathlib import Path
from typing import Any, Union

from ._octant import InputError, check_scenario, json_to_toml, schema, toml_to_json

PathLike = Union[str, "os.PathLike[str]"]


def _value(value: Any) -> str:
    """Write a value as TOML, for KEY=VALUE."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if hasattr(value, "item") and getattr(value, "shape", None) == ():
        value = value.item()
    if isinstance(value, (int, float)):
        return repr(value)
    return json.dumps(value)


def overrides(changes: Mapping[str, Any] | None, keywords: Mapping[str, Any]) -> list[str]:
    """Changes of keys as KEY=VALUE.

    Keywords have two underscores for a dot: ``procedure__calibration__duration="12 h"``.
    """
    named = {name.replace("__", "."): value for name, value in keywords.items()}
    return [f"{key}={_value(value)}" for key, value in {**(changes or {}), **named}.items()]


class Section(MutableMapping[str, Any]):
    """A table of a scenario. Keys are attributes and items alike.

    A key that the scenario doesn't have yet can be set; the harness refuses it by name when the
    scenario is checked, if there is no such key.
    """

    __slots__ = ("_keys",)

    def __init__(self, keys: dict[str, Any]) -> None:
        object.__setattr__(self, "_keys", keys)

    def __getitem__(self, key: str) -> Any:
        at, name = self._at(key, make=False)
        value = at[name]
        return Section(value) if isinstance(value, dict) else value

    def __setitem__(self, key: str, value: Any) -> None:
        at, name = self._at(key, make=True)
        at[name] = _plain(value)

    def __delitem__(self, key: str) -> None:
        at, name = self._at(key, make=False)
        del at[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._keys)

    def __len__(self) -> int:
        return len(self._keys)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the scenario has no {name!r} here: it has {', '.join(self)}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._keys!r})"

    def _at(self, key: str, *, make: bool) -> tuple[dict[str, Any], str]:
        """Find the table of a dotted key, and its last name."""
        *path, name = key.split(".")
        at = self._keys
        for part in path:
            at = at.setdefault(part, {}) if make else at[part]
            if not isinstance(at, dict):
                raise KeyError(key)
        return at, name


def _plain(value: Any) -> Any:
    """Copy sections into dictionaries."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value


class Scenario(Section):
    """A scenario: what ``octant run`` reads from a TOML file.

    Tables and keys are those of the file (docs/scenario.md), as attributes or by dotted name::

        scenario = octant.Scenario.load("quick.toml")
        scenario.procedure.calibration.duration = "12 h"
        scenario["imu.angle_random_walk"] = "0.0001 deg/sqrt(h)"
        scenario.check()

    Quantities are text with a unit. Comments of the file aren't kept.

    Attributes
    ----------
    _path : pathlib.Path
        File of the scenario: relative names of files in it start at its folder.
    """

    __slots__ = ("_path",)

    def __init__(self, keys: Mapping[str, Any] | None = None, path: PathLike = "scenario.toml") -> None:
        super().__init__({"schema": 1, **_plain(keys or {})})
        object.__setattr__(self, "_path", Path(path))

    @classmethod
    def load(cls, path: PathLike) -> Scenario:
        """Read a TOML file.

        Raises
        ------
        InputError
            If the file can't be read, or isn't TOML. Keys are looked at by :meth:`check`.
        """
        try:
            text = Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"failed to read {path}: {error}") from None
        return cls.from_toml(text, path)

    @classmethod
    def from_toml(cls, text: str, path: PathLike = "scenario.toml") -> Scenario:
        """Read TOML; ``path`` is where relative names of files start."""
        try:
            keys = json.loads(toml_to_json(text))
        except ValueError as error:
            raise InputError(f"{path}: {error}") from None
        return cls(keys, path)

    def to_toml(self) -> str:
        """Write the scenario as TOML."""
        return json_to_toml(json.dumps(self._keys))

    def save(self, path: PathLike) -> None:
        """Write the scenario into a TOML file."""
        Path(path).write_text(self.to_toml(), encoding="utf-8")

    def check(self) -> Scenario:
        """Check every key and value, and return the scenario.

        Raises
        ------
        InputError
            With every problem: the key, what was found, what was expected.
        """
        check_scenario(settings(self))
        return self

    def copy(self) -> Scenario:
        """Return a copy that can be changed by itself."""
        return Scenario(self._keys, self._path)

    @staticmethod
    def schema() -> dict[str, Any]:
        """JSON Schema of scenarios."""
        return json.loads(schema())


def settings(scenario: PathLike | Scenario) -> dict[str, Any]:
    """The settings of a request that name its scenario."""
    if isinstance(scenario, Scenario):
        return {"scenario": scenario._path, "text": scenario.to_toml()}
    return {"scenario": Path(scenario)}
