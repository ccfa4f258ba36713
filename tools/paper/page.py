"""The page of results: the paper's captions beside our pictures, plots and numbers."""

import quantities


def cell(value, form="{:.3g}"):
    return "–" if value is None else form.format(value)


def numbers(figure, results):
    """A table of all runs of a figure."""
    lines = ["| run | particles | mean step (ms) | max speed (m/s) | mean compression | most energy / initial | ended |",
             "|---|---:|---:|---:|---:|---:|---|"]
    for run in figure.runs:
        stats = results[run.name].stats
        water = stats.get("nodes", {}).get("water", {})
        lines.append(" | ".join((
            "| " + run.title, str(stats.get("particles", "–")), cell(stats.get("step_ms", {}).get("mean")),
            cell(water.get("max_speed")), cell(water.get("compression", {}).get("mean")),
            cell(quantities.energy_gain(results[run.name].series) if figure.plot == "energy_and_compression" else None),
            stats.get("end", "–") + " |")))
    return lines


def convergence_numbers(figure, results):
    """How many iterations the relative error takes to come below some levels."""
    levels = (0.1, 0.01, 0.001)
    lines = ["| run | " + " | ".join(f"k to ε < {level}" for level in levels) + " | ψ⁰ (J) | ψ at the end (J) |",
             "|---|" + "---:|" * (len(levels) + 2)]
    for run in figure.runs:
        objective = quantities.last_objective(results[run.name].series)
        errors = quantities.relative_errors(objective) if objective else None
        if errors is None:
            continue
        steps = [cell(quantities.iterations_to(errors, level), "{}") for level in levels]
        grown = " (grew)" if objective[-1] > objective[0] else ""
        lines.append(f"| {run.title} | " + " | ".join(steps) +
                     f" | {objective[0]:.4g} | {objective[-1]:.4g}{grown} |")
    return lines


def write(file, command, device, done, times, drawn=True):
    """`done`: (figure, scale, results, names of pictures) each; `times`: (figure, particles, ms); `drawn`:
    whether there are montages and plots."""
    lines = ["# The paper's figures", "", f"Made by `{command}` on {device}.", ""]
    for figure, scale, results, pictures in done:
        lines += [f"## Figure {figure.key[3:]}", "", "> " + figure.caption, "",
                  f"Scale {scale:g} of the paper's particle count.", ""]
        lines += [f"![Figure {figure.key[3:]}]({name})\n" for name in pictures]
        of_iterations = figure.plot in ("bulk_energies", "convergence")
        lines += (convergence_numbers if of_iterations else numbers)(figure, results) + [""]
    if times:
        lines += ["## Table 1", "", "> Statistics and timings per timestep for all examples.", ""]
        lines += ["![Times](table1.png)", ""] if drawn else []
        lines += ["| figure | particles | mean step (ms) |", "|---|---:|---:|"]
        lines += [f"| {key} | {particles} | {ms:.3g} |" for key, particles, ms in times]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
