// Lists: of colours as a ramp from low to high values, of numbers or words as text.
import { evaluate } from "../model/expression";
import type { Json } from "../model/types";
import { hexOf, type FieldProps } from "./fields";
import { useDraft } from "./useDraft";

const kBegin = ["#124a94", "#f0f8fd"];

/** Half way between two colours. */
function between(a: string, b: string): string {
  const part = (c: string, k: number) => parseInt(c.slice(2 * k + 1, 2 * k + 3), 16);
  return "#" + [0, 1, 2].map((k) => Math.round((part(a, k) + part(b, k)) / 2).toString(16).padStart(2, "0")).join("");
}

export function RampField({ value, onChange, label }: FieldProps) {
  const colors = (Array.isArray(value) ? value : []).map(hexOf);
  const put = (next: string[]) => onChange(next);
  if (colors.length < 2)
    return <span className="ramp"><button onClick={() => put(kBegin)} aria-label={`Make ${label}`}>Colours of one's own</button></span>;
  return (
    <span className="ramp">
      <span className="strip" style={{ background: `linear-gradient(to right, ${colors.join(", ")})` }} />
      <span className="stops">
        {colors.map((c, i) => (
          <span key={i} className="stop">
            <input type="color" aria-label={`${label} ${i + 1}`} value={c} onChange={(e) => put(colors.map((old, k) => (k === i ? e.target.value : old)))} />
            <button aria-label={`Remove ${label} ${i + 1}`} disabled={colors.length === 2} onClick={() => put(colors.filter((_, k) => k !== i))}>×</button>
            {i + 1 < colors.length && (
              <button aria-label={`Insert behind ${label} ${i + 1}`} onClick={() => put([...colors.slice(0, i + 1), between(c, colors[i + 1]!), ...colors.slice(i + 1)])}>+</button>
            )}
          </span>
        ))}
        <button onClick={() => put([...colors].reverse())} aria-label={`Reverse ${label}`} title="The other way round">⇄</button>
      </span>
    </span>
  );
}

/** Parted by commas. Numbers may be expressions. */
export function WordsField({ parameter, value, onChange, label }: FieldProps) {
  const shown = Array.isArray(value) ? value.join(", ") : "";
  const { text, setText, problem, setProblem } = useDraft(shown);
  const isText = parameter.elements === "string";
  const take = () => {
    const words = text.split(/[,;]/).map((w) => w.trim()).filter(Boolean);
    const items: Json[] = isText ? words : words.map(evaluate);
    if (items.includes(null)) return setProblem("numbers, parted by commas");
    setProblem(null);
    if (text !== shown) onChange(items);
  };
  return (
    <span className="words">
      <input
        aria-label={label} aria-invalid={problem !== null} value={text} placeholder={value === null ? "not set" : "parted by commas"}
        onChange={(e) => setText(e.target.value)} onBlur={take} onKeyDown={(e) => e.key === "Enter" && take()}
      />
      {problem && <em role="alert">{problem}</em>}
    </span>
  );
}
