// One quantity over simulated time, with its axes; the pointer reads values off, a line marks the frame that is shown.
import { useMemo, useState } from "react";
import { shortText } from "../model/numbers";
import { someTicks, ticks } from "../model/playback";
import { titleOf, unitOf } from "../model/quantities";
import { pointAt, pointsOf, type Point, type Run, type Sample } from "../model/runs";

/** Share of the height that is left free above and below. */
const kMargin = 0.06;
const kTicks = 4;
/** Colours of other runs, which repeat. */
const kColors = 6;
/** Percent of the width from which on the unit stands below the axis, or the time that is read. */
const kUnitFrom = 92, kTimeFrom = 70;
/** Percent of the height below which a label stands above its line. */
const kLow = 75;

/** `others`: what the same quantity was in other runs. */
export function Plot({ name, title = titleOf(name), samples, cursor, others = [] }: { title?: string; name: string; samples: Sample[]; cursor: number | null; others?: Pick<Run, "label" | "samples">[] }) {
  const points = useMemo(() => pointsOf(name, samples), [name, samples]);
  const beside = useMemo(() => others.map((r) => ({ label: r.label, points: pointsOf(name, r.samples) })).filter((r) => r.points.length > 0), [name, others]);
  const [pointed, setPointed] = useState<number | null>(null);
  const [large, setLarge] = useState(false);
  if (points.length === 0) return null;
  const all = [points, ...beside.map((r) => r.points)];
  const ends = (of: (ps: Point[]) => number, which: (...ns: number[]) => number) => which(...all.map(of));
  const least = ends((ps) => Math.min(...ps.map((p) => p[1])), Math.min), most = ends((ps) => Math.max(...ps.map((p) => p[1])), Math.max);
  // A constant is drawn in the middle.
  const half = most > least ? 0 : Math.abs(most) || 1;
  const [low, high] = [least - half, most + half];
  const start = ends((ps) => ps[0]![0], Math.min), last = ends((ps) => ps.at(-1)![0], Math.max), end = last > start ? last : start + 1;
  const x = (t: number) => (100 * (t - start)) / (end - start);
  const y = (v: number) => 100 * (1 - kMargin - ((v - low) / (high - low)) * (1 - 2 * kMargin));
  const read = pointed ?? cursor;
  const [time, value] = read === null ? points.at(-1)! : pointAt(points, read);
  const unit = unitOf(name);
  const vertical = someTicks(low, high, large ? 4 : 2);
  return (
    <figure className={large ? "plot large" : "plot"} data-quantity={name}>
      <figcaption><span title={name}>{title}</span><span className="values">{beside.map((r, i) => <b key={r.label} className={`other n${i % kColors}`} title={r.label}>{shortText(pointAt(r.points, time)[1])}</b>)} <b>{shortText(value)} {unit}</b></span></figcaption>
      <div
        className="field" role="img" aria-label={`${titleOf(name)}, ${shortText(value)} ${unit} at ${shortText(time)} s, from ${shortText(least)} to ${shortText(most)}`}
        title="A click makes it large, and small again" onClick={() => setLarge(!large)}
        onPointerMove={(e) => {
          const box = e.currentTarget.getBoundingClientRect();
          setPointed(start + ((e.clientX - box.left) / box.width) * (end - start));
        }}
        onPointerLeave={() => setPointed(null)}
      >
        {vertical.map((v, i) => <i key={v} className={y(v) > kLow ? "line low" : "line"} style={{ top: `${y(v)}%` }}>{(large || i === 0 || i === vertical.length - 1) && <span>{shortText(v)}</span>}</i>)}
        <svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden>
          {beside.map((r, i) => <polyline key={r.label} className={`other n${i % kColors}`} points={r.points.map(([t, v]) => `${x(t)},${y(v)}`).join(" ")} />)}
          {points.length > 1 && <polyline points={points.map(([t, v]) => `${x(t)},${y(v)}`).join(" ")} />}
        </svg>
        {read !== null && read >= start && read <= end && <i className="cursor" style={{ left: `${x(read)}%` }} />}
        <i className="dot" style={{ left: `${x(time)}%`, top: `${y(value)}%` }} />
      </div>
      <div className="axis">{ticks(start, end, kTicks).filter((t) => x(t) < (read === null ? kUnitFrom : kTimeFrom)).map((t) => <span key={t} style={{ left: `${x(t)}%` }}>{shortText(t)}</span>)}<small>{read === null ? "s" : `at ${shortText(time)} s`}</small></div>
    </figure>
  );
}
