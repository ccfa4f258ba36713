// Handles of the planes that cut the fluids open, where nothing is selected: one moves the plane along its normal, one turns it.
import { useEffect, useRef } from "react";
import { cutsOf, footOf, withNormal, withPlane, type Cut } from "../model/clips";
import { edit, useStudio } from "../model/store";
import type { View } from "./view";

/** Of what is seen: half the side of the square that is drawn, and how long the normal is. */
const kHalf = 0.5, kNormal = 0.25;
/** Of what is seen, and radians, for a press of an arrow key. */
const kStep = 0.01, kTurn = Math.PI / 36;

const plus = (a: number[], b: number[], by = 1): number[] => a.map((x, i) => x + by * b[i]!);
const cross = (a: number[], b: number[]): number[] => [a[1]! * b[2]! - a[2]! * b[1]!, a[2]! * b[0]! - a[0]! * b[2]!, a[0]! * b[1]! - a[1]! * b[0]!];
const unit = (v: number[]): number[] => v.map((x) => x / (Math.hypot(...v) || 1));

/** Two directions in the plane. */
function sidesOf(normal: number[]): [number[], number[]] {
  const least = normal.map(Math.abs).indexOf(Math.min(...normal.map(Math.abs)));
  const u = unit(cross(normal, [0, 1, 2].map((i) => Number(i === least))));
  return [u, cross(normal, u)];
}

export function Cuts({ view }: { view: View }) {
  const scene = useStudio((s) => s.scene);
  const shown = useStudio((s) => s.role === "writer" && s.selected.length === 0);
  if (!shown) return null;
  return <>{cutsOf(scene).map((cut, i) => <Plane key={i} which={i} cut={cut} view={view} />)}</>;
}

function Plane({ which, cut, view }: { which: number; cut: Cut; view: View }) {
  const square = useRef<SVGPolygonElement>(null), line = useRef<SVGLineElement>(null);
  const middle = useRef<HTMLButtonElement>(null), tip = useRef<HTMLButtonElement>(null);
  const latest = useRef(cut);
  latest.current = cut;
  const places = () => {
    const { center, size } = view.extent(), foot = footOf(latest.current, center), { normal } = latest.current;
    return { foot, size, end: plus(foot, normal, kNormal * size), sides: sidesOf(normal) };
  };
  const place = () => {
    const { foot, end, size, sides: [u, v] } = places();
    const corners = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([a, b]) => view.project(plus(plus(foot, u, a! * kHalf * size), v, b! * kHalf * size)));
    const [from, to] = [view.project(foot), view.project(end)];
    square.current?.toggleAttribute("hidden", corners.includes(null));
    square.current?.setAttribute("points", corners.flatMap((p) => (p ? [`${p.x},${p.y}`] : [])).join(" "));
    line.current?.toggleAttribute("hidden", !from || !to);
    for (const [handle, at] of [[middle.current, from], [tip.current, to]] as const) {
      if (!handle) continue;
      handle.hidden = at === null;
      if (at) handle.style.transform = `translate(${at.x}px, ${at.y}px)`;
    }
    if (from && to) for (const [name, x] of Object.entries({ x1: from.x, y1: from.y, x2: to.x, y2: to.y })) line.current?.setAttribute(name, String(x));
  };
  useEffect(() => view.onDrawn(place), [view]); // eslint-disable-line
  useEffect(place);
  const name = `cut ${which + 1}`;
  const move = (to: number[]) => edit((s) => withPlane(s, which, to), `${name} place`);
  const turn = (about: number[], to: number[]) => edit((s) => withNormal(s, which, about, to), `${name} turn`);
  const held = (e: React.PointerEvent) => e.currentTarget.hasPointerCapture(e.pointerId);
  const press = (e: React.PointerEvent) => (e.button === 0 && e.currentTarget.setPointerCapture(e.pointerId), e.stopPropagation());
  const wayOf = (e: React.KeyboardEvent): [number, number] | null => {
    const way = ({ ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowLeft: [-1, 0], ArrowDown: [0, -1] } as const)[e.key as "ArrowUp"];
    if (!way) return null;
    e.preventDefault();
    e.stopPropagation();
    return [...way];
  };
  const along = Number(cut.point.reduce((s, x, i) => s + x * cut.normal[i]!, 0).toPrecision(3));
  return (
    <div className="faces" role="group" aria-label={name}>
      <svg className="arrow cut" aria-hidden><polygon ref={square} /><line ref={line} /></svg>
      <button
        ref={middle} className="face cut" role="slider" aria-label={`Place of ${name}`} aria-valuenow={along} aria-valuetext={`${along} m`}
        title={`${name}, ${along} m along its normal. Drag it, or use the arrow keys`} onPointerDown={press}
        onPointerMove={(e) => {
          const to = held(e) ? view.alongWay(e.clientX, e.clientY, places().foot, latest.current.normal) : null;
          if (to) move(to);
        }}
        onKeyDown={(e) => {
          const way = wayOf(e), { foot, size } = places();
          if (way) move(plus(foot, latest.current.normal, (way[0] + way[1]) * kStep * size));
        }}
      />
      <button
        ref={tip} className="face tip cut" role="slider" aria-label={`Normal of ${name}`} aria-valuenow={0} aria-valuetext={cut.normal.map((x) => x.toFixed(2)).join(", ")}
        title={`The normal of ${name}: drag it to turn the plane, or use the arrow keys`} onPointerDown={press}
        onPointerMove={(e) => {
          if (!held(e)) return;
          const { foot, end } = places(), to = view.besides(e.clientX, e.clientY, end);
          if (to) turn(foot, to);
        }}
        onKeyDown={(e) => {
          const way = wayOf(e), { foot, sides: [u, v] } = places();
          if (way) turn(foot, plus(plus(plus(foot, latest.current.normal), u, way[0] * Math.tan(kTurn)), v, way[1] * Math.tan(kTurn)));
        }}
      />
    </div>
  );
}
