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


def verdict(passed):
    return {True: "pass", False: "**FAIL**", None: "–"}[passed]


def off(row):
    """How far a row of the JSON is from what it expects."""
    if row.get("measured") is None or not row.get("expected"):
        return "–"
    return f"{100 * (row['measured'] / row['expected'] - 1):+.2f} %"


def table(rows, beside=()):
    """`rows` are those of the JSON; `beside`: the same check's rows by what they say, of each other device."""
    if not beside:
        lines = ["| what | expected | measured | unit | off by | demanded | |", "|---|---:|---:|---|---:|---|---|"]
        return lines + [f"| {row['what']} | {number(row['expected'])} | {number(row['measured'])} | {row['unit']} | "
                        f"{off(row)} | {row['demanded']} | {verdict(row['passed'])} |" for row in rows]
    devices = range(1 + len(beside))
    lines = ["| what | unit | demanded |" + "".join(f" expected | ({k + 1}) | off by | |" for k in devices),
             "|---|---|---|" + "---:|---:|---:|---|" * len(devices)]
    for row in rows:
        cells = [row] + [others.get(row["what"], {}) for others in beside]
        lines.append(f"| {row['what']} | {row['unit']} | {row['demanded']} |" + "".join(
            f" {number(cell.get('expected'))} | {number(cell.get('measured'))} | {off(cell)} | {verdict(cell.get('passed'))} |"
            for cell in cells))
    return lines


def summary(results):
    verdicts = [row["passed"] for check in results["checks"] for row in check["rows"]]
    made = f" ({results['made']})" if results.get("made") else ""
    return (f"Made by `{results['command']}` on {results['device']}{made} in {results['seconds'] / 60:.1f} minutes of "
            f"simulation: {verdicts.count(True)} demands met, {verdicts.count(False)} not.")


def markdown(done, results):
    """`done`: (check, outcome, names of pictures) each; `results`: what as_json says of each device, that of `done` first."""
    lines = [summary(results[0]), ""]
    if len(results) > 1:
        lines = [f"{k}. {summary(one)}" for k, one in enumerate(results, 1)] + [""]
    by_key = [{check["key"]: check["rows"] for check in one["checks"]} for one in results]
    for check, _, pictures in done:
        beside = [{row["what"]: row for row in one.get(check.key, [])} for one in by_key[1:]]
        lines += [f"## {check.title}", "", check.about, "", *table(by_key[0][check.key], beside), ""]
        lines += [f"![{check.title}]({name})\n" for name in pictures]
    return "\n".join(lines) + "\n"


def as_json(done, command, machine, seconds, made=""):
    """`made`: the day and the commit."""
    checks = [{"key": check.key, "title": check.title,
               "passed": all(row.passed is not False for row in outcome.rows),
               "rows": [{"what": row.what, "measured": row.measured, "unit": row.unit, "expected": row.expected,
                         "demanded": demand(row), "passed": row.passed} for row in outcome.rows]}
              for check, outcome, _ in done]
    return json.dumps({"command": command, "device": machine, "made": made, "seconds": seconds, "checks": checks}, indent=2,
                      ensure_ascii=False) + "\n"


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
