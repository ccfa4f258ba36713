"""Surfaces, measurements, forces and poses as arrays, and checkpoints."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import weir
from conftest import dam_break, falling_drop


def with_surface(scene: weir.Scene) -> weir.Scene:
    scene.water.fluid >> scene.add("FluidSurface", "skin", cell_size=0.5).fluid
    return scene


def area_and_volume(mesh: weir.Mesh) -> tuple[float, float]:
    a, b, c = (mesh.vertices[mesh.faces[:, i]].astype(float) for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def test_the_surface_of_a_drop_is_a_sphere():
    scene = with_surface(falling_drop(spacing=0.02))
    sim = weir.Simulation(scene, device="cpu")
    sim.refresh()
    mesh = scene.skin.surface.value
    assert mesh.vertices.dtype == mesh.normals.dtype == np.float32 and mesh.faces.dtype == np.int32
    assert mesh.vertices.shape == mesh.normals.shape == mesh.velocities.shape and mesh.faces.shape[1] == 3
    assert mesh.faces.min() == 0 and mesh.faces.max() == len(mesh.vertices) - 1
    radius = np.linalg.norm(mesh.vertices, axis=1)
    assert abs(radius.mean() - 0.2) < 0.01 and radius.std() < 0.01
    assert (np.einsum("ij,ij->i", mesh.normals, mesh.vertices) / radius > 0.9).all()
    area, volume = area_and_volume(mesh)
    assert area == pytest.approx(4 * np.pi * radius.mean() ** 2, rel=0.05)
    assert volume == pytest.approx(4 / 3 * np.pi * radius.mean() ** 3, rel=0.05)
    assert repr(mesh) == f"<Mesh of {len(mesh.vertices)} vertices and {len(mesh.faces)} faces>"


def test_the_surface_has_the_velocity_of_the_fluid():
    scene = with_surface(falling_drop(spacing=0.05))
    sim = weir.Simulation(scene, device="cpu")
    scene.water.velocities = (1, 2, 3)
    sim.refresh()
    assert np.allclose(scene.skin.surface.value.velocities, (1, 2, 3), atol=1e-5)
    kept = scene.skin.surface.value
    before = kept.vertices.copy()
    sim.advance(1)
    assert np.array_equal(kept.vertices, before)  # a copy
    moved = scene.skin.surface.value.vertices.mean(axis=0) - before.mean(axis=0)
    assert np.allclose(moved, (0.1, 0.2 - 0.5 * 9.8 * 0.1 * 0.11, 0.3), atol=0.01)


def test_sums_at_points_are_those_of_gauges():
    scene = dam_break()
    points = np.array([(0.2, 0.2, 0.2), (0.1, 0.35, 0.3), (0.2, 0.41, 0.2)])
    for i, point in enumerate(points):
        scene.water.fluid >> scene.add("Gauge", f"gauge{i}", shape="point", position=point).particles
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(3)
    filled, velocity = scene.water.sample(points), scene.water.sample(points, "velocity")
    density = scene.water.sample(points, "density")
    for i in range(3):
        values = scene[f"gauge{i}"].values
        assert {"type": "Gauge", **values} == sim.statistics["nodes"][f"gauge{i}"]
        assert filled[i] == pytest.approx(values["filled"], rel=1e-5)
        assert velocity[i] == pytest.approx(values["velocity"], rel=1e-4)
        assert density[i] == pytest.approx(values["density"], rel=1e-5)
    assert scene.water.sample([(9, 9, 9)])[0] == 0 and np.isnan(scene.water.sample([(9, 9, 9)], "velocity")).all()


def test_sums_at_points_are_sums():
    """The kernel's sum over all particles, without cells, also far from the origin and on its negative side."""
    scene = falling_drop()
    weir.Simulation(scene, device="cpu")
    for shift in ((0, 0, 0), (-70, 30, -500)):
        scene.water.positions[:] += np.float32(shift)
        points = np.float32(shift) + np.random.default_rng(2).uniform(-0.4, 0.4, (50, 3)).astype(np.float32)
        apart = points[:, None].astype(float) - scene.water.positions[None].astype(float)
        reach, squared = 0.2, (apart**2).sum(axis=2)
        kernel = 315 / (64 * np.pi * reach**3) * np.clip(1 - squared / reach**2, 0, None) ** 3
        assert np.allclose(scene.water.sample(points), 0.1**3 * kernel.sum(axis=1), rtol=1e-4, atol=1e-6)
    with pytest.raises(weir.Error, match="no particle attribute 'velocty'.*") as raised:
        scene.water.sample([(0, 0, 0)], "velocty")
    assert "'velocity'" in raised.value.hint
    with pytest.raises(weir.Error, match="type int64, which has no mean"):
        scene.water.sample([(0, 0, 0)], "id")


def test_forces_on_solids():
    scene = dam_break()
    floor = scene.add("BoxMesh", "floor", min=(-0.5, -0.2, -0.5), max=(1.5, 0, 1))
    solid = scene.add("SemiAnalyticalSFI", "solid")
    floor.surface >> solid.solids
    scene.water.fluid >> solid.fluid
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(3)
    forces = scene.solid.forces.value
    assert list(forces) == ["floor"]
    force, said = forces["floor"], sim.statistics["nodes"]["solid"]["solids"][0]
    assert force.force.tolist() == said["force"] and force.torque.tolist() == said["torque"]
    assert force.force[1] < 0  # water falls on it
    assert np.array_equal(scene.solid.pose().matrix, np.eye(4))


