#!/usr/bin/env python3
"""Reads what --usd wrote by USD's own library, point by point, beside the same run's --ply-particles: test_usd.py WEIR

To be run by a Python that has the module pxr (./dev setup-blender brings it); without it the exit code is 77, which
means skipped.
"""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy
    from pxr import Gf, Usd, UsdGeom, UsdShade
except ImportError as error:
    print(f"skipped: {error}: ./dev setup-blender brings it")
    sys.exit(77)

WEIR = sys.argv.pop(1)
FRAMES = 5
RATE = 25
SPIN = 3.0  # rad/s
SCENE = {
    "weir": 1, "world": {"dt": 0.004, "frame_rate": RATE, "duration": 0.16},
    "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0.02, 0.02, 0.02], "max": [0.3, 0.4, 0.3]}},
        "tank": {"type": "StaticBoundary",
                 "params": {"shape": "box", "min": [0, 0, 0], "max": [0.8, 0.6, 0.32], "inverted": True}},
        "sink": {"type": "Sink", "params": {"min": [0.25, 0, 0], "max": [0.9, 0.05, 0.4]}},
        "post": {"type": "BoxMesh", "params": {"min": [0.5, 0.0, 0.1], "max": [0.6, 0.3, 0.2]}},
        "wall": {"type": "SemiAnalyticalSFI", "params": {"angular_velocity": [0, SPIN, 0], "pivot": [0.55, 0, 0.15]}},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 3}},
        "skin": {"type": "FluidSurface"}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries", "post.surface -> wall.solids",
              "water.fluid -> wall.fluid", "water.fluid -> skin.fluid", "sink.sink -> water.sinks"],
    "render": {"width": 64, "height": 48, "cycles": {"aperture": 0.05},
               "camera": {"eye": [2, 1, 2], "target": [0.4, 0.2, 0.1], "fov": 35, "orbit_period": 2},
               "surfaces": [{"node": "post", "look": "metal", "color": [0.9, 0.5, 0.1]},
                            {"node": "skin", "look": "water"}]}}


def read_ply(path):
    """Columns by name, of a binary PLY file."""
    head, data = path.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    kinds = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
    elements = []
    for line in lines:
        if line[0] == "element":
            elements.append((line[1], int(line[2]), []))
        elif line[0] == "property" and line[1] != "list":
            elements[-1][2].append((line[2], kinds[line[1]]))
    count, columns = elements[0][1], numpy.dtype(elements[0][2])
    vertices = numpy.frombuffer(data, columns, count)
    faces = numpy.zeros((0, 3), dtype="i4")
    if len(elements) > 1:
        face = numpy.dtype([("n", "u1"), ("corners", "<i4", 3)])
        faces = numpy.frombuffer(data[count * columns.itemsize:], face, elements[1][1])["corners"]
    return vertices, faces


def columns(vertices, *names):
    return numpy.stack([vertices[name] for name in names], axis=1)


