"""Writes nodes.pyi and modules.pyi: the node and module types as editors and type checkers know them.

usage: make_type_stubs.py FOLDER        with the built package on PYTHONPATH, and nothing but NumPy
"""

import sys
import textwrap
from pathlib import Path

from weir._library import library
from weir._parameters import describe

HEAD = '''# Written by the build from what parameters say of themselves.
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from ._core import Particles
from ._nodes import ModuleHandle, Modules, NodeHandle, Port
from ._parameters import Parameters
from ._results import BodyMotion, Pose
'''

TYPES = {"bool": "bool", "int": "int", "float": "float", "string": "str", "path": "str | PathLike[str]",
         "vec2": "Sequence[float]", "vec3": "Sequence[float]", "color": "Sequence[float] | str",
         "rotation": "Sequence[float]", "curve": "Sequence[Sequence[float]]", "list": "Sequence[Any]",
         "group list": "Sequence[Mapping[str, Any]]"}

OWN_MEMBERS = {
    "ParticleFile": ["def set_particles(self, positions: Any, velocities: Any = None, "
                     "attributes: Mapping[str, Any] | None = None) -> None: ..."],
    "MeshFile": ["def set_mesh(self, vertices: Any, faces: Any) -> None: ..."],
    "RigidBody": ["def motion(self) -> BodyMotion: ...",
                  "def place(self, pose: Pose | None = None, velocity: Any = None, angular_velocity: Any = None) -> None: ..."]}


def type_of(about: dict) -> str:
    kind = f"Literal[{', '.join(map(repr, about['choices']))}]" if "choices" in about else TYPES.get(about["kind"], "Any")
    kind += " | Mapping[str, Any]" if about["animated"] else ""
    return kind + (" | None" if about.get("default", 0) is None else "")


def quoted(text: str) -> str:
    return '"""' + text.replace("\\", "\\\\").replace('"""', "'''") + ('"""' if not text.endswith('"') else ' """')


def members(parameters: list, prefix: str) -> tuple[list[str], list[str]]:
    """The lines of a class's members, and those of the classes of its groups."""
    lines, groups = [], []
    for about in parameters:
        kind = f"_{prefix}_{about['name']}" if about["kind"] == "group" else type_of(about)
        if about["kind"] == "group":
            groups += class_lines(kind, "Parameters", about["doc"], about["parameters"], [])
        lines += [f"{about['name']}: {kind}", quoted(describe(about))]
    return lines, groups


def class_lines(name: str, base: str, doc: str, parameters: list, more: list[str]) -> list[str]:
    lines, groups = members(parameters, name.lstrip("_"))
    body = "\n".join([quoted(doc), *lines, *more])
    return [*groups, f"class {name}({base}):", textwrap.indent(body, "    "), ""]


def ports(about: dict) -> list[str]:
    lines = []
    for port in about["inputs"] + about["outputs"]:
        lines += [f"{port['name']}: Port", quoted(port["doc"])]
    if "modules" in about:
        lines.append("modules: Modules")
    if any(port["type"] == "Particles" for port in about["outputs"]):
        lines += ["particles: Particles", "positions: Any", "velocities: Any", "ids: Any", "count: int",
                  'def sample(self, points: Any, attribute: str = "") -> Any: ...',
                  "def neighbors(self) -> tuple[Any, Any]: ..."]
    if about["moves"]:
        lines.append("def pose(self, time: float | None = None) -> Pose: ...")
    return lines


def main(folder: Path) -> None:
    types = library.types()
    nodes, modules = [HEAD], [HEAD]
    for name, about in types["nodes"].items():
        nodes += class_lines(name, "NodeHandle", about["doc"], about["parameters"], ports(about) + OWN_MEMBERS.get(name, []))
    for name, about in types["modules"].items():
        modules += class_lines(name, "ModuleHandle", about["doc"], about["parameters"], [])
    (folder / "nodes.pyi").write_text("\n".join(nodes), encoding="utf-8")
    (folder / "modules.pyi").write_text("\n".join(modules), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