def test_outputs_of_other_nodes():
    scene = dam_break()
    assert len(weir.Scene()) == 0
    with pytest.raises(weir.Error, match="node 'block'.*nothing to show yet"):
        scene.block.particles.value
    sim = weir.Simulation(scene, device="cpu")
    batch = scene.block.particles.value
    assert len(batch) == scene.water.count and batch.velocities.shape == batch.positions.shape and batch.attributes == {}
    assert scene.water.fluid.value.count == len(batch)
    assert scene.tank.boundary.value.distances([(0.1, 0.5, 0.2), (0.1, -0.1, 0.2)]) == pytest.approx([0.1, -0.1])
    assert [port.path for port in scene.water.boundaries.links] == ["tank.boundary"] and scene.water.sinks.value == []
    assert [len(given) for given in scene.water.initial.value] == [len(batch)]
    assert scene.water.boundaries.value[0].normals([(0.1, 0.5, 0.2)]) == pytest.approx(np.array([(1, 0, 0)]))
    scene.add("Sink", "drain", min=(2, 2, 2), max=(3, 3, 3))
    sim.reset()
    with pytest.raises(weir.Error, match="type SinkRegion has no value"):
        [port.value for port in scene.drain._outputs()]
    assert not hasattr(scene.water, "pose")
    scene.add("Gauge", "late")
    with pytest.raises(weir.Error, match="after the new node 'late'"):
        scene.late.values
    sim.close()
    with pytest.raises(weir.Error, match="nothing to show yet"):
        scene.water.values


# Checkpoints

def program() -> Path:
    found = Path(weir.__file__).resolve().parents[2] / "bin" / "weir"
    if not found.is_file():
        pytest.skip("the program weir is not built beside the package")
    return found


def state(scene: weir.Scene) -> dict[str, np.ndarray]:
    return {name: scene.water.particles[name].copy() for name in scene.water.particles}


def same(a: dict, b: dict) -> bool:
    return a.keys() == b.keys() and all(np.array_equal(a[name], b[name]) for name in a)


def test_a_simulation_goes_on_from_where_it_was_saved(tmp_path):
    scene = dam_break()
    sim = weir.Simulation(scene, device="cpu", threads=2)
    sim.advance(2)
    sim.save(tmp_path / "state.h5")
    saved = state(scene)
    sim.advance(2)
    other = dam_break()
    resumed = weir.Simulation.resume(other, tmp_path / "state.h5", device="cpu", threads=1)
    assert (resumed.frame, resumed.device) == (2, "cpu") and same(state(other), saved)
    resumed.advance(2)
    assert resumed.steps == sim.steps and same(state(other), state(scene))


def test_saving_at_time_0_and_saving_change_nothing(tmp_path):
    first, second = dam_break(), dam_break()
    a, b = (weir.Simulation(scene, device="cpu") for scene in (first, second))
    a.save(tmp_path / "start.h5")
    for sim in (a, b):
        sim.advance(2)
    a.save(tmp_path / "start.h5")
    assert (tmp_path / "start.previous.h5").is_file()
    for sim in (a, b):
        sim.advance(1)
    assert same(state(first), state(second))


def test_the_command_and_python_take_each_others_checkpoints(tmp_path):
    scene = dam_break()
    scene.save(tmp_path / "dam.json")
    run = [program(), "run", tmp_path / "dam.json", "--device", "cpu", "--checkpoint-every", "1"]
    whole = weir.Simulation(scene, device="cpu")
    whole.advance(2)
    whole.save(tmp_path / "python.h5")
    whole.advance(3)
    # The command goes on from Python's, and Python from the command's.
    for arguments in (["--checkpoint", tmp_path / "resumed.h5", "--resume", tmp_path / "python.h5", "--frames", "5"],
                      ["--checkpoint", tmp_path / "command.h5", "--frames", "5"]):
        done = subprocess.run([*map(str, run), *map(str, arguments)], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
    for file in ("resumed.h5", "command.h5"):
        other = weir.load(tmp_path / "dam.json")
        sim = weir.Simulation.resume(other, tmp_path / file, device="cpu")
        assert sim.frame == whole.frame and same(state(other), state(scene)), file


def test_a_checkpoint_is_of_a_frame_and_of_its_scene(tmp_path):
    scene = dam_break()
    sim = weir.Simulation(scene, device="cpu")
    sim.step()
    with pytest.raises(weir.Error, match="between two frames") as raised:
        sim.save(tmp_path / "state.h5")
    assert "advance()" in raised.value.allowed
    sim.advance(1)
    with pytest.raises(weir.Error, match="of no known kind"):
        sim.save(tmp_path / "state.txt")
    with pytest.raises(weir.Error):
        sim.save(tmp_path / "missing" / "state.h5")
    sim.save(tmp_path / "state.h5")
    with pytest.raises(weir.Error, match="nodes.water.params.spacing: 0.05 then, 0.06"):
        weir.Simulation.resume(dam_break(spacing=0.06), tmp_path / "state.h5", device="cpu")
    sim.advance(1)  # nothing is broken by that


def test_the_state_of_modules_is_saved(tmp_path):
    @weir.register
    class Counting(weir.Module):
        """Counts steps."""

        state = ("count",)

        def reset(self, fluid):
            self.count = 0

        def step(self, fluid, dt):
            self.count += 1

    def make():
        scene = dam_break()
        scene.water.modules.insert("counting", Counting(), before="predict")
        return scene

    sim = weir.Simulation(make(), device="cpu")
    sim.advance(2)
    sim.save(tmp_path / "state.h5")
    resumed = weir.Simulation.resume(make(), tmp_path / "state.h5", device="cpu")
    assert resumed.scene.water.modules["counting"].count == sim.steps
