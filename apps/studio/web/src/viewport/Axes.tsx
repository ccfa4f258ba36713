// Which way the axes point in the view; a click on an end looks from there.
import { useEffect, useRef } from "react";
import type { View } from "./view";

const kReach = 24, kMiddle = 34;
const kEnds = ([["x", 0], ["y", 1], ["z", 2]] as const).flatMap(([name, axis]) => ([1, -1] as const).map((way) => ({ name, axis, way, from: [0, 1, 2].map((i) => (i === axis ? way : 0)) })));

export function Axes({ view }: { view: View }) {
  const ends = useRef<(HTMLButtonElement | null)[]>([]), lines = useRef<(SVGLineElement | null)[]>([]);
  useEffect(() => {
    const place = () =>
      kEnds.forEach(({ from }, k) => {
        const [x, y, towards] = view.seenAs(from), left = kMiddle + kReach * x!, top = kMiddle - kReach * y!;
        const end = ends.current[k], line = lines.current[k];
        if (end) Object.assign(end.style, { transform: `translate(${left}px, ${top}px)`, zIndex: String(towards! > 0 ? 2 : 1), opacity: towards! < 0 ? "0.55" : "1" });
        line?.setAttribute("x2", String(left));
        line?.setAttribute("y2", String(top));
      });
    place();
    return view.onDrawn(place);
  }, [view]);
  return (
    <div className="compass" role="group" aria-label="Axes">
      <svg aria-hidden>{kEnds.map(({ name, way }, k) => way > 0 && <line key={name} ref={(e) => void (lines.current[k] = e)} className={name} x1={kMiddle} y1={kMiddle} />)}</svg>
      {kEnds.map(({ name, way, from }, k) => (
        <button key={name + way} ref={(e) => void (ends.current[k] = e)} className={`end ${name} ${way > 0 ? "plus" : "minus"}`} aria-label={`From ${way > 0 ? "+" : "−"}${name}`} title={`Look from ${way > 0 ? "+" : "−"}${name}`} onClick={() => view.lookFrom(from)}>
          {way > 0 && name}
        </button>
      ))}
    </div>
  );
}
