// One editor for each kind of parameter value, made from the parameter's description alone.
import { useEffect, useRef, useState } from "react";
import { quantityIn, unitOf } from "../model/units";
import { evaluate, numberText } from "../model/expression";
import { rangeProblem } from "../model/parameters";
import { fetchFiles, type ServedFile } from "../protocol/client";
import type { Json, Parameter } from "../model/types";
import { CurveField } from "./CurveField";
import { RampField, WordsField } from "./ListField";
import { useDraft } from "./useDraft";

export interface FieldProps {
  parameter: Parameter;
  value: Json;
  onChange(value: Json): void;
  label: string;
}

const isInt = (p: Parameter) => p.kind === "int";

/** Pixels that a hand may tremble in a click. */
const kTremble = 3;
/** Of a drag with Shift; with Ctrl it is as much coarser. */
const kFine = 0.1;

/** A number: typed, as an expression too, or dragged sideways. */
export function NumberField({ parameter, value, onChange, label, placeholder, refuse }: FieldProps & {
  placeholder?: string;
  /** Further reasons to refuse a number. */
  refuse?(v: number): string | null;
}) {
  const shown = typeof value === "number" ? numberText(value) : "";
  const { text, setText, problem, setProblem } = useDraft(shown);
  const drag = useRef<{ x: number; at: number; by: number; moved: boolean } | null>(null);

  const take = (t: string) => {
    const v = evaluate(t) ?? (parameter.unit ? quantityIn(t, parameter.unit) : null);
    const wrong = v === null ? `a number, or an expression such as 2*pi/3${parameter.unit && unitOf(parameter.unit) ? `, also in a unit that can be turned into ${parameter.unit}` : ""}` : rangeProblem(parameter, v) ?? refuse?.(v) ?? null;
    setProblem(wrong);
    if (!wrong && v !== value) onChange(v);
  };
  /** `between`: whole numbers are not yet rounded. */
  const bounded = (v: number, between = false) => {
    const above = parameter.above !== undefined ? parameter.above + 1e-6 : -Infinity;
    const low = Math.max(parameter.min ?? -Infinity, above);
    return Math.min(Math.max(isInt(parameter) && !between ? Math.round(v) : v, low), parameter.max ?? Infinity);
  };
  /** A hundredth of what the number is about. */
  const step = (from: number) => {
    const span = (parameter.soft_max ?? NaN) - (parameter.soft_min ?? NaN);
    return isInt(parameter) ? 0.2 : Number.isFinite(span) ? span / 200 : Math.max(Math.abs(from), 0.01) / 100;
  };
  /** A notch up or down. */
  const stepBy = (way: number) => typeof value === "number" && onChange(Number(bounded(value + way * (isInt(parameter) ? 1 : 10 * step(value))).toPrecision(6)));
  // The wheel turns a number that has the keyboard: others scroll on with the panel.
  const input = useRef<HTMLInputElement>(null);
  const notch = useRef(stepBy);
  notch.current = stepBy;
  useEffect(() => {
    const field = input.current;
    const turn = (e: WheelEvent) => {
      if (document.activeElement !== field || e.deltaY === 0) return;
      e.preventDefault();
      notch.current(e.deltaY < 0 ? 1 : -1);
    };
    field?.addEventListener("wheel", turn, { passive: false });
    return () => field?.removeEventListener("wheel", turn);
  }, []);
  /** The number follows the pointer; with Shift finely, with Ctrl coarsely. */
  const dragging = typeof value !== "number" ? {} : {
    onPointerDown: (e: React.PointerEvent<HTMLElement>) => {
      // Where it is typed, the pointer selects text.
      if (e.button === 0 && document.activeElement !== e.currentTarget) drag.current = { x: e.clientX, at: value, by: step(value), moved: false };
    },
    onMouseDown: (e: React.MouseEvent) => drag.current && e.preventDefault(),
    onPointerMove: (e: React.PointerEvent<HTMLElement>) => {
      const d = drag.current;
      if (!d || (!d.moved && Math.abs(e.clientX - d.x) <= kTremble)) return;
      if (!d.moved) (e.currentTarget.setPointerCapture(e.pointerId), (d.moved = true));
      d.at = bounded(d.at + (e.clientX - d.x) * d.by * (e.shiftKey ? kFine : e.ctrlKey || e.metaKey ? 1 / kFine : 1), true);
      d.x = e.clientX;
      // At once, so that a run shows it while the hand still moves.
      take(numberText(Number(bounded(d.at).toPrecision(e.shiftKey ? 6 : 4))));
    },
    onPointerUp: (e: React.PointerEvent<HTMLElement>) => {
      const clicked = drag.current?.moved === false;
      drag.current = null;
      if (!clicked) return;
      const field = e.currentTarget.closest(".number")!.querySelector("input")!;
      field.focus();
      field.select();
    },
    onPointerCancel: () => (drag.current = null),
  };
  return (
    <span className={typeof value === "number" ? "number drags" : "number"} title={problem ? `allowed: ${problem}` : undefined}>
      <input
        value={text} aria-label={label} aria-invalid={problem !== null} inputMode="decimal" placeholder={placeholder} {...dragging}
        onChange={(e) => setText(e.target.value)} onBlur={() => text !== shown && take(text)} ref={input} data-draft={text === shown ? undefined : ""}
        onKeyDown={(e) => {
          if (e.key === "Enter") take(text);
          else if (e.key === "Escape") (setText(shown), setProblem(null), e.currentTarget.blur());
          else if ((e.key === "ArrowUp" || e.key === "ArrowDown") && typeof value === "number") {
            stepBy(e.key === "ArrowUp" ? 1 : -1);
            e.preventDefault();
          }
        }}
      />
      {typeof value === "number" && <span className="grip" aria-hidden title="Drag to change; with Shift finely, with Ctrl coarsely" {...dragging}>↔</span>}
      {problem && <em role="alert">{problem}</em>}
    </span>
  );
}

