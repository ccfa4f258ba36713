"""Counts the iterations that one step's pressure takes, by the size of the fluid and by the method.

    multilevel_pressure.py PARTICLES.ply --bulk-modulus 1e7 --tiles 0,1 [--tolerance T]

The file holds a cube of still water that was settled in a tank (x, y, z, vx, vy, vz). It is mirrored and
stacked --tiles times, each of which makes the column twice as deep and the particles eight times as many.
Prints, for the linear system of the first Newton step, the iterations of conjugate gradients until the residual has
fallen to a tenth, a hundredth and a hundred-thousandth of itself; with --tolerance, what the whole step takes:
iterations of conjugate gradients and Newton steps, what is left, and the lengths of the steps. Units are spacings and steps of time.
"""

import argparse

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

SUPPORT = 1.5  # H/d
GRAVITY = 9.8  # m/s²
CONTACT = 0.52  # how near walls let particles, in spacings
CALIBRATION = 0.5908445  # s of packing at this support ratio
STRAIN = 1 / 3  # share of the pair stiffness that counts as mass
GAP = 1.4  # between tiles, in spacings


def read_ply(path):
    data = open(path, "rb").read()
    end = data.index(b"end_header") + len(b"end_header\n")
    header = data[:end].decode().splitlines()
    count = int(next(line for line in header if line.startswith("element vertex")).split()[-1])
    kinds = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4", "uchar": "u1", "int64": "<i8"}
    fields = [(line.split()[2], kinds[line.split()[1]]) for line in header if line.startswith("property")]
    return np.frombuffer(data[end:], np.dtype(fields), count)


def tiled(x, v, width):
    """Mirrored in x and z, stacked in y, with a gap between that leaves about rest density."""
    for axis in (0, 1, 2):
        y, w = x.copy(), v.copy()
        if axis == 1:
            y[:, 1] += x[:, 1].max() - CONTACT + GAP
        else:
            y[:, axis] = 2 * width - 2 * CONTACT + GAP - y[:, axis]
            w[:, axis] *= -1
        x, v = np.vstack([x, y]), np.vstack([v, w])
    return x, v, 2 * width - 2 * CONTACT + GAP


class Step:
    """One step: displacements u from the predicted positions, s = (c·dt/d)²."""

    def __init__(self, x, lo, hi, s):
        self.start, self.lo, self.hi, self.s, self.n = x, lo, hi, s, len(x)
        self.i, self.j = cKDTree(x).query_pairs(SUPPORT, output_type="ndarray").T

    def place(self, u):
        """λ at u; the pairs' ways are kept."""
        x = self.start + u
        self.way = x[self.j] - x[self.i]
        self.r = np.maximum(np.linalg.norm(self.way, axis=1), 1e-9)
        self.t = np.clip(1 - self.r / SUPPORT, 0, 1)
        w0 = CALIBRATION * 15 / np.pi / SUPPORT**3
        return w0 * (1 + self.both(self.t**3, self.t**3))

    def both(self, ofi, ofj):
        return np.bincount(self.i, ofi, self.n) + np.bincount(self.j, ofj, self.n)

    def slope(self):
        """|W'|/r of each pair."""
        return CALIBRATION * 45 / np.pi / SUPPORT**4 * self.t**2 / self.r

    def contained(self, u):
        return np.clip(self.start + u, self.lo, self.hi) - self.start

    def objective(self, u):
        e = np.maximum(self.place(u) - 1, 0)
        return 0.5 * np.sum(u * u) + 0.5 * self.s * np.sum(e * e), e

    def jacobian(self):
        g = -self.slope()[:, None] * self.way  # ∂λ_i/∂x_j = −∂λ_j/∂x_i
        k, rows, cols, values = np.arange(self.n), [], [], []
        for c in range(3):
            rows += [self.i, self.j, k]
            cols += [3 * self.j + c, 3 * self.i + c, 3 * k + c]
            values += [g[:, c], -g[:, c], self.both(-g[:, c], g[:, c])]
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))
        return sp.csr_matrix(entries, shape=(self.n, 3 * self.n))


