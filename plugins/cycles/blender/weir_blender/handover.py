"""Reads what Weir hands over to Blender: a folder of frames, each a NumPy archive. Needs NumPy alone.

frame_00012.npz holds the array 'scene', the bytes of a JSON text, and the numbers that the text speaks of:

    particles0_positions  (n, 3) float32, m       of particles[0]
    particles0_values     (n,) float32            what colours them, where they are coloured
    particles0_velocities (n, 3) float32, m/s     where there is motion blur
    particles0_radii      (n,) float32, m         where they are not all the same; 0: not to be seen
    surface0_vertices     (n, 3) float32, m       of surfaces[0], if it is another mesh at each frame
    surface0_triangles    (n, 3) int32
    surface0_velocities   (n, 3) float32, m/s     where there is motion blur
    surface0_colors       (n, 3) float32          where it has the colours of particles
    surface0_foam         (n,) float32            how much of the area there is covered; a mean within 'foam_reach', m

A surface that keeps its shape names a file of its own, mesh_00000.npz, with 'vertices' and 'triangles'. Surroundings
that are a picture stand in environment.npz as 'light', (height, width, 3) float32, the first row below. Lengths are
metres and +y is up, as in Weir; colours are sRGB from 0 to 1.
"""

import json
import pathlib
import re

import numpy

FORMAT = "weir-view"
VERSION = 1

_NAME = re.compile(r"frame_(\d{5,})\.npz")


class HandoverError(Exception):
    """What is wrong with a folder or a file, in a sentence for the user."""


def _load(path):
    try:
        with open(path, "rb") as file, numpy.load(file, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, KeyError) as error:
        raise HandoverError(f"{path}: cannot be read: {error}") from error
    except Exception as error:  # zipfile's own
        raise HandoverError(f"{path}: is no whole .npz file: {error}") from error


class Frame:
    """One frame: `scene` is the JSON, arrays by name."""

    def __init__(self, path, meshes=None):
        self.path = pathlib.Path(path)
        self._arrays = _load(self.path)
        self._meshes = {} if meshes is None else meshes  # by path; they stay as they are
        if "scene" not in self._arrays:
            raise HandoverError(f"{path}: holds no 'scene': it is not of Weir")
        try:
            self.scene = json.loads(self._arrays["scene"].tobytes().decode("utf-8"))
        except ValueError as error:
            raise HandoverError(f"{path}: its 'scene' is no JSON: {error}") from error
        if self.scene.get("format") != FORMAT or self.scene.get("version") != VERSION:
            found = f"{self.scene.get('format')} {self.scene.get('version')}"
            raise HandoverError(f"{path}: is of the format {found}; this reads {FORMAT} {VERSION}")

    def array(self, name):
        """Or None."""
        return self._arrays.get(name)

    def mesh(self, index):
        """Vertices and triangles of a surface."""
        file = self.scene["surfaces"][index].get("mesh")
        if file is None:
            return self._need(f"surface{index}_vertices"), self._need(f"surface{index}_triangles")
        path = self.path.parent / pathlib.PurePath(file).name
        if path not in self._meshes:
            arrays = _load(path)
            if "vertices" not in arrays or "triangles" not in arrays:
                raise HandoverError(f"{path}: holds no mesh")
            self._meshes[path] = (arrays["vertices"], arrays["triangles"])
        return self._meshes[path]

    def environment_light(self):
        """The picture of the surroundings, or None."""
        file = self.scene["environment"].get("image")
        if file is None:
            return None
        path = self.path.parent / pathlib.PurePath(file).name
        if path not in self._meshes:
            self._meshes[path] = _load(path).get("light")
        return self._meshes[path]

    def _need(self, name):
        if name not in self._arrays:
            raise HandoverError(f"{self.path}: has no array '{name}', of which its scene speaks")
        return self._arrays[name]

    def positions(self, index):
        return self._need(f"particles{index}_positions")

    def particle_colors(self, index):
        """(n, 4) float32, linear; None where all have the one colour."""
        values = self.array(f"particles{index}_values")
        if values is None or len(values) == 0:
            return None
        looks = self.scene["particles"][index]
        table = linear(numpy.asarray(looks["colors"], dtype=numpy.float32))
        low, high = looks["range"]
        share = numpy.clip((numpy.nan_to_num(values) - low) / max(high - low, 1e-30), 0, 1) * (len(table) - 1)
        below = numpy.minimum(share.astype(numpy.int64), len(table) - 2)
        part = (share - below)[:, None]
        colors = (1 - part) * table[below] + part * table[below + 1]
        return _opaque(colors)

    def surface_colors(self, index):
        """(n, 4) float32, linear; None where it has the one colour."""
        colors = self.array(f"surface{index}_colors")
        return None if colors is None else _opaque(linear(colors))


