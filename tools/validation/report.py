"""The table of a validation: Markdown, JSON, and charts."""

import json


def number(value):
    return "–" if value is None else f"{value:.4g}"


def demand(row):
    parts = []
    if row.within is not None:
        parts.append(f"within {100 * row.within:g} %")
    if row.below is not None:
        parts.append(f"below {row.below:g}")
    if row.above is not None:
        parts.append(f"above {row.above:g}")
    return ", ".join(parts) or "–"


def verdict(row):
    return {True: "pass", False: "**FAIL**", None: "–"}[row.passed]


def table(rows):
    lines = ["| what | expected | measured | unit | off by | demanded | |", "|---|---:|---:|---|---:|---|---|"]
    for row in rows:
        off = "–" if row.deviation is None else f"{100 * row.deviation:+.2f} %"
        lines.append(f"| {row.what} | {number(row.expected)} | {number(row.measured)} | {row.unit} | {off} | "
                     f"{demand(row)} | {verdict(row)} |")
    return lines


def markdown(done, command, machine, seconds):
    """`done`: (check, outcome, names of pictures) each."""
    rows = [row for _, outcome, _ in done for row in outcome.rows]
    failed = sum(row.passed is False for row in rows)
    lines = [f"Made by `{command}` on {machine} in {seconds / 60:.1f} minutes of simulation: "
             f"{sum(row.passed is True for row in rows)} demands met, {failed} not.", ""]
    for check, outcome, pictures in done:
        lines += [f"## {check.title}", "", check.about, "", *table(outcome.rows), ""]
        lines += [f"![{check.title}]({name})\n" for name in pictures]
    return "\n".join(lines) + "\n"


def as_json(done, command, machine):
    checks = [{"key": check.key, "title": check.title,
               "passed": all(row.passed is not False for row in outcome.rows),
               "rows": [{"what": row.what, "measured": row.measured, "unit": row.unit, "expected": row.expected,
                         "demanded": demand(row), "passed": row.passed} for row in outcome.rows]}
              for check, outcome, _ in done]
    return json.dumps({"command": command, "device": machine, "checks": checks}, indent=2, ensure_ascii=False) + "\n"


def draw(charts, file):
    """All charts of a check beside each other."""
    import plots  # matplotlib is slow to load
    drawing, axes = plots.panels(len(charts), 3.4)
    for axis, chart in zip(axes, charts):
        for label, xs, ys, style in chart.curves:
            axis.plot(xs, ys, style, label=label, markersize=4, linewidth=1.2)
        axis.set_title(chart.title, fontsize=10)
        axis.set_xlabel(chart.x)
        axis.set_ylabel(chart.y)
        axis.legend(fontsize=7)
    plots.finish(drawing, file)


def shrink(picture, file):
    """A picture of the program as a small JPEG."""
    import plots
    plots.plt.imsave(file, plots.plt.imread(picture)[..., :3].copy(order="C"), pil_kwargs={"quality": 85})
