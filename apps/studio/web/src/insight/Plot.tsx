// One quantity over simulated time, with its axes; the pointer reads values off, a line marks the frame that is shown.
import { useMemo, useState } from "react";
import { shortText } from "../model/numbers";
import { ticks } from "../model/playback";
import { inUnit, titleOf, unitOf } from "../model/quantities";
import type { Sample } from "../model/store";

type Point = readonly [time: number, value: number];

/** Share of the height that is left free above and below. */
const kMargin = 0.06;
const kTicks = 4;
/** Percent of the height below which a label stands above its line. */
const kLow = 75;

/** The last point that is not after a time, or else the first one. */
export function pointAt(points: Point[], time: number): Point {
  let low = 0, high = points.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (points[middle]![0] <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  return points[low]!;
}

export function Plot({ name, samples, cursor }: { name: string; samples: Sample[]; cursor: number | null }) {
  const points = useMemo(
    () => samples.flatMap((s): Point[] => (Number.isFinite(s.values[name]) ? [[s.time, inUnit(name, s.values[name]!)]] : [])),
    [name, samples],
  );
  const [pointed, setPointed] = useState<number | null>(null);
  const [large, setLarge] = useState(false);
  if (points.length === 0) return null;
  const ys = points.map((p) => p[1]);
  const [least, most] = [Math.min(...ys), Math.max(...ys)];
  // A constant is drawn in the middle.
  const half = most > least ? 0 : Math.abs(most) || 1;
  const [low, high] = [least - half, most + half];
  const start = points[0]![0], end = Math.max(points.at(-1)![0], start + 1e-9);
  const x = (t: number) => (100 * (t - start)) / (end - start);
  const y = (v: number) => 100 * (1 - kMargin - ((v - low) / (high - low)) * (1 - 2 * kMargin));
  const read = pointed ?? cursor;
  const [time, value] = read === null ? points.at(-1)! : pointAt(points, read);
  const unit = unitOf(name);
  const vertical = ticks(low, high, 3);
  return (
    <figure className={large ? "plot large" : "plot"} data-quantity={name}>
      <figcaption><span title={name}>{titleOf(name)}</span><b>{shortText(value)} {unit}</b></figcaption>
      <div
        className="field" role="img" aria-label={`${titleOf(name)}, ${shortText(value)} ${unit} at ${shortText(time)} s, from ${shortText(least)} to ${shortText(most)}`}
        title="A click makes it large, and small again" onClick={() => setLarge(!large)}
        onPointerMove={(e) => {
          const box = e.currentTarget.getBoundingClientRect();
          setPointed(start + ((e.clientX - box.left) / box.width) * (end - start));
        }}
        onPointerLeave={() => setPointed(null)}
      >
        {vertical.map((v) => <i key={v} className={y(v) > kLow ? "line low" : "line"} style={{ top: `${y(v)}%` }}><span>{shortText(v)}</span></i>)}
        <svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden>
          {points.length > 1 && <polyline points={points.map(([t, v]) => `${x(t)},${y(v)}`).join(" ")} />}
        </svg>
        {read !== null && read >= start && read <= end && <i className="cursor" style={{ left: `${x(read)}%` }} />}
        <i className="dot" style={{ left: `${x(time)}%`, top: `${y(value)}%` }} />
      </div>
      <div className="axis">{ticks(start, end, kTicks).map((t) => <span key={t} style={{ left: `${x(t)}%` }}>{shortText(t)}</span>)}<small>{read === null ? "s" : `at ${shortText(time)} s`}</small></div>
    </figure>
  );
}
