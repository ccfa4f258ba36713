"""Scenes: what a scene file says, as objects."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any, TypeVar, overload

from . import _core, _nodes, _ply
from ._arrays import mesh_arrays, particle_arrays
from ._errors import usage_error
from ._library import library
from ._node import Node
from ._parameters import Parameters, make_class

N = TypeVar("N", bound=_nodes.NodeHandle)
P = TypeVar("P", bound=Node)


ClassType = type  # which a parameter of add() hides


class Section(Parameters):
    """A section of a scene, such as world and render, with its parameters as attributes."""


def keyframes(*points: tuple[float, Any]) -> dict[str, list]:
    """Values over time for a parameter that may be keyframes: pairs of a time in s, increasing, and a value.

    Linear between them, and held at the ends.
    """
    return {"keyframes": [list(point) for point in points]}


_section_classes: dict[str, type[Section]] = {}


def _section_class(name: str) -> type[Section]:
    if name not in _section_classes:
        about = library.types()["sections"][name]
        _section_classes[name] = make_class(name, (Section,), about["doc"], about["parameters"])
    return _section_classes[name]


class Scene:
    """A graph of nodes, and what they share.

        scene = weir.Scene("A dam breaks")
        block = scene.add("BoxSampler", "block", max=(0.5, 0.5, 0.5))
        water = scene.add("ParticleFluid", "water", spacing=0.02)
        block.particles >> water.initial

    Nodes are found by their names, as `scene.water` or `scene["water"]`, and so are the sections `scene.world`
    and, with the plugin that draws pictures, `scene.render`.
    """

    def __init__(self, title: str = ""):
        self._core = _core.Scene(library)
        self._core.title = title

    @classmethod
    def _of(cls, core: _core.Scene) -> Scene:
        made = cls.__new__(cls)
        made._core = core
        return made

    @property
    def title(self) -> str:
        """Shown in videos."""
        return self._core.title

    @title.setter
    def title(self, text: str) -> None:
        self._core.title = text

    @property
    def world(self) -> Section:
        """What all nodes share: gravity, time step, frame rate, duration."""
        return self._section("world")

    def _section(self, name: str) -> Section:
        made = _section_class(name)()
        made._bind(self._core, _core.Target("world") if name == "world" else _core.Target("section", name))
        return made

    @overload
    def add(self, type: type[N], name: str, **params: Any) -> N: ...
    @overload
    def add(self, type: type[P] | P, name: str, **params: Any) -> P: ...
    @overload
    def add(self, type: str, name: str, **params: Any) -> Any: ...
    def add(self, type, name, **params):
        """Add a node of a type, with values of its parameters. The type is given by its name or as a class of
        weir.nodes; of nodes in Python, as a class that derives from weir.Node, or an object of it."""
        if isinstance(type, ClassType):
            type = type() if issubclass(type, Node) else type.__name__
        if isinstance(type, Node):
            type._check_made()
        self._core.add_node(type, name, params)
        return self[name]

    def add_particles(self, name: str, positions: Any, velocities: Any = None,
                      attributes: Mapping[str, Any] | None = None, **params: Any) -> Any:
        """Add particles from arrays, as a ParticleFile that needs no file:

            block = scene.add_particles("block", positions, velocities, {"heat": heat})
            block.particles >> water.initial

        `positions` (n, 3) in m and `velocities` (n, 3) or (3,) in m/s are arrays of NumPy, PyTorch or the like. The
        fluid gets the `attributes`, (n,) or (n, 3) numbers by name; integers stay integers. All are copied and must be
        finite. `params` are those of ParticleFile, such as position, which moves the particles.
        """
        self._core.add_node("ParticleFile", name, params, particle_arrays(positions, velocities, attributes))
        return self[name]

    def add_mesh(self, name: str, vertices: Any, faces: Any, **params: Any) -> Any:
        """Add a triangle mesh from arrays, as a MeshFile that needs no file:

            hull = scene.add_mesh("hull", vertices, faces)
            hull.surface >> solid.solids

        `vertices` (n, 3) in m and `faces` (m, 3), indices of vertices that are counter-clockwise seen from outside, are
        arrays of NumPy, PyTorch or the like, and are copied. `params` are those of MeshFile, such as position.
        """
        self._core.add_node("MeshFile", name, params, mesh_arrays(vertices, faces))
        return self[name]

    def link(self, output: _nodes.Port | str, input: _nodes.Port | str) -> None:
        """Link an output to an input: ports, or texts such as "tank.boundary"."""
        _nodes.link(self._core, output, input)

    @property
    def links(self) -> list[str]:
        """All links, as texts "tank.boundary -> water.boundaries"."""
        return self._core.links()

    @property
    def nodes(self) -> dict[str, Any]:
        """All nodes by name, in the order in which they were added."""
        return {name: self[name] for name, _ in self._core.nodes()}

    def __getitem__(self, name: str) -> Any:
        return _nodes.node_named(self._core, name)

    def __contains__(self, name: object) -> bool:
        return name in dict(self._core.nodes())

    def __iter__(self) -> Iterator[str]:
        return iter(dict(self._core.nodes()))

    def __len__(self) -> int:
        return len(self._core.nodes())

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._core.sections():
            return self._section(name)
        if name in self:
            return self[name]
        raise AttributeError(f"the scene has no node or section '{name}'; it has {', '.join([*self, 'world', *self._core.sections()])}")

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_") or name == "title":
            object.__setattr__(self, name, value)
        else:
            raise AttributeError(f"'{name}' cannot be set; nodes are added by scene.add(type, name)")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self, *self._core.sections()]

    def validate(self) -> None:
        """Check what can only be checked when all is there, as a simulation does: required inputs."""
        self._core.validate()

    def to_json(self) -> str:
        """The text of a scene file. Only what differs from the defaults is written. Raises an Error if nodes were given
        arrays, which save() writes beside the file."""
        return self._core.to_json("")

    def save(self, path: str | os.PathLike) -> None:
        """Write a scene file, which `weir run` and weir.load() read.

        Arrays that nodes were given are written beside it, as PLY files named after the scene and the node.
        """
        path = os.fspath(path)
        folder, stem = os.path.dirname(os.path.abspath(path)), os.path.splitext(os.path.basename(path))[0]
        files = {node: f"{stem}.{node}.ply" for node in self._core.nodes_with_arrays()}
        text = self._core.to_json(folder, files)
        for node, name in files.items():
            arrays = self._core.given(node)
            write = _ply.write_mesh if "faces" in arrays else _ply.write_particles
            write(os.path.join(folder, name), **arrays)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def copy(self) -> Scene:
        """Another scene that says the same, at time 0. Modules and nodes that are written in Python must be
        registered."""
        given = {node: self._core.given(node) for node in self._core.nodes_with_arrays()}
        made = Scene._of(_core.Scene.parse(library, self._core.to_json("/", {node: node for node in given}), "", "/", []))
        for node, arrays in given.items():
            made._core.give(node, arrays)  # in place of the file
        return made

    def __repr__(self) -> str:
        return f"<Scene {self.title!r}: " + ", ".join(f"{name} ({type})" for name, type in self._core.nodes()) + ">"


def load(path: str | os.PathLike, set: dict[str, Any] | None = None) -> Scene:
    """Read a scene file.

    `set` changes parameters before the scene is built: {"water.spacing": 0.02}, as --set does.
    """
    return Scene._of(_core.Scene.load(library, os.fspath(path), _changes(set)))


def loads(text: str, folder: str | os.PathLike = ".", set: dict[str, Any] | None = None) -> Scene:
    """The same from the text of a scene file. Relative paths in it are relative to `folder`."""
    return Scene._of(_core.Scene.parse(library, text, "", os.path.abspath(os.fspath(folder)), _changes(set)))


def _changes(set: dict[str, Any] | None) -> list[str]:
    import json

    return [f"{name}={json.dumps(value)}" for name, value in (set or {}).items()]


def as_scene(scene: Scene | str | os.PathLike) -> Scene:
    """A scene, or the one that a path leads to."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, (str, os.PathLike)):
        return load(scene)
    raise usage_error(f"found a {type(scene).__name__} as a scene", "a weir.Scene, or the path of a scene file")
