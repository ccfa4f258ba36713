// The dotted ground of the graph. It is a layer of its own that only shifts while the graph is panned, so nothing is drawn anew.
import { useStore } from "@xyflow/react";

const kGap = 24;
const kLeast = 14;

const remainder = (x: number, by: number) => ((x % by) + by) % by;

export function Dots() {
  const [x, y, zoom] = useStore((s) => s.transform);
  let gap = kGap * zoom;
  while (gap < kLeast) gap *= 2;
  return (
    <div
      className="dots" aria-hidden
      style={{ inset: -gap, backgroundSize: `${gap}px ${gap}px`, transform: `translate(${remainder(x, gap)}px, ${remainder(y, gap)}px)` }}
    />
  );
}
