// Points that are dragged in a drawing: of curves, and of values over time.
import { useRef, useState } from "react";

export type Point = [number, number];

export interface PointPlotProps {
  points: Point[];
  label: string;
  onChange(points: Point[]): void;
  /** As many points stay. */
  least: number;
  unit?: string;
  /** Points over time: sorted, none before 0, and each axis has a scale of its own. */
  overTime?: boolean;
  /** Bounds of the second number. */
  low?: number;
  high?: number;
}

const kWidth = 260;
const kHeight = 180;
const kMargin = { left: 34, right: 10, top: 10, bottom: 18 };
const kInner = { width: kWidth - kMargin.left - kMargin.right, height: kHeight - kMargin.top - kMargin.bottom };

interface Range {
  low: number;
  high: number;
}

const rangeOf = (values: number[], from: number, least: number): Range => {
  const low = Math.min(from, ...values);
  return { low, high: Math.max(low + least, ...values) };
};

/** What the drawing shows: all points, from 0; curves with one scale for both axes. */
function rangesOf(points: Point[], overTime: boolean): [Range, Range] {
  const ys = points.map((p) => p[1]);
  const x = rangeOf(points.map((p) => p[0]), 0, overTime ? 1 : 0.1);
  if (overTime) {
    x.high *= 1.15;
    const [low, high] = [Math.min(0, ...ys), Math.max(0, ...ys)];
    const spare = 0.15 * (high - low) || 1;
    return [x, { low: low < 0 ? low - spare : 0, high: high + spare }];
  }
  const y = rangeOf(ys, 0, 0.1);
  const scale = Math.max((x.high - x.low) / kInner.width, (y.high - y.low) / kInner.height);
  return [{ low: x.low, high: x.low + scale * kInner.width }, { low: y.low, high: y.low + scale * kInner.height }];
}

/** One, two or five times a power of ten: about four of them in a range. */
function ticksOf({ low, high }: Range): number[] {
  const rough = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= rough)!;
  const ticks: number[] = [];
  for (let t = Math.ceil(low / step) * step; t <= high + 1e-9 * step; t += step) ticks.push(Number(t.toPrecision(6)));
  return ticks;
}

const rounded = (v: number) => Number(v.toPrecision(4));

