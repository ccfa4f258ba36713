"""Nodes that are written in Python."""

from __future__ import annotations

from typing import Any

from . import _core
from ._nodes import Port
from ._part import Part, members_of


class Input:
    """An input of a node, declared as a member of its class.

        fluid = weir.Input("Particles", doc="What it measures.")

    Its type is that of the outputs that may be linked to it: Particles, ParticleBatch, TriangleMesh, DynamicMesh,
    SolidForces, Boundary and others; `help(weir.nodes.ParticleFluid)` has those of a node. Of an object it is a Port:
    `water.fluid >> probe.fluid` links it, `self.fluid.value` is what arrives there, and `self.fluid.links` are the
    outputs at the other end. With `many` there may be any number of links, and value is a list.
    """

    def __init__(self, type: str, *, doc: str = "", required: bool = True, many: bool = False):
        if not isinstance(type, str):
            raise TypeError(f"the type of an input is a text such as 'Particles', not {type!r}")
        self.type, self.required, self.many = type, required, many
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, node: Node | None, owner: type | None = None) -> Any:
        about = {"name": self.name, "type": self.type, "doc": self.__doc__, "many": self.many}
        return self if node is None else Port(node, about, False)

    def __set__(self, node: Node, value: Any) -> None:
        raise AttributeError(f"the input '{self.name}' cannot be set; it is linked: OUTPUT >> NODE.{self.name}")


class Output:
    """An output of a node: particles on their way into a fluid, as samplers and emitters give them.

        drops = weir.Output(doc="New drops.")

    Of an object it is a Port. `self.drops.set_particles(positions, velocities)` gives particles out: in reset() those
    that are there at first, in step() those that are born in this step. `self.drops.spacing` is the distance of particles
    that the fluid asks for.
    """

    def __init__(self, *, doc: str = ""):
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, node: Node | None, owner: type | None = None) -> Any:
        about = {"name": self.name, "type": "ParticleBatch", "doc": self.__doc__}
        return self if node is None else Port(node, about, True)

    def __set__(self, node: Node, value: Any) -> None:
        raise AttributeError(f"the output '{self.name}' cannot be set; self.{self.name}.set_particles(…) gives particles")


class Node(Part):
    """A node of a scene. Derive from it, and add the class, or an object of it, by name:

        class Top(weir.Node):
            "Measures how high the fluid reaches."
            fluid = weir.Input("Particles", doc="The fluid.")
            above = weir.Param(0.0, unit="m", doc="The level from which it counts.")

            def report(self):
                return {"height": self.fluid.value.positions[:, 1].max() - self.above}

        top = scene.add(Top, "top", above=0.1)
        water.fluid >> top.fluid

    What report() returns stands among the statistics and series of a run, and in `top.values`. Nodes are called in the
    order of the links: what stands above has made its step. What it keeps between steps is named in `state`, so that
    checkpoints hold it. An exception that a method raises ends the step, and is raised by whoever asked for it.
    """

    def __init__(self, **params: Any):
        super().__init__(**params)
        inputs, outputs = members_of(type(self), Input), members_of(type(self), Output)
        for name in [*inputs, *outputs]:
            if hasattr(Node, name):
                raise TypeError(f"the port '{name}' of {type(self).__name__} has the name of what every node has")
        for name, port in inputs.items():
            _core.add_input(self, name, port.type, port.__doc__, port.required, port.many)
        for name, port in outputs.items():
            _core.add_output(self, name, port.__doc__)

    def _begin(self, type: str, doc: str) -> None:
        self._begin_node(type, doc)

    @classmethod
    def _register(cls, library: _core.Library) -> None:
        library.register_node(cls)

    def _title(self) -> str:
        return f"the node {super()._title()}"

    @property
    def _core(self) -> _core.Scene:
        return _core.scene_of(self)

    def _outputs(self) -> list[Port]:
        return [getattr(self, name) for name in members_of(type(self), Output)]

    @property
    def type(self) -> str:
        """The name of its type."""
        return type(self).__name__

    @property
    def scene(self) -> Any:
        """The scene that it is in, with all other nodes. Parameters that may change during a run can be set in step()."""
        from ._scene import Scene

        return Scene._of(self._core)

    @property
    def time(self) -> float:
        """The time of the simulation, s: in step() that of its beginning."""
        return self._core.time()

    @property
    def values(self) -> dict[str, Any]:
        """What report() returns, as sim.statistics["nodes"] has it. Needs an open simulation."""
        return self._core.report(self.name)

    def reset(self) -> None:
        """Called at time 0, when the nodes above are there: the place to set what it keeps."""

    def step(self, dt: float) -> None:
        """Called in each step, of `dt` seconds, when the nodes above have made theirs."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}>"
