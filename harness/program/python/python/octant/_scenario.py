"""Scenarios as objects."""

from __future__ import annotations

import difflib
import json
import os
from collections.abc import Iterator, Mapping, MutableMapping
from functools import cache
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

    Attributes are those of the program's schema: a table that isn't there yet is empty, and comes to be with
    its first key; a key that no scenario has is refused where it is set. Values are looked at by
    :meth:`Scenario.check`.
    """

    __slots__ = ("_keys", "_name", "_node", "_parent")

    def __init__(
        self,
        keys: dict[str, Any],
        node: Mapping[str, Any] | None = None,
        name: str = "",
        parent: Section | None = None,
    ) -> None:
        for slot, value in (("_keys", keys), ("_node", node), ("_name", name), ("_parent", parent)):
            object.__setattr__(self, slot, value)

    def __getitem__(self, key: str) -> Any:
        first, _, rest = key.partition(".")
        value = self._keys[first]
        if isinstance(value, dict):
            value = Section(value, self._inner(first), self._path(first))
        elif rest:
            raise KeyError(key)
        return value[rest] if rest else value

    def __setitem__(self, key: str, value: Any) -> None:
        first, _, rest = key.partition(".")
        self._known(first)
        if rest:
            at = self[first] if first in self._keys else self._empty(first)
            if not isinstance(at, Section):
                raise InputError(f"{self._path(first)} is {at!r}, a table is needed for {self._path(key)}")
            if not _is_table(self._inner(first)):
                raise InputError(f"{self._path(first)} takes a value, not the key {self._path(key)}")
            at[rest] = value
            return
        self._attach()
        self._keys[first] = _plain(value)

    def __delitem__(self, key: str) -> None:
        first, _, rest = key.partition(".")
        if rest:
            at = self[first]
            if not isinstance(at, Section):
                raise KeyError(key)
            del at[rest]
        else:
            del self._keys[first]

    def __iter__(self) -> Iterator[str]:
        return iter(self._keys)

    def __len__(self) -> int:
        return len(self._keys)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._keys:
            return self[name]
        node = self._inner(name)
        if node is not None and "properties" in node:
            return self._empty(name)
        if node is not None:
            left_out = f": by default it is {node['default']!r}" if "default" in node else ""
            raise AttributeError(f"the scenario has no {self._path(name)}{left_out}")
        raise AttributeError(self._unknown(name))

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value

    def __delattr__(self, name: str) -> None:
        if name not in self._keys:
            raise AttributeError(f"the scenario has no {self._path(name)}")
        del self[name]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._keys, *self._properties()})

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._keys!r})"

    # Copies and pickles hold the keys; what else is here is set past __setattr__.
    def __reduce__(self) -> tuple[Any, ...]:
        return Section, (_plain(self._keys), self._node, self._name)

    def describe(self, key: str = "") -> str:
        """Meaning of a key, what it takes, and its default, in a line; of the table itself without a key.

        Raises
        ------
        InputError
            If there is no such key.
        """
        node = self._node
        name = self._name
        for part in key.split(".") if key else []:
            table = Section({}, node, name)
            table._known(part)
            if not _is_table(node):
                raise InputError(f"{name} takes a value, and has no key {part}")
            node, name = table._inner(part), table._path(part)
        if node is None:
            return f"{name}: free"
        default = f" Default: {json.dumps(node['default'], ensure_ascii=False)}." if "default" in node else ""
        return f"{name or 'scenario'}: {node.get('description', node.get('title', ''))}{default}"

    def _path(self, name: str) -> str:
        return f"{self._name}.{name}" if self._name else name

    def _properties(self) -> Mapping[str, Any]:
        return (self._node or {}).get("properties", {})

    def _inner(self, name: str) -> Mapping[str, Any] | None:
        return self._properties().get(name)

    def _empty(self, name: str) -> Section:
        """A table that comes to be with its first key."""
        return Section({}, self._inner(name), self._path(name), self)

    def _attach(self) -> None:
        """Put a table that was empty into the one around it."""
        parent = self._parent
        if parent is not None:
            parent._attach()
            # Another one of this name may have been first.
            keys = parent._keys.setdefault(self._name.rpartition(".")[2], self._keys)
            object.__setattr__(self, "_keys", keys)
            object.__setattr__(self, "_parent", None)

    def _known(self, name: str) -> None:
        """Refuse a key that the schema doesn't have, where it has any."""
        if self._node is not None and "properties" in self._node and name not in self._properties():
            raise InputError(self._unknown(name))

    def _unknown(self, name: str) -> str:
        known = sorted(self._properties())
        near = difflib.get_close_matches(name, known, n=1)
        meant = f"did you mean {self._path(near[0])}? " if near else ""
        return f"no scenario has the key {self._path(name)}: {meant}{self._name or 'it'} takes {', '.join(known)}"


def _is_table(node: Mapping[str, Any] | None) -> bool:
    """Whether a key of this schema may be a table; the schema says nothing of keys that are free."""
    if node is None or "properties" in node or node.get("type") == "object":
        return True
    return any(_is_table(one) for word in ("anyOf", "oneOf") for one in node.get(word, ()))


def _plain(value: Any) -> Any:
    """Copy sections into dictionaries."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value


@cache
def _schema() -> dict[str, Any]:
    """JSON Schema of scenarios."""
    return json.loads(schema())


class Scenario(Section):
    """A scenario: what ``octant run`` reads from a TOML file.

    Tables and keys are those of the file (docs/scenario.md), as attributes or by dotted name::

        scenario = octant.Scenario.load("quick.toml")
        scenario.procedure.calibration.duration = "12 h"
        scenario["imu.angle_random_walk"] = "0.0001 deg/sqrt(h)"
        scenario.describe("imu.angle_random_walk")
        scenario.check()

    Quantities are text with a unit. Comments of the file aren't kept. Type checkers and editors know every key:
    the types are written from the program's schema.

    Parameters
    ----------
    keys : mapping, optional
        Tables and keys.
    path : path
        File of the scenario: relative names of files in it start at its folder.
    """

    __slots__ = ("_file",)

    def __init__(self, keys: Mapping[str, Any] | None = None, path: PathLike = "scenario.toml") -> None:
        super().__init__({"schema": 1, **_plain(keys or {})}, _schema())
        object.__setattr__(self, "_file", Path(path))

    def __reduce__(self) -> tuple[Any, ...]:
        return Scenario, (_plain(self._keys), self._file)

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
        return Scenario(self._keys, self._file)

    @staticmethod
    def schema() -> dict[str, Any]:
        """JSON Schema of scenarios."""
        return json.loads(schema())  # A copy of its own.


def settings(scenario: PathLike | Scenario) -> dict[str, Any]:
    """The settings of a request that name its scenario."""
    if isinstance(scenario, Scenario):
        return {"scenario": scenario._file, "text": scenario.to_toml()}
    return {"scenario": Path(scenario)}
