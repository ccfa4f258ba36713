"""Particles, meshes and motions from arrays."""

import json

import numpy as np
import pytest

import weir
from conftest import dam_break

CUBE = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)
CUBE_FACES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
                       (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])


def lattice(count: int, spacing: float) -> np.ndarray:
    return spacing * np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


def thrown(positions, velocities=None, attributes=None, **params) -> weir.Scene:
    """Particles that fly freely."""
    scene = weir.Scene("Thrown")
    scene.world.set(duration=1, dt=0.01, frame_rate=10)
    cloud = scene.add_particles("cloud", positions, velocities, attributes, **params)
    water = scene.add("ParticleFluid", "water", spacing=0.1)
    cloud.particles >> water.initial
    for module in ("solver", "viscosity"):
        water.modules[module].enabled = False
    return scene


def in_order(water, name: str) -> np.ndarray:
    return water.particles[name][np.argsort(water.ids)]


@pytest.fixture
def cloud():
    rng = np.random.default_rng(1)
    return rng.uniform(-5, 5, (500, 3)), rng.uniform(-2, 2, (500, 3))


def test_particles_fly_as_they_were_thrown(cloud):
    positions, velocities = cloud
    scene = thrown(positions, velocities)
    sim = weir.Simulation(scene, device="cpu")
    assert np.array_equal(in_order(scene.water, "position"), positions.astype(np.float32))
    sim.advance(5)
    # A step of dt adds dt·g to the velocity, and then dt times that to the position.
    steps, dt, g = sim.steps, 0.01, np.array(scene.world.gravity)
    expected = positions + steps * dt * velocities + 0.5 * steps * (steps + 1) * dt * dt * g
    assert np.allclose(in_order(scene.water, "position"), expected, atol=2e-5)
    assert scene.cloud.values["particles_read"] == 500


def test_attributes_stay_with_their_particles(cloud):
    positions, velocities = cloud
    given = {"heat": np.arange(500) * 0.5, "mark": np.arange(500) % 7, "home": positions, "wet": positions[:, 0] > 0}
    scene = thrown(positions, velocities, given)
    sim = weir.Simulation(scene, device="cpu")
    for _ in range(2):
        types = {name: about["type"] for name, about in scene.water.particles.describe().items() if name in given}
        assert types == {"heat": "float", "mark": "int", "home": "vec3", "wet": "int"}
        sim.advance(3)
        for name, values in given.items():
            assert np.array_equal(in_order(scene.water, name), values.astype(np.float32 if name != "mark" else np.int32)), name
        sim.reset()  # they are there again


def test_particles_without_the_attribute_have_0():
    scene = thrown(lattice(4, 0.1), None, {"heat": np.full(64, 3.0)})
    more = scene.add_particles("more", lattice(3, 0.1) + 2)
    more.particles >> scene.water.initial
    weir.Simulation(scene, device="cpu")
    heat = scene.water.particles["heat"]
    assert sorted(heat) == [0.0] * 27 + [3.0] * 64
    assert (heat[scene.water.positions[:, 0] > 1] == 0).all()


def test_one_velocity_does_for_all_and_params_move_them():
    scene = thrown(lattice(3, 0.1), (1, 2, 3), position=(0, 5, 0), scale=2)
    weir.Simulation(scene, device="cpu")
    assert np.allclose(scene.water.velocities, (2, 4, 6))
    assert np.allclose(in_order(scene.water, "position"), 2 * lattice(3, 0.1) + (0, 5, 0))


def test_tensors_and_lists_are_arrays_too():
    torch = pytest.importorskip("torch")
    tensor = torch.tensor(lattice(3, 0.1), requires_grad=True)
    scene = thrown(tensor, lattice(3, 0.1).tolist())
    weir.Simulation(scene, device="cpu")
    assert np.allclose(in_order(scene.water, "position"), lattice(3, 0.1))


def test_lists_are_arrays_too():
    scene = thrown([[0, 0, 0], [1, 2, 3]], [0, 1, 0])
    weir.Simulation(scene, device="cpu")
    assert np.array_equal(in_order(scene.water, "position"), [[0, 0, 0], [1, 2, 3]])


GOOD = lattice(3, 0.1)
WITH_NAN = np.where(np.arange(81).reshape(27, 3) == 31, np.nan, GOOD)


