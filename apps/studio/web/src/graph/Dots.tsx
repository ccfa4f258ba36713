// The dotted ground of the graph. It is a layer of its own that only shifts while the graph is panned, by whole pixels, so nothing is drawn anew.
import { useStore } from "@xyflow/react";

const kGap = 24;
const kMin = 14;

const remainder = (x: number, by: number) => ((x % by) + by) % by;

export function Dots() {
  const [x, y, zoom] = useStore((s) => s.transform);
  let gap = kGap * zoom;
  while (gap < kMin) gap *= 2;
  return (
    <div
      className="dots" aria-hidden
      style={{ inset: -gap, backgroundSize: `${gap}px ${gap}px`, transform: `translate(${Math.round(remainder(x, gap))}px, ${Math.round(remainder(y, gap))}px)` }}
    />
  );
}
