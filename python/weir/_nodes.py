"""Nodes, ports and modules of a scene, with classes made from what their types say of themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from . import _core
from ._arrays import floats, mesh_arrays, numbers, particle_arrays
from ._errors import usage_error
from ._library import library
from ._module import Module
from ._parameters import Parameters, make_class
from ._results import BodyMotion, Pose, Walls, as_motion, as_pose, as_result


class Port:
    """Where nodes are linked: `tank.boundary >> water.boundaries`."""

    def __init__(self, node: Any, about: dict, is_output: bool):
        self.node, self.name, self.type, self.is_output = node, about["name"], about["type"], is_output
        self._many = about.get("many", False)
        self.__doc__ = about["doc"]

    @property
    def path(self) -> str:
        """ "water.boundaries" """
        return f"{self.node.name}.{self.name}"

    @property
    def value(self) -> Any:
        """What an output holds: a weir.Mesh, weir.Particles, weir.ParticleArrays, weir.Walls, or for each solid a
        weir.SolidForce. What an input gets: that of the output that is linked to it, None without one, or a list if it
        takes many.

        Of particles it is a view, of the others a copy. A fluid's surface is that of the last frame, or of the last
        refresh() of the simulation. Needs an open simulation.
        """
        if not self.is_output:
            values = [output.value for output in self.links]
            return values if self._many else values[0] if values else None
        core, node = self.node._core, self.node.name
        if self.type == "Particles":
            core.particles(node).count  # an Error where there are none yet
            return core.particles(node)
        if self.type == "Boundary":
            return Walls(core.walls(node, self.name))
        return as_result(self.type, core.output(node, self.name))

    @property
    def links(self) -> list[Port]:
        """The ports at the other ends of its links; their `node` has more than the value, such as a pose."""
        ends = [text.split(" -> ") for text in self.node._core.links()]
        here, there = (0, 1) if self.is_output else (1, 0)
        found = [_port_named(self.node._core, end[there]) for end in ends if end[here] == self.path]
        return sorted(found, key=lambda port: port.node.name)  # the order in which an input reads them

    @property
    def spacing(self) -> float | None:
        """Of an output of a node in Python: the distance of particles that the fluid below asks for, m; None without."""
        return _core.spacing_of(self._own(), self.name)

    def set_particles(self, positions: Any, velocities: Any = None, attributes: Mapping[str, Any] | None = None) -> None:
        """Give particles out, in reset() or step() of a node in Python: the arrays are as in Scene.add_particles, and
        there may be none."""
        _core.put(self._own(), self.name, particle_arrays(positions, velocities, attributes, least=0))

    def _own(self) -> _core.PartBase:
        if not self.is_output or not isinstance(self.node, _core.PartBase):
            raise usage_error(f"'{self.path}' is no output of a node in Python", "a weir.Output", f"node '{self.node.name}'")
        return self.node

    def __rshift__(self, other: Port) -> Any:
        """Link this output to an input; gives the node of the input."""
        if not isinstance(other, Port):
            return NotImplemented
        link(self.node._core, self, other)
        return other.node

    def __repr__(self) -> str:
        return f"<{'output' if self.is_output else 'input'} {self.path}: {self.type}>"


def _port_named(core: _core.Scene, path: str) -> Port:
    node, name = path.rsplit(".", 1)
    return getattr(node_named(core, node), name)


def node_named(core: _core.Scene, name: str) -> Any:
    """The node of that name: of one in Python its object, otherwise a NodeHandle."""
    own = core.node_object(name)  # an Error that suggests the nearest name
    if own is not None:
        return own
    found = node_class(dict(core.nodes())[name])()
    found._bind(core, _core.Target("node", name))
    object.__setattr__(found, "_name", name)
    return found


def link(core: _core.Scene, output: Port | str, input: Port | str) -> None:
    """Link an output to an input, given as ports or as texts such as "tank.boundary"."""
    for end in (output, input):
        if isinstance(end, Port) and end.node._core is not core:
            raise usage_error(f"'{end.path}' is of another scene", "ports of nodes of one scene")
    texts = [end.path if isinstance(end, Port) else end for end in (output, input)]
    core.link(" -> ".join(texts))


class ModuleHandle(Parameters):
    """A module of a node, with its parameters as attributes."""

    _name: str
    _node: str

    @property
    def name(self) -> str:
        """Its name in the pipeline."""
        return self._name

    @property
    def enabled(self) -> bool:
        """Whether it takes part in steps."""
        return self._core.module_enabled(self._node, self._name)

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self._core.enable_module(self._node, self._name, on)


class Modules(Mapping):
    """The modules of a node in their order, by name."""

    def __init__(self, core: _core.Scene, node: str):
        self._core, self._node = core, node

    def _types(self) -> dict[str, str]:
        return dict(self._core.modules(self._node))

    def __getitem__(self, name: str) -> ModuleHandle | Module:
        own = self._core.module_object(self._node, name)  # an Error that suggests the nearest name
        if own is not None:
            return own
        handle = module_class(self._types()[name])()
        handle._bind(self._core, _core.Target("module", self._node, name))
        object.__setattr__(handle, "_node", self._node)
        object.__setattr__(handle, "_name", name)
        return handle

    def __iter__(self) -> Iterator[str]:
        return iter(self._types())

    def __len__(self) -> int:
        return len(self._types())

    def __contains__(self, name: object) -> bool:
        return name in self._types()

    def insert(self, name: str, module: Module | str | type, *, before: str | None = None, after: str | None = None,
               **params: Any) -> ModuleHandle | Module:
        """Insert a module before or after another one.

        `module` is an object of a class that derives from weir.Module, such a class, or the name of a type.
        """
        if (before is None) == (after is None):
            raise usage_error("found both before and after" if before else "found neither before nor after",
                              f"one of them, with the name of a module: {', '.join(self)}")
        neighbor = before if before is not None else after
        self[neighbor]  # an error for an unknown name
        index = list(self).index(neighbor) + (after is not None)
        return self._put(name, module, index, params)

    def replace(self, name: str, module: Module | str | type, **params: Any) -> ModuleHandle | Module:
        """Put another module in the place of the one of this name."""
        return self._put(name, module, None, params)

    def _put(self, name: str, module: Any, index: int | None, params: dict[str, Any]) -> ModuleHandle | Module:
        if isinstance(module, type):
            module = module() if issubclass(module, Module) else module.__name__
        if isinstance(module, Module):
            module._check_made()
        self._core.insert_module(self._node, module, name, index, params)
        return self[name]

    def __repr__(self) -> str:
        return "Modules(" + ", ".join(f"{name}: {type}" for name, type in self._types().items()) + ")"


class NodeHandle(Parameters):
    """A node of a scene, with its parameters and ports as attributes."""

    _name: str
    _type: str

    @property
    def name(self) -> str:
        """Its name in the scene."""
        return self._name

    @property
    def type(self) -> str:
        """The name of its type."""
        return self._type

    @property
    def values(self) -> dict[str, Any]:
        """The numbers that it measures and counts, as sim.statistics["nodes"] has them. Needs an open simulation."""
        return self._core.report(self._name)

    def _outputs(self) -> list[Port]:
        return []

    def __repr__(self) -> str:
        return f"<{self._type} {self._name!r}>"


def _port_property(about: dict, is_output: bool) -> property:
    kind = "output" if is_output else "input"
    return property(lambda self: Port(self, about, is_output), doc=f"The {kind} of type {about['type']}. {about['doc']}")


def _particles(self: NodeHandle) -> _core.Particles:
    return self._core.particles(self._name)


def _particle_member(name: str, doc: str) -> property:
    def put(self: NodeHandle, values: Any) -> None:
        setattr(_particles(self), name, values)

    return property(lambda self: getattr(_particles(self), name), put, doc=doc)


def _fluid_members() -> dict[str, property]:
    return {
        "particles": property(_particles, doc=_core.Particles.__doc__),
        "positions": _particle_member("positions", "Positions of the particles, m: (n, 3); see weir.Particles."),
        "velocities": _particle_member("velocities", "Velocities of the particles, m/s: (n, 3)."),
        "ids": _particle_member("ids", "A number that stays with each particle: (n,)."),
        "count": property(lambda self: _particles(self).count, doc="How many particles there are."),
    }


def _sample(self: NodeHandle, points: Any, attribute: str = "") -> Any:
    """An attribute of floats or vectors, such as "velocity", at points (n, 3) in space, m: the mean of the particles
    within two spacings, weighted as the node Gauge does it, and NaN where there are none.

    Without an attribute, the share of space that is filled: 1 within fluid, 1/2 at a flat surface.
    """
    return self._core.sampled(self._name, attribute, floats(points, "points", (None, 3), allowed="(n, 3)"))


def _neighbors(self: NodeHandle) -> tuple[Any, Any]:
    return _particles(self).neighbors()


_neighbors.__doc__ = _core.Particles.neighbors.__doc__


def _pose(self: NodeHandle, time: float | None = None) -> Pose:
    """Where its solids are, at the present time or another one, s. Needs an open simulation."""
    return as_pose(*self._core.pose(self._name, time))


def _motion(self: NodeHandle) -> BodyMotion:
    """Its velocities as they are now. Needs an open simulation."""
    return as_motion(*self._core.motion(self._name))


def _place(self: NodeHandle, pose: Pose | None = None, velocity: Any = None, angular_velocity: Any = None) -> None:
    """Put the body there, between steps; what is left out stays. `velocity` (m/s) is that of its centre of mass,
    `angular_velocity` is in rad/s; axes that are fixed keep 0. Water is pushed out of where it is put, so it must not be
    put far into it at once. Needs an open simulation."""
    present, motion = self.pose(), self.motion()
    to = present if pose is None else pose
    self._core.place(self._name, numbers(to.rotation, "rotation", 4), numbers(to.translation, "translation", 3),
                     numbers(motion.velocity if velocity is None else velocity, "velocity", 3),
                     numbers(motion.angular_velocity if angular_velocity is None else angular_velocity, "angular_velocity", 3))


def _set_particles(self: NodeHandle, positions: Any, velocities: Any = None, attributes: Mapping[str, Any] | None = None) -> None:
    """Take these particles in place of the present ones, from the next reset on; see Scene.add_particles."""
    self._core.give(self._name, particle_arrays(positions, velocities, attributes))


def _set_mesh(self: NodeHandle, vertices: Any, faces: Any) -> None:
    """Take this mesh in place of the present one, from the next reset on; see Scene.add_mesh."""
    self._core.give(self._name, mesh_arrays(vertices, faces))


# Of single types: those that take arrays, and bodies.
_OWN_MEMBERS: dict[str, dict[str, Any]] = {"ParticleFile": {"set_particles": _set_particles},
                                           "MeshFile": {"set_mesh": _set_mesh},
                                           "RigidBody": {"motion": _motion, "place": _place}}

_node_classes: dict[str, type[NodeHandle]] = {}
_module_classes: dict[str, type[ModuleHandle]] = {}


def _make_node_class(name: str, about: dict) -> type[NodeHandle]:
    members: dict[str, Any] = {}
    if any(port["type"] == "Particles" for port in about["outputs"]):
        members.update(_fluid_members())
        members.update(sample=_sample, neighbors=_neighbors)
    if about["moves"]:
        members["pose"] = _pose
    members.update(_OWN_MEMBERS.get(name, {}))
    if "modules" in about:
        members["modules"] = property(lambda self: Modules(self._core, self._name), doc="Its modules, by name.")
    for ports, is_output in ((about["inputs"], False), (about["outputs"], True)):
        members.update({port["name"]: _port_property(port, is_output) for port in ports})
    members["_outputs"] = lambda self: [Port(self, port, True) for port in about["outputs"]]
    members["_type"] = name
    return make_class(name, (NodeHandle,), about["doc"], about["parameters"], members)


def _known(classes: dict, kind: str) -> dict:
    """The classes of all types that are loaded; those of plugins come when they are loaded."""
    types = library.types()[kind]
    for name, about in types.items():
        if name not in classes:
            if kind == "nodes":
                classes[name] = _make_node_class(name, about)
            else:
                classes[name] = make_class(name, (ModuleHandle,), about["doc"], about["parameters"])
    return classes


def node_class(name: str) -> type[NodeHandle] | None:
    """The class of a node type; None if there is no such type."""
    return _node_classes.get(name) or _known(_node_classes, "nodes").get(name)


def module_class(name: str) -> type[ModuleHandle]:
    """The class of a module type."""
    return _module_classes.get(name) or _known(_module_classes, "modules").get(name, ModuleHandle)


def node_classes() -> dict[str, type[NodeHandle]]:
    """All of them, by name."""
    return _known(_node_classes, "nodes")


def module_classes() -> dict[str, type[ModuleHandle]]:
    """All of them, by name."""
    return _known(_module_classes, "modules")
