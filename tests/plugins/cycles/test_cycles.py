#!/usr/bin/env python3
"""Pictures by Cycles, and the add-on, with a real Blender: test_cycles.py WEIR SHARE

WEIR is the program, SHARE the folder share/weir of its build. To be run by a Python that has the module bpy
(./dev setup-blender brings one); without it the exit code is 77, which means skipped. Pictures are compared with closed
forms: where light passes straight through, what is seen is the background times exp(-absorption depth), and what is seen
where follows from the projection of the camera.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import bpy
    import numpy
except ImportError as error:
    print(f"skipped: {error}: ./dev setup-blender brings it")
    sys.exit(77)

WEIR, SHARE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
del sys.argv[1:3]
sys.path.insert(0, str(SHARE / "blender"))
REFERENCE = pathlib.Path(__file__).parent / "reference_64.png"

from weir_blender import handover  # noqa: E402

SIZE = 64
TOP, BOTTOM = [0.55, 0.7, 0.9], [0.95, 0.96, 0.97]


def scene(**changes):
    """A hand-over's description of nothing, seen along -z from (0, 0, 4)."""
    made = {
        "format": "weir-view", "version": 1, "frame": 0, "time": 0.0, "frame_rate": 50.0,
        "picture": {"width": SIZE, "height": SIZE, "transparent": False, "tone": "plain", "exposure": 1.0},
        "camera": {"eye": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 30.0},
        "cycles": {"samples": 16, "noise": 0.0, "denoise": False, "device": "cpu", "caustics": False, "shutter": 0.0,
                   "aperture": 0.0, "focus": None},
        "environment": {"look": "studio", "towards_sun": [0.3, 0.9, 0.3], "sun_strength": 1.0, "background": True,
                        "top": BOTTOM, "bottom": BOTTOM, "image": None},
        "ground": None, "waters": [], "particles": [], "surfaces": []}
    for name, change in changes.items():
        made[name] = {**made[name], **change} if isinstance(made[name], dict) else change
    return made