class ReadBack(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls._folder.name)
        scene = cls.folder / "scene.json"
        scene.write_text(json.dumps(SCENE))
        for name in ("points", "skins"):
            (cls.folder / name).mkdir()
        done = subprocess.run([WEIR, "run", scene, "--device", "cpu", "--usd", cls.folder / "run.usda",
                               "--ply-particles", cls.folder / "points", "--ply", cls.folder / "skins",
                               "--export", cls.folder / "run.vtkhdf"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        cls.stage = Usd.Stage.Open(str(cls.folder / "run.usda"))

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def test_the_stage_says_its_units_and_times(self):
        stage = self.stage
        self.assertEqual(UsdGeom.GetStageMetersPerUnit(stage), 1)
        self.assertEqual(UsdGeom.GetStageUpAxis(stage), "Y")
        self.assertEqual((stage.GetStartTimeCode(), stage.GetEndTimeCode()), (0, FRAMES - 1))
        self.assertEqual(stage.GetTimeCodesPerSecond(), RATE)
        self.assertEqual(stage.GetDefaultPrim().GetPath(), "/World")
        self.assertEqual(stage.GetCompositionErrors(), [])

    def test_all_points_are_those_of_the_run(self):
        points = UsdGeom.Points.Get(self.stage, "/World/water")
        self.assertEqual(list(points.GetWidthsAttr().Get()), [numpy.float32(0.04)])
        counts = set()
        for frame in range(FRAMES):
            vertices, _ = read_ply(self.folder / f"points/water_{frame:05}.ply")
            counts.add(len(vertices))

            def values(attribute):
                return numpy.array(attribute.Get(frame))

            places, wanted = values(points.GetPointsAttr()), columns(vertices, "x", "y", "z")
            # In PLY the first number may be another by its last bit, see plyOf.
            numpy.testing.assert_array_equal(places.ravel()[1:], wanted.ravel()[1:])
            numpy.testing.assert_allclose(places[0], wanted[0], rtol=2e-7)
            numpy.testing.assert_array_equal(values(points.GetVelocitiesAttr()), columns(vertices, "vx", "vy", "vz"))
            numpy.testing.assert_array_equal(values(points.GetIdsAttr()), vertices["id"])
            self.assertEqual(values(points.GetIdsAttr()).dtype, numpy.int64)
            density = UsdGeom.PrimvarsAPI(points).GetPrimvar("density")
            self.assertEqual(density.GetInterpolation(), "vertex")
            numpy.testing.assert_array_equal(numpy.array(density.Get(frame)), vertices["density"])
            low, high = points.GetExtentAttr().Get(frame)
            numpy.testing.assert_array_equal(low, places.min(axis=0))
            numpy.testing.assert_array_equal(high, places.max(axis=0))
        self.assertGreater(len(counts), 1)  # the sink has taken some

    def test_surfaces_are_those_of_the_run_and_move_with_the_fluid(self):
        skin = UsdGeom.Mesh.Get(self.stage, "/World/skin")
        self.assertEqual(skin.GetSubdivisionSchemeAttr().Get(), "none")
        for frame in range(FRAMES):
            vertices, faces = read_ply(self.folder / f"skins/skin_{frame:05}.ply")
            points = numpy.array(skin.GetPointsAttr().Get(frame))
            wanted = columns(vertices, "x", "y", "z")
            # In PLY the first number may be another by its last bit, see plyOf.
            numpy.testing.assert_array_equal(points.ravel()[1:], wanted.ravel()[1:])
            numpy.testing.assert_allclose(points[0], wanted[0], rtol=2e-7)
            numpy.testing.assert_array_equal(numpy.array(skin.GetNormalsAttr().Get(frame)),
                                             columns(vertices, "nx", "ny", "nz"))
            numpy.testing.assert_array_equal(numpy.array(skin.GetFaceVertexIndicesAttr().Get(frame)), faces.ravel())
            self.assertEqual(set(skin.GetFaceVertexCountsAttr().Get(frame)), {3})
            velocities = numpy.array(skin.GetVelocitiesAttr().Get(frame))
            self.assertEqual(len(velocities), len(vertices))
            # A mean of what the particles have.
            particles, _ = read_ply(self.folder / f"points/water_{frame:05}.ply")
            fastest = numpy.linalg.norm(columns(particles, "vx", "vy", "vz"), axis=1).max()
            self.assertLessEqual(numpy.linalg.norm(velocities, axis=1).max(), 1.0001 * fastest)
        self.assertLess(velocities[:, 1].mean(), -0.05)  # it falls

    def test_solids_turn_as_the_scene_says(self):
        post = UsdGeom.Mesh.Get(self.stage, "/World/post")
        numpy.testing.assert_allclose(post.GetExtentAttr().Get(), [[0.5, 0, 0.1], [0.6, 0.3, 0.2]], atol=1e-6)
        for frame in range(FRAMES):
            angle = SPIN * frame / RATE
            matrix = UsdGeom.XformCache(frame).GetLocalToWorldTransform(post.GetPrim())
            for x, z in ((0.5, 0.1), (0.6, 0.2)):
                dx, dz = x - 0.55, z - 0.15  # turned about y through the pivot
                wanted = (0.55 + math.cos(angle) * dx + math.sin(angle) * dz, 0.3,
                          0.15 - math.sin(angle) * dx + math.cos(angle) * dz)
                numpy.testing.assert_allclose(matrix.Transform(Gf.Vec3d(x, 0.3, z)), wanted, atol=1e-5)

    def test_the_camera_sees_what_the_pictures_see(self):
        camera = UsdGeom.Camera.Get(self.stage, "/World/camera")
        for frame in range(FRAMES):
            lens = camera.GetCamera(frame)
            self.assertAlmostEqual(lens.GetFieldOfView(Gf.Camera.FOVVertical), 35, places=3)
            self.assertAlmostEqual(lens.aspectRatio, 64 / 48, places=5)
            angle = 2 * math.pi * frame / RATE / 2  # of the orbit about y
            dx, dz = 1.6, 1.9
            eye = (0.4 + math.cos(angle) * dx + math.sin(angle) * dz, 1, 0.1 - math.sin(angle) * dx + math.cos(angle) * dz)
            numpy.testing.assert_allclose(lens.transform.ExtractTranslation(), eye, atol=1e-4)
            ahead = lens.transform.TransformDir(Gf.Vec3d(0, 0, -1))
            wanted = numpy.array([0.4, 0.2, 0.1]) - eye
            numpy.testing.assert_allclose(ahead, wanted / numpy.linalg.norm(wanted), atol=1e-4)
            self.assertAlmostEqual(lens.focusDistance, numpy.linalg.norm(wanted), places=3)
            # In a stage of metres a lens of 0.1 is 1 cm long: its diameter is that by the f-number.
            self.assertAlmostEqual(lens.focalLength / 10 / lens.fStop, 0.05, places=5)

    def test_materials_are_those_of_the_looks(self):
        def shader(path):
            material, _ = UsdShade.MaterialBindingAPI(self.stage.GetPrimAtPath(path)).ComputeBoundMaterial()
            found = material.ComputeSurfaceSource()[0]
            self.assertEqual(found.GetIdAttr().Get(), "UsdPreviewSurface")
            return {value.GetBaseName(): value.Get() for value in found.GetInputs()}

        metal, water = shader("/World/post"), shader("/World/skin")
        self.assertEqual(metal["metallic"], 1)
        numpy.testing.assert_allclose(metal["diffuseColor"], [0.7874, 0.2140, 0.0100], atol=1e-3)  # linear light
        self.assertAlmostEqual(water["ior"], 1.33, places=5)
        self.assertLess(water["opacity"], 0.5)
        self.assertGreater(water["diffuseColor"][2], water["diffuseColor"][0])

    def test_an_export_shows_the_same(self):
        done = subprocess.run([WEIR, "render", self.folder / "run.vtkhdf", "--scene", self.folder / "scene.json",
                               "--usd", self.folder / "again.usda"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        stage = Usd.Stage.Open(str(self.folder / "again.usda"))
        for path, type_ in (("/World/water", UsdGeom.Points), ("/World/skin", UsdGeom.Mesh)):
            mine, theirs = type_.Get(self.stage, path), type_.Get(stage, path)
            numpy.testing.assert_array_equal(numpy.array(mine.GetPointsAttr().Get(3)),
                                             numpy.array(theirs.GetPointsAttr().Get(3)))

    def test_a_surface_has_the_colours_of_its_particles(self):
        colored = json.loads(json.dumps(SCENE))
        colored["render"].update(color={"by": "density", "range": [-1, 0], "table": ["#ff0000", "#0000ff"]},
                                 surfaces=[{"node": "skin", "particle_colors": True}])
        scene = self.folder / "colored.json"
        scene.write_text(json.dumps(colored))
        done = subprocess.run([WEIR, "run", scene, "--device", "cpu", "--frames", "1", "--usd",
                               self.folder / "colored.usda"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        stage = Usd.Stage.Open(str(self.folder / "colored.usda"))
        skin = UsdGeom.Mesh.Get(stage, "/World/skin")
        colors = skin.GetDisplayColorPrimvar()
        self.assertEqual(colors.GetInterpolation(), "vertex")
        found = numpy.array(colors.Get(1))
        self.assertEqual(len(found), len(skin.GetPointsAttr().Get(1)))
        numpy.testing.assert_allclose(found, numpy.broadcast_to([0, 0, 1], found.shape), atol=1e-5)
        self.assertEqual(UsdGeom.Mesh.Get(self.stage, "/World/skin").GetDisplayColorPrimvar().GetInterpolation(), "constant")

    def test_a_name_that_usd_does_not_allow_is_changed(self):
        scene = self.folder / "named.json"
        text = json.dumps(SCENE).replace('"water":', '"the-water":').replace("water.", "the-water.")
        scene.write_text(text.replace("-> water", "-> the-water"))
        done = subprocess.run([WEIR, "run", scene, "--device", "cpu", "--frames", "1", "--usd",
                               self.folder / "named.usda"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        stage = Usd.Stage.Open(str(self.folder / "named.usda"))
        points = UsdGeom.Points.Get(stage, "/World/the_water")
        self.assertGreater(len(points.GetPointsAttr().Get(1)), 100)


if __name__ == "__main__":
    os.environ.setdefault("PYTHONDONTWRITEBYTECODE", "1")
    unittest.main(verbosity=2)
