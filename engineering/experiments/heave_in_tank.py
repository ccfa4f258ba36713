"""Period of a ball that heaves, half under water, in a round tank by linear potential flow (engineering/bodies.md): finite
elements in (R, θ) about its centre, waves and ball on in time; once with the stiffness c·z of linear theory, once with that
of a ball, c·z·(1 − z²/3r²). Needs numpy.

  python3 engineering/experiments/heave_in_tank.py [NAME=VALUE…]
"""
import sys

import numpy as np

# m, s; the tank has the area of the validation's square one of 1.5 m. rate: of damping of waves beyond `beach`, 1/s.
SETTINGS = dict(radius=0.15, tank=0.846, depth=0.7, drop=0.09, radial=48, angular=36, dt=1e-3, duration=1.9, gravity=9.8,
                beach=0.0, rate=5.0)


def mesh_of(s):
    """Positions (r, z) of nodes [radial, angular]; angle 0 is down, the last one the surface."""
    angle = np.linspace(0, np.pi / 2, int(s["angular"]))
    with np.errstate(divide="ignore"):
        far = np.minimum(s["tank"] / np.sin(angle), s["depth"] / np.maximum(np.cos(angle), 1e-12))
    share = np.linspace(0, 1, int(s["radial"]))[:, None]
    at = s["radius"] * (far / s["radius"]) ** share if s["tank"] < 10 * s["radius"] else (
        s["radius"] + (far - s["radius"]) * share ** 1.5)
    return np.stack([at * np.sin(angle), -at * np.cos(angle)], -1)


def stiffness_of(x):
    """∫ ∇N·∇N 2πr dr dz of bilinear quadrilaterals, by 2 × 2 points."""
    rows, columns = x.shape[:2]
    number = np.arange(rows * columns).reshape(rows, columns)
    nodes = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1).reshape(-1, 4)
    corners = x.reshape(-1, 2)[nodes]
    full = np.zeros((rows * columns,) * 2)
    for a in (-1, 1):
        for b in (-1, 1):
            u, v = a / np.sqrt(3), b / np.sqrt(3)
            shape = np.array([(1 - u) * (1 - v), (1 + u) * (1 - v), (1 + u) * (1 + v), (1 - u) * (1 + v)]) / 4
            slope = np.array([[v - 1, 1 - v, 1 + v, -1 - v], [u - 1, -1 - u, 1 + u, 1 - u]]) / 4
            jacobian = np.einsum("an,enb->eab", slope, corners)
            gradient = np.linalg.solve(jacobian, np.broadcast_to(slope, jacobian.shape[:1] + slope.shape))
            weight = 2 * np.pi * (corners[:, :, 0] @ shape) * np.abs(np.linalg.det(jacobian))
            part = np.einsum("e,ean,eam->enm", weight, gradient, gradient)
            np.add.at(full, (nodes[:, :, None], nodes[:, None, :]), part)
    return full, number


def along(x, f):
    """∫ N f 2πr ds along a polygon, lumped at its points."""
    step = np.linalg.norm(np.diff(x, axis=0), axis=1)
    size = np.zeros(len(x))
    size[:-1] += step / 2
    size[1:] += step / 2
    return 2 * np.pi * x[:, 0] * size * f


class Tank:
    def __init__(self, s):
        x = mesh_of(s)
        full, number = stiffness_of(x)
        surface, body = number[:, -1], number[0]
        inside = np.setdiff1d(number, surface)
        push = np.zeros(number.size)
        push[body] = along(x[0], np.cos(np.linspace(0, np.pi / 2, len(body))))
        inner = full[np.ix_(inside, inside)]
        solved = np.linalg.solve(inner, np.column_stack([-full[np.ix_(inside, surface)], push[inside]]))
        self.waves, self.by_body = solved[:, :-1], solved[:, -1]  # φ inside by φ at the surface, and by the ball
        mass = along(x[:, -1], np.ones(len(surface)))
        to = full[np.ix_(surface, inside)]
        self.rise = (to @ self.waves + full[np.ix_(surface, surface)]) / mass[:, None]
        self.rise_by_body = (to @ self.by_body - push[surface]) / mass
        self.added = push[inside] @ self.by_body  # over water's density
        self.felt = push[inside] @ self.waves + push[surface]
        self.beach = s["rate"] * np.clip((x[:, -1, 0] - s["beach"]) / max(s["tank"] - s["beach"], 1e-9), 0, 1) ** 2 \
            if s["beach"] else np.zeros(len(surface))

    def heights(self, s, linear):
        g, r, n = s["gravity"], s["radius"], len(self.felt)
        mass = 2 / 3 * np.pi * r ** 3

        def slope(y):
            z, v, high, phi = y[0], y[1], y[2:2 + n], y[2 + n:]
            spring = np.pi * r ** 2 * g * (z if linear else z - z ** 3 / (3 * r ** 2))
            lift = -spring + self.felt @ (g * high)
            return np.concatenate([[v, lift / (mass + self.added)], self.rise @ phi + v * self.rise_by_body - self.beach * high,
                                   -g * high - self.beach * phi])

        y, dt, found = np.zeros(2 + 2 * n), s["dt"], []
        y[0] = s["drop"]
        for _ in range(round(s["duration"] / dt) + 1):
            found.append(y[0])
            a = slope(y)
            b = slope(y + dt / 2 * a)
            c = slope(y + dt / 2 * b)
            y = y + dt / 6 * (a + 2 * b + 2 * c + slope(y + dt * c))
        return np.array(found)


def period(z, dt):
    """Of the first full swing, about the mean of the last two fifths, as the validation has it."""
    z = z - np.mean(z[len(z) * 3 // 5:])
    k = np.flatnonzero(z[1:] * z[:-1] < 0)[:3]
    at = dt * (k - z[k] / (z[k + 1] - z[k]))
    return at[2] - at[0]


if __name__ == "__main__":
    settings = dict(SETTINGS)
    for word in sys.argv[1:]:
        name, value = word.split("=")
        settings[name] = float(value)
    tank = Tank(settings)
    mass = 2 / 3 * np.pi * settings["radius"] ** 3
    print(f"added mass of high frequencies {tank.added / mass:.4f}")
    for linear in (True, False):
        z = tank.heights(settings, linear)
        print("linear" if linear else "with a ball's stiffness", f"period {period(z, settings['dt']):.4f} s;",
              "heights at 0.1 s:", np.round(1000 * z[::round(0.1 / settings["dt"])], 1))
