"""Particles as arrays that share memory with the simulation."""

import gc

import numpy as np
import pytest

import weir
from conftest import dam_break, falling_drop


def pointer(array) -> int:
    return array.__array_interface__["data"][0]


def test_arrays_share_memory(sim, scene):
    positions = scene.water.positions
    assert positions.dtype == np.float32 and positions.shape == (len(scene.water.particles), 3)
    assert pointer(positions) == pointer(scene.water.positions) == pointer(scene.water.particles["position"])
    assert positions.flags.writeable and not positions.flags.owndata
    positions[5] = (0.1, 0.2, 0.3)
    assert np.array_equal(scene.water.positions[5], np.float32([0.1, 0.2, 0.3]))
    assert pointer(np.from_dlpack(positions)) == pointer(positions)


def test_a_tensor_shares_memory(sim, scene):
    torch = pytest.importorskip("torch")
    tensor = torch.from_dlpack(scene.water.positions)
    assert tensor.data_ptr() == pointer(scene.water.positions)
    tensor[0, 1] = 0.125
    assert scene.water.positions[0, 1] == 0.125


def test_what_is_written_is_simulated():
    scene = falling_drop()
    scene.world.gravity = (0, 0, 0)
    sim = weir.Simulation(scene, device="cpu")
    ids = scene.water.ids.copy()
    start = scene.water.positions[np.argsort(ids)].copy()
    scene.water.velocities = (1, 2, 3)
    scene.water.velocities[scene.water.ids == 3] = (-1, 0, 0)
    for _ in range(10):
        sim.step()
    order = np.argsort(scene.water.ids)
    expected = start + sim.time * np.array([[1, 2, 3]])
    expected[3] = start[3] + sim.time * np.array([-1, 0, 0])
    assert np.allclose(scene.water.positions[order], expected, atol=1e-6)


def test_writing_is_what_another_start_would_be():
    """Velocities that are written at time 0 give bit for bit the run of a sampler with those velocities."""
    first, second = dam_break(), dam_break()
    first.block.velocity = (0.5, 0, 0)
    a = weir.Simulation(first, device="cpu")
    b = weir.Simulation(second, device="cpu")
    second.water.velocities[:] = (0.5, 0, 0)
    for simulation in (a, b):
        simulation.advance(3)
    assert np.array_equal(first.water.positions, second.water.positions)


def test_attributes(sim, scene):
    particles = scene.water.particles
    assert list(particles) == ["position", "velocity", "id", "density"] and "density" in particles
    assert particles.describe()["density"]["unit"] == "kg/m^3"
    assert 700 < particles["density"].mean() < 1100
    color = particles.add("color", "vec3", unit="", doc="A colour.")
    assert color.shape == (len(particles), 3) and not color.any()
    particles.add("tag", "int")[:] = scene.water.ids
    particles.add("stress", "mat3", unit="Pa")[:, 1, 2] = scene.water.ids
    particles.add("stamp", "int64")[:] = scene.water.ids + 2**40
    assert particles["stamp"].dtype == scene.water.ids.dtype == np.int64
    assert particles["stress"].shape == (len(particles), 3, 3)
    sim.advance(2)
    assert np.array_equal(particles["stress"][:, 1, 2], scene.water.ids)
    assert np.array_equal(particles["tag"], scene.water.ids)  # it travels with its particle
    assert np.array_equal(particles["stamp"], scene.water.ids + 2**40)
    assert not np.array_equal(scene.water.ids, np.arange(len(particles)))  # and they were sorted
    with pytest.raises(weir.Error, match="different types"):
        particles.add("tag", "float")
    with pytest.raises(weir.Error, match="float, vec3, int, mat3 or int64"):
        particles.add("other", "double")
    with pytest.raises(weir.Error, match="is not a valid name"):
        particles.add("a b")
    with pytest.raises(weir.Error, match="did you mean 'density'"):
        particles["densty"]
    with pytest.raises(ValueError):
        particles["velocity"] = np.zeros((2, 3))


def test_there_are_no_particles_before_a_simulation(scene):
    with pytest.raises(weir.Error, match="no particles yet"):
        scene.water.positions
    assert not hasattr(scene.tank, "positions")


def test_arrays_outlive_everything():
    scene = dam_break()
    sim = weir.Simulation(scene, device="cpu")
    positions = scene.water.positions
    expected = positions.copy()
    sim.close()
    del sim, scene
    gc.collect()
    others = [dam_break() for _ in range(3)]
    simulations = [weir.Simulation(other, device="cpu") for other in others]  # want memory of the same sizes
    assert np.array_equal(positions, expected)
    positions[:] = np.nan
    for simulation, other in zip(simulations, others):
        simulation.advance(2)
        assert np.isfinite(other.water.positions).all()


def test_memory_of_old_arrays_is_given_to_nobody_while_emission_grows_the_fluid():
    """Arrays of all steps are kept. What none of the last steps had is written to: the run is bit for bit the one
    without that."""

    def jet() -> weir.Scene:
        scene = weir.Scene()
        scene.world.set(duration=0.2, frame_rate=20, dt=0.002)
        nozzle = scene.add("SquareEmitter", "nozzle", width=0.6, height=0.6, speed=8)
        water = scene.add("ParticleFluid", "water", spacing=0.04)
        nozzle.particles >> water.emitters
        return scene

    plain, held = jet(), jet()
    weir.Simulation(plain, device="cpu", threads=2).run()
    sim = weir.Simulation(held, device="cpu", threads=2)
    old: list[list[np.ndarray]] = []
    while not sim.done:
        # Modules exchange a few arrays with one another, so what was not seen for some steps has been outgrown.
        recent = {pointer(array) for arrays in old[-8:] for array in arrays}
        for arrays in old[:-8]:
            for array in arrays:
                if pointer(array) not in recent:
                    array.fill(1e30)
        sim.step()
        old.append([held.water.positions, held.water.velocities])
    grown = {pointer(array) for arrays in old for array in arrays}
    assert len(grown) > 8  # more than those that are exchanged
    assert held.water.count == plain.water.count > 8192
    assert np.array_equal(plain.water.positions, held.water.positions)
    assert np.array_equal(plain.water.velocities, held.water.velocities)


def test_a_reset_leaves_old_arrays_alone(sim, scene):
    positions = scene.water.positions
    sim.step()
    sim.reset()
    start = scene.water.positions.copy()
    positions.fill(7)
    assert np.array_equal(scene.water.positions, start)
    sim.step()
