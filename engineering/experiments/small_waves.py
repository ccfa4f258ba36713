"""Period of a small standing wave by the program, and what a relief of the packing's shear stress does to it
(engineering/jelly.md). Needs weir as a Python module and numpy, and scipy for the relief.

  python3 engineering/experiments/small_waves.py [NAME=VALUE…]

The first mode of a tank of 1 m, 0.4 m deep, periodic across, starts with the velocities of potential flow; its
closed form has ω² = g·k·tanh(k·h). With projections=1 (and modulus=0) its solver is TwoProjections with this
`smoothing`. With ends=0 the tank is periodic along, too, and the wave is 1 m long: deep enough for the floor to matter
little. With mesh=1 the walls are a mesh of SemiAnalyticalSFI. With relief = 1 each step begins with

  v_i ← v_i + (dt/ρ0)·Σ_j V0·(D_i + D_j)·|W'|/r·r_ij,   D_i = K·(λ_i − 1)·dev(M_i)/m_i,   M_i = Σ_j V0·|W'|/r·r⊗r,

m_i being a third of the trace of M_i: the stress of the pairs with the opposite deviator. Particles whose
neighbours are not on all sides, at walls and the surface, have no D. D is spread over neighbours and follows with
`memory`. It is done between steps, on the CPU, to learn what it does; it is no module.
"""

import sys

import numpy as np
import weir

LENGTH, DEPTH, G = 1.0, 0.4, 9.8
# Lengths in m, but width in spacings; m/s, Pa, s. modulus=0 leaves it and the tolerance to the program; the relief
# needs pressures that are better known than by the default tolerance.
SETTINGS = dict(spacing=0.04, ratio=2.0, width=8, speed=0.2, dt=2e-3, modulus=1e6, tolerance=1e-4, viscosity=0,
                relief=0.0, memory=0.01, spread=1, duration=1.5, still=0, ends=1, mesh=0, projections=0,
                smoothing=1.0)


def tank(s):
    wide = s["width"] * s["spacing"]
    scene = weir.Scene("small waves")
    scene.world.set(duration=s["duration"], frame_rate=50, dt=s["dt"])
    block = scene.add("BoxSampler", "block", min=(0, 0, 0), max=(LENGTH, DEPTH, wide))
    beyond = 0 if s["ends"] else 1
    low, high = (-beyond, 0, -1), (LENGTH + beyond, 2 * DEPTH, 1 + wide)
    water = scene.add("ParticleFluid", "water", spacing=s["spacing"], support_ratio=s["ratio"],
                      periodic="z" if s["ends"] else "xz", domain_min=(-0.5 * s["ends"], -0.5, 0),
                      domain_max=(LENGTH + 0.5 * s["ends"], 1.5, wide))
    if s["modulus"] > 0:
        water.set(bulk_modulus=s["modulus"])
        water.modules["solver"].set(tolerance=s["tolerance"])
    if s["projections"]:
        water.modules.replace("solver", "TwoProjections", smoothing=s["smoothing"])
    water.modules["viscosity"].enabled = bool(s["viscosity"])
    block.particles >> water.initial
    if s["mesh"]:
        walls = scene.add("SemiAnalyticalSFI", "tank", fill="container")
        scene.add("BoxMesh", "box", min=low, max=high).surface >> walls.solids
        water.fluid >> walls.fluid
    else:
        walls = scene.add("StaticBoundary", "tank", shape="box", min=low, max=high, inverted=True)
        walls.boundary >> water.boundaries
    return scene, water, wide


def mode(x, k):
    """Velocities of the mode whose surface moves by 1."""
    along, up = k * x[:, 0], k * x[:, 1]
    return np.column_stack([-np.sin(along) * np.cosh(up), np.cos(along) * np.sinh(up), 0 * up]) / np.sinh(k * DEPTH)


