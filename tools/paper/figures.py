"""What each figure of the paper needs: its scene, the runs that compare settings, and its caption."""

from dataclasses import dataclass, field

# The comparison of the paper is with position based fluids as the authors' code has it ("unnormalized"); the
# textbook form is a fair rival.
METHODS = {
    "ours": ("ours", {}),
    "pbf": ("PBF, as the paper's", {"water.solver.type": "Pbf", "water.solver.form": "unnormalized"}),
    "pbf_textbook": ("PBF, textbook", {"water.solver.type": "Pbf"}),
}
BOX = ("block.min", "block.max", "tank.min", "tank.max", "render.camera.eye", "render.camera.target")


@dataclass(frozen=True)
class Run:
    name: str  # of its folder
    title: str
    settings: dict = field(default_factory=dict)
    frames: int | None = None
    row: int = 0  # in the montage
    column: int = 0


@dataclass(frozen=True)
class Figure:
    key: str
    scene: str  # file in resources/scenes/paper
    caption: str  # the paper's
    runs: tuple
    reduced: float  # the scale where none is given
    scaling: str = "size"
    lengths: tuple = BOX
    times: tuple = ()  # of the pictures shown, s, at full scale
    pictures: bool = True
    plot: str | None = None  # name of a function in plots.py
    timed: str | None = None  # which run goes into the table of times, by prefix of its name


def by_method(values, setting, label):
    """Every method with every value: one row each, one column a value."""
    runs = []
    for row, (method, (name, settings)) in enumerate(METHODS.items()):
        for column, value in enumerate(values):
            runs.append(Run(f"{method}_{value}", f"{name}, {label(value)}",
                            {**settings, setting: str(value)}, row=row, column=column))
    return tuple(runs)


def millimetres(spacing):
    return f"d = {1000 * spacing:g} mm"


FIGURES = [
    Figure(
        "fig1", "fig1_three_sizes.json",
        "The simulation scenario encompasses various particle sizes, specifically 0.01m (left), 0.03m (middle), "
        "and 0.05m (right), with corresponding particle counts of 23 million (left), 0.83 million (middle), and "
        "0.19 million (right) particles.",
        tuple(Run(f"ours_{d}", millimetres(d), {"water.spacing": str(d)}, column=i)
              for i, d in enumerate((0.01, 0.03, 0.05))),
        reduced=0.01, times=(1.0,), timed="ours"),
    Figure(
        "fig4", "fig4_momentum.json",
        "A comparison illustrating momentum conservation using (a) the conservative scheme described in Equation "
        "14 and the non-conservative scheme described in Equation 12. Particle velocities are color-coded. It is "
        "noteworthy that the fluid exhibits oscillations when momentum is not conserved.",
        (Run("eq14", "Eq. 14"),
         Run("eq12", "Eq. 12", {"water.solver.conservative": "false"}, column=1),
         Run("free_eq14", "Eq. 14, free blob", {"world.gravity": "[0, 0, 0]", "block.jitter": "0.1"}, row=1),
         Run("free_eq12", "Eq. 12, free blob",
             {"world.gravity": "[0, 0, 0]", "block.jitter": "0.1", "water.solver.conservative": "false"},
             row=1, column=1)),
        reduced=0.15, times=(4.0,), plot="momentum"),
    Figure(
        "fig5", "fig5_bulk_energies.json",
        "Three representative bulk energy functions are employed to assess convergence: (a) the original bulk "
        "energy functions, (b) their first-order derivatives, and (c) the convergence rates for all three bulk "
        "energy functions.",
        tuple(Run(f"{start}_{energy}_{length}", f"{energy.upper()}, {length} steps",
                  {"water.solver.energy": energy, "water.solver.step_length": length, **settings}, frames)
              for start, settings, frames in (
                  ("dam", {}, None),
                  ("disorder", {"block.jitter": "0.1", "world.frame_rate": "1000", "world.duration": "0.001"}, 1))
              for energy in ("b0", "b1", "b2") for length in ("full", "particle", "global")),
        reduced=0.3, pictures=False, plot="bulk_energies"),
    Figure(
        "fig6", "fig6_time_steps.json",
        "We compared our method to the PBF method with different time steps, both employing 70,000 particles. "
        "Time steps are set to 1ms, 5ms, and 10ms from left to right. The particle sizes are consistently set to "
        "0.01m. The smoothing lengths are uniform at 1.2dx, equivalent to 0.012m. Both our method and the PBF "
        "method employed 3 iterations. The strengths of the artificial viscosity solver (XSPH) are identically "
        "set at 0.3.",
        by_method((0.001, 0.005, 0.01), "world.dt", lambda dt: f"dt = {1000 * dt:g} ms"),
        reduced=1, times=(0.4, 0.8), plot="energy_and_compression"),
    Figure(
        "fig7", "fig7_spacings.json",
        "Comparison to the PBF method. The dam-break is respectively simulated using the PBF method and our "
        "method with 0.01m, 0.015m, 0.02m and 0.04m. The time steps are all set to 0.001s, the smoothing lengths "
        "are defined as 1.2 times the particle size dx, and the gravity is 9.8m/s².",
        by_method((0.01, 0.015, 0.02, 0.04), "water.spacing", millimetres),
        reduced=0.1, times=(0.6,), plot="energy_and_compression", timed="ours"),
    Figure(
        "fig8", "fig8_convergence.json",
        "We compare the convergence of the dam-break scenario in Figure 7, with different particle sizes: (a) "
        "particle size of 0.005m; (b) particle size of 0.0075m; (c) particle size of 0.010m. We calculate the "
        "relative errors for both our method and the PBF method using Equation 18. It is observed that, in "
        "contrast to our method, the convergence speed of the PBF method is significantly influenced by the "
        "particle size.",
        by_method((0.005, 0.0075, 0.01), "water.spacing", millimetres),
        reduced=0.01, pictures=False, plot="convergence"),
]


def find(keys):
    """The figures of these keys, in the paper's order; a ValueError names the keys that there are."""
    known = [figure.key for figure in FIGURES]
    unknown = [key for key in keys if key not in known]
    if unknown:
        raise ValueError(f"there is no figure {', '.join(unknown)}; allowed: {', '.join(known)}")
    return [figure for figure in FIGURES if not keys or figure.key in keys]
