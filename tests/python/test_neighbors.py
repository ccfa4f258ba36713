"""Neighbours as arrays, and sums over them."""

import numpy as np
import pytest

import weir
from conftest import dam_break, falling_drop


def pairs_of(offsets, indices) -> set:
    first = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    return set(zip(first.tolist(), indices.tolist()))


def all_pairs(positions, reach: float) -> tuple[set, set]:
    """Those nearer than reach, and those for which rounding decides."""
    apart = np.linalg.norm(positions[:, None].astype(float) - positions[None].astype(float), axis=2)
    np.fill_diagonal(apart, np.inf)
    return set(zip(*map(list, np.nonzero(apart < reach)))), set(zip(*map(list, np.nonzero(abs(apart - reach) < 1e-5))))


def spiky_sum(positions, offsets, indices, reach: float):
    """Of (1 - r/H)^3 over the neighbours of each particle, itself included."""
    first = np.repeat(np.arange(len(positions)), np.diff(offsets))
    r = np.linalg.norm(positions[first] - positions[indices], axis=1)
    return 1 + np.bincount(first, weights=np.clip(1 - r / reach, 0, None) ** 3, minlength=len(positions))


def test_lists_are_all_pairs_within_the_support():
    scene = dam_break(spacing=0.06)
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(3)
    offsets, indices = scene.water.neighbors()
    assert offsets.dtype == indices.dtype == np.int32
    assert len(offsets) == scene.water.count + 1 and offsets[0] == 0 and offsets[-1] == len(indices)
    expected, uncertain = all_pairs(scene.water.positions, 2 * scene.water.spacing)
    found = pairs_of(offsets, indices)
    assert len(found) == len(indices) > 1000 and found ^ expected <= uncertain
    assert {(j, i) for i, j in found} == found


def test_a_sum_in_python_is_the_density():
    scene = falling_drop(spacing=0.04)
    seen = {}

    class Density(weir.Module):
        """Sums the density."""

        def step(self, fluid, dt):
            offsets, indices = fluid.neighbors()
            sums = spiky_sum(fluid.positions, offsets, indices, fluid.support_radius)
            fluid["own_density"][:] = fluid.particle_mass * fluid.kernel_at_0 * sums
            seen["pairs"], seen["positions"] = pairs_of(offsets, indices), fluid.positions.copy()
            seen["factor"] = fluid.particle_mass * fluid.kernel_at_0

        def reset(self, fluid):
            fluid.particles.add("own_density", "float")

    scene.water.modules.insert("density", Density(), after="neighbors")
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(1)
    expected, uncertain = all_pairs(seen["positions"], 0.08)
    assert seen["pairs"] ^ expected <= uncertain
    # The drop falls as one, so its density is what it was within the step: that of C++ at the frame.
    assert np.allclose(scene.water.particles["own_density"], scene.water.particles["density"], rtol=2e-3)
    # The same sum at the frame itself.
    sums = spiky_sum(scene.water.positions, *scene.water.neighbors(), 2 * scene.water.spacing)
    assert np.allclose(seen["factor"] * sums, scene.water.particles["density"], rtol=1e-5)


@pytest.mark.parametrize("place", [{"before": "predict"}, {"before": "neighbors"}])
def test_before_the_search_there_are_none(place):
    class Early(weir.Module):
        """Asks too early."""

        def step(self, fluid, dt):
            fluid.neighbors()

    scene = dam_break()
    scene.water.modules.insert("early", Early(), **place)
    sim = weir.Simulation(scene, device="cpu")
    with pytest.raises(weir.Error, match="not known yet") as raised:
        sim.step()
    assert 'after="neighbors"' in raised.value.allowed


def test_a_reset_has_none():
    class InReset(weir.Module):
        """Asks too early."""

        def reset(self, fluid):
            fluid.particles.neighbors()

        def step(self, fluid, dt):
            pass

    scene = dam_break()
    scene.water.modules.insert("early", InReset(), after="neighbors")
    with pytest.raises(weir.Error, match="not known yet"):
        weir.Simulation(scene, device="cpu")


def test_no_particles_have_no_neighbors():
    scene = dam_break()
    scene.water.set(domain_min=(5, 5, 5), domain_max=(6, 6, 6))
    weir.Simulation(scene, device="cpu")
    offsets, indices = scene.water.neighbors()
    assert offsets.tolist() == [0] and len(indices) == 0


def test_arrays_outlive_what_they_came_from():
    scene = dam_break()
    sim = weir.Simulation(scene, device="cpu")
    offsets, indices = scene.water.neighbors()
    kept = indices.copy()
    sim.advance(2)
    del sim, scene
    assert np.array_equal(indices, kept) and offsets[-1] == len(kept)
