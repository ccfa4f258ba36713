"""PLY files of the arrays that nodes were given, binary and exact, as ParticleFile and MeshFile read them."""

from __future__ import annotations

import os
from typing import Any

_HEAD = "ply\nformat binary_little_endian 1.0\ncomment made by Weir, lengths in metres\n"
_COMPONENTS = {1: ("",), 3: ("_x", "_y", "_z")}


def _write(path: str | os.PathLike, header: str, *tables: Any) -> None:
    with open(path, "wb") as file:
        file.write((_HEAD + header + "end_header\n").encode())
        for table in tables:
            file.write(table.tobytes())


def _table(columns: list[tuple[str, Any]]) -> tuple[Any, str]:
    """The rows of a table, and the properties of a header that say what its columns are."""
    import numpy

    kinds = [(name, "<i4" if values.dtype.kind == "i" else "<f4") for name, values in columns]
    rows = numpy.empty(len(columns[0][1]), kinds)
    for name, values in columns:
        rows[name] = values
    return rows, "".join(f"property {'int' if kind == '<i4' else 'float'} {name}\n" for name, kind in kinds)


def write_particles(path: str | os.PathLike, positions: Any, velocities: Any, attributes: dict[str, Any]) -> None:
    columns = [(axis, positions[:, i]) for i, axis in enumerate("xyz")]
    columns += [("v" + axis, velocities[:, i]) for i, axis in enumerate("xyz")]
    for name, values in attributes.items():
        flat = values.reshape(len(values), -1)
        columns += [(name + ending, flat[:, i]) for i, ending in enumerate(_COMPONENTS[flat.shape[1]])]
    rows, properties = _table(columns)
    _write(path, f"element vertex {len(rows)}\n{properties}", rows)


def write_mesh(path: str | os.PathLike, vertices: Any, faces: Any) -> None:
    import numpy

    rows, properties = _table([(axis, vertices[:, i]) for i, axis in enumerate("xyz")])
    triangles = numpy.empty(len(faces), [("corners", "u1"), ("indices", "<i4", 3)])
    triangles["corners"], triangles["indices"] = 3, faces
    header = f"element vertex {len(rows)}\n{properties}element face {len(faces)}\nproperty list uchar int vertex_indices\n"
    _write(path, header, rows, triangles)
