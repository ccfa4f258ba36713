"""Time of a step against the number of particles, ours and others', on logarithmic axes."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import results as benchmarks  # noqa: E402

COLORS = ("#1f77b4", "#2ca02c", "#9467bd", "#17becf")
PEER_STYLES = (("s", "#d62728"), ("v", "#7f7f7f"), ("^", "#ff7f0e"), ("D", "#8c564b"))
CASES = (("dam", "1 sweep", "-"), ("dam-3-sweeps", "3 sweeps", "--"))


def save(figure, axis, file):
    """A plot of the time of a step against the number of particles."""
    axis.grid(True, which="both", color="#e4e4e4", linewidth=0.5)
    axis.set_xlabel("particles")
    axis.set_ylabel("ms a step")
    axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    plt.close(figure)


def draw(many, peers, file):
    figure, axis = plt.subplots(figsize=(8.2, 5.4))
    for color, results in zip(COLORS * len(many), many):
        for case, label, style in CASES:
            series = results.series(case, "late")
            if series:
                axis.loglog(*zip(*series), style, color=color, marker="o", markersize=4,
                            label=f"Weir, {results.device.split(',')[0]}, {label}, late")
    soft = [(row.particles, row.ms("late")) for results in many for row in results.rows
            if row.case in {case for case, _, _ in CASES} and row.is_soft and row.ms("late")]
    if soft:
        axis.loglog(*zip(*soft), "kx", markersize=9, label=f"compressed by more than {100 * benchmarks.SOFT:.0f} %: capacity, not water")
    for (marker, color), peer in zip(PEER_STYLES * len(peers), peers):
        for moment, face in (("late", color), ("early", "none")):
            points = [(n, ms) for n, ms in zip(peer["particles"], peer[moment + "_ms"]) if ms]
            if points:
                axis.loglog(*zip(*points), marker, color=color, markerfacecolor=face, markersize=6,
                            label=f"{peer['name']}, {moment}")
    save(figure, axis, file)