class Linear:
    """(J M⁻¹ Jᵀ + 1/s) δ = −J M⁻¹ g on the particles that are compressed; Δu = −M⁻¹ (g + Jᵀ δ)."""

    def __init__(self, step, u, also=None, held=None):
        """`also` are particles at less than rest density that the step compresses, `held` are ways that walls stop."""
        lam = step.place(u)
        e = np.maximum(lam - 1, 0)
        jacobian = step.jacobian()
        self.active = e > 0 if also is None else (e > 0) | also
        self.x = step.start + u
        self.gradient = u.reshape(-1) + step.s * (jacobian.T @ e)
        # What pressure adds to the stiffness of pairs.
        second = CALIBRATION * 90 / np.pi / SUPPORT**5 * step.t * (e[step.i] + e[step.j]) * step.s * STRAIN
        mass = 1 + step.both(second, second)
        free = np.ones_like(u)
        g, near = self.gradient.reshape(-1, 3), 1e-3
        free[(self.x <= step.lo + near) & (g > 0)] = 0
        free[(self.x >= step.hi - near) & (g < 0)] = 0
        if held is not None:
            free[~np.isnan(held)] = 0
        self.shift = np.zeros(u.size) if held is None else np.nan_to_num(held).reshape(-1)
        self.root = np.sqrt(free.reshape(-1) / np.repeat(mass, 3))
        self.jt = jacobian.multiply(self.root[None, :]).tocsr()[self.active].T.tocsr()
        self.j = self.jt.T.tocsr()
        self.compliance = 1 / step.s
        self.whole, self.under = jacobian, np.minimum(lam - 1, 0)
        # A way that walls stop is given, and so is what it changes of λ.
        self.right = self.under[self.active] - self.j @ (self.root * self.gradient)
        self.right += (jacobian @ self.shift)[self.active]
        self.floor = 0.5 * np.sum((self.root * self.gradient) ** 2)
        self.diagonal = np.asarray(self.j.multiply(self.j).sum(axis=1)).ravel() + self.compliance

    def times(self, d):
        return self.j @ (self.jt @ d) + self.compliance * d

    def change(self, d):
        return (self.shift - self.root * (self.root * self.gradient + self.jt @ d)).reshape(-1, 3)


def trilinear(x, cell):
    """Weights of the eight nodes around each particle, and how many nodes there are."""
    at = (x - x.min(0)) / cell + 1e-6
    low = np.floor(at).astype(int)
    f, dims = at - low, low.max(0) + 2
    rows, cols, values = [], [], []
    for corner in range(8):
        o = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        c = low + o
        rows.append(np.arange(len(x)))
        cols.append((c[:, 2] * dims[1] + c[:, 1]) * dims[0] + c[:, 0])
        values.append(np.prod(np.where(o, f, 1 - f), axis=1))
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))
    return sp.csr_matrix(entries, shape=(len(x), dims.prod())), dims


def constant(x, cell):
    c = np.floor((x - x.min(0)) / cell + 1e-6).astype(int)
    dims = c.max(0) + 1
    entries = np.ones(len(x)), (np.arange(len(x)), (c[:, 2] * dims[1] + c[:, 1]) * dims[0] + c[:, 0])
    return sp.csr_matrix(entries, shape=(len(x), dims.prod()))