class Relief:
    def __init__(self, s, x, wide):
        self.s, self.wide, self.H, self.V0 = s, wide, s["ratio"] * s["spacing"], s["spacing"] ** 3
        self.kept = np.zeros((0, 6))  # D by the number of a particle
        # The calibration with which the pressure in the middle, K·(λ − 1)·m, is that of the water above.
        self.factor, self.full = 1, 1
        _, _, _, lam, M = self.sums(x)
        inside = (np.abs(x[:, 0] - LENGTH / 2) < LENGTH / 4) & (np.abs(x[:, 1] - DEPTH / 2) < DEPTH / 8)
        self.full = np.mean(M[inside, :3]) / np.mean(lam[inside])
        compressed = 1000 * G * np.mean(DEPTH - x[inside, 1]) / (s["modulus"] * self.full)
        self.factor = (1 + compressed) / np.mean(lam[inside])

    def sums(self, x):
        """Ends and ways of all pairs, |W'|/r and W of each, λ and M of each particle."""
        from scipy.spatial import cKDTree
        images, index = x, np.arange(len(x))
        for axis, size in [(2, self.wide)] + [(0, LENGTH)] * (not self.s["ends"]):
            high, low = np.flatnonzero(images[:, axis] > size - self.H), np.flatnonzero(images[:, axis] < self.H)
            shift = size * np.eye(3)[axis]
            images = np.concatenate([images, images[high] - shift, images[low] + shift])
            index = np.concatenate([index, index[high], index[low]])
        pairs = cKDTree(x).sparse_distance_matrix(cKDTree(images), self.H, output_type="coo_matrix")
        i, j, r = pairs.row[pairs.data > 1e-6], pairs.col[pairs.data > 1e-6], pairs.data[pairs.data > 1e-6]
        way = images[j] - x[i]
        t = 1 - r / self.H
        scale = self.factor * 15 / (np.pi * self.H ** 3)
        w, a = scale * t ** 3, scale * 3 / self.H * t ** 2 / r
        lam = self.V0 * (scale + np.bincount(i, w, len(x)))
        M = np.stack([np.bincount(i, self.V0 * a * way[:, p] * way[:, q], len(x))
                      for p, q in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], 1)
        return (i, index[j], way), w, a, lam, M

    def change(self, x, ids):
        s = self.s
        (i, j, way), w, a, lam, M = self.sums(x)
        m = M[:, :3].mean(1)
        whole = np.clip((m / self.full - 0.8) / 0.15, 0, 1)
        M[:, :3] -= m[:, None]
        D = (whole * s["modulus"] * np.maximum(lam - 1, 0) / np.maximum(m, 1e-9))[:, None] * M
        own = self.factor * 15 / (np.pi * self.H ** 3)
        for _ in range(s["spread"]):
            total = own + np.bincount(i, w, len(x))
            D = np.stack([(own * d + np.bincount(i, w * d[j], len(x))) / total for d in D.T], 1)
        if max(ids) >= len(self.kept):
            self.kept = np.concatenate([self.kept, np.zeros((max(ids) + 1 - len(self.kept), 6))])
        self.kept[ids] += s["dt"] / (s["dt"] + s["memory"]) * (D - self.kept[ids])
        kept = self.kept[ids]
        both = kept[i] + kept[j]
        tensor = both[:, [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
        force = self.V0 * a[:, None] * np.einsum("npq,nq->np", tensor, way)
        return s["relief"] * s["dt"] / 1000 * np.stack([np.bincount(i, f, len(x)) for f in force.T], 1)


def main():
    s = dict(SETTINGS)
    for word in sys.argv[1:]:
        name, value = word.split("=")
        s[name] = type(s[name])(float(value))
    k = np.pi / LENGTH * (1 if s["ends"] else 2)
    omega = np.sqrt(G * k * np.tanh(k * DEPTH))
    scene, water, wide = tank(s)
    sim = weir.Simulation(scene, device="cpu")
    sim.refresh()
    x = np.array(water.positions, dtype=float)
    relief = Relief(s, x, wide) if s["relief"] > 0 else None
    if not s["still"]:
        water.velocities[:] = s["speed"] * mode(x, k)
    times, speeds, noise, energy = [], [], [], []
    while sim.time < s["duration"]:
        x, v = np.array(water.positions, dtype=float), np.array(water.velocities, dtype=float)
        shape = mode(x, k)
        times.append(sim.time)
        speeds.append(np.sum(v * shape) / np.sum(shape ** 2))
        noise.append(np.sqrt(np.mean(np.sum((v - speeds[-1] * shape) ** 2, 1))))
        energy.append(np.mean(np.sum(v ** 2, 1) / 2 + G * x[:, 1]))
        if relief:
            water.velocities[:] = (v + relief.change(x, np.array(water.particles.ids))).astype(np.float32)
        sim.step()
    t, a = np.array(times), np.array(speeds)
    print(*sys.argv[1:], f"({len(x)} particles)")
    if not s["still"]:
        z = np.flatnonzero(np.diff(np.sign(a)))
        zeros = t[z] - a[z] * (t[z + 1] - t[z]) / (a[z + 1] - a[z])
        period = 2 * np.mean(np.diff(zeros))
        lost = [100 * (1 - np.max(np.abs(a[low:high])) / s["speed"]) for low, high in zip(z[:2], z[1:3])]
        print(f"  period {period:.4f} s, {100 * (period * omega / 2 / np.pi - 1):+.1f} %; {lost[0]:.1f} % lost in the first "
              f"half" + (f", {lost[1]:.1f} % in the first period" if lost[1:] else ""))
    each = max(1, len(t) // 8)
    print("  velocities beside the wave, m/s:", *np.round(noise[::each], 3))
    print("  energy gained, J/kg:", *np.round(np.array(energy[::each]) - energy[0], 4))


if __name__ == "__main__":
    main()
