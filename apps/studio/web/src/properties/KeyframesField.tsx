// A value that changes over time, drawn: points are dragged; below it stand the same numbers to type.
import { useState } from "react";
import { framesOf, pointsOf, sizeOf, withPoints, withTime, type Keyframe } from "../model/keyframes";
import { NumberField, ValueField, type FieldProps } from "./fields";
import { PointPlot } from "./PointPlot";

const kTime = { name: "time", kind: "float", doc: "", default: 0, min: 0, live: false, animated: false, unit: "s" };
const kLater = 1;

export function KeyframesField({ parameter, value, onChange, label }: FieldProps) {
  const frames = framesOf(value);
  const [part, setPart] = useState(0);
  const put = (next: Keyframe[]) => onChange({ keyframes: next });
  const size = sizeOf(frames[0]?.[1]);
  const axes = size === 4 ? ["w", "x", "y", "z"] : ["x", "y", "z"].slice(0, size);
  const end = frames.at(-1) ?? [-kLater, parameter.default];
  return (
    <div className="keyframes">
      {size > 1 && (
        <span className="axes" role="group" aria-label={`${label}, which part is drawn`}>
          {axes.map((a, i) => <button key={a} aria-pressed={i === part} onClick={() => setPart(i)}>{a}</button>)}
        </span>
      )}
      {size > 0 && (
        <PointPlot
          points={pointsOf(frames, part)} label={`${label}${size > 1 ? ` ${axes[part]}` : ""} over time`} overTime least={1}
          unit={parameter.unit} low={parameter.min ?? parameter.above} high={parameter.max} onChange={(p) => put(withPoints(frames, part, p))}
        />
      )}
      {frames.map(([time, v], i) => (
        <div key={i} className="keyframe">
          <NumberField
            parameter={kTime} label={`${label}, time ${i + 1}`} value={time} onChange={(t) => put(withTime(frames, i, Number(t)))}
            refuse={(t) => (frames.some((f, k) => k !== i && f[0] === t) ? "a time of its own" : null)}
          />
          <span>s</span>
          <ValueField parameter={parameter} label={`${label}, value ${i + 1}`} value={v} onChange={(n) => put(frames.map((f, k) => (k === i ? [f[0], n] : f)))} />
          <button aria-label={`Remove keyframe ${i + 1}`} disabled={frames.length === 1} onClick={() => put(frames.filter((_, k) => k !== i))}>×</button>
        </div>
      ))}
      <button onClick={() => put([...frames, [end[0] + kLater, end[1]]])}>Add a keyframe</button>
    </div>
  );
}
