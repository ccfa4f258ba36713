"""What each figure of the paper needs: its scene, the runs that compare settings, and its caption."""

from dataclasses import dataclass, field

# The rival is position based fluids. The paper compares with an unnormalised form whose step length was "adjusted"
# for 10 mm and 1 ms and then kept; step = 1000 makes it as long as the textbook's there. The published code has 10.
METHODS = {
    "ours": ("ours", {}),
    "stiff": ("ours, K = 1 MPa", {"water.mu": "null", "water.bulk_modulus": "1e6"}),
    "pbf": ("PBF, step tuned at 10 mm", {"water.solver.type": "Pbf", "water.solver.form": "unnormalized",
                                         "water.solver.step": "1000"}),
    "pbf_code": ("PBF, the code's step", {"water.solver.type": "Pbf", "water.solver.form": "unnormalized"}),
    "pbf_textbook": ("PBF, textbook", {"water.solver.type": "Pbf"}),
}
# Away from all walls: a tank around the block, which nothing reaches.
FREE = {"world.gravity": "[0, 0, 0]", "block.jitter": "0.1", "tank.min": "[-2, -2, -2]", "tank.max": "[3, 3, 3]"}
# Figure 6's 70,000 particles as a layer of 15, not a block of 35.
SHALLOW = {"block.max": "[0.6, 0.15, 0.78]", "tank.max": "[1.2, 0.7, 0.78]", "render.camera.target": "[0.6, 0.2, 0.39]"}
BOX = ("block.min", "block.max", "tank.min", "tank.max", "render.camera.eye", "render.camera.target")


@dataclass(frozen=True)
class Run:
    name: str  # of its folder
    title: str
    settings: dict = field(default_factory=dict)  # lengths of the figure at full size
    frames: int | None = None
    row: int = 0  # in the montage
    column: int = 0
    variant: str = ""  # end of its name, where methods are there more than once
    shown: bool = True  # in the montage


@dataclass(frozen=True)
class Figure:
    key: str
    scene: str  # file in resources/scenes/paper
    caption: str  # the paper's
    runs: tuple
    reduced: float  # the scale where none is given
    scaling: str = "size"
    lengths: tuple = BOX
    times: tuple = ()  # of the pictures shown, s, at full size
    reduced_times: tuple = ()  # where the scale is below 1, if not the same
    pictures: bool = True
    plot: str | None = None  # name of a function in plots.py
    timed: str | None = None  # which run goes into the table of times, by prefix of its name
    reduced_settings: dict = field(default_factory=dict)  # where the scale is below 1


def by_method(methods, values, setting, label, first_row=0, variant="", variant_label="", common=None):
    """Every method with every value: a row for a method, a column for a value. A variant is a name and settings in
    common, so that methods may be there more than once."""
    runs = []
    for row, method in enumerate(methods, first_row):
        name, settings = METHODS[method]
        for column, value in enumerate(values):
            runs.append(Run(f"{method}{variant}_{value}", f"{name}{variant_label}, {label(value)}",
                            {**settings, **(common or {}), setting: str(value)}, row=row, column=column, variant=variant))
    return tuple(runs)


def millimetres(spacing):
    return f"d = {1000 * spacing:g} mm"


def milliseconds(dt):
    return f"dt = {1000 * dt:g} ms"


def same_stiffness(spacings, of=0.01):
    """Ours with mu in proportion to d^5: the relative stiffness (c·dt/d)² is that of ours with mu = 1 and `of`."""
    return tuple(Run(f"scaled_{d}", f"ours, same (c·dt/d)², {millimetres(d)}",
                     {"water.spacing": str(d), "water.mu": f"{(d / of) ** 5:.6g}"}, column=column)
                 for column, d in enumerate(spacings))


