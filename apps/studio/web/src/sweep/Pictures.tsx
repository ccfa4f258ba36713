// The runs of a sweep side by side, at one time, seen from the view's camera.
import { useEffect, useRef, useState } from "react";
import { frameAt, type Run } from "../model/runs";
import { valueName, type Tried } from "../model/sweep";
import { useStudio } from "../model/store";
import { outlinesOf } from "../viewport/outlines";
import { mainView, View } from "../viewport/view";

const kWide = 320, kTall = 200;
const kColors = 6;

/** As the lines of the plot: the first has the page's own colour. */
const swatchOf = (run: number): string => (run === 0 ? "swatch" : `swatch other n${(run - 1) % kColors}`);

/** One view draws all of them, out of sight. */
function useDrawing() {
  const stage = useRef<HTMLDivElement>(null);
  const [view, setView] = useState<View | null>(null);
  useEffect(() => {
    const made = new View(stage.current!, { moved: () => {}, picked: () => {}, selected: () => {}, range: () => {} });
    if (mainView.current) made.lookAs(mainView.current);
    setView(made);
    return () => made.dispose();
  }, []);
  return { stage, view };
}

/** The least and the most that frames show. */
function rangeOf(runs: Run[], time: number): [number, number] | null {
  const all = runs.flatMap((r) => frameAt(r.frames, time)?.fluids.flatMap((f) => (f.attribute ? [f.attribute] : [])) ?? []);
  return all.length > 0 ? [Math.min(...all.map((a) => a.low)), Math.max(...all.map((a) => a.high))] : null;
}

export function Pictures({ tried, unit, time, onUse, onCompare }: {
  tried: Tried[]; unit: string; time: number; onUse: ((t: Tried) => void) | null; onCompare: ((t: Tried) => void) | null;
}) {
  const { stage, view } = useDrawing();
  const pictures = useRef<(HTMLDivElement | null)[]>([]);
  useEffect(() => {
    if (!view) return;
    view.setBackground(document.documentElement.dataset["theme"] === "dark" ? "#171c22" : "#eef2f6");
    if (mainView.current) view.colorAs(mainView.current, rangeOf(tried.flatMap((t) => (t.run ? [t.run] : [])), time));
    tried.forEach(({ run }, i) => {
      const frame = run && frameAt(run.frames, time);
      if (!frame) return;
      const { types } = useStudio.getState();
      if (run.geometry) view.geometry(run.geometry);
      if (types) view.setOutlines(outlinesOf(run.scene, types));
      view.frame(frame);
      pictures.current[i]?.replaceChildren(view.picture(kWide, kTall));
    });
  }, [view, tried, time]);
  return (
    <>
      <div ref={stage} className="unseen" style={{ width: kWide, height: kTall }} aria-hidden />
      <ul className="multiples">
        {tried.map((t, i, all) => (
          <li key={valueName(t.value)} data-value={valueName(t.value)}>
            {t.run ? <div className="picture" ref={(e) => void (pictures.current[i] = e)} role="img" aria-label={`With ${valueName(t.value)}`} /> : <p className="picture" role="alert">{t.problem}</p>}
            <span><i className={t.run ? swatchOf(all.slice(0, i).filter((u) => u.run).length) : ""} /> <b title={`${valueName(t.value)} ${unit}`}>{valueName(t.value)}</b></span>
            <span className="does">
              <button disabled={!onUse} title="The scene gets this value" onClick={() => onUse?.(t)}>Use it</button>
              <button disabled={!onCompare || !t.run} title="Keep this run beside the next one" onClick={() => onCompare?.(t)}>Compare</button>
            </span>
          </li>
        ))}
      </ul>
    </>
  );
}
