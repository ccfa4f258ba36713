"""Modules of a fluid that are written in Python."""

from __future__ import annotations

import inspect
import math
from typing import Any

from . import _core


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

    An exception that a method raises ends the step, and is raised by whoever asked for it.
    """

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

    def report(self) -> dict[str, Any] | None:
        """Numbers by name, for the statistics of the fluid's node."""
        return None
