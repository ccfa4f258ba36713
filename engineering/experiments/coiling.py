"""Steady coiling of a slender viscous rope, the reference of the check `coiling` (engineering/validation.md). Needs numpy and scipy.

  python3 engineering/experiments/coiling.py                          # the limits of slow and of heavy ropes
  python3 engineering/experiments/coiling.py radius speed viscosity height…   # m, m/s, kinematic m²/s, m

The theory is N. M. Ribe's (Coiling of viscous jets, Proc. R. Soc. A 460, 2004). In the frame that turns with the coil the rope is
at rest as a curve, along which liquid runs with speed U and area A = Q/U. Its triad d1, d2, d3 (d3 along it) changes by
d_i' = κ × d_i along the arc, and liquid spins with U·κ + Ω·e3. So with I = A²/4π

  N·d3 = 3ηA·U'     M·d1 = 3ηI·(U·κ1)'     M·d2 = 3ηI·(U·κ2)'     M·d3 = 2ηI·(U·κ3)'
  N' = ρA·(acceleration − g)               M' = N × d3

The nozzle gives place, direction, speed and no spin; below, at the height of the pile, the rope is laid at rest: neither speed nor
spin. Ω and the rope's length are found with the rest: 19 conditions for 17 equations and two numbers.

Lengths are in fall heights H, speeds in that at the nozzle, U0; N in η·I0·U0/H³, M in η·I0·U0/H², with I0 at the nozzle. What is left
is the slenderness a0/H, gH²/νU0 and U0·H/ν."""

import sys

import numpy as np
from scipy.integrate import solve_bvp, trapezoid

GRAVITY = 9.8
UP = np.array([0.0, 0.0, 1.0])[:, None]
PLACE, TURN, BEND, SPEED, FORCE, MOMENT = slice(0, 3), slice(3, 7), slice(7, 10), 10, slice(11, 14), slice(14, 17)


def triads(q):
    """Of quaternions (w, x, y, z): arrays whose columns are d1, d2, d3."""
    w, x, y, z = q
    return np.array([[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]])


def spun(q, k):
    """q' where the triad turns by k, given in itself."""
    w, x, y, z = q
    return 0.5 * np.array([-x * k[0] - y * k[1] - z * k[2], w * k[0] + y * k[2] - z * k[1],
                           w * k[1] + z * k[0] - x * k[2], w * k[2] + x * k[1] - y * k[0]])


def along(state, unknown, slenderness, gravity, inertia):
    """Derivatives along the arc, which is scaled to a length of 1."""
    omega, length = unknown
    thin = slenderness ** 2 / 4
    place, bend, speed, force = state[PLACE], state[BEND], state[SPEED], state[FORCE]
    triad = triads(state[TURN])
    way = triad[:, 2]
    area = 1 / speed
    stretch = (force * way).sum(axis=0) * thin / (3 * area)
    moment = np.einsum("ijn,in->jn", triad, state[MOMENT])
    bend_rate = (moment / (np.array([3, 3, 2])[:, None] * area ** 2) - stretch * bend) / speed
    turning = np.cross(np.einsum("ijn,jn->in", triad, bend), way, axis=0)
    acceleration = (speed * (stretch * way + speed * turning) + 2 * omega * speed * np.cross(UP, way, axis=0)
                    - omega ** 2 * place * (1 - UP))
    return length * np.vstack([way, spun(state[TURN], bend), bend_rate, stretch[None],
                               area / thin * (gravity * UP + inertia * acceleration), np.cross(force, way, axis=0)])


def ends(top, low, unknown):
    """What is zero: at the nozzle, and where the rope is laid, on the first axis."""
    omega, _ = unknown
    triad, place, speed = triads(low[TURN]), low[PLACE], low[SPEED]
    return np.concatenate([
        top[PLACE], top[TURN] - [0, 1, 0, 0], top[BEND] - [0, 0, omega / top[SPEED]], [top[SPEED] - 1],
        [place[2] + 1, place[1]], speed * triad[:, 2] + omega * np.array([-place[1], place[0], 0]),
        speed * triad @ low[BEND] + omega * UP[:, 0]])


