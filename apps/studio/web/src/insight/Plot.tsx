// One quantity over simulated time, as a small drawing.
import { useMemo } from "react";
import type { Sample } from "../model/store";

const kWidth = 240;
const kHeight = 74;

const short = (v: number) => String(Number(v.toPrecision(3)));

export function Plot({ name, samples }: { name: string; samples: Sample[] }) {
  const points = useMemo(
    () => samples.map((s) => [s.time, s.values[name]] as const).filter((p): p is readonly [number, number] => p[1] !== undefined && Number.isFinite(p[1])),
    [name, samples],
  );
  if (points.length === 0) return null;
  const ys = points.map((p) => p[1]);
  const [low, high] = [Math.min(...ys), Math.max(...ys)];
  const [start, end] = [points[0]![0], Math.max(points.at(-1)![0], points[0]![0] + 1e-9)];
  const line = points
    .map(([t, v]) => `${((t - start) / (end - start)) * kWidth},${kHeight - 4 - ((v - low) / (high - low || 1)) * (kHeight - 8)}`)
    .join(" ");
  return (
    <figure className="plot">
      <figcaption><span title={name}>{name}</span><b>{short(ys.at(-1)!)}</b></figcaption>
      <svg viewBox={`0 0 ${kWidth} ${kHeight}`} role="img" aria-label={`${name}, now ${short(ys.at(-1)!)}, from ${short(low)} to ${short(high)}`} preserveAspectRatio="none">
        <polyline points={line} />
      </svg>
      <small>{short(low)} to {short(high)}</small>
    </figure>
  );
}