function VectorField({ parameter, value, onChange, label }: FieldProps) {
  const size = parameter.kind === "vec2" ? 2 : 3;
  const v = Array.isArray(value) ? value : Array<Json>(size).fill(null);
  return (
    <span className="vector">
      {["x", "y", "z"].slice(0, size).map((axis, i) => (
        <NumberField
          key={axis} parameter={{ ...parameter, kind: "float" }} label={`${label} ${axis}`} placeholder={axis} value={v[i] ?? null}
          onChange={(n) => onChange(v.map((old, k) => (k === i ? n : old ?? 0)))}
        />
      ))}
    </span>
  );
}

/** Degrees about x, y and z. A quaternion of four numbers is shown as it is. */
function RotationField(props: FieldProps) {
  const isQuaternion = Array.isArray(props.value) && props.value.length === 4;
  return isQuaternion ? <JsonField {...props} /> : <VectorField {...props} parameter={{ ...props.parameter, kind: "vec3" }} />;
}

/** "#rrggbb" of a colour; white where there is none. */
export function hexOf(v: Json): string {
  if (typeof v === "string") return v.slice(0, 7);
  if (!Array.isArray(v)) return "#ffffff";
  return "#" + v.slice(0, 3).map((c) => Math.round(Number(c) * 255).toString(16).padStart(2, "0")).join("");
}

const opacityOf = (v: Json): number => {
  if (typeof v === "string") return v.length === 9 ? parseInt(v.slice(7), 16) / 255 : 1;
  return Array.isArray(v) && v.length === 4 ? Number(v[3]) : 1;
};

function ColorField({ value, onChange, label }: FieldProps) {
  const opacity = opacityOf(value);
  const put = (color: string, alpha: number) =>
    onChange(alpha === 1 ? color : color + Math.round(255 * alpha).toString(16).padStart(2, "0"));
  return (
    <span className={value === null ? "color none" : "color"}>
      <input type="color" aria-label={label} title={value === null ? "not set" : hexOf(value)} value={hexOf(value)} onChange={(e) => put(e.target.value, opacity)} />
      <input type="range" aria-label={`${label}, opacity`} title={`Opacity ${Math.round(100 * opacity)} %`} min={0} max={100} value={Math.round(100 * opacity)} onChange={(e) => put(hexOf(value), Number(e.target.value) / 100)} />
      <small>{Math.round(100 * opacity)} %</small>
    </span>
  );
}

