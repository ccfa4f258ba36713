"""Modules of a fluid that are written in Python."""

from __future__ import annotations

from . import _core
from ._part import Part


class Module(Part):
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

    def _begin(self, type: str, doc: str) -> None:
        self._begin_module(type, doc)

    @classmethod
    def _register(cls, library: _core.Library) -> None:
        library.register_module(cls)

    def _title(self) -> str:
        return f"the module {super()._title()}"

    @property
    def enabled(self) -> bool:
        """Whether it takes part in steps."""
        return self._enabled

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self._enabled = on

    def reset(self, fluid: _core.FluidStep) -> None:
        """Called before the first step: the place to add attributes."""

    def step(self, fluid: _core.FluidStep, dt: float) -> None:
        """Called in each step, of `dt` seconds."""
        raise NotImplementedError(f"{type(self).__name__} has no method step(self, fluid, dt)")
