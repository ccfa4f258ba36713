"""Modules of a fluid that are written in Python."""

from __future__ import annotations

import inspect
import math
from typing import Any

from . import _core, _state
from ._errors import usage_error


class Param:
    """A parameter of a module, declared as a member of its class.

        rate = weir.Param(3.0, unit="1/s", min=0, doc="Angular frequency.")

    Its kind is that of the first value: bool, int, float, str, or two or three numbers. Values are checked like
    those of all parameters. With `above`, that value itself is refused too. With `animated`, a float or three
    numbers may be given as keyframes.
    """

    def __init__(self, default: Any, *, unit: str = "", doc: str = "", min: float = -math.inf, max: float = math.inf,
                 above: float | None = None, live: bool = True, animated: bool = False):
        self.default = default
        self.spec = {"unit": unit, "doc": doc, "min": min if above is None else above, "max": max,
                     "above": above is not None, "live": live, "animated": animated}
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, module: Module | None, owner: type | None = None) -> Any:
        return self if module is None else module._get(self.name)

    def __set__(self, module: Module, value: Any) -> None:
        module._assign({self.name: value})


class Module(_core.ModuleBase):
    """One algorithm in the pipeline of a fluid. Derive from it, and insert an object of it by name:

        class Lift(weir.Module):
            "Pushes the fluid up."
            strength = weir.Param(2.0, unit="m/s^2", doc="Acceleration.")

            def step(self, fluid, dt):
                fluid.velocities[:, 1] += self.strength * dt

        water.modules.insert("lift", Lift(strength=3), before="predict")

    What it keeps between steps is named in `state`, so that checkpoints hold it:

        state = ("count", "random")

    An exception that a method raises ends the step, and is raised by whoever asked for it.
    """

    state: tuple[str, ...] = ()
    """Attributes that checkpoints hold: numbers, strings, lists, tuples, dicts, NumPy's arrays and random generators.
    Those of the classes it derives from are added. A resumed run gets them back after reset()."""

    _made = False

    def __init__(self, **params: Any):
        super().__init__()
        self._made = True
        self._begin(type(self).__name__, inspect.cleandoc(type(self).__doc__ or ""))
        for name, param in self.declared().items():
            self._define(name, param.default, **param.spec)
        self._assign(params)

    @classmethod
    def declared(cls) -> dict[str, Param]:
        """Its parameters, those of the classes it derives from first."""
        found: dict[str, Param] = {}
        for base in reversed(cls.__mro__):
            found.update({name: member for name, member in vars(base).items() if isinstance(member, Param)})
        return found

    def reset(self, fluid: _core.FluidStep) -> None:
        """Called before the first step: the place to add attributes."""

    def step(self, fluid: _core.FluidStep, dt: float) -> None:
        """Called in each step, of `dt` seconds."""
        raise NotImplementedError(f"{type(self).__name__} has no method step(self, fluid, dt)")

    def save(self) -> Any:
        """What else a checkpoint shall hold, of the same kinds; None for nothing."""
        return None

    def restore(self, saved: Any) -> None:
        """Takes back what save() returned, when a run is resumed; after reset(), with `state` in place."""

    @classmethod
    def declared_state(cls) -> list[str]:
        """The names in `state` of the class and of those it derives from."""
        names: list[str] = []
        for base in reversed(cls.__mro__):
            own = vars(base).get("state", ())
            if isinstance(own, Param):
                continue
            if isinstance(own, str) or not all(isinstance(name, str) for name in own):
                raise TypeError(f"state of {base.__name__} is {own!r}, not a tuple of names of attributes")
            names += [name for name in own if name not in names]
        return names

    def _saved_state(self) -> bytes:
        kept = {}
        for name in self.declared_state():
            if not hasattr(self, name):
                raise AttributeError(f"state of {type(self).__name__} names {name!r}, which the module does not have")
            kept[name] = getattr(self, name)
        return _state.packed({"state": kept, "saved": self.save()}, type(self).__name__)

    def _restore_state(self, packed: bytes) -> None:
        kept = _state.unpacked(packed)
        found, declared = sorted(kept["state"]), sorted(self.declared_state())
        if found != declared:
            raise usage_error(f"the checkpoint holds the state {found} of {type(self).__name__}, which declares {declared}",
                              "a checkpoint of the same module")
        for name, value in kept["state"].items():
            setattr(self, name, value)
        if kept["saved"] is not None:
            self.restore(kept["saved"])

    def report(self) -> dict[str, Any] | None:
        """Numbers by name, for the statistics of the fluid's node."""
        return None