function EnumField({ parameter, value, onChange, label }: FieldProps) {
  const choices = parameter.choices ?? {};
  return (
    <select aria-label={label} value={String(value)} title={choices[String(value)]} onChange={(e) => onChange(e.target.value)}>
      {value === null && <option value="null" disabled>not set</option>}
      {Object.entries(choices).map(([name, doc]) => (
        <option key={name} value={name} title={doc}>{name}</option>
      ))}
    </select>
  );
}

function BoolField({ value, onChange, label }: FieldProps) {
  return <input type="checkbox" className="switch" role="switch" aria-label={label} checked={value === true} onChange={(e) => onChange(e.target.checked)} />;
}

function TextField({ value, onChange, label }: FieldProps) {
  const shown = typeof value === "string" ? value : "";
  const { text, setText } = useDraft(shown);
  const take = () => text !== shown && onChange(text);
  return <input aria-label={label} value={text} data-draft={text === shown ? undefined : ""} onChange={(e) => setText(e.target.value)} onBlur={take} onKeyDown={(e) => e.key === "Enter" && take()} />;
}

/** A file below the served folder. */
function PathField(props: FieldProps) {
  const [files, setFiles] = useState<ServedFile[] | null>(null);
  const [folder, setFolder] = useState("");
  const show = async (where: string) => {
    setFolder(where);
    setFiles(await fetchFiles(where).catch(() => []));
  };
  return (
    <span className="path">
      <TextField {...props} />
      <button onClick={() => (files ? setFiles(null) : void show(""))} aria-expanded={files !== null} title="Choose a file">…</button>
      {files && (
        <ul className="files">
          {folder && <li><button onClick={() => void show(folder.split("/").slice(0, -1).join("/"))}>../</button></li>}
          {files.map((f) => (
            <li key={f.path}>
              <button onClick={() => (f.folder ? void show(f.path) : (props.onChange(f.path), setFiles(null)))}>
                {f.path.split("/").at(-1)}{f.folder ? "/" : ""}
              </button>
            </li>
          ))}
          {files.length === 0 && <li>empty</li>}
        </ul>
      )}
    </span>
  );
}

/** What has no editor of its own, as JSON. */
export function JsonField({ value, onChange, label }: FieldProps) {
  const shown = JSON.stringify(value);
  const { text, setText, problem, setProblem } = useDraft(shown);
  const take = () => {
    try {
      const v = JSON.parse(text) as Json;
      setProblem(null);
      if (text !== shown) onChange(v);
    } catch (e) {
      setProblem((e as Error).message);
    }
  };
  return <input aria-label={label} aria-invalid={problem !== null} title={problem ?? undefined} value={text} onChange={(e) => setText(e.target.value)} onBlur={take} onKeyDown={(e) => e.key === "Enter" && take()} />;
}

export function ValueField(props: FieldProps) {
  switch (props.parameter.kind) {
    case "float":
    case "int":
      return <NumberField {...props} placeholder={props.parameter.default === null ? "not set" : undefined} />;
    case "vec2":
    case "vec3":
      return <VectorField {...props} />;
    case "rotation":
      return <RotationField {...props} />;
    case "color":
      return <ColorField {...props} />;
    case "enum":
      return <EnumField {...props} />;
    case "bool":
      return <BoolField {...props} />;
    case "string":
      return <TextField {...props} />;
    case "path":
      return <PathField {...props} />;
    case "curve":
      return <CurveField {...props} />;
    case "list":
      if (props.parameter.elements === "color") return <RampField {...props} />;
      return props.parameter.elements ? <WordsField {...props} /> : <JsonField {...props} />;
    default:
      return <JsonField {...props} />;
  }
}
