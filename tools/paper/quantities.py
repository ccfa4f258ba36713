"""Numbers for the plots, from what runs wrote."""

import math


def relative_errors(objective):
    """Eq. 18: (ψ(x^k) − ψ(x^N)) / (ψ(x⁰) − ψ(x^N)) for k = 0 … N − 1; None where ψ did not change at all."""
    first, last = objective[0], objective[-1]
    if first == last:
        return None
    return [(psi - last) / (first - last) for psi in objective[:-1]]


def fluid(frame, node="water"):
    """What the fluid reported at a frame, or {} where it reported nothing."""
    report = frame["nodes"].get(node, {})
    return report if "linear_momentum" in report else {}


def over_time(series, of):
    """(times, values) of a function of the fluid's report, over the frames that have one."""
    points = [(frame["time"], of(fluid(frame))) for frame in series if fluid(frame)]
    return [t for t, _ in points], [value for _, value in points]


def mass(report, density=1000):
    return report["fluid_volume"] * density


def mean_velocity(report):
    """|momentum| per mass, m/s."""
    return math.hypot(*report["linear_momentum"]) / mass(report)


def kinetic(report):
    """J/kg."""
    return report["kinetic_energy"] / mass(report)


def compression(report):
    return report["compression"]["mean"]


def energy_gain(series):
    """The most of kinetic and potential energy (above y = 0) at any frame, by that at the start: above 1 where a
    solver adds energy. None without frames, or where the energy at the start is not above 0."""
    energies = [report["kinetic_energy"] + report["potential_energy"] for report in map(fluid, series) if report]
    return max(energies) / energies[0] if energies and energies[0] > 0 else None


def last_objective(series):
    """ψ by iteration of the last frame's step."""
    for frame in reversed(series):
        objective = fluid(frame).get("objective_by_iteration")
        if objective:
            return objective
    return None


def iterations_to(errors, level):
    """The first iteration whose relative error is below the level, and stays there; None if none is."""
    first = None
    for k, error in enumerate(errors):
        if not abs(error) < level:
            first = None
        elif first is None:
            first = k
    return first


def step_time(stats):
    """(particles at the end, mean ms a step)."""
    return stats["particles"], stats["step_ms"]["mean"]