@pytest.mark.parametrize("call, where, found, allowed", [
    (lambda s: s.add_particles("p", GOOD[:, :2]), "array 'positions'", "found shape (27, 2), float64", "(n, 3), of numbers"),
    (lambda s: s.add_particles("p", GOOD > 0), "array 'positions'", "found shape (27, 3), bool", "(n, 3), of numbers"),
    (lambda s: s.add_particles("p", GOOD[:0]), "array 'positions'", "found no particles", "at least one"),
    (lambda s: s.add_particles("p", WITH_NAN), "array 'positions'", "row 10 is [0.1, nan, 0.1]", "finite numbers"),
    (lambda s: s.add_particles("p", GOOD + 1e300), "array 'positions'", "row 0 is", "single precision"),
    (lambda s: s.add_particles("p", "block.ply"), "array 'positions'", "found shape ()", "(n, 3)"),
    (lambda s: s.add_particles("p", GOOD, GOOD[:5]), "array 'velocities'", "found shape (5, 3)", "(n, 3) with n = 27"),
    (lambda s: s.add_particles("p", GOOD, -np.inf * np.ones(3)), "array 'velocities'", "row 0 is -inf", "finite"),
    (lambda s: s.add_particles("p", GOOD, None, {"heat": GOOD[:5, 0]}), "array 'heat'", "found shape (5,)", "n = 27"),
    (lambda s: s.add_particles("p", GOOD, None, {"heat": WITH_NAN[:, 1]}), "array 'heat'", "row 10 is nan", "finite"),
    (lambda s: s.add_particles("p", GOOD, None, {"mark": np.full(27, 2**40)}), "array 'mark'", str(2**40), "32 bits"),
    (lambda s: s.add_particles("p", GOOD, None, {"id": np.arange(27)}), "array 'id'", "every particle has", "another name"),
    (lambda s: s.add_particles("p", GOOD, None, {"1 a": np.arange(27)}), "", "'1 a' is not a valid name", "letters"),
    (lambda s: s.add_mesh("m", CUBE[:, 0], CUBE_FACES), "array 'vertices'", "found shape (8,)", "(n, 3)"),
    (lambda s: s.add_mesh("m", CUBE, CUBE_FACES.astype(float)), "array 'faces'", "float64", "(m, 3), of integers"),
    (lambda s: s.add_mesh("m", CUBE, CUBE_FACES + 1), "array 'faces'", "row 2 is [5, 7, 8]", "from 0 to 7"),
    (lambda s: s.add_mesh("m", CUBE, CUBE_FACES - 1), "array 'faces'", "row 0 is [-1, 0, 2]", "from 0 to 7"),
    (lambda s: s.add_mesh("m", CUBE, CUBE_FACES[:0]), "array 'faces'", "found no rows", "at least one"),
    (lambda s: weir.motion([0, 1, 1], np.zeros((3, 3))), "array 'times'", "row 2 is 1, after 1", "increase"),
    (lambda s: weir.motion([-1, 1], np.zeros((2, 3))), "array 'times'", "begins at -1 s", "at least 0"),
    (lambda s: weir.motion([0, np.nan], np.zeros((2, 3))), "array 'times'", "row 1 is nan", "finite"),
    (lambda s: weir.motion([0, 1], np.zeros((3, 3))), "array 'positions'", "found shape (3, 3)", "n = 2"),
    (lambda s: weir.motion([0, 1]), "array 'positions'", "neither", "poses"),
    (lambda s: weir.motion([0, 1], None, np.ones((2, 4))), "array 'rotations'", "row 0 has the length 2", "length 1"),
    (lambda s: weir.motion([0, 1], None, -np.tile(np.eye(3), (2, 1, 1))), "array 'rotations'", "row 0 is no rotation", "determinant"),
    (lambda s: weir.motion([0, 1], poses=np.ones((2, 4, 4))), "array 'poses'", "last row", "turns"),
])
def test_an_error_says_which_array_what_was_found_and_what_is_allowed(call, where, found, allowed):
    with pytest.raises(weir.Error) as raised:
        call(weir.Scene())
    error = raised.value
    assert error.where == where and found in error.found and allowed in error.allowed, str(error)
    assert error.kind == "usage" and error.found in str(error) and error.allowed in str(error)


def test_an_attribute_that_the_fluid_computes_is_refused():
    scene = thrown(GOOD, None, {"density": np.ones(27)})
    with pytest.raises(weir.Error, match="'density'.*computes itself"):
        weir.Simulation(scene, device="cpu")