FIGURES = [
    Figure(
        "fig1", "fig1_three_sizes.json",
        "The simulation scenario encompasses various particle sizes, specifically 0.01m (left), 0.03m (middle), "
        "and 0.05m (right), with corresponding particle counts of 23 million (left), 0.83 million (middle), and "
        "0.19 million (right) particles.",
        tuple(Run(f"ours_{d}", millimetres(d), {"water.spacing": str(d)}, column=i)
              for i, d in enumerate((0.01, 0.03, 0.05))),
        reduced=0.005, times=(1.0,), timed="ours"),
    Figure(
        "fig2", "fig2_waterfall.json",
        "Waterfall. This scenario consists of 1 million particles, and the particle size is 0.01 m.",
        (Run("ours", ""),), reduced=0.03, scaling="spacing", times=(1.0, 5.0), timed="ours"),
    Figure(
        "fig3", "fig3_seaside.json",
        "Seaside. The scenario consists of 600k particles and 2.5k boundary triangles. When the particle size is "
        "set to 0.02m (b) the PBF method exhibits artifacts when numerical parameters are not well adjusted, (a) "
        "whereas our method remains stable without the need to adjust numerical parameters.",
        tuple(Run(method, METHODS[method][0], METHODS[method][1], column=i)
              for i, method in enumerate(("ours", "pbf"))),
        reduced=0.05, times=(0.8, 1.6), timed="ours",
        lengths=("sea.min", "sea.max", "wave.min", "wave.max", "tank.min", "tank.max", "shore.size", "shore.profile",
                 "shore.roughness", "shore.thickness", "shore.feature_size", "shore.rock_size", "shore.rock_range",
                 "water.domain_min", "water.domain_max", "render.camera.eye", "render.camera.target")),
    Figure(
        "fig4", "fig4_momentum.json",
        "A comparison illustrating momentum conservation using (a) the conservative scheme described in Equation "
        "14 and the non-conservative scheme described in Equation 12. Particle velocities are color-coded. It is "
        "noteworthy that the fluid exhibits oscillations when momentum is not conserved.",
        (Run("eq14", "Eq. 14"),
         Run("eq12", "Eq. 12", {"water.solver.conservative": "false"}, column=1),
         Run("free_eq14", "Eq. 14, free blob", FREE, shown=False),
         Run("free_eq12", "Eq. 12, free blob",
             {**FREE, "water.solver.conservative": "false"}, shown=False)),
        reduced=0.15, times=(4.0,), plot="momentum"),
    Figure(
        "fig5", "fig5_bulk_energies.json",
        "Three representative bulk energy functions are employed to assess convergence: (a) the original bulk "
        "energy functions, (b) their first-order derivatives, and (c) the convergence rates for all three bulk "
        "energy functions.",
        tuple(Run(f"{start}_{energy}_{length}", f"{energy.upper()}, {length} steps, {start}",
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
        by_method(("ours", "pbf", "pbf_code"), (0.001, 0.005, 0.01), "world.dt", milliseconds)
        + by_method(("ours", "pbf"), (0.001, 0.005, 0.01), "world.dt", milliseconds, first_row=3, variant="_shallow",
                    variant_label=", shallow", common=SHALLOW),
        reduced=0.3, times=(0.4, 0.8), plot="energy_and_compression"),
    Figure(
        "fig7", "fig7_spacings.json",
        "Comparison to the PBF method. The dam-break is respectively simulated using the PBF method and our "
        "method with 0.01m, 0.015m, 0.02m and 0.04m. The time steps are all set to 0.001s, the smoothing lengths "
        "are defined as 1.2 times the particle size dx, and the gravity is 9.8m/s².",
        by_method(("ours", "stiff", "pbf", "pbf_textbook"), (0.01, 0.015, 0.02, 0.04), "water.spacing",
                  millimetres),
        reduced=0.05, times=(0.75,), plot="energy_and_compression", timed="ours"),
    Figure(
        "fig8", "fig8_convergence.json",
        "We compare the convergence of the dam-break scenario in Figure 7, with different particle sizes: (a) "
        "particle size of 0.005m; (b) particle size of 0.0075m; (c) particle size of 0.010m. We calculate the "
        "relative errors for both our method and the PBF method using Equation 18. It is observed that, in "
        "contrast to our method, the convergence speed of the PBF method is significantly influenced by the "
        "particle size.",
        by_method(("ours", "pbf", "pbf_code", "pbf_textbook"), (0.005, 0.0075, 0.01), "water.spacing", millimetres)
        + same_stiffness((0.005, 0.0075)),
        reduced=0.004, pictures=False, plot="convergence"),
    Figure(
        "fig9", "fig9_fountain.json",
        "Fountain. This scenario consists of 2.5 million fluid particles and 1.5 million boundary triangle meshes, "
        "the particle sizes are set to 0.01m.",
        (Run("ours", ""),), reduced=0.03, scaling="spacing", times=(6.0, 20.0), reduced_times=(2.0, 4.0),
        timed="ours", reduced_settings={"fountain.segments": "128"}),
    Figure(
        "fig10", "fig10_goblet.json",
        "The real-time simulation system we have developed encompasses modules for real-time rendering, modeling, "
        "and other crucial components essential for conducting real-time simulations. This system enables the rapid "
        "creation of complex simulation scenarios through node-based connections, eliminating the necessity for "
        "manual coding.",
        (Run("ours", ""),), reduced=1, scaling="spacing", times=(0.6, 4.0), timed="ours"),
]


def find(keys):
    """The figures of these keys, in the paper's order; a ValueError names the keys that there are."""
    known = [figure.key for figure in FIGURES]
    unknown = [key for key in keys if key not in known]
    if unknown:
        raise ValueError(f"there is no figure {', '.join(unknown)}; allowed: {', '.join(known)}")
    return [figure for figure in FIGURES if not keys or figure.key in keys]