def halved(n):
    """Interpolation along a line of n nodes from every second one."""
    coarse = n // 2 + 1
    weights = sp.lil_matrix((n, coarse))
    for k in range(n):
        weights[k, k // 2] = 1 if k % 2 == 0 else 0.5
        if k % 2 == 1:
            weights[k, k // 2 + 1] = 0.5
    return weights.tocsr(), coarse


class Levels:
    """A V-cycle with a sweep of l1-Jacobi before and after on each level, and eight on the last."""

    def __init__(self, matrix, dims):
        self.matrices, self.between, self.inverse = [], [], []
        while True:
            rows = np.asarray(abs(matrix).sum(axis=1)).ravel()
            self.matrices.append(matrix)
            self.inverse.append(np.where(rows > 1e-14, 1 / np.maximum(rows, 1e-14), 0))
            if max(dims) <= 4:
                return
            (px, x), (py, y), (pz, z) = (halved(n) for n in dims)
            p = sp.kron(pz, sp.kron(py, px)).tocsr()
            self.between.append(p)
            matrix, dims = (p.T @ matrix @ p).tocsr(), (x, y, z)

    def solve(self, b, level=0):
        a, inverse = self.matrices[level], self.inverse[level]
        last = level == len(self.between)
        x = inverse * b
        for _ in range(7 if last else 0):
            x = x + inverse * (b - a @ x)
        if not last:
            p = self.between[level]
            x = x + p @ self.solve(p.T @ (b - a @ x), level + 1)
            x = x + inverse * (b - a @ x)
        return x


def preconditioners(linear, cell=3.0):
    x, diagonal = linear.x[linear.active], linear.diagonal
    yield "none", lambda r: r
    yield "diagonal", lambda r: r / diagonal
    p = constant(x, cell)
    p = p[:, np.asarray((p != 0).sum(axis=0)).ravel() > 0]
    y = linear.jt @ p
    coarse = splu((y.T @ y + linear.compliance * p.T @ p).tocsc())
    yield "and aggregates", lambda r, p=p: r / diagonal + p @ coarse.solve(p.T @ r)
    p, dims = trilinear(x, cell)
    y = linear.jt @ p
    levels = Levels((y.T @ y + linear.compliance * p.T @ p).tocsr(), dims)
    yield "and V-cycle", lambda r: r / diagonal + p @ levels.solve(p.T @ r)


def conjugate_gradients(linear, precondition, targets, most=2000):
    """The solution at the last of the targets, and the iterations to each."""
    x, r = np.zeros_like(linear.right), linear.right.copy()
    z = precondition(r)
    direction, rz, first, counts = z.copy(), r @ z, np.linalg.norm(r), []
    for k in range(1, most + 1):
        ap = linear.times(direction)
        step = rz / (direction @ ap)
        x += step * direction
        r -= step * ap
        while len(counts) < len(targets) and np.linalg.norm(r) <= targets[len(counts)] * first:
            counts.append(k)
        if len(counts) == len(targets):
            break
        z = precondition(r)
        rz, before = r @ z, rz
        direction = z + rz / before * direction
    return x, counts


def to_gap(linear, precondition, share, x, most=500):
    """The same from x, until primal and dual, s·|r|²/2 apart, differ by a share of what the model gains."""
    r = linear.right - linear.times(x)
    z = precondition(r)
    direction, rz = z.copy(), r @ z
    for k in range(1, most + 1):
        ap = linear.times(direction)
        step = rz / (direction @ ap)
        x += step * direction
        r -= step * ap
        dual = linear.floor - 0.5 * x @ (linear.right + r)
        if 0.5 * (r @ r) / linear.compliance <= share * dual:
            break
        z = precondition(r)
        rz, before = r @ z, rz
        direction = z + rz / before * direction
    return x, k


def newton(step, name, tolerance, inner, most=15, sets=3):
    """Iterations of conjugate gradients, Newton steps, what is left, and the lengths of steps."""
    u = step.contained(np.zeros_like(step.start))
    energy, e = step.objective(u)
    total, lengths = 0, []
    while len(lengths) < most and (e.mean() > tolerance or not lengths):
        also, held, d = None, None, np.zeros(step.n)
        for _ in range(sets):
            linear = Linear(step, u, also, held)
            precondition = dict(preconditioners(linear))[name]
            solved, count = to_gap(linear, precondition, inner, d[linear.active])
            d[linear.active] = solved
            total += count
            change, length = linear.change(solved), 1.0
            # Those that the step would compress, and those that it would take through walls.
            met = (linear.under < 0) & (linear.under + linear.whole @ change.reshape(-1) > 0)
            stopped = step.contained(u + change) - u
            through = np.abs(stopped - change) > 1e-6
            if not met.any() and not through.any():
                break
            also = met if also is None else also | met
            held = np.where(through, stopped, np.nan if held is None else held)
        while True:
            tried = step.contained(u + length * change)
            found, e = step.objective(tried)
            if found <= energy or length < 0.02:
                break
            length /= 2
        u, energy = tried, found
        lengths.append(length)
    return total, len(lengths), e.mean(), energy, lengths


def descent(step, momentum, tolerance, most=3000):
    """Iterations of the solver as it is, with or without Nesterov's momentum."""
    u = step.contained(np.zeros_like(step.start))
    last, k, best = u.copy(), 0, np.inf
    for done in range(most):
        energy, e = step.objective(u)
        if e.mean() <= tolerance and done >= 3:
            break
        if momentum and k > 0 and energy > best * (1 + 1e-6):
            u, k, best = last.copy(), 0, np.inf
            continue
        best = energy
        a = step.s * step.slope()
        force = ((e[step.i] + e[step.j]) * a)[:, None] * step.way
        push = np.stack([step.both(-force[:, c], force[:, c]) for c in range(3)], axis=1)
        plain = step.contained(u + (push - u) / (1 + 2 * step.both(a, a))[:, None])
        u = step.contained(plain + k / (k + 3) * (plain - last)) if momentum else plain
        last, k = plain, k + 1
    return done, e.mean(), energy


def gradient(step, u, e):
    """Of the objective, and the divisor of a plain iteration."""
    a = step.s * step.slope()
    force = ((e[step.i] + e[step.j]) * a)[:, None] * step.way
    push = np.stack([step.both(-force[:, c], force[:, c]) for c in range(3)], axis=1)
    return u - push, 1 + 2 * step.both(a, a)[:, None]


def conjugate(step, tolerance, most=400):
    """Conjugate gradients for displacements, the length of a step from the slopes at its start and where it is tried."""
    u = step.contained(np.zeros_like(step.start))
    lam, direction, length = step.place(u), 0, 1.0
    for done in range(1, most + 1):
        step.place(u)
        g, divisor = gradient(step, u, np.maximum(lam - 1, 0))
        z = step.contained(u - g / divisor) - u
        slope = -np.sum(z * g)
        beta = max(0, -np.sum(z * (g - last)) / last_slope) if done > 1 else 0
        if slope - beta * np.sum(direction * g) <= 0.1 * slope:
            beta = 0
        direction, last, last_slope = z + beta * direction, g, slope
        tried = step.contained(u + length * direction)
        way = tried - u
        there = step.place(tried)
        at_start = np.sum(way * g)
        at_trial = np.sum(tried * way) + step.s * np.sum(np.maximum(there - 1, 0) * (there - lam))
        part = at_start / (at_start - at_trial) if at_trial > at_start else 4
        part = min(max(part, 0.1), 4)
        length *= part
        moved = step.contained(u + length * direction)
        direction, u = (moved - u) / length, moved
        lam = lam + part * (there - lam) if abs(part - 1) <= 0.4 else step.place(u)
        if np.maximum(lam - 1, 0).mean() <= tolerance and done > 1:
            break
    energy, e = step.objective(u)
    return done, e.mean(), energy


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("particles")
    parser.add_argument("--spacing", type=float, default=0.01)
    parser.add_argument("--dt", type=float, default=1e-3)
    parser.add_argument("--bulk-modulus", type=float, default=1e7)
    parser.add_argument("--tiles", default="0,1")
    parser.add_argument("--tolerance", type=float, help="solve the whole step until the mean compression is not above this")
    parser.add_argument("--uniform", action="store_true", help="a linear system with the same right side everywhere")
    parser.add_argument("--gap", type=float, default=0.1, help="how exactly a Newton step is solved")
    parser.add_argument("--plain", action="store_true", help="iterations without momentum, too, which takes long")
    args = parser.parse_args()
    found = read_ply(args.particles)
    d, dt = args.spacing, args.dt
    for tiles in map(int, args.tiles.split(",")):
        x = np.stack([found[c] for c in ("x", "y", "z")], axis=1).astype(float) / d
        v = np.stack([found[c] for c in ("vx", "vy", "vz")], axis=1).astype(float) * dt / d
        width = round(x[:, 0].max() + CONTACT)
        for _ in range(tiles):
            x, v, width = tiled(x, v, width)
        x = x + v + np.array([0, -GRAVITY * dt * dt / d, 0])
        s = args.bulk_modulus / 1000 * (dt / d) ** 2
        step = Step(x, np.full(3, CONTACT), np.array([width - CONTACT, 4 * width, width - CONTACT]), s)
        u = step.contained(np.zeros_like(x))
        energy, e = step.objective(u)
        print(f"{len(x)} particles, c·dt/d = {s**0.5:.3g}: mean compression {e.mean():.2e}", flush=True)
        linear = Linear(step, u)
        if args.uniform:
            linear.right = np.ones_like(linear.right)
        for name, precondition in preconditioners(linear):
            _, counts = conjugate_gradients(linear, precondition, [1e-1, 1e-2, 1e-5])
            print(f"  linear, {name}: {counts}", flush=True)
        if args.tolerance is None:
            continue
        print(f"  to {args.tolerance:g}, objective {energy:.4e} at first:")
        for name in ("diagonal", "and V-cycle"):
            total, outer, left, psi, lengths = newton(step, name, args.tolerance, args.gap)
            print(f"    Newton, {name}: {total} in {outer}, left {left:.3e}, objective {psi:.4e}, {lengths}", flush=True)
        done, left, psi = conjugate(step, args.tolerance)
        print(f"    conjugate: {done}, left {left:.3e}, objective {psi:.4e}", flush=True)
        for name in ("momentum", "plain"):
            if name == "momentum" or args.plain:
                done, left, psi = descent(step, name == "momentum", args.tolerance)
                print(f"    {name}: {done}, left {left:.3e}, objective {psi:.4e}", flush=True)


if __name__ == "__main__":
    main()