def test_new_arrays_take_a_reset():
    scene = thrown(GOOD)
    sim = weir.Simulation(scene, device="cpu")
    scene.cloud.set_particles(GOOD + 1, (0, 1, 0))
    with pytest.raises(weir.Error, match="new arrays of 'cloud'"):
        sim.step()
    sim.reset()
    assert np.allclose(in_order(scene.water, "position"), GOOD + 1)


# Meshes

def with_obstacle(add) -> weir.Scene:
    scene = dam_break()
    solid = scene.add("SemiAnalyticalSFI", "solid")
    add(scene).surface >> solid.solids
    scene.water.fluid >> solid.fluid
    return scene


def positions_after(scene: weir.Scene, frames: int) -> np.ndarray:
    weir.Simulation(scene, device="cpu", threads=2).advance(frames)
    return scene.water.positions.copy()


def test_a_mesh_from_arrays_is_that_of_a_file(tmp_path):
    head = ["ply", "format ascii 1.0", "element vertex 8", *[f"property float {axis}" for axis in "xyz"],
            "element face 12", "property list uchar int vertex_indices", "end_header"]
    rows = [f"{x} {y} {z}" for x, y, z in CUBE] + [f"3 {a} {b} {c}" for a, b, c in CUBE_FACES]
    (tmp_path / "cube.ply").write_text("\n".join(head + rows))
    place = {"unit": 0.2, "position": (0.5, 0, 0.1)}
    fromFile = with_obstacle(lambda s: s.add("MeshFile", "cube", file=tmp_path / "cube.ply", **place))
    fromArrays = with_obstacle(lambda s: s.add_mesh("cube", CUBE, CUBE_FACES, **place))
    assert np.array_equal(positions_after(fromFile, 3), positions_after(fromArrays, 3))
    mesh = fromArrays.cube.surface.value
    assert mesh.vertices.min(axis=0) == pytest.approx((0.5, 0, 0.1)) and mesh.vertices.max(axis=0) == pytest.approx((0.7, 0.2, 0.3))


def test_a_mesh_goes_wherever_meshes_go():
    scene = weir.Scene()
    cube = scene.add_mesh("cube", CUBE, CUBE_FACES)
    sampler = scene.add("MeshSampler", "filled")
    cube.surface >> sampler.surface
    sampler.particles >> scene.add("ParticleFluid", "water", spacing=0.1, rest_steps=0).initial
    weir.Simulation(scene, device="cpu")
    assert 900 < scene.water.count < 1100
    cube.set_mesh(CUBE * (1, 1, 2), CUBE_FACES)
    weir.Simulation(scene, device="cpu")
    assert 1800 < scene.water.count < 2200


def test_a_mesh_without_an_area_is_refused():
    scene = with_obstacle(lambda s: s.add_mesh("flat", CUBE * 0, CUBE_FACES))
    with pytest.raises(weir.Error, match="none of the mesh's 12 triangles has an area") as raised:
        weir.Simulation(scene, device="cpu")
    assert raised.value.node == "flat"


# Saving

def test_a_saved_scene_runs_alike(tmp_path):
    rng = np.random.default_rng(3)
    scene = with_obstacle(lambda s: s.add_mesh("cube", CUBE * 0.2, CUBE_FACES, position=(0.5, 0, 0.1)))
    count = len(GOOD)
    drops = scene.add_particles("drops", 0.5 * GOOD + (0.6, 0.5, 0.1), (0, -1, 0),
                                {"heat": rng.random(count), "mark": np.arange(count), "home": rng.random((count, 3))})
    drops.particles >> scene.water.initial
    scene.save(tmp_path / "drops.json")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["drops.cube.ply", "drops.drops.ply", "drops.json"]
    written = json.loads((tmp_path / "drops.json").read_text())
    assert written["nodes"]["drops"]["params"] == {"file": "drops.drops.ply", "attributes": ["heat", "mark", "home"]}
    read = weir.load(tmp_path / "drops.json")
    assert np.array_equal(positions_after(read, 3), positions_after(scene, 3))
    for name in ("heat", "mark", "home", "velocity", "id"):
        assert np.array_equal(read.water.particles[name], scene.water.particles[name]), name


def test_a_copy_has_the_arrays():
    scene = thrown(GOOD, (0, 1, 0), {"heat": GOOD[:, 0]})
    copy = scene.copy()
    scene.cloud.set_particles(GOOD + 5)
    weir.Simulation(copy, device="cpu")
    assert np.array_equal(in_order(copy.water, "position"), GOOD.astype(np.float32))
    assert np.array_equal(in_order(copy.water, "heat"), GOOD[:, 0].astype(np.float32))
    assert copy.cloud.file == "" and list(copy.cloud.attributes) == []


