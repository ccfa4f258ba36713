"""A dam breaks by TwoProjections and by the default solver (engineering/jelly.md): where the front is, energy, how much
water is compressed, and ε, by which an even pressure kicks particles: d·|Σ_j (N_i + N_j)·a·r|, root of the mean square
inside the water. Needs weir as a Python module and numpy.

  python3 engineering/experiments/dam_of_projections.py [NAME=VALUE…]
"""

import sys

import numpy as np
import weir

# m, s; the width across, periodic, in spacings. solver=0 is the default one, 1 TwoProjections.
SETTINGS = dict(spacing=0.025, ratio=2.0, width=5.0, column=0.35, depth=0.4, length=1.0, dt=2e-3, duration=1.5, solver=1.0,
                smoothing=1.0)


def kicks(x, wide, d, ratio, length):
    """ε, and the share of particles that are inside."""
    x = np.concatenate([x, x + [0, 0, wide], x - [0, 0, wide]])
    n, H = len(x) // 3, ratio * d
    moments, ways, weights, inside = np.zeros((n, 3, 3)), [], [], np.zeros(n, bool)
    for i in range(n):
        r = x - x[i]
        far = np.sqrt(np.sum(r * r, 1))
        near = np.flatnonzero((far < H) & (far > 0))
        a = d ** 3 * 45 / (np.pi * H ** 4) * (1 - far[near] / H) ** 2 / far[near]
        ways.append((near % n, a[:, None] * r[near]))
        moments[i] = np.einsum("n,np,nq->pq", a, r[near], r[near])
        weights.append(len(near))
    low = np.array([H, H, -1])
    inside = np.all(x[:n] > low, 1) & (x[:n, 0] < length - H) & (np.array(weights) > 0.75 * np.median(weights))
    inverse = np.linalg.inv(moments + 1e-3 * np.eye(3))
    kicks = [np.einsum("npq,nq->p", inverse[i] + inverse[j], e) for i, (j, e) in enumerate(ways) if inside[i]]
    return d * np.sqrt(np.mean(np.sum(np.array(kicks) ** 2, 1))), np.mean(inside)


def main():
    s = dict(SETTINGS)
    for word in sys.argv[1:]:
        name, value = word.split("=")
        s[name] = float(value)
    d, wide = s["spacing"], s["width"] * s["spacing"]
    scene = weir.Scene("dam")
    scene.world.set(duration=s["duration"], frame_rate=50, dt=s["dt"])
    block = scene.add("BoxSampler", "block", min=(0, 0, 0), max=(s["column"], s["depth"], wide))
    water = scene.add("ParticleFluid", "water", spacing=d, support_ratio=s["ratio"], periodic="z",
                      domain_min=(-0.5, -0.5, 0), domain_max=(s["length"] + 0.5, 2, wide))
    if s["solver"]:
        water.modules.replace("solver", "TwoProjections", smoothing=s["smoothing"])
    water.modules["viscosity"].enabled = False
    block.particles >> water.initial
    walls = scene.add("StaticBoundary", "tank", shape="box", min=(0, 0, -1), max=(s["length"], 2, 1 + wide), inverted=True)
    walls.boundary >> water.boundaries
    sim = weir.Simulation(scene, device="cpu")
    sim.refresh()
    print(*sys.argv[1:], f"({len(water.positions)} particles)")
    begin, last, rises, next_ = None, None, 0, 0.0
    while sim.time < s["duration"]:
        x, v = np.array(water.positions, dtype=float), np.array(water.velocities, dtype=float)
        energy = np.mean(np.sum(v ** 2, 1) / 2 + 9.8 * x[:, 1])
        begin = energy if begin is None else begin
        rises += max(0, energy - (energy if last is None else last))
        last = energy
        if sim.time > next_ - 1e-9:
            next_ += 0.1
            sim.refresh()
            over = np.maximum(np.array(water.particles["density"]) / 1000 - 1, 0)
            kick, share = kicks(x, wide, d, s["ratio"], s["length"])
            print(f"  t {sim.time:.2f}: front {np.sort(x[:, 0])[int(0.995 * len(x))]:.3f} m, energy {energy - begin:+.3f} J/kg, "
                  f"rises {rises:.4f}; compressed {100 * np.mean(over):.2f} %, most {100 * np.max(over):.1f} %; ε {kick:.2f} "
                  f"of {100 * share:.0f} %; fastest {np.sqrt(np.max(np.sum(v ** 2, 1))):.2f} m/s")
        sim.step()


if __name__ == "__main__":
    main()