def first_guess(points=200):
    """A rope that comes down straight and leans over into a circle."""
    from scipy.spatial.transform import Rotation
    s = np.linspace(0, 1, points)
    lean, heading = np.pi / 2 * s ** 3, -np.pi / 2 * s ** 2
    way = np.array([np.sin(lean) * np.cos(heading), np.sin(lean) * np.sin(heading), -np.cos(lean)])
    place = np.hstack([np.zeros((3, 1)), np.cumsum((way[:, 1:] + way[:, :-1]) / 2 / (points - 1), axis=1)])
    length = -1 / place[2, -1]
    about = Rotation.from_rotvec([0, 0, -np.arctan2(place[1, -1], place[0, -1])]).as_matrix()
    place, way = about @ place * length, about @ way
    found = [np.diag([1.0, -1, -1])]
    for before, now in zip(way.T, way.T[1:]):  # carried along without twist
        axis = np.cross(before, now)
        turn = Rotation.from_rotvec(axis / max(np.linalg.norm(axis), 1e-12) * np.arccos(min(before @ now, 1))).as_matrix()
        found.append(turn @ found[-1])
    turns = Rotation.from_matrix(found).as_quat()[:, [3, 0, 1, 2]]
    for k in range(points):
        turns[k] *= np.sign(turns[k] @ (turns[k - 1] if k else [0, 1, 0, 0]))
    bend = np.cross(way, np.gradient(way, s * length, axis=1), axis=0)
    state = np.zeros((17, points))
    state[PLACE], state[TURN], state[SPEED] = place, turns.T, 1
    state[BEND] = np.einsum("nij,in->jn", np.array(found), bend)
    return s, state, np.array([1 / place[0, -1], length])


def steady(slenderness, gravity=0.0, inertia=0.0, steps=12, tolerance=1e-3):
    """The solution, led from a weightless rope to the one wanted."""
    def solved(s, state, unknown, share, accuracy):
        found = solve_bvp(lambda _, y, p: along(y, p, slenderness, share * gravity, share * inertia), ends, s, state, unknown,
                          tol=accuracy, max_nodes=4000)
        if found.status:
            raise ValueError(f"not solved at {share:.2f} of the load: {found.message}")
        return found

    found = solved(*first_guess(), 0, tolerance)
    for k in range(steps if gravity or inertia else 0):
        found = solved(found.x, found.y, found.p, ((k + 1) / steps) ** 2, tolerance)
    return found


def dissipated(found, slenderness, gravity, inertia):
    """The power that stretching, bending and twist take, over what gravity and the speed of the liquid give less what the pull at
    the nozzle takes: 1, and not one of the equations that were solved."""
    thin, state = slenderness ** 2 / 4, found.y
    triad, area = triads(state[TURN]), 1 / state[SPEED]
    pull = (state[FORCE] * triad[:, 2]).sum(axis=0)
    moment = np.einsum("ijn,in->jn", triad, state[MOMENT])
    taken = pull ** 2 * thin / (3 * area) + (moment ** 2 / (np.array([3, 3, 2])[:, None] * area ** 2)).sum(axis=0)
    return trapezoid(taken, found.x) * found.p[1] / ((gravity + inertia / 2) / thin - pull[0])


def limits():
    print("  a0/H gH²/νU0   R/H  ΩH/U1   R/a1  Ω/(gQ³/νa1⁸)^¼")
    for slenderness in (0.1, 0.05, 0.02):
        for gravity in (0, 0.1, 0.3, 1, 2, 4) if slenderness > 0.02 else (0,):  # the thinnest needs smaller steps to be loaded
            found = steady(slenderness, gravity)
            omega, speed, radius = found.p[0], found.y[SPEED, -1], found.y[0, -1]
            laid = slenderness / speed ** 0.5
            scale = (gravity * (np.pi * slenderness ** 2) ** 3 / laid ** 8) ** 0.25
            print(f"{slenderness:6.2f} {gravity:7.1f} {radius:7.4f} {omega / speed:6.3f} {radius / laid:6.2f}",
                  f"{omega / scale:8.4f}" if gravity else "")


def ropes(radius, speed, viscosity, heights):
    print("  H, mm  Ω, rad/s  R, mm  a1, mm  U1, m/s  pull at the nozzle over the rope's weight  power, taken over given")
    for height in heights:
        gravity = GRAVITY * height ** 2 / (viscosity * speed)
        loads = radius / height, gravity, speed * height / viscosity
        found = steady(*loads)
        laid = found.y[SPEED, -1]
        weight = 4 * (height / radius) ** 2 * gravity * found.p[1] * trapezoid(1 / found.y[SPEED], found.x)
        print(f"{1000 * height:7.1f} {found.p[0] * speed / height:9.2f} {1000 * height * found.y[0, -1]:6.2f} "
              f"{1000 * radius / laid ** 0.5:7.2f} {speed * laid:8.3f} {-found.y[FORCE, 0][2] / weight:9.3f} "
              f"{dissipated(found, *loads):40.5f}", flush=True)


if __name__ == "__main__":
    numbers = [float(word) for word in sys.argv[1:]]
    ropes(*numbers[:3], numbers[3:]) if numbers else limits()