def test_text_cannot_hold_arrays():
    scene = thrown(GOOD)
    with pytest.raises(weir.Error, match="node 'cloud'.*holds arrays") as raised:
        scene.to_json()
    assert "save(path)" in raised.value.allowed


def test_a_checkpoint_belongs_to_its_arrays(tmp_path):
    scene = thrown(GOOD)
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(2)
    sim.save(tmp_path / "state.h5")
    weir.Simulation.resume(thrown(GOOD), tmp_path / "state.h5", device="cpu").advance(1)
    with pytest.raises(weir.Error, match="cloud: the arrays are others now"):
        weir.Simulation.resume(thrown(GOOD + 0.001), tmp_path / "state.h5", device="cpu")


# Motions

def turn(axis, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def moving(**motion) -> weir.Scene:
    scene = with_obstacle(lambda s: s.add("BoxMesh", "box", min=(0.6, 0.05, 0.1), max=(0.7, 0.2, 0.3)))
    scene.solid.set(**motion)
    return scene


@pytest.mark.parametrize("form", ["matrices", "quaternions", "poses"])
def test_solids_move_as_the_arrays_say(form):
    rng = np.random.default_rng(5)
    times, axes, angles = np.linspace(0, 2, 9), rng.normal(size=(9, 3)), rng.uniform(-3, 3, 9)
    matrices = np.array([turn(axis, angle) for axis, angle in zip(axes, angles)])
    places = rng.uniform(-0.1, 0.1, (9, 3))
    if form == "matrices":
        motion = weir.motion(times, places, matrices)
    elif form == "quaternions":
        units = axes / np.linalg.norm(axes, axis=1)[:, None]
        motion = weir.motion(times, places, np.column_stack([np.cos(angles / 2), np.sin(angles / 2)[:, None] * units]))
    else:
        poses = np.tile(np.eye(4), (9, 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = matrices, places
        motion = weir.motion(times, poses=poses)
    scene = moving(**motion)
    weir.Simulation(scene, device="cpu")
    for time, matrix, place in zip(times, matrices, places):
        pose = scene.solid.pose(time)
        assert np.allclose(pose.matrix[:3, :3], matrix, atol=1e-5) and np.allclose(pose.translation, place, atol=1e-6)
        assert np.allclose(pose.apply(CUBE), CUBE @ matrix.T + place, atol=1e-5)


def test_between_two_rotations_it_is_the_shortest_turn():
    axis, angle = (1, 2, -1), 2.6
    scene = moving(**weir.motion([0, 1, 2], None, [np.eye(3), turn(axis, angle), turn(axis, 2 * angle)]))
    weir.Simulation(scene, device="cpu")
    for time in (0.25, 0.5, 0.9, 1.5):
        assert np.allclose(scene.solid.pose(time).matrix[:3, :3], turn(axis, time * angle), atol=2e-6)
    assert np.array_equal(scene.solid.pose(3).rotation, scene.solid.pose(2).rotation)


def test_angles_may_turn_more_than_once():
    scene = moving(**weir.motion([0, 1], None, [(0, 0, 0), (0, 720, 0)]))
    weir.Simulation(scene, device="cpu")
    assert np.allclose(scene.solid.pose(0.125).matrix[:3, :3], turn((0, 1, 0), np.pi / 2), atol=1e-6)


def test_a_motion_is_saved_and_run(tmp_path):
    motion = weir.motion(np.linspace(0, 0.2, 5), np.linspace((0, 0, 0), (-0.1, 0, 0), 5), [turn((0, 1, 0), a) for a in np.linspace(0, 1, 5)])
    scene = moving(**motion)
    scene.save(tmp_path / "moving.json")
    assert np.array_equal(positions_after(weir.load(tmp_path / "moving.json"), 3), positions_after(scene, 3))


def test_steps_are_as_short_as_the_turn_asks():
    """With cfl, no point of the solid moves farther in a step than cfl times the spacing: rotations as quaternions count."""
    scene = moving(**weir.motion([0, 0.2], None, [np.eye(3), turn((0, 1, 0), 3.0)]))
    scene.world.set(cfl=0.4, dt=0.02, min_dt=1e-5)
    sim = weir.Simulation(scene, device="cpu")
    radius = np.linalg.norm(scene.box.surface.value.vertices, axis=1).max()
    sim.step()
    assert 0 < sim.time <= 1.001 * 0.4 * scene.water.spacing / (3.0 / 0.2 * radius)