class Run:
    """A folder of frames."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self._meshes = {}
        self.frames = self.find_frames()
        if not self.frames:
            raise HandoverError(
                f"{folder}: holds no frame_00000.npz: it is not what weir run --blender wrote, or has no frame yet")

    def find_frames(self):
        """The numbers of the frames that are there, in their order."""
        if not self.folder.is_dir():
            raise HandoverError(f"{self.folder}: is no folder")
        found = (_NAME.fullmatch(entry.name) for entry in self.folder.iterdir())
        return sorted(int(match.group(1)) for match in found if match)

    def nearest(self, number):
        """The last frame that is there up to this one, or the first."""
        before = [frame for frame in self.frames if frame <= number]
        return before[-1] if before else self.frames[0]

    def frame(self, number):
        return Frame(self.folder / f"frame_{number:05}.npz", self._meshes)


def linear(srgb):
    """Light of sRGB colours."""
    srgb = numpy.asarray(srgb, dtype=numpy.float32)
    return numpy.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4).astype(numpy.float32)


def _opaque(colors):
    return numpy.concatenate([colors, numpy.ones((len(colors), 1))], axis=1).astype(numpy.float32)


def is_closed(triangles):
    """Whether each edge of a triangle is an edge of another one, the other way round."""
    t = numpy.asarray(triangles, dtype=numpy.int64)
    if len(t) == 0:
        return False
    edges = numpy.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    there = numpy.sort(edges[:, 0] << 32 | edges[:, 1])
    back = numpy.sort(edges[:, 1] << 32 | edges[:, 0])
    return bool(numpy.array_equal(there, back))


def _quaternion_matrix(q):
    w, x, y, z = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


# Blender's z is up: (x, y, z) there is (x, -z, y) here.
TURN = numpy.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def turned(vectors):
    """Places or directions, (n, 3) or (3,), as Blender has them."""
    v = numpy.asarray(vectors, dtype=numpy.float32)
    return numpy.stack([v[..., 0], -v[..., 2], v[..., 1]], axis=-1)


def pose_matrix(position, rotation):
    """4x4, for meshes that were turned; `rotation` is a quaternion, w first."""
    matrix = numpy.identity(4)
    matrix[:3, :3] = TURN @ _quaternion_matrix(rotation) @ TURN.T
    matrix[:3, 3] = turned(position)
    return matrix


def camera_matrix(camera):
    """4x4, of a camera that looks along its -z with +y up."""
    eye, target, up = (turned(camera[name]).astype(float) for name in ("eye", "target", "up"))
    back = (eye - target) / numpy.linalg.norm(eye - target)
    right = numpy.cross(up, back)
    if numpy.linalg.norm(right) < 1e-6:  # it looks along `up`
        right = numpy.cross([0.0, 1.0, 0.0] if abs(back[1]) < 0.9 else [1.0, 0.0, 0.0], back)
    right /= numpy.linalg.norm(right)
    matrix = numpy.identity(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, numpy.cross(back, right), back, eye
    return matrix
