// A value that changes over time: pairs of a time and a value.
import type { Json, JsonObject } from "../model/types";
import { NumberField, ValueField, type FieldProps } from "./fields";

export const isKeyframes = (v: Json | undefined): v is { keyframes: Json[] } =>
  v !== null && typeof v === "object" && !Array.isArray(v) && Array.isArray((v as JsonObject)["keyframes"]);

const kTime = { name: "time", kind: "float", doc: "", default: 0, min: 0, live: false, animated: false, unit: "s" };

export function KeyframesField({ parameter, value, onChange, label }: FieldProps) {
  const frames = (isKeyframes(value) ? value.keyframes : []) as [number, Json][];
  const put = (next: [number, Json][]) => onChange({ keyframes: next });
  const end = frames.at(-1) ?? [0, parameter.default];
  return (
    <div className="keyframes">
      {frames.map(([time, v], i) => (
        <div key={i} className="keyframe">
          <NumberField parameter={kTime} label={`${label}, time ${i + 1}`} value={time} onChange={(t) => put(frames.map((f, k) => (k === i ? [Number(t), f[1]] : f)))} />
          <span>s</span>
          <ValueField parameter={parameter} label={`${label}, value ${i + 1}`} value={v} onChange={(n) => put(frames.map((f, k) => (k === i ? [f[0], n] : f)))} />
          <button aria-label="Remove" disabled={frames.length === 1} onClick={() => put(frames.filter((_, k) => k !== i))}>×</button>
        </div>
      ))}
      <button onClick={() => put([...frames, [end[0] + 1, end[1]]])}>Add a keyframe</button>
    </div>
  );
}
