"""Bodies: read, placed, and driven in a loop."""

import numpy as np
import pytest

import weir
from conftest import DEVICE


def body_scene(**params: object) -> weir.Scene:
    """A box of half a metre times 0.2 m times 0.3 m that falls."""
    scene = weir.Scene("A body")
    scene.world.set(duration=5, dt=0.005, frame_rate=20, gravity=(0, -10, 0))
    box = scene.add("BoxMesh", "box", min=(-0.25, -0.1, -0.15), max=(0.25, 0.1, 0.15))
    box.surface >> scene.add("RigidBody", "body", **{"mass": 3, **params}).mesh
    return scene


def test_poses_and_velocities_are_those_of_now():
    scene = body_scene(velocity=(1, 0, 0), angular_velocity=(0, 2, 0))
    sim = weir.Simulation(scene, device=DEVICE)
    for k in range(1, 14):  # frames end at steps 10, 20, …
        sim.step()
        pose, motion = scene.body.pose(), scene.body.motion()
        assert pose.translation == pytest.approx([0.005 * k, -10 * 0.005**2 * k * (k + 1) / 2, 0], abs=1e-6)
        assert motion.velocity == pytest.approx([1, -0.05 * k, 0], abs=1e-9)
        assert motion.angular_velocity == pytest.approx([0, 2, 0], abs=1e-9)
        angle = 2 * np.arctan2(pose.rotation[2], pose.rotation[0])
        assert angle == pytest.approx(0.01 * k, abs=1e-5)


def test_bodies_are_placed_and_fly_on():
    scene = body_scene(fixed="z")
    sim = weir.Simulation(scene, device=DEVICE)
    sim.advance(1)
    half = np.sqrt(0.5)
    scene.body.place(weir.Pose((half, 0, half, 0), (1, 2, 3)), velocity=(4, 5, 6), angular_velocity=(0, 7, 0))
    assert scene.body.pose().translation == pytest.approx([1, 2, 3])
    assert scene.body.motion().velocity == pytest.approx([4, 5, 0])
    scene.body.place(velocity=(0, 1, 0))  # the rest stays
    assert scene.body.pose().translation == pytest.approx([1, 2, 3])
    assert scene.body.motion().angular_velocity == pytest.approx([0, 7, 0])
    sim.step()
    assert scene.body.motion().velocity == pytest.approx([0, 0.95, 0])


def test_what_is_no_place_is_refused():
    scene = body_scene()
    with pytest.raises(weir.Error, match="nothing to show yet"):
        scene.body.motion()
    sim = weir.Simulation(scene, device=DEVICE)
    with pytest.raises(weir.Error, match="3 finite numbers"):
        scene.body.place(velocity=(1, np.nan, 0))
    with pytest.raises(weir.Error, match="4 finite numbers"):
        scene.body.place(weir.Pose((1, 0, 0), (0, 0, 0)))
    with pytest.raises(weir.Error, match="length 1"):
        scene.body.place(weir.Pose((1, 1, 0, 0), (0, 0, 0)))
    sim.close()


def test_a_controller_holds_a_body_against_its_weight():
    """A spring and a damper in a loop: it comes to rest where the spring bears the weight."""
    scene = body_scene()
    sim = weir.Simulation(scene, device=DEVICE)
    stiffness, damping, goal = 300.0, 50.0, np.array((0.2, 0.5, 0))
    while sim.time < 3:
        scene.body.applied_force = tuple(stiffness * (goal - scene.body.pose().translation)
                                         - damping * scene.body.motion().velocity)
        sim.step()
    assert scene.body.pose().translation == pytest.approx(goal - (0, 3 * 10 / stiffness, 0), abs=1e-4)
    assert np.linalg.norm(scene.body.motion().velocity) < 1e-3


def test_a_controller_holds_a_body_under_water():
    """Fluid and controller bear the weight together, and what they do beyond it is the body's acceleration."""
    scene = weir.Scene("A cube is held under water")
    scene.world.set(duration=5, dt=0.004, frame_rate=25)
    side, goal = 0.1, np.array((0, 0.12, 0))
    block = scene.add("BoxSampler", "block", min=(-0.1, 0, -0.1), max=(0.1, 0.24, 0.1))
    tank = scene.add("StaticBoundary", "tank", shape="box", min=(-0.1, 0, -0.1), max=(0.1, 1, 0.1), inverted=True)
    cube = scene.add("BoxMesh", "cube", min=(-side / 2,) * 3, max=(side / 2,) * 3)
    body = scene.add("RigidBody", "body", density=500, position=tuple(goal), fixed="xz", fixed_rotation="xyz")
    water = scene.add("ParticleFluid", "water", spacing=0.02, rest_steps=20)
    water.modules.replace("solver", "SemiImplicitSolver", iterations=20)
    block.particles >> water.initial
    tank.boundary >> water.boundaries
    tank.boundary >> body.walls
    water.fluid >> body.fluid
    cube.surface >> body.mesh
    sim = weir.Simulation(scene, device=DEVICE, threads=2)
    mass, pushed, speed = 500 * side**3, [], 0.0
    for frame in range(1, 7):
        while sim.frame < frame:
            force = 1500 * (goal - body.pose().translation) - 40 * body.motion().velocity
            body.applied_force = (0, force[1], 0)
            pushed.append(body.applied_force[1])
            sim.step()
        changed, speed = body.motion().velocity[1] - speed, body.motion().velocity[1]
        borne = body.forces.value["cube"].force[1] + np.mean(pushed)
        assert borne == pytest.approx(mass * (9.8 + changed / 0.04), abs=1e-3 * mass * 9.8)
        pushed.clear()
    assert abs(body.pose().translation[1] - goal[1]) < 0.02


def test_applied_forces_are_in_checkpoints(tmp_path):
    scene = body_scene(applied_force={"keyframes": [[0, (0, 0, 0)], [1, (30, 30, 0)]]})
    sim = weir.Simulation(scene, device=DEVICE)
    sim.advance(6)
    sim.save(tmp_path / "state.h5")
    sim.advance(6)
    expected = scene.body.pose().translation
    resumed = weir.Simulation.resume(scene, tmp_path / "state.h5", device=DEVICE)
    resumed.advance(6)
    assert (scene.body.pose().translation == expected).all()
