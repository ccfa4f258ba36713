"""Objects whose attributes are parameters, and their classes, made from what parameters say of themselves."""

from __future__ import annotations

import textwrap
from typing import Any

from . import _core


class Parameters:
    """Has parameters as attributes. Values are checked as in scene files; a wrong one raises weir.Error."""

    _core: _core.Scene
    _target: _core.Target
    _path: tuple[str, ...] = ()
    _parameters: dict[str, dict] = {}

    def _bind(self, core: _core.Scene, target: _core.Target, path: tuple[str, ...] = ()) -> None:
        for name, value in (("_core", core), ("_target", target), ("_path", path)):
            object.__setattr__(self, name, value)

    def set(self, **values: Any) -> None:
        """Set several parameters at once: all of them or, after an error, none."""
        for name in reversed(self._path):
            values = {name: values}
        self._core.assign(self._target, values)

    def get(self) -> dict[str, Any]:
        """All parameters that are not groups, by name."""
        return {name: self._get(name) for name, about in self._parameters.items() if about["kind"] != "group"}

    def _get(self, name: str) -> Any:
        return self._core.get(self._target, [*self._path, name])

    def __setattr__(self, name: str, value: Any) -> None:
        if isinstance(getattr(type(self), name, None), property):
            object.__setattr__(self, name, value)
        else:
            self.set(**{name: value})  # an error that suggests the nearest name

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value!r}" for name, value in self.get().items())
        return f"{type(self).__name__}({values})"


def range_text(about: dict) -> str:
    """ "above 0 to 1000" """
    low = f"above {about['above']:g}" if "above" in about else f"from {about['min']:g}" if "min" in about else ""
    if "max" in about:
        return f"{low} to {about['max']:g}" if low else f"at most {about['max']:g}"
    return low.replace("from", "at least")


def describe(about: dict) -> str:
    """What a parameter says of itself, in some lines."""
    facts = about["kind"] + (f" [{about['unit']}]" if "unit" in about else "")
    facts = ", ".join(filter(None, [facts, range_text(about)]))
    if about["kind"] != "group":
        facts += f", default {about['default']!r}"
    facts += ", may change during a run" if about["live"] else ""
    facts += ", may be keyframes" if about["animated"] else ""
    lines = [facts + ".", *textwrap.wrap(about["doc"], 96)]
    lines += [f"  {name!r}: {doc}" for name, doc in about.get("choices", {}).items()]
    return "\n".join(lines)


def describe_all(parameters: list[dict]) -> str:
    """The same of several, with their names."""
    return "\n".join(f"{about['name']}\n{textwrap.indent(describe(about), '    ')}" for about in parameters)


def _value_property(name: str, about: dict) -> property:
    def get(self: Parameters) -> Any:
        return self._get(name)

    def put(self: Parameters, value: Any) -> None:
        self.set(**{name: value})

    return property(get, put, doc=describe(about))


def _group_property(name: str, about: dict, owner: str) -> property:
    group = make_class(f"{owner}.{name}", (Parameters,), about["doc"], about["parameters"])

    def get(self: Parameters) -> Parameters:
        made = group()
        made._bind(self._core, self._target, (*self._path, name))
        return made

    def put(self: Parameters, values: dict) -> None:
        self.set(**{name: values})

    return property(get, put, doc=describe(about))


def make_class(name: str, bases: tuple[type, ...], doc: str, parameters: list[dict],
               members: dict[str, Any] | None = None) -> type:
    """A class with a property for each parameter; `members` are what it has beside them."""
    known = {about["name"]: about for about in parameters}
    body: dict[str, Any] = {"_parameters": known, "__module__": "weir"}
    for about in parameters:
        make = _group_property(about["name"], about, name) if about["kind"] == "group" else None
        body[about["name"]] = make or _value_property(about["name"], about)
    body.update(members or {})
    text = doc + ("\n\nParameters:\n\n" + describe_all(parameters) if parameters else "")
    return type(name, bases, {"__doc__": text, **body})
