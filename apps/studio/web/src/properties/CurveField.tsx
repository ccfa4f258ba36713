// The points of a curve: drawn and dragged, or as text. Profiles of surfaces and terrains.
import { useState } from "react";
import { evaluate } from "../model/expression";
import type { Json } from "../model/types";
import type { FieldProps } from "./fields";
import { PointPlot, type Point } from "./PointPlot";
import { useDraft } from "./useDraft";

const pointsOf = (v: Json): Point[] =>
  Array.isArray(v) ? v.filter((p): p is Json[] => Array.isArray(p) && p.length === 2).map((p) => [Number(p[0]), Number(p[1])]) : [];

/** Two numbers or expressions a line, or what is wrong. */
export function readPoints(text: string): Point[] | string {
  const points: Point[] = [];
  for (const [i, line] of text.split("\n").entries()) {
    const words = line.trim().split(/[,;\s]+/).filter(Boolean);
    if (words.length === 0) continue;
    const numbers = words.map(evaluate);
    if (numbers.length !== 2 || numbers.includes(null)) return `line ${i + 1}: two numbers, such as 0.1 0.25`;
    points.push(numbers as Point);
  }
  return points;
}

function PointsText({ points, label, onChange }: { points: Point[]; label: string; onChange(points: Point[]): void }) {
  const shown = points.map((p) => p.join(" ")).join("\n");
  const { text, setText, problem, setProblem } = useDraft(shown);
  const take = () => {
    const read = readPoints(text);
    if (typeof read === "string") return setProblem(read);
    setProblem(null);
    if (JSON.stringify(read) !== JSON.stringify(points)) onChange(read);
  };
  return (
    <>
      <textarea
        aria-label={`${label}, points`} aria-invalid={problem !== null} rows={8} value={text} spellCheck={false}
        onChange={(e) => setText(e.target.value)} onBlur={take} onKeyDown={(e) => e.key === "Enter" && e.ctrlKey && take()}
      />
      {problem && <em role="alert">{problem}</em>}
    </>
  );
}

export function CurveField({ parameter, value, onChange, label }: FieldProps) {
  const points = pointsOf(value);
  const [asText, setAsText] = useState(false);
  return (
    <span className="curve">
      {asText ? <PointsText points={points} label={label} onChange={onChange} /> : (
        <PointPlot points={points} label={label} unit={parameter.unit} least={2} onChange={onChange} />
      )}
      <small>{asText ? "Two numbers a line." : "Drag points; double click adds one, Delete takes one away, arrows move it."}</small>
      <button aria-label={asText ? `${label} as a drawing` : `${label} as text`} onClick={() => setAsText(!asText)}>{asText ? "Drawing" : "Text"}</button>
    </span>
  );
}
