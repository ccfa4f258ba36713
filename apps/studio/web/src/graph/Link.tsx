// A link between nodes, led through its bends. From far all of them are drawn into one picture: hundreds of small ones are what
// browsers are slow at.
import { BaseEdge, getBezierPath, Position, useReactFlow, type EdgeProps } from "@xyflow/react";
import { createContext, useContext, useState } from "react";
import { createPortal } from "react-dom";
import { withBends, type Point } from "../model/links";
import { edit } from "../model/store";

/** Where links are drawn while the graph is seen from far; null while it is not. */
export const FarLinks = createContext<SVGSVGElement | null>(null);

const kRadius = 5;
const kStep = 10;

/** One curve after another, from left to right at each bend. */
function pathThrough({ sourceX, sourceY, targetX, targetY }: EdgeProps, bends: Point[]): string {
  const stops = [{ x: sourceX, y: sourceY }, ...bends, { x: targetX, y: targetY }];
  return stops.slice(1).map((to, i) => getBezierPath({
    sourceX: stops[i]!.x, sourceY: stops[i]!.y, sourcePosition: Position.Right, targetX: to.x, targetY: to.y, targetPosition: Position.Left,
  })[0]).join(" ");
}

/** A point that a link is led through: dragged, moved by the arrow keys, taken away by Delete or a double click. */
function Bend({ link, bends, index, shown, onMove }: { link: string; bends: Point[]; index: number; shown: Point; onMove(at: Point | null): void }) {
  const flow = useReactFlow();
  const { x, y } = bends[index]!;
  const put = (to: Point | null) => edit((s) => withBends(s, link, to ? bends.map((p, i) => (i === index ? to : p)) : bends.filter((_, i) => i !== index)), to ? `bend ${link} ${index}` : undefined);
  const key = (e: React.KeyboardEvent) => {
    const way = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] }[e.key];
    if (way) put({ x: x + way[0]! * kStep, y: y + way[1]! * kStep });
    else if (e.key === "Delete" || e.key === "Backspace") put(null);
    else return;
    e.preventDefault();
    e.stopPropagation();
  };
  return (
    <circle
      className="bend nodrag nopan" cx={shown.x} cy={shown.y} r={kRadius} tabIndex={0} role="button" aria-label={`Bend ${index + 1} of ${link}`} onKeyDown={key}
      onDoubleClick={(e) => (e.stopPropagation(), put(null))}
      onPointerDown={(e) => e.button === 0 && (e.stopPropagation(), e.currentTarget.setPointerCapture(e.pointerId))}
      onPointerMove={(e) => e.currentTarget.hasPointerCapture(e.pointerId) && onMove(flow.screenToFlowPosition({ x: e.clientX, y: e.clientY }))}
      onPointerUp={(e) => {
        if (!e.currentTarget.hasPointerCapture(e.pointerId)) return;
        const to = flow.screenToFlowPosition({ x: e.clientX, y: e.clientY });
        onMove(null);
        if (Math.hypot(to.x - x, to.y - y) > 1) put(to);
      }}
    />
  );
}

export function Link(props: EdgeProps) {
  const far = useContext(FarLinks);
  const { className, bends: kept } = props.data as { className: string; bends: Point[] };
  // While a bend is dragged it moves here only; the scene learns of it at the end.
  const [dragged, setDragged] = useState<{ index: number; at: Point } | null>(null);
  const bends = dragged ? kept.map((p, i) => (i === dragged.index ? dragged.at : p)) : kept;
  const path = pathThrough(props, bends);
  if (far) {
    const name = `react-flow__edge ${props.selected ? "selected" : ""} ${className}`;
    return createPortal(<g className={name}><path className="react-flow__edge-path" d={path} style={props.style} /></g>, far);
  }
  return (
    <>
      <BaseEdge id={props.id} path={path} style={props.style} interactionWidth={props.interactionWidth ?? 20} />
      {bends.map((at, i) => <Bend key={i} link={props.id} bends={kept} index={i} shown={at} onMove={(to) => setDragged(to && { index: i, at: to })} />)}
    </>
  );
}
