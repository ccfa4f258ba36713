"""The results of weir bench as Markdown."""

import results as benchmarks


def number(value, form="{:.3g}"):
    return "–" if value is None else form.format(value)


def ms(value):
    """Three digits, and never an exponent."""
    if value is None:
        return "–"
    return f"{value:.3f}" if value < 1 else f"{value:.2f}" if value < 10 else f"{value:.1f}"


def count(value):
    return "–" if value is None else f"{value:,}"


def case_table(results):
    """All cases and sizes: early and late."""
    lines = ["| case | particles | early (ms) | late (ms) | late, batch (ms) | late (ns a particle) | memory (B a particle) | "
             "of the copy's speed | neighbours | compression |", "|---|" + "---:|" * 9]
    for row in results.rows:
        late = row.moment("late")
        if row.trouble and not row.ms("early"):
            lines.append(f"| {row.case} | {count(row.particles)} | {row.trouble} |" + " |" * 7)
            continue
        late = late or {}
        nanoseconds = 1e6 * late["step_ms_median"] / late["particles"] if late else None
        cells = (row.case, count(row.particles), ms(row.ms("early")),
                 ms(row.ms("late")) if late or not row.trouble else row.trouble, ms(late.get("batch_step_ms_mean")),
                 number(nanoseconds, "{:.1f}"), number(row.bytes_per_particle, "{:.0f}"),
                 number(late.get("share_of_copy_bandwidth"), "{:.2f}"), number(late.get("neighbors_mean"), "{:.1f}"),
                 number(late.get("compression_mean"), "{:.2g}"))
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def soft_rows(results):
    """Says which rows are not water."""
    rows = [f"{count(row.particles)} ({row.case})" for row in results.rows if row.is_soft]
    if not rows:
        return []
    return [f"Compressed by more than {100 * benchmarks.SOFT:.0f} % on average, so that they show capacity and not water: {', '.join(rows)}."]


def module_table(results, case="dam", moment="late"):
    """Milliseconds of each module of the fluid by size."""
    rows = [row for row in results.rows if row.case == case and row.moment(moment)]
    paths = []
    for row in rows:
        paths += [path for path in row.moment(moment)["modules_ms"] if "/" in path and path not in paths]
    shown = [path for path in paths if any(is_noticeable(row.moment(moment), path) for row in rows)]
    if not shown:
        return []
    names = [path.split("/", 1)[1] for path in shown]
    lines = [f"Of a step of `{case}`, {moment}, in ms; modules of less than a hundredth of the step are left out:", "",
             "| particles | " + " | ".join(names) + " |", "|---:|" + "---:|" * len(shown)]
    for row in rows:
        modules = row.moment(moment)["modules_ms"]
        lines.append(f"| {count(row.particles)} | " + " | ".join(ms(modules.get(path)) for path in shown) + " |")
    return lines


def is_noticeable(moment, path):
    return moment["modules_ms"].get(path, 0) >= 0.01 * moment["step_ms_median"]


def growth(results):
    """How the time grows with the number of particles."""
    lines = []
    for case, moment in (("dam", "late"), ("dam-3-sweeps", "late")):
        series = results.series(case, moment)
        power = benchmarks.exponent(series)
        if power is None:
            continue
        line = (f"From {min(n for n, _ in series if n >= 135_000):,} to {series[-1][0]:,} particles, the time of "
                f"`{case}`, {moment}, grows like the {power:.3f}th power of their number")
        batches = [pair for pair in results.series(case, moment, "batch_step_ms_mean") if pair[0] >= 135_000]
        if len(batches) > 1:
            line += (f"; in batches like the {benchmarks.exponent(batches):.3f}th, "
                     f"and the {benchmarks.exponent([batches[0], batches[-1]]):.3f}th by the first and the last of these sizes")
        lines.append(line + ".")
    return lines


def peer_table(results, peers, case="dam-3-sweeps"):
    """Times of others beside ours with as many sweeps of viscosity, at the same sizes."""
    ours = {row.size: row for row in results.rows if row.case == case and (row.ms("early") or row.ms("late"))}
    if not ours:
        return []
    lines = [f"Early, late (ms); Weir's are those of `{case}`. The last column is the quickest other program's late time, the probe "
             "left out, divided by Weir's.", "",
             "| particles | Weir | " + " | ".join(peer["name"] for peer in peers) + " | times faster |",
             "|---:|" + "---:|" * (len(peers) + 2)]
    for size, row in ours.items():
        cells, others = [], []
        for peer in peers:
            at = peer["particles"].index(size) if size in peer["particles"] else None
            times = (None, None) if at is None else (peer["early_ms"][at], peer["late_ms"][at])
            cells.append(", ".join(ms(time) for time in times) if any(times) else "–")
            if times[1] and peer["name"] != "probe":
                others.append(times[1])
        faster = min(others) / row.ms("late") if others and row.ms("late") else None
        lines.append(f"| {count(size)} | {ms(row.ms('early'))}, {ms(row.ms('late'))} | " + " | ".join(cells) +
                     f" | {number(faster, '{:.1f}')} |")
    return lines


def machine_line(results):
    machine = results.machine
    parts = [machine["cpu"], machine["system"], f"{machine['compiler']}, {machine['build_type']}"]
    if results.on_cuda:
        parts.append(f"CUDA: {machine['cuda']}")
    return (f"{'; '.join(parts)}; commit {machine['commit']}, {machine['date'][:10]}. A copy reads and writes "
            f"{results.copy_bytes_per_second * 1e-9:.4g} GB/s. `{results.command}`")


def markdown(many, peers, picture):
    """`many`: Results; `picture`: the plot's name, or None where there is none."""
    lines = [f"![Time of a step by number of particles]({picture})", ""] if picture else []
    for results in many:
        lines += [f"### {results.device}", "", machine_line(results), "", *case_table(results), ""]
        for part in (soft_rows(results), growth(results), module_table(results), peer_table(results, peers) if results.on_cuda else []):
            lines += [*part, ""] if part else []
    lines += ["The others:", ""] + [f"- {peer['name']}: {peer['source']}" for peer in peers]
    return "\n".join(lines) + "\n"
