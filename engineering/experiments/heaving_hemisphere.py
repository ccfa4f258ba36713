"""Added mass and damping of a ball that heaves, half under deep water, by linear theory (engineering/bodies.md).

The potential of unit heave is a wave source at the centre and wave-free multipoles (Havelock 1955; Hulme 1982), fitted by
least squares to the normal velocity cos θ on the hemisphere. Lengths in radii; K = ω²r/g.
"""

import sys

import numpy

NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(200)


def gauss(a, b):
    return 0.5 * (b - a) * NODES + 0.5 * (a + b), 0.5 * (b - a) * WEIGHTS


def bessel0(x):
    """J0 by its integral."""
    angle = (numpy.arange(400) + 0.5) / 400 * numpy.pi
    return numpy.cos(numpy.multiply.outer(numpy.asarray(x), numpy.sin(angle))).mean(-1)


def source(r, z, K):
    """1/R + K·PV∫ e^(kz)·J0(kr)/(k − K) dk + iπK·e^(Kz)·J0(Kr), for z < 0."""
    def wave(k):
        return numpy.exp(k * z) * bessel0(k * r)
    k, w = gauss(0, 2 * K)  # about the pole, where 1/(k − K) alone has no principal value
    integral = (w * (wave(k) - wave(K)) / (k - K)).sum()
    ends = 2 * K + numpy.linspace(0, 1, 13) ** 2 * (30 / max(-z, 0.02))
    for a, b in zip(ends[:-1], ends[1:]):
        k, w = gauss(a, b)
        integral += (w * wave(k) / (k - K)).sum()
    return 1 / numpy.hypot(r, z) + K * integral + 1j * numpy.pi * K * wave(K)


def added_mass_and_damping(K, multipoles=7, points=24):
    """Over the mass of half a ball of water, and that times ω."""
    nodes, weights = numpy.polynomial.legendre.leggauss(points)
    cosine, weights = 0.5 * nodes + 0.5, 0.5 * weights
    sine, step = numpy.sqrt(1 - cosine ** 2), 1e-4

    def sources(R):
        return numpy.array([source(R * s, -R * c, K) for s, c in zip(sine, cosine)])
    potential, slope = [sources(1)], [(sources(1 + step) - sources(1 - step)) / (2 * step)]
    for n in range(1, multipoles + 1):
        even, odd = (numpy.polynomial.legendre.Legendre.basis(m)(cosine) for m in (2 * n, 2 * n - 1))
        potential.append(even + K / (2 * n) * odd + 0j)
        slope.append(-(2 * n + 1) * even - K * odd + 0j)
    root = numpy.sqrt(weights)
    shares = numpy.linalg.lstsq(numpy.array(slope).T * root[:, None], cosine * root, rcond=None)[0]
    force = -3 * (weights * (numpy.array(potential).T @ shares) * cosine).sum()
    return force.real, abs(force.imag)


if __name__ == "__main__":
    for K in [float(text) for text in sys.argv[1:]] or (0.05, 0.5, 1.0, 1.056):
        print(K, *(round(float(x), 4) for x in added_mass_and_damping(K)))
