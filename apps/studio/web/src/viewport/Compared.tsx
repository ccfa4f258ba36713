// A run that was kept, beside the present one: one camera, one time, and in what the two differ.
import { useEffect, useMemo, useRef, useState } from "react";
import { shortText } from "../model/numbers";
import { counted } from "../model/playback";
import { differencesOf, frameAt, type Difference, type Run } from "../model/runs";
import { sceneOfRun } from "../model/recorded";
import { useStudio } from "../model/store";
import type { Json } from "../model/types";
import type { Ramp } from "./colorMaps";
import { outlinesOf } from "./outlines";
import { View } from "./view";

const valueText = (v: Json | undefined): string => (v === undefined ? "default" : typeof v === "object" && v !== null && !Array.isArray(v) ? "…" : shortText(v));

/** How it was, and how it is. */
const changeText = ({ before, after }: Difference): string =>
  before === undefined && typeof after === "string" ? `+ ${after}` : after === undefined && typeof before === "string" ? `− ${before}` : `${valueText(before)} → ${valueText(after)}`;

const kMostChips = 12;

/** In what the present run differs from the one that was kept; a click leads there. */
export function Differences({ run }: { run: Run }) {
  const scene = useStudio((s) => s.scene);
  const reset = useStudio((s) => s.sceneState.reset);
  const builds = useStudio((s) => s.builds);
  const all = useMemo(() => differencesOf(run.scene, sceneOfRun()), [run, scene, reset, builds]); // eslint-disable-line
  const go = (d: Difference) =>
    useStudio.setState({ selected: d.node !== null && d.node in useStudio.getState().scene.nodes ? [d.node] : [], selectedLinks: [], wanted: d.path.length > 0 ? { module: d.module, path: d.path } : null });
  return (
    <div className="differences" role="group" aria-label="In what the runs differ">
      <b>A → B</b>
      {all.slice(0, kMostChips).map((d, i) => <button key={i} className="chip" title="Show it" onClick={() => go(d)}>{d.name} <b>{changeText(d)}</b></button>)}
      {all.length > kMostChips && <span className="hint">and {counted(all.length - kMostChips, "other")}</span>}
      {all.length === 0 && <span className="hint">Nothing differs yet: change a value, and play.</span>}
      <span className="gap" />
      <button title="Show the present run alone" onClick={() => useStudio.setState({ pinned: null })}>End comparison</button>
    </div>
  );
}

/** `range`: of the present run's colours, where it shows the same quantity. */
export function Compared({ run, view, ramp, range, dark }: {
  run: Run; view: View; ramp: Ramp; range: { low: number; high: number; name: string } | null; dark: boolean;
}) {
  const element = useRef<HTMLDivElement>(null);
  const [own, setOwn] = useState<View | null>(null);
  const time = useStudio((s) => (s.rendered && s.looking === null ? undefined : s.shown?.time) ?? s.status.time ?? 0);
  const frame = useMemo(() => frameAt(run.frames, time), [run, time]);
  useEffect(() => {
    const made = new View(element.current!, { moved: () => {}, picked: () => {}, selected: () => {}, range: () => {} });
    if (run.geometry) made.geometry(run.geometry);
    const { types } = useStudio.getState();
    if (types) made.setOutlines(outlinesOf(run.scene, types));
    made.lookAs(view);
    const leave = [view.onCamera(() => made.lookAs(view)), made.onCamera(() => view.lookAs(made))];
    setOwn(made);
    return () => {
      leave.forEach((f) => f());
      made.dispose();
    };
  }, [run, view]);
  useEffect(() => own?.setBackground(dark ? "#171c22" : "#eef2f6"), [own, dark]);
  const same = range && frame?.fluids.some((f) => f.attribute?.name === range.name);
  useEffect(() => own?.setColors(ramp, same ? [range.low, range.high] : null), [own, ramp, range, same]);
  useEffect(() => {
    if (own && frame) own.frame(frame);
  }, [own, frame]);
  const shown = frame?.fluids.find((f) => f.attribute)?.attribute?.name;
  return (
    <div className="stage compared" ref={element} aria-label="The run that was kept" role="img" data-time={frame?.time.toFixed(3)}>
      <p className="side"><b>A</b> {frame ? `kept, ${frame.time.toFixed(3)} s` : "kept, without frames"}{shown && range && shown !== range.name && `, by ${shown}`}</p>
    </div>
  );
}
