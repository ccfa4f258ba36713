// The points of a curve, drawn and dragged: profiles of surfaces and terrains.
import { useRef, useState } from "react";
import type { Json } from "../model/types";
import type { FieldProps } from "./fields";

type Point = [number, number];

const kWidth = 260;
const kHeight = 200;
const kMargin = 12;

const pointsOf = (v: Json): Point[] =>
  Array.isArray(v) ? v.filter((p): p is Json[] => Array.isArray(p) && p.length === 2).map((p) => [Number(p[0]), Number(p[1])]) : [];

/** Maps curve coordinates to the drawing, with one scale for both axes. */
function frame(points: Point[]) {
  const xs = points.map((p) => p[0]);
  const ys = points.map((p) => p[1]);
  const [x0, y0] = [Math.min(0, ...xs), Math.min(0, ...ys)];
  const span = Math.max(Math.max(...xs, 0.1) - x0, (Math.max(...ys, 0.1) - y0) * (kWidth / kHeight), 1e-6);
  const scale = (kWidth - 2 * kMargin) / span;
  return {
    toScreen: (p: Point): Point => [kMargin + (p[0] - x0) * scale, kHeight - kMargin - (p[1] - y0) * scale],
    toCurve: (x: number, y: number): Point => [x0 + (x - kMargin) / scale, y0 + (kHeight - kMargin - y) / scale],
  };
}

const rounded = (p: Point): Point => [Number(p[0].toPrecision(4)), Number(p[1].toPrecision(4))];

export function CurveField({ value, onChange, label }: FieldProps) {
  const given = pointsOf(value);
  const [held, setHeld] = useState<{ index: number; points: Point[] } | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const svg = useRef<SVGSVGElement>(null);
  // The scale stays while a point is dragged.
  const map = frame(given);
  const points = held?.points ?? given;
  const at = (e: React.PointerEvent | React.MouseEvent): Point => {
    const box = svg.current!.getBoundingClientRect();
    return rounded(map.toCurve(((e.clientX - box.left) * kWidth) / box.width, ((e.clientY - box.top) * kHeight) / box.height));
  };
  const insert = (e: React.MouseEvent) => {
    const p = at(e);
    const distance = (i: number) => {
      const [a, b] = [given[i]!, given[i + 1]!];
      return Math.hypot((a[0] + b[0]) / 2 - p[0], (a[1] + b[1]) / 2 - p[1]);
    };
    const best = given.slice(1).reduce((k, _, i) => (distance(i) < distance(k) ? i : k), 0);
    onChange([...given.slice(0, best + 1), p, ...given.slice(best + 1)]);
  };
  const line = points.map((p) => map.toScreen(p).join()).join(" ");
  return (
    <span className="curve">
      <svg
        ref={svg} viewBox={`0 0 ${kWidth} ${kHeight}`} aria-label={`${label}, ${points.length} points`} tabIndex={0}
        onDoubleClick={insert}
        onPointerMove={(e) => held && setHeld({ ...held, points: held.points.map((p, i) => (i === held.index ? at(e) : p)) })}
        onPointerUp={() => (held && JSON.stringify(held.points) !== JSON.stringify(given) && onChange(held.points), setHeld(null))}
        onKeyDown={(e) => {
          if ((e.key !== "Delete" && e.key !== "Backspace") || chosen === null || given.length <= 2) return;
          onChange(given.filter((_, i) => i !== chosen));
          setChosen(null);
          e.stopPropagation();
        }}
      >
        <polyline points={line} />
        {points.map((p, i) => {
          const [x, y] = map.toScreen(p);
          return (
            <circle
              key={i} cx={x} cy={y} r={4} className={i === chosen ? "chosen" : ""}
              onPointerDown={(e) => (svg.current!.setPointerCapture(e.pointerId), setChosen(i), setHeld({ index: i, points: given }))}
            >
              <title>{`${p[0]}, ${p[1]}`}</title>
            </circle>
          );
        })}
      </svg>
      <small>Drag points; double click adds one, Delete removes the chosen one.</small>
    </span>
  );
}
