// The property editors of an owner of parameters: a node, a module, the world or a section.
import { Icon } from "../Icon";
import { copyText, menuOf, showMenu } from "../Menu";
import { isKeyframes } from "../model/keyframes";
import { afterChoice, isUsed, labelOf, limitsOf, unitText } from "../model/parameters";
import { canSweep } from "../model/sweep";
import { paramsOf, setParam, setParams, type Owner, type Scene } from "../model/scene";
import { edit, problemOf, useStudio } from "../model/store";
import type { Json, JsonObject, Parameter } from "../model/types";
import { ValueField } from "./fields";
import { KeyframesField } from "./KeyframesField";

/** By owner, the values that a choice left without a meaning: they come back with the choice before. */
const leftOut = new Map<string, JsonObject>();

/** The value that was copied last, for others of its kind. */
let copied: { kind: string; value: Json } | null = null;

interface Props {
  owner: Owner;
  parameters: Parameter[];
  /** Where they stand inside the owner, for groups. */
  path?: string[];
}

const valueAt = (params: JsonObject, path: string[]): Json | undefined =>
  path.reduce<Json | undefined>(
    (v, key) => (v !== null && typeof v === "object" && !Array.isArray(v) ? v[key] : undefined),
    params,
  );

/** What a parameter is, what is allowed, and its default. */
function tipOf(p: Parameter): string {
  const bounds = limitsOf(p);
  return [p.doc, bounds && `Allowed: ${bounds}${p.unit ? ` ${unitText(p.unit)}` : ""}.`, `Default: ${p.default === null ? "not set" : JSON.stringify(p.default)}.`]
    .concat(`In the scene's file: ${p.name}`).filter(Boolean).join("\n");
}

function useProblem(owner: Owner, name: string): string | null {
  const problem = useStudio(problemOf);
  if (!problem) return null;
  const text = problem.message + (problem.allowed ? ` — allowed: ${problem.allowed}` : "");
  const base =
    "section" in owner ? `/${owner.section}/` :
    "module" in owner ? `/nodes/${owner.node}/modules/${owner.module}/params/` : `/nodes/${owner.node}/params/`;
  return problem.pointer?.startsWith(base + name) ? text : null;
}

/** Of a list of groups: each an object that is edited in place. */
function GroupList({ owner, parameter, path }: { owner: Owner; parameter: Parameter; path: string[] }) {
  const list = useStudio((s) => valueAt(paramsOf(s.scene, owner), path));
  const items = (Array.isArray(list) ? list : []) as JsonObject[];
  const put = (next: JsonObject[], part?: string) =>
    edit((s) => setParam(s, owner, path, next.length > 0 ? next : undefined), part && JSON.stringify([owner, path, part]));
  return (
    <div className="group-list">
      {items.map((item, i) => (
        <fieldset key={i}>
          <legend>
            {i + 1} <button aria-label={`Remove ${parameter.name} ${i + 1}`} onClick={() => put(items.filter((_, k) => k !== i))}>×</button>
          </legend>
          {parameter.parameters!.map((p) => (
            <label key={p.name} className="row" title={tipOf(p)}>
              <span className="name">{labelOf(p.name)}{p.unit && <small>{unitText(p.unit)}</small>}</span>
              <ValueField
                parameter={p} label={`${parameter.name} ${i + 1} ${p.name}`} value={item[p.name] ?? p.default}
                onChange={(v) => put(items.map((old, k) => (k === i ? { ...old, [p.name]: v } : old)), `${i}/${p.name}`)}
              />
            </label>
          ))}
        </fieldset>
      ))}
      <button aria-label={`Add to ${parameter.name}`} onClick={() => put([...items, {}])}>Add</button>
    </div>
  );
}