export function PointPlot({ points: given, label, onChange, least, unit, overTime = false, low = -Infinity, high = Infinity }: PointPlotProps) {
  const [held, setHeld] = useState<{ index: number; points: Point[] } | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const svg = useRef<SVGSVGElement>(null);
  // The scale stays while a point is dragged.
  const [xs, ys] = rangesOf(given, overTime);
  const points = held?.points ?? given;

  const xOf = (v: number) => kMargin.left + ((v - xs.low) / (xs.high - xs.low)) * kInner.width;
  const yOf = (v: number) => kHeight - kMargin.bottom - ((v - ys.low) / (ys.high - ys.low)) * kInner.height;
  const allowed = ([x, y]: Point): Point => [rounded(overTime ? Math.max(0, x) : x), rounded(Math.min(Math.max(y, low), high))];
  const pointAt = (e: React.MouseEvent): Point => {
    const box = svg.current!.getBoundingClientRect();
    const [sx, sy] = [((e.clientX - box.left) * kWidth) / box.width, ((e.clientY - box.top) * kHeight) / box.height];
    return allowed([
      xs.low + ((sx - kMargin.left) / kInner.width) * (xs.high - xs.low),
      ys.low + ((kHeight - kMargin.bottom - sy) / kInner.height) * (ys.high - ys.low),
    ]);
  };
  /** Over time a point stays between its neighbours. */
  const moved = (all: Point[], index: number, to: Point): Point[] => {
    const [before, after] = [all[index - 1]?.[0] ?? -Infinity, all[index + 1]?.[0] ?? Infinity];
    const gap = 1e-3;
    const x = overTime ? Math.min(Math.max(to[0], before + gap), after - gap) : to[0];
    return all.map((p, i) => (i === index ? allowed([x, to[1]]) : p));
  };
  const put = (next: Point[]) => JSON.stringify(next) !== JSON.stringify(given) && onChange(next);
  const insert = (p: Point) => {
    const at = overTime ? given.filter((q) => q[0] < p[0]).length : nearestGap(given, p) + 1;
    if (overTime && given.some((q) => q[0] === p[0])) return;
    onChange([...given.slice(0, at), p, ...given.slice(at)]);
    setChosen(at);
  };
  const key = (e: React.KeyboardEvent) => {
    const at = chosen === null ? undefined : given[chosen];
    const [stepX, stepY] = [(xs.high - xs.low) / 100, (ys.high - ys.low) / 100];
    if (e.key === "PageDown" || e.key === "PageUp")
      setChosen(given.length === 0 ? null : ((chosen ?? -1) + (e.key === "PageDown" ? 1 : -1) + given.length) % given.length);
    else if (at && (e.key === "Delete" || e.key === "Backspace")) {
      if (given.length > least) (onChange(given.filter((_, i) => i !== chosen)), setChosen(null));
    } else if (at && e.key === "ArrowLeft") put(moved(given, chosen!, [at[0] - stepX, at[1]]));
    else if (at && e.key === "ArrowRight") put(moved(given, chosen!, [at[0] + stepX, at[1]]));
    else if (at && e.key === "ArrowUp") put(moved(given, chosen!, [at[0], at[1] + stepY]));
    else if (at && e.key === "ArrowDown") put(moved(given, chosen!, [at[0], at[1] - stepY]));
    else return;
    e.preventDefault();
    e.stopPropagation();
  };

  const first = points[0];
  const last = points.at(-1);
  const line = points.map((p) => `${xOf(p[0])},${yOf(p[1])}`);
  // Values over time are held before the first and behind the last point.
  if (overTime && first && last) (line.unshift(`${xOf(xs.low)},${yOf(first[1])}`), line.push(`${xOf(xs.high)},${yOf(last[1])}`));
  const told = chosen !== null ? points[chosen] : undefined;
  return (
    <span className="point-plot">
      <svg
        ref={svg} viewBox={`0 0 ${kWidth} ${kHeight}`} role="application" tabIndex={0} onDoubleClick={(e) => insert(pointAt(e))} onKeyDown={key}
        aria-label={`${label}, ${points.length} points: Page Down chooses one, arrows move it, Delete takes it away`}
        onPointerMove={(e) => held && setHeld({ ...held, points: moved(given, held.index, pointAt(e)) })}
        onPointerUp={() => (held && put(held.points), setHeld(null))} onPointerCancel={() => setHeld(null)}
      >
        {ticksOf(xs).map((t) => <g key={`x${t}`}><line className="grid" x1={xOf(t)} x2={xOf(t)} y1={kMargin.top} y2={kHeight - kMargin.bottom} /><text x={xOf(t)} y={kHeight - 6} textAnchor="middle">{t}</text></g>)}
        {ticksOf(ys).map((t) => <g key={`y${t}`}><line className="grid" x1={kMargin.left} x2={kWidth - kMargin.right} y1={yOf(t)} y2={yOf(t)} /><text x={kMargin.left - 4} y={yOf(t) + 3} textAnchor="end">{t}</text></g>)}
        <polyline points={line.join(" ")} />
        {points.map((p, i) => (
          <circle
            key={i} cx={xOf(p[0])} cy={yOf(p[1])} r={i === chosen ? 5.5 : 4} className={i === chosen ? "chosen" : ""}
            onPointerDown={(e) => (svg.current!.setPointerCapture(e.pointerId), svg.current!.focus(), setChosen(i), setHeld({ index: i, points: given }))}
            onDoubleClick={(e) => e.stopPropagation()}
          >
            <title>{p.join(", ")}</title>
          </circle>
        ))}
      </svg>
      <output>{told ? `${told[0]}${overTime ? " s" : ""}, ${told[1]}${unit ? ` ${unit}` : ""}` : ""}</output>
    </span>
  );
}

/** The index of the point behind which a new one stretches the line least. */
function nearestGap(points: Point[], p: Point): number {
  const length = (a: Point, b: Point) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  const cost = (i: number) => length(points[i]!, p) + length(p, points[i + 1]!) - length(points[i]!, points[i + 1]!);
  let best = points.length - 1;
  for (let i = 0; i + 1 < points.length; ++i) if (best === points.length - 1 || cost(i) < cost(best)) best = i;
  return best;
}
