// Arrows whose tips are dragged: the speed of the selected nozzle; gravity where nothing is selected.
import * as THREE from "three";
import { useEffect, useRef } from "react";
import { gravityArrow, speedArrow, tipOf, withTip, type Arrow } from "../model/arrows";
import { labelOf } from "../model/parameters";
import { edit, useStudio } from "../model/store";
import { quaternionOf } from "./outlines";
import type { View } from "./view";

/** Of what is seen, for 1 m/s and for the Earth's gravity. */
const kSpeedShare = 0.06, kGravityShare = 0.02;
/** Of its length, for a press of an arrow key. */
const kStep = 0.05;

const downwards = (rotation: Parameters<typeof quaternionOf>[0]): number[] => new THREE.Vector3(0, -1, 0).applyQuaternion(quaternionOf(rotation)).toArray();

function useArrow(view: View): Arrow | null {
  const scene = useStudio((s) => s.scene), types = useStudio((s) => s.types);
  const selected = useStudio((s) => (s.role !== "writer" || s.selected.length > 1 ? null : s.selected));
  if (!selected || !types || Object.keys(scene.nodes).length === 0) return null;
  const box = view.extent();
  return selected.length === 1 ? speedArrow(scene, types, selected[0]!, kSpeedShare * box.size, downwards) : gravityArrow(scene, types, box.center, kGravityShare * box.size);
}

export function Arrows({ view }: { view: View }) {
  const arrow = useArrow(view);
  return arrow ? <Tip key={JSON.stringify(arrow.owner)} arrow={arrow} view={view} /> : null;
}

function Tip({ arrow, view }: { arrow: Arrow; view: View }) {
  const handle = useRef<HTMLButtonElement>(null), line = useRef<SVGLineElement>(null);
  const latest = useRef(arrow);
  latest.current = arrow;
  const place = () => {
    const from = view.project(latest.current.from), to = view.project(tipOf(latest.current));
    const shown = from !== null && to !== null;
    if (handle.current) handle.current.hidden = !shown;
    line.current?.toggleAttribute("hidden", !shown);
    if (!shown || !handle.current || !line.current) return;
    handle.current.style.transform = `translate(${to.x}px, ${to.y}px)`;
    for (const [name, v] of Object.entries({ x1: from.x, y1: from.y, x2: to.x, y2: to.y })) line.current.setAttribute(name, String(v));
  };
  useEffect(() => view.onDrawn(place), [view]); // eslint-disable-line
  useEffect(place);
  const name = "section" in arrow.owner ? labelOf(arrow.parameter) : `${labelOf(arrow.parameter)} of ${arrow.owner.node}`;
  const put = (tip: number[]) => edit((s) => withTip(s, latest.current, tip), `arrow ${name}`);
  const size = Array.isArray(arrow.value) ? Math.hypot(...arrow.value) : arrow.value;
  const text = `${Number(size.toPrecision(3))} ${arrow.unit.replaceAll("^2", "²")}`;
  return (
    <div className="faces" role="group" aria-label={name}>
      <svg className="arrow" aria-hidden><line ref={line} /></svg>
      <button
        ref={handle} className="face tip" role="slider" aria-label={name} aria-valuenow={size} aria-valuetext={text} title={`${name}: ${text}. Drag it, or use the arrow keys`}
        onPointerDown={(e) => (e.button === 0 && e.currentTarget.setPointerCapture(e.pointerId), e.stopPropagation())}
        onPointerMove={(e) => {
          if (!e.currentTarget.hasPointerCapture(e.pointerId)) return;
          const a = latest.current;
          const to = a.way ? view.alongWay(e.clientX, e.clientY, a.from, a.way) : view.besides(e.clientX, e.clientY, tipOf(a));
          if (to !== null) put(to);
        }}
        onKeyDown={(e) => {
          const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[e.key];
          if (!way) return;
          e.preventDefault();
          e.stopPropagation();
          const a = latest.current, tip = tipOf(a);
          put(tip.map((x, i) => a.from[i]! + (1 + way * kStep) * (x - a.from[i]!)));
        }}
      >
        <span>{text}</span>
      </button>
    </div>
  );
}