function Row({ owner, parameter, siblings, path }: { owner: Owner; parameter: Parameter; siblings: Parameter[]; path: string[] }) {
  const set = useStudio((s) => valueAt(paramsOf(s.scene, owner), path));
  const playing = useStudio((s) => s.status.state !== "empty");
  const writer = useStudio((s) => s.role === "writer");
  const problem = useProblem(owner, path.join("/"));
  const value = set === undefined ? parameter.default : set;
  const keyed = isKeyframes(value);
  const put = (v: Json | undefined) => (s: Scene) => {
    const next = setParam(s, owner, path, v);
    if (!parameter.choices || path.length > 1) return next;
    const key = JSON.stringify([useStudio.getState().opened, owner]);
    const { values, left } = afterChoice(siblings, paramsOf(next, owner), leftOut.get(key) ?? {});
    leftOut.set(key, left);
    return setParams(next, owner, values);
  };
  const change = (v: Json) => edit(put(v), JSON.stringify([owner, path]));
  const Field = keyed ? KeyframesField : ValueField;
  const animate = () => change(keyed ? ((value.keyframes[0] as Json[])[1] ?? parameter.default) : { keyframes: [[0, value]] });
  const menu = (e: React.MouseEvent) => {
    // Text that is edited has the browser's own.
    if (e.target === document.activeElement && (e.target as Element).matches("input, textarea")) return;
    e.preventDefault();
    const text = JSON.stringify(value);
    showMenu(e, parameter.name, menuOf(
      { name: "Copy the value", take: () => ((copied = { kind: parameter.kind, value }), void copyText(text)) },
      { name: "Paste the value", off: copied?.kind !== parameter.kind || !writer, take: () => copied && change(copied.value) },
      { name: "Copy as JSON", take: () => void copyText(`${JSON.stringify(parameter.name)}: ${text}`) }, null,
      canSweep(parameter) && !keyed && { name: "Sweep this value…", off: !writer, take: () => useStudio.setState({ sweeping: { owner, path, parameter } }) },
      parameter.animated && { name: keyed ? "One value for all times" : "Change over time", off: !writer, take: animate },
      { name: "Back to the default", off: set === undefined || !writer, take: () => edit(put(undefined)) },
    ));
  };
  return (
    <div
      onContextMenu={menu} onMouseDown={(e) => e.button === 2 && e.target !== document.activeElement && e.preventDefault()}
      className={`row${set === undefined ? "" : " set"}${problem ? " wrong" : ""}`} data-param={parameter.name}>
      <span className="name" title={tipOf(parameter)}>
        {labelOf(parameter.name)}<wbr />
        <small>
          {parameter.unit && unitText(parameter.unit)}
          {playing && !parameter.live && <span className="needs-reset" title="A change takes effect after a reset"> <Icon name="reset" /></span>}
        </small>
      </span>
      <span className="field">
        <Field parameter={parameter} value={value} label={parameter.name} onChange={change} />
        {parameter.animated && (
          <button
            className="key" aria-pressed={keyed} title={keyed ? "One value for all times" : "Change over time by keyframes"}
            onClick={animate}
          >
            ◆
          </button>
        )}
        {set !== undefined && (
          <button className="default" title={`Back to the default: ${JSON.stringify(parameter.default)}`} aria-label={`Reset ${parameter.name}`}
            onClick={() => edit(put(undefined))}><Icon name="undo" /></button>
        )}
      </span>
      {problem && <p role="alert">{problem}</p>}
    </div>
  );
}

export function Parameters({ owner, parameters, path = [] }: Props) {
  const given = useStudio((s) => valueAt(paramsOf(s.scene, owner), path) as JsonObject | undefined) ?? {};
  // What is given is shown in any case: it may be what is wrong.
  const shown = parameters.filter((p) => p.name in given || isUsed(p, parameters, given));
  const writer = useStudio((s) => s.role === "writer");
  return (
    <fieldset className="parameters" disabled={!writer}>
      {shown.map((p) => {
        const below = [...path, p.name];
        if (p.kind === "group list")
          return <details key={p.name} data-param={p.name}><summary title={`${p.doc}\nIn the scene's file: ${p.name}`}>{labelOf(p.name)}</summary><GroupList owner={owner} parameter={p} path={below} /></details>;
        if (p.parameters)
          return <details key={p.name} data-param={p.name} open><summary title={`${p.doc}\nIn the scene's file: ${p.name}`}>{labelOf(p.name)}</summary><Parameters owner={owner} parameters={p.parameters} path={below} /></details>;
        return <Row key={p.name} owner={owner} parameter={p} siblings={parameters} path={below} />;
      })}
    </fieldset>
  );
}