def box(low, high):
    """A closed mesh."""
    low, high = numpy.array(low, dtype="f4"), numpy.array(high, dtype="f4")
    corners = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype="f4")
    triangles = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                 [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return low + corners * (high - low), numpy.array(triangles, dtype="i4")


def surface(look, **more):
    return {"name": "thing", "mesh": None, "look": look, "color": [0.8, 0.1, 0.1], "water": 0, "position": [0, 0, 0],
            "rotation": [1, 0, 0, 0], **more}


def write(path, description, **arrays):
    numpy.savez(path, scene=numpy.frombuffer(json.dumps(description).encode(), dtype="u1"), **arrays)


def pixels_of(path):
    """Linear light, (height, width, 3), rows from above."""
    image = bpy.data.images.load(str(path), check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    flat = numpy.empty(width * height * 4, dtype=numpy.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return handover.linear(flat.reshape(height, width, 4)[::-1, :, :3])


class WithFolder(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()


class Pictures(WithFolder):
    """One process of the worker for all."""

    @classmethod
    def setUpClass(cls):
        cls.worker = subprocess.Popen([sys.executable, "-B", str(SHARE / "blender/weir_blender/worker.py")],
                                      stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                      text=True)

    @classmethod
    def tearDownClass(cls):
        _, messages = cls.worker.communicate()
        assert cls.worker.returncode == 0, messages

    def render(self, description, **arrays):
        write(self.folder / "frame_00000.npz", description, **arrays)
        picture = self.folder / "picture.png"
        picture.unlink(missing_ok=True)
        request = {"frame": str(self.folder / "frame_00000.npz"), "picture": str(picture)}
        self.worker.stdin.write(json.dumps(request) + "\n")
        self.worker.stdin.flush()
        while not picture.exists():
            self.assertIsNone(self.worker.poll(), "the worker has ended")
            os.sched_yield()
        self.assertEqual([entry.name for entry in self.folder.glob("*.part*")], [])
        return pixels_of(picture)

    def test_the_background_is_the_sky_colour(self):
        seen = self.render(scene())
        numpy.testing.assert_allclose(seen, numpy.broadcast_to(handover.linear(BOTTOM), seen.shape), atol=0.01)
        seen = self.render(scene(environment={"top": TOP, "bottom": BOTTOM},
                                 camera={"eye": [0, 0, 0], "target": [0, 1, 0.01], "up": [0, 0, 1]}))
        numpy.testing.assert_allclose(seen[SIZE // 2, SIZE // 2], handover.linear(TOP), atol=0.01)

    def test_water_absorbs_as_beer_and_lambert_say(self):
        absorption = numpy.array([2.0, 0.7, 0.3])
        water = {"absorption": absorption.tolist(), "scattering": 0.0, "scattered": [1, 1, 1], "refractive_index": 1.0}
        before = numpy.ones(3)
        for depth in (0.2, 0.5, 1.0):
            vertices, triangles = box([-3, -3, -depth], [3, 3, 0])
            seen = self.render(scene(waters=[water], surfaces=[surface("water")]), surface0_vertices=vertices,
                               surface0_triangles=triangles)[SIZE // 2, SIZE // 2]
            expected = handover.linear(BOTTOM) * numpy.exp(-absorption * depth)
            numpy.testing.assert_allclose(seen, expected, atol=0.012)
            self.assertTrue((seen < before).all())
            self.assertGreater(seen[2] / seen[0], before[2] / before[0])
            before = seen

    def test_a_body_is_seen_where_the_camera_projects_it(self):
        # A square of side 1 at z = 0.5, seen from 3.5 m away: half of it is 0.5 / (3.5 tan 15 deg) of half the picture.
        vertices, triangles = box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])
        seen = self.render(scene(surfaces=[surface("matt", position=[0.25, 0, 0])]), surface0_vertices=vertices,
                           surface0_triangles=triangles)
        red = seen[..., 0] > 2 * seen[..., 2]
        half = 0.5 / (3.5 * numpy.tan(numpy.radians(15))) * SIZE / 2
        shift = half / 2
        rows, columns = numpy.nonzero(red)
        self.assertAlmostEqual(rows.min(), SIZE / 2 - half, delta=1)
        self.assertAlmostEqual(rows.max() + 1, SIZE / 2 + half, delta=1)
        self.assertAlmostEqual(columns.max() + 1, SIZE / 2 + half + shift, delta=1)

    def test_particles_are_spheres_of_their_radius_in_the_colours_of_the_map(self):
        looks = {"name": "water particles", "radius": 0.3, "color": [0.2, 0.5, 0.9], "colors": [[0, 0, 1], [1, 0, 0]],
                 "range": [0, 2]}
        places = numpy.array([[-0.5, 0, 0], [0.5, 0, 0], [numpy.nan, 0, 0]], dtype="f4")
        seen = self.render(scene(particles=[looks]), particles0_positions=places,
                           particles0_values=numpy.array([0, 2, 1], dtype="f4"))
        blue, red = seen[..., 2] > 2 * seen[..., 0], seen[..., 0] > 2 * seen[..., 2]
        across = 0.3 / (4 * numpy.tan(numpy.radians(15))) * SIZE  # pixels
        for mask, middle in ((blue, -0.5), (red, 0.5)):
            rows, columns = numpy.nonzero(mask)
            self.assertAlmostEqual(rows.max() + 1 - rows.min(), across, delta=1.5)
            self.assertAlmostEqual(columns.mean() + 0.5, SIZE / 2 * (1 + middle / (4 * numpy.tan(numpy.radians(15)))), delta=1)

    def test_spheres_may_have_a_radius_each(self):
        looks = {"name": "foam particles", "radius": 0.2, "color": [1, 0, 0], "white": False}
        places = numpy.array([[-0.5, 0, 0], [numpy.nan, 0, 0], [0.5, 0, 0], [-0.5, 0.5, 0]], dtype="f4")
        seen = self.render(scene(particles=[looks]), particles0_positions=places,
                           particles0_radii=numpy.array([0.1, 1, 0.3, 0], dtype="f4"))
        red = seen[..., 0] > 2 * seen[..., 2]
        for half, radius in ((red[:, :SIZE // 2], 0.1), (red[:, SIZE // 2:], 0.3)):
            rows = numpy.nonzero(half)[0]
            across = radius / (4 * numpy.tan(numpy.radians(15))) * SIZE
            self.assertAlmostEqual(rows.max() + 1 - rows.min(), across, delta=1.5)

    def test_few_of_white_water_are_mist_and_many_are_white(self):
        # Before a black wall: what passes between them is dark.
        vertices, triangles = box([-3, -3, -1.2], [3, 3, -1])
        wall = surface("matt", color=[0, 0, 0])
        looks = {"name": "foam particles", "radius": 0.2, "color": [0.95, 0.97, 0.98], "white": True}

        def light(count):
            places = numpy.array([[0, 0, -0.05 * i] for i in range(count)], dtype="f4").reshape(-1, 3)
            seen = self.render(scene(cycles={"samples": 64}, surfaces=[wall], particles=[looks]),
                               surface0_vertices=vertices, surface0_triangles=triangles, particles0_positions=places)
            return seen[SIZE // 2 - 2:SIZE // 2 + 2, SIZE // 2 - 2:SIZE // 2 + 2].mean()

        none, one, many = light(0), light(1), light(12)
        self.assertGreater(one, none + 0.1)
        self.assertGreater(many, 1.1 * one)

    def test_foam_makes_water_white_where_it_lies(self):
        # Before a black wall, seen through clear water with foam on its left half.
        vertices, triangles = box([-1, -1, -0.4], [1, 1, 0])
        back, sides = box([-3, -3, -1.2], [3, 3, -1])
        water = {"absorption": [0, 0, 0], "scattering": 0.0, "scattered": [1, 1, 1], "refractive_index": 1.0}

        def light(cover):
            things = [surface("water", foam_reach=0.1), {**surface("matt", color=[0, 0, 0]), "name": "wall"}]
            seen = self.render(scene(cycles={"samples": 64}, waters=[water], surfaces=things), surface0_vertices=vertices,
                               surface0_triangles=triangles, surface1_vertices=back, surface1_triangles=sides,
                               surface0_foam=numpy.where(vertices[:, 0] < 0, cover, 0).astype("f4"))
            return seen[SIZE // 3:-SIZE // 3, SIZE // 6:SIZE // 4].mean(), seen[SIZE // 3:-SIZE // 3, -SIZE // 6:].mean()

        none, little, much = light(0), light(0.04), light(1)
        self.assertGreater(much[0], none[0] + 0.3)
        self.assertTrue(none[0] + 0.03 < little[0] < 0.8 * much[0], (none, little, much))
        self.assertLess(little[1], none[1] + 0.03)

    def test_the_pattern_of_foam_goes_along_with_the_water(self):
        # A bright face with little foam flows to the right. A tenth of a second later its threads are that much farther.
        vertices, triangles = box([-2, -2, -0.4], [2, 2, 0])
        back, sides = box([-3, -3, -1.2], [3, 3, -1])
        water = {"absorption": [0, 0, 0], "scattering": 0.0, "scattered": [1, 1, 1], "refractive_index": 1.0}
        things = [surface("water", foam_reach=0.1), {**surface("matt", color=[0, 0, 0]), "name": "wall"}]
        metre = SIZE / (2 * 4 * numpy.tan(numpy.radians(15)))  # in pixels
        way = 8  # pixels

        def face(time, speed):
            velocities = numpy.tile(numpy.array([speed, 0, 0], dtype="f4"), (len(vertices), 1))
            return self.render(scene(time=time, cycles={"samples": 32}, waters=[water], surfaces=things),
                               surface0_vertices=vertices, surface0_triangles=triangles, surface1_vertices=back,
                               surface1_triangles=sides, surface0_velocities=velocities,
                               surface0_foam=numpy.full(len(vertices), 0.05, dtype="f4")).mean(axis=2)

        def like(a, b):
            return numpy.corrcoef(a.ravel(), b.ravel())[0, 1]

        speed = way / metre / 0.1
        before, after = face(0.2, speed), face(0.3, speed)  # one pattern is most of both
        self.assertGreater(like(before[:, :-way], after[:, way:]), 0.7)
        self.assertLess(like(before, after), 0.4)
        still = face(0.05, 0)
        self.assertGreater(like(still, face(0.3, 0)), 0.95)
        self.assertAlmostEqual(before.mean(), still.mean(), delta=0.3 * still.mean())

    def test_a_surface_may_have_a_colour_at_each_vertex(self):
        vertices, triangles = box([-1, -1, -0.1], [1, 1, 0])
        left = vertices[:, :1] < 0
        colors = numpy.where(left, [[1, 0, 0]], [[0, 0, 1]]).astype("f4")
        seen = self.render(scene(surfaces=[surface("matt")]), surface0_vertices=vertices, surface0_triangles=triangles,
                           surface0_colors=colors)
        middle = seen[SIZE // 2]
        self.assertGreater(middle[SIZE // 8, 0], 3 * middle[SIZE // 8, 2])
        self.assertGreater(middle[-SIZE // 8, 2], 3 * middle[-SIZE // 8, 0])
        self.assertAlmostEqual(middle[SIZE // 2, 0], middle[SIZE // 2, 2], delta=0.1)

    def test_what_moves_is_blurred_by_its_way_while_the_shutter_is_open(self):
        vertices, triangles = box([-0.2, -0.2, -0.2], [0.2, 0.2, 0.2])

        def columns(shutter, item, **arrays):
            seen = self.render(scene(cycles={"shutter": shutter, "samples": 64}, surfaces=[item]),
                               surface0_vertices=vertices, surface0_triangles=triangles, **arrays)
            share = 1 - seen[SIZE // 2, :, 2] / handover.linear(BOTTOM)[2]
            return numpy.count_nonzero(share > 0.05)

        pixel = 2 * 3.8 * numpy.tan(numpy.radians(15)) / SIZE  # m, where the front of the box is
        at_rest = columns(0.0, surface("matt"))
        # A solid that went 0.4 m in the last frame, and a fluid's surface at 20 m/s, which is 0.4 m a frame.
        solid = columns(0.5, surface("matt", position_before=[-0.4, 0, 0], rotation_before=[1, 0, 0, 0]))
        fluid = columns(0.5, surface("matt"),
                        surface0_velocities=numpy.tile(numpy.array([[20, 0, 0]], dtype="f4"), (8, 1)))
        for blurred in (solid, fluid):
            self.assertAlmostEqual(blurred - at_rest, 0.5 * 0.4 / pixel, delta=3)

    def test_the_picture_is_the_stored_one(self):
        vertices, triangles = box([-0.6, -0.5, -0.6], [0.6, 0.1, 0.6])
        water = {"absorption": [4.2, 1.1, 0.55], "scattering": 0.0, "scattered": [1, 1, 1], "refractive_index": 1.33}
        ball = {"name": "ball particles", "radius": 0.2, "color": [0.9, 0.6, 0.2]}
        seen = self.render(
            scene(camera={"eye": [1.5, 1.3, 3], "target": [0, -0.1, 0], "up": [0, 1, 0], "fov": 35.0},
                  cycles={"samples": 64}, waters=[water], surfaces=[surface("water")], particles=[ball],
                  ground={"height": -0.5, "center": [0, 0, 0], "radius": 3.0, "color": [0.9, 0.9, 0.9], "tiles": 0.3}),
            surface0_vertices=vertices, surface0_triangles=triangles,
            particles0_positions=numpy.array([[-0.3, 0.5, 0.2], [0.2, -0.3, 0.0]], dtype="f4"))
        if "WEIR_NEW_REFERENCES" in os.environ:
            (self.folder / "picture.png").replace(REFERENCE)
            self.skipTest("the reference is written anew")
        # Releases of Cycles differ in their noise, and a little in their shading.
        wanted = pixels_of(REFERENCE)
        self.assertLess(numpy.abs(seen - wanted).mean(), 0.02)
        blocks = (8, SIZE // 8, 8, SIZE // 8, 3)
        self.assertLess(numpy.abs((seen - wanted).reshape(blocks).mean(axis=(1, 3))).max(), 0.06)


class Folders(WithFolder):
    def test_what_is_wrong_is_said(self):
        with self.assertRaisesRegex(handover.HandoverError, "is no folder"):
            handover.Run(self.folder / "none")
        with self.assertRaisesRegex(handover.HandoverError, "holds no frame"):
            handover.Run(self.folder)
        (self.folder / "frame_00000.npz").write_bytes(b"PK\x03\x04 half")
        with self.assertRaisesRegex(handover.HandoverError, "frame_00000.npz"):
            handover.Run(self.folder).frame(0)
        write(self.folder / "frame_00001.npz", {**scene(), "version": 2})
        with self.assertRaisesRegex(handover.HandoverError, "this reads weir-view 1"):
            handover.Run(self.folder).frame(1)

    def test_closed_meshes_are_told_from_open_ones(self):
        _, triangles = box([0, 0, 0], [1, 1, 1])
        self.assertTrue(handover.is_closed(triangles))
        self.assertFalse(handover.is_closed(triangles[1:]))
        self.assertFalse(handover.is_closed(triangles[:0]))


SCENE = {
    "weir": 1, "world": {"dt": 0.004, "frame_rate": 25, "duration": 0.12},
    "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0.02, 0.02, 0.02], "max": [0.3, 0.4, 0.3]}},
        "tank": {"type": "StaticBoundary",
                 "params": {"shape": "box", "min": [0, 0, 0], "max": [0.8, 0.6, 0.32], "inverted": True}},
        "post": {"type": "BoxMesh", "params": {"min": [0.5, 0.0, 0.1], "max": [0.6, 0.3, 0.2]}},
        "wall": {"type": "SemiAnalyticalSFI", "params": {"angular_velocity": [0, 3, 0], "pivot": [0.55, 0, 0.15]}},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 3}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries", "post.surface -> wall.solids",
              "water.fluid -> wall.fluid"],
    "render": {"width": SIZE, "height": SIZE, "overlay": False, "cycles": {"samples": 4, "shutter": 0.5, "device": "cpu"},
               "fluids": [{"node": "water", "look": "water"}], "surfaces": [{"node": "post", "look": "metal"}]}}


class Runs(WithFolder):
    def weir(self, *arguments, code=0):
        done = subprocess.run([WEIR, *map(str, arguments)], capture_output=True, text=True, check=False,
                              env={**os.environ, "WEIR_BLENDER": sys.executable})
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr

    def setUp(self):
        super().setUp()
        self.scene = self.folder / "scene.json"
        self.scene.write_text(json.dumps(SCENE))

    def test_a_run_is_rendered_and_no_frame_twice(self):
        pictures, export = self.folder / "pictures", self.folder / "run.vtkhdf"
        run = ["run", self.scene, "--device", "cpu", "--engine", "cycles", "--images", pictures]
        self.weir(*run, "--export", export)
        names = [f"frame_{i:05}.png" for i in range(4)]
        self.assertEqual(sorted(entry.name for entry in pictures.glob("*.png")), names)
        seen = pixels_of(pictures / names[3])
        self.assertEqual(seen.shape, (SIZE, SIZE, 3))
        self.assertGreater(seen.std(), 0.02)  # there is something
        first = (pictures / names[0]).read_bytes()
        (pictures / names[2]).unlink()
        self.assertIn("3 pictures were there", self.weir(*run))
        self.assertEqual((pictures / names[0]).read_bytes(), first)
        self.assertTrue((pictures / names[2]).exists())
        # The export shows the same.
        again = self.folder / "again"
        self.weir("render", export, "--scene", self.scene, "--engine", "cycles", "--images", again)
        difference = numpy.abs(pixels_of(again / names[3]) - seen).mean()
        self.assertLess(difference, 0.02)

    def test_a_lone_particle_is_spray_and_no_ball(self):
        scene = json.loads(json.dumps(SCENE))
        place = numpy.array([0.7, 0.5, 0.1])
        scene["nodes"]["drop"] = {"type": "BoxSampler", "params": {"min": list(place - 0.02), "max": list(place + 0.02)}}
        scene["links"].append("drop.particles -> water.initial")
        self.scene.write_text(json.dumps(scene))
        run = self.folder / "run"
        self.weir("run", self.scene, "--device", "cpu", "--blender", run, "--frames", "0")
        frame = handover.Frame(run / "frame_00000.npz")
        number, item = next((i, p) for i, p in enumerate(frame.scene["particles"]) if p["name"] == "water spray particles")
        self.assertTrue(item["white"])
        away = numpy.linalg.norm(frame.positions(number) - place, axis=1)
        near = away < 0.3  # as far as they are strewn
        self.assertEqual(near.sum(), 32)
        radii = frame.array(f"particles{number}_radii")[near]
        self.assertTrue(0 < radii.min() and radii.max() < 0.01, radii)
        self.assertEqual(len(frame.array(f"particles{number}_velocities")), len(away))
        water = next(i for i, s in enumerate(frame.scene["surfaces"]) if s["name"] == "water")
        vertices, _ = frame.mesh(water)
        self.assertGreater(numpy.linalg.norm(vertices - place, axis=1).min(), 0.1)

    def test_a_fluid_is_as_smooth_as_its_look_says(self):
        def roughness(smoothing):
            """Of the side of the block that no wall holds, m."""
            scene, run = json.loads(json.dumps(SCENE)), self.folder / f"run{smoothing}"
            scene["render"]["fluids"][0]["smoothing"] = smoothing
            self.scene.write_text(json.dumps(scene))
            self.weir("run", self.scene, "--device", "cpu", "--blender", run, "--frames", "2", "--set", "water.spacing=0.02")
            frame = handover.Frame(run / "frame_00002.npz")
            vertices, _ = frame.mesh(next(i for i, s in enumerate(frame.scene["surfaces"]) if s["name"] == "water"))
            inner = (abs(vertices[:, 1] - 0.15) < 0.07) & (abs(vertices[:, 2] - 0.16) < 0.08) & (vertices[:, 0] > 0.2)
            x, place = vertices[inner, 0], vertices[inner, 1:]
            shape = numpy.column_stack([numpy.ones(len(x)), place, place**2])  # the front is bent
            return (x - shape @ numpy.linalg.lstsq(shape, x, rcond=None)[0]).std()

        self.assertLess(roughness(6), 0.6 * roughness(0))

    def test_what_cycles_lacks_is_said(self):
        message = self.weir("run", self.scene, "--device", "cpu", "--engine", "cycles", "--images", self.folder / "p",
                            "--set", "render.cycles.device=gpu", "--frames", "0", code=5)
        self.assertIn("finds no GPU here", message)

    def test_the_add_on_opens_a_run_and_renders_it(self):
        run = self.folder / "run"
        self.weir("run", self.scene, "--device", "cpu", "--blender", run)
        self.assertEqual(sorted(entry.name for entry in run.glob("frame*")), [f"frame_{i:05}.npz" for i in range(4)])
        os.environ["BLENDER_USER_RESOURCES"] = str(self.folder / "home")
        script = f"""
import bpy, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_install(filepath={str(SHARE / "weir_blender.zip")!r}, overwrite=True)
bpy.ops.preferences.addon_enable(module="weir_blender")
scene = bpy.context.scene
assert bpy.ops.weir.open_run(directory={str(run)!r}) == {{"FINISHED"}}
assert (scene.frame_start, scene.frame_end) == (0, 3), (scene.frame_start, scene.frame_end)
heights = []
for frame in (0, 3, 0):
    scene.frame_set(frame)
    water = bpy.data.objects["Weir water"].data
    assert len(water.polygons) > 100, len(water.polygons)
    heights.append(max(vertex.co.z for vertex in water.vertices))
assert heights[0] == heights[2] > heights[1] + 0.02, heights
scene.render.filepath = {str(self.folder / "film_")!r}
scene.frame_start = 2
bpy.ops.render.render(animation=True)
try:
    bpy.ops.weir.open_run(directory={str(self.folder)!r})
except RuntimeError as error:
    assert "holds no frame_00000.npz" in str(error), error
else:
    raise AssertionError("a folder without frames was opened")
bpy.ops.wm.open_mainfile(filepath={str(run / "scene.blend")!r})
scene = bpy.context.scene
assert scene.frame_current == 3 and scene.camera is not None and scene.render.engine == "CYCLES"
scene.frame_set(0)
assert max(vertex.co.z for vertex in bpy.data.objects["Weir water"].data.vertices) == heights[0]
print("all is well")
"""
        done = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True, check=False)
        self.assertIn("all is well", done.stdout, done.stdout[-2000:] + done.stderr[-4000:])
        self.assertTrue((self.folder / "film_0002.png").exists())
        self.assertTrue((self.folder / "film_0003.png").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
