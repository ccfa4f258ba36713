"""The paper's plots, from what runs wrote: the same quantities on the same axes."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)

import quantities  # noqa: E402

# Table 1: particles, ms a step, on the authors' laptop. Rows 7(a3) and 7(a4) repeat the times as particle counts
# and are left out.
TABLE_1 = (("Fig. 1", 23.0e6, 1670), ("Fig. 1", 831e3, 82.7), ("Fig. 1", 195e3, 16.5), ("Fig. 2", 1.03e6, 105),
           ("Fig. 3", 600e3, 69.7), ("Fig. 7", 531e3, 35.9), ("Fig. 7", 135e3, 13.5), ("Fig. 9", 2.09e6, 45.9),
           ("Fig. 10", 20e3, 11.2))

COLORS = {"ours": "#1f77b4", "stiff": "#17becf", "pbf": "#d62728", "pbf_code": "#9467bd", "pbf_textbook": "#ff7f0e"}
SPACING_COLORS = ("#1f77b4", "#2ca02c", "#d62728")
STYLES = ("-", "--", ":", "-.")


def panels(count, height=3.2, columns=None):
    columns = columns or count
    rows = (count + columns - 1) // columns
    figure, axes = plt.subplots(rows, columns, figsize=(4.6 * columns, height * rows), squeeze=False)
    for axis in axes.flat:
        axis.grid(True, color="#dddddd", linewidth=0.6)
    return figure, list(axes.flat)


def finish(figure, file):
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    plt.close(figure)


def momentum(figure, results, file):
    """Figure 4: momentum and kinetic energy over time for Eq. 14 and Eq. 12."""
    drawing, axes = panels(3)
    for name, label, color in (("eq14", "Eq. 14", "#1f77b4"), ("eq12", "Eq. 12", "#d62728")):
        series = results[name].series
        axes[0].plot(*quantities.over_time(series, quantities.mean_velocity), color=color, label=label)
        axes[1].semilogy(*quantities.over_time(series, quantities.kinetic), color=color, label=label)
        free = results["free_" + name].series
        axes[2].semilogy(*quantities.over_time(free[1:], quantities.mean_velocity), color=color, label=label)
    titles = ("dam break in a tank: momentum / mass (m/s)", "the same: kinetic energy / mass (J/kg)",
              "free blob: momentum / mass (m/s)")
    for axis, title in zip(axes, titles):
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("time (s)")
        axis.legend()
    finish(drawing, file)


def draw_errors(axis, objective, label, **style):
    errors = quantities.relative_errors(objective) if objective else None
    if errors:
        axis.semilogy(range(len(errors)), [max(abs(e), 1e-9) for e in errors], label=label, **style)


def convergence_axis(axis, title):
    axis.set_title(title, fontsize=10)
    axis.set_xlabel("iteration k")
    axis.set_ylabel("relative error ε (Eq. 18)")
    axis.legend(fontsize=8)


def bulk_energies(figure, results, file):
    """Figure 5: B and its derivative; relative error by iteration with and without search."""
    drawing, axes = panels(4, columns=2)
    lambdas = [0.5 + k / 100 for k in range(101)]
    for power, color in zip((1, 2, 3), ("#1f77b4", "#2ca02c", "#d62728")):
        name = f"B{power - 1}"
        axes[0].plot(lambdas, [(x ** (power + 1) - 1) / (power + 1) - x + 1 for x in lambdas], color=color,
                     label=name)
        axes[1].plot(lambdas, [x ** power - 1 for x in lambdas], color=color, label=name)
        for axis, start in zip(axes[2:], ("dam", "disorder")):
            for length, style in zip(("particle", "full"), ("-", ":")):
                run = results[f"{start}_b{power - 1}_{length}"]
                search = "searched" if length == "particle" else "full steps"
                draw_errors(axis, quantities.last_objective(run.series), f"{name}, {search}", color=color,
                            linestyle=style)
    for axis, title in zip(axes, ("(a) B(λ)", "(b) its derivative")):
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("λ")
        axis.legend(fontsize=8)
    convergence_axis(axes[2], "(c) a dam break at 0.2 s")
    convergence_axis(axes[3], "a disordered block, first step")
    finish(drawing, file)


def spacing_of(run):
    return run.title.rsplit(", ", 1)[1]


def convergence(figure, results, file):
    """Figure 8: relative error by iteration for three spacings, by method; and of ours for all three together, with
    one mu and with one relative stiffness, which are the same at 10 mm."""
    columns = sorted({run.column for run in figure.runs})
    drawing, axes = panels(len(columns) + 1, columns=2)
    for run in figure.runs:
        method = run.name.rsplit("_", 1)[0]
        objective = quantities.last_objective(results[run.name].series)
        if method != "scaled":
            draw_errors(axes[run.column], objective, run.title.rsplit(", ", 1)[0], color=COLORS[method])
        if method in ("ours", "scaled"):
            both = run.column == columns[-1]
            same = "both" if both else "(c·dt/d)² = 10" if method == "scaled" else "mu = 1"
            draw_errors(axes[-1], objective, f"{same}, {spacing_of(run)}", color=SPACING_COLORS[run.column],
                        linestyle=":" if same == "mu = 1" else "-")
    for axis, column in zip(axes, columns):
        convergence_axis(axis, f"({'abc'[column]}) " + next(spacing_of(r) for r in figure.runs if r.column == column))
    convergence_axis(axes[-1], "ours: one mu, or one relative stiffness")
    finish(drawing, file)


def energy_and_compression(figure, results, file):
    """For Figures 6 and 7: what tells whether a run is stable, by method and setting; a variant has a row of its own."""
    variants = sorted({run.variant for run in figure.runs})
    drawing, axes = panels(2 * len(variants), 3.6, columns=2)
    for run in figure.runs:
        at = 2 * variants.index(run.variant)
        method = run.name.rsplit("_", 1)[0].removesuffix(run.variant)
        style = {"color": COLORS[method], "linestyle": STYLES[run.column], "label": run.title}
        series = results[run.name].series[1:]
        axes[at].semilogy(*quantities.over_time(series, quantities.kinetic), **style)
        axes[at + 1].semilogy(*quantities.over_time(series, lambda r: max(quantities.compression(r), 1e-7)), **style)
    for row, variant in enumerate(variants):
        name = variant.replace("_", " ")
        for axis, title in zip(axes[2 * row:], ("kinetic energy / mass (J/kg)", "mean compression, max(λ − 1, 0)")):
            axis.set_title(title + (f",{name}" if name else ""), fontsize=10)
            axis.set_xlabel("time (s)")
        axes[2 * row + 1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    finish(drawing, file)


def step_times(points, device, file):
    """Table 1 against ours: points are (figure, particles, ms a step)."""
    drawing, axes = panels(1, 3.8)
    axes[0].loglog([n for _, n, _ in TABLE_1], [ms for _, _, ms in TABLE_1], "s", color="#888888",
                   label="Table 1 (RTX 3080 Ti laptop)")
    axes[0].loglog([n for _, n, _ in points], [ms for _, _, ms in points], "o", color="#1f77b4", label=device)
    axes[0].set_xlabel("particles")
    axes[0].set_ylabel("time per step (ms)")
    axes[0].legend(fontsize=8)
    finish(drawing, file)
