// The small map of the graph. Its nodes are drawn when they change; while the graph moves, the map and the frame of what is seen
// only shift.
import { Panel, useReactFlow, useStoreApi, type Node } from "@xyflow/react";
import { memo, useLayoutEffect, useMemo, useRef } from "react";
import { boundsOf, sizeOf } from "./flow";

const kWidth = 150;
const kHeight = 100;
const kMargin = 5;
/** Of a wheel's notch, as in the graph. */
const kZoomPerPixel = 0.002;

interface Box { left: number; top: number; width: number; height: number }

const scaleOf = (box: Box): number => Math.min((kWidth - 2 * kMargin) / box.width, (kHeight - 2 * kMargin) / box.height);

function unite(a: Box, b: Box): Box {
  if (a.width === 0) return b;
  const left = Math.min(a.left, b.left), top = Math.min(a.top, b.top);
  return {
    left, top,
    width: Math.max(a.left + a.width, b.left + b.width) - left, height: Math.max(a.top + a.height, b.top + b.height) - top,
  };
}

const Map = memo(function Map({ nodes, box }: { nodes: Node[]; box: Box }) {
  return (
    <svg viewBox={`${box.left} ${box.top} ${box.width} ${box.height}`} width={box.width * scaleOf(box)} height={box.height * scaleOf(box)}>
      {nodes.map((n) => <rect key={n.id} x={n.position.x} y={n.position.y} {...sizeOf(n)} rx={5} className={n.selected ? "selected" : ""} />)}
    </svg>
  );
});

export function Overview({ nodes }: { nodes: Node[] }) {
  const store = useStoreApi();
  const flow = useReactFlow();
  const map = useRef<HTMLDivElement>(null);
  const seen = useRef<HTMLElement>(null);
  const box = useMemo(() => boundsOf(nodes), [nodes]);
  /** Of the map's pixels to the graph's units. */
  const scale = useRef(1);

  useLayoutEffect(() => {
    let last: unknown[] = [];
    const draw = () => {
      const { transform, width, height } = store.getState();
      const now = [...transform, width, height];
      if (width === 0 || now.every((v, i) => v === last[i])) return;
      last = now;
      const [x, y, zoom] = transform;
      const view = { left: -x / zoom, top: -y / zoom, width: width / zoom, height: height / zoom };
      // Where all is seen it would only lie upon a node, and where there are none it shows nothing.
      const seesAll = box.width === 0 || view.left <= box.left && view.top <= box.top && view.left + view.width >= box.left + box.width && view.top + view.height >= box.top + box.height;
      seen.current!.parentElement!.toggleAttribute("data-needless", seesAll);
      const all = unite(box, view);
      const s = (scale.current = scaleOf(all));
      const at = (left: number, top: number) =>
        `translate(${(kWidth - all.width * s) / 2 + (left - all.left) * s}px, ${(kHeight - all.height * s) / 2 + (top - all.top) * s}px)`;
      if (box.width > 0) map.current!.style.transform = `${at(box.left, box.top)} scale(${s / scaleOf(box)})`;
      Object.assign(seen.current!.style, { transform: at(view.left, view.top), width: `${view.width * s}px`, height: `${view.height * s}px` });
    };
    draw();
    return store.subscribe(draw);
  }, [store, box]);

  const drag = (e: React.PointerEvent) => {
    if (!e.currentTarget.hasPointerCapture(e.pointerId)) return;
    const { x, y, zoom } = flow.getViewport();
    void flow.setViewport({ x: x - (e.movementX * zoom) / scale.current, y: y - (e.movementY * zoom) / scale.current, zoom });
  };
  return (
    <Panel
      position="bottom-right" className="overview" role="img" aria-label="Overview"
      onPointerDown={(e) => e.currentTarget.setPointerCapture(e.pointerId)} onPointerMove={drag}
      onWheel={(e) => void flow.zoomTo(flow.getZoom() * 2 ** (-e.deltaY * kZoomPerPixel))}
    >
      <div ref={map} className="map">{box.width > 0 && <Map nodes={nodes} box={box} />}</div>
      <i ref={seen} />
    </Panel>
  );
}
