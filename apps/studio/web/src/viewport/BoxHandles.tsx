// Handles on the faces of the selected box: each is dragged along its axis, or moved by the arrow keys.
import { useEffect, useRef } from "react";
import { setParam } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { boxOf, withFace, type Corners } from "./outlines";
import type { View } from "./view";

const kAxes = ["x", "y", "z"] as const;
const kEnds = ["min", "max"] as const;
/** Of a side, for a press of an arrow key. */
const kStep = 0.01;

const snapped = (v: number, step: number): number => Number((step * Math.round(v / step)).toPrecision(12));

const centerOf = (box: Corners, end: "min" | "max", axis: number): number[] => box.min.map((low, i) => (i === axis ? box[end][axis]! : (low + box.max[i]!) / 2));

export function BoxHandles({ view }: { view: View }) {
  const node = useStudio((s) => (s.role === "writer" && s.selected.length === 1 ? s.selected[0]! : null));
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const box = node !== null && types ? boxOf(scene, types, node) : null;
  return node !== null && box ? <Faces key={node} node={node} box={box} view={view} /> : null;
}

function Faces({ node, box, view }: { node: string; box: Corners; view: View }) {
  const handles = useRef<(HTMLButtonElement | null)[]>([]);
  const latest = useRef(box);
  latest.current = box;
  const faces = kAxes.flatMap((axis, i) => kEnds.map((end) => ({ axis, i, end })));
  const place = () =>
    faces.forEach(({ i, end }, k) => {
      const at = view.project(centerOf(latest.current, end, i)), handle = handles.current[k];
      if (!handle) return;
      handle.hidden = at === null;
      if (at) handle.style.transform = `translate(${at.x}px, ${at.y}px)`;
    });
  useEffect(() => view.onDrawn(place), [view]); // eslint-disable-line
  useEffect(place);
  const put = (end: "min" | "max", axis: number, to: number) => {
    const next = withFace(latest.current, end, axis, to);
    edit((s) => setParam(s, { node }, [end], next[end]), `box ${node} ${end}`);
  };
  return (
    <div className="faces" role="group" aria-label={`Faces of ${node}`}>
      {faces.map(({ axis, i, end }, k) => (
        <button
          key={axis + end} ref={(e) => void (handles.current[k] = e)} className={`face ${axis}`} role="slider" aria-label={`${end} ${axis} of ${node}`} aria-valuenow={box[end][i]!}
          title={`${end} ${axis}: ${box[end][i]} m. Drag it, with Ctrl in round steps, or use the arrow keys`}
          onPointerDown={(e) => (e.button === 0 && e.currentTarget.setPointerCapture(e.pointerId), e.stopPropagation())}
          onPointerMove={(e) => {
            if (!e.currentTarget.hasPointerCapture(e.pointerId)) return;
            const to = view.along(e.clientX, e.clientY, centerOf(latest.current, end, i), i);
            if (to !== null) put(end, i, e.ctrlKey ? snapped(to, view.snapStep()) : to);
          }}
          onKeyDown={(e) => {
            const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[e.key];
            if (!way) return;
            e.preventDefault();
            e.stopPropagation();
            put(end, i, box[end][i]! + way * kStep * (box.max[i]! - box.min[i]!));
          }}
        />
      ))}
    </div>
  );
}
