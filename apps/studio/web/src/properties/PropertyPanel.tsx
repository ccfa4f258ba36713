// What is selected: its name, its parameters and its modules; or the scene's own settings.
import { useEffect, useRef } from "react";
import { nameProblem, removeNodes, renameNode } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { labelOf } from "../model/parameters";
import { offOf, setOff, type Off } from "../model/switchedOff";
import { Modules } from "./Modules";
import { Parameters } from "./Parameters";
import { useDraft } from "./useDraft";

function NameField({ name }: { name: string }) {
  const scene = useStudio((s) => s.scene);
  const writer = useStudio((s) => s.role === "writer");
  const { text, setText } = useDraft(name);
  const problem = nameProblem(scene, text, name);
  const take = () => {
    if (problem || text === name) return setText(name);
    edit((s) => renameNode(s, name, text));
    useStudio.setState(({ unfolded }) => ({ selected: [text], unfolded: unfolded.map((n) => (n === name ? text : n)) }));
  };
  return (
    <label className="name-field">
      <input aria-label="Name" disabled={!writer} value={text} data-draft={text === name ? undefined : ""} aria-invalid={problem !== null} onChange={(e) => setText(e.target.value)} onBlur={take} onKeyDown={(e) => e.key === "Enter" && take()} />
      {problem && <em role="alert">{problem}</em>}
    </label>
  );
}

const kStates: [label: string, off: Off | undefined, doc: string][] = [
  ["On", undefined, "The node is part of the run"],
  ["Bypass", "bypassed", "Leave the node out, and pass on what comes in: an output gives what comes in at the input of its type (B)"],
  ["Mute", "muted", "Leave the node out, and all its links (M)"],
];

/** Whether nodes are on, bypassed or muted. */
function StateField({ names }: { names: string[] }) {
  const writer = useStudio((s) => s.role === "writer");
  const states = useStudio((s) => names.map((n) => offOf(s.scene, n) ?? "on").join());
  return (
    <span className="axes" role="group" aria-label="State">
      {kStates.map(([label, off, doc]) => (
        <button key={label} title={doc} disabled={!writer} aria-pressed={states.split(",").every((x) => x === (off ?? "on"))} onClick={() => edit((s) => setOff(s, names, off))}>{label}</button>
      ))}
    </span>
  );
}

function SceneSettings() {
  const types = useStudio((s) => s.types)!;
  const title = useStudio((s) => s.scene.title ?? "");
  const writer = useStudio((s) => s.role === "writer");
  return (
    <>
      <h2>Scene</h2>
      <label className="row"><span className="name">Title</span>
        <input aria-label="title" disabled={!writer} defaultValue={title} key={title} onBlur={(e) => e.target.value !== title && edit((s) => ({ ...s, title: e.target.value || undefined }))} />
      </label>
      <details open data-param="world"><summary>World</summary><Parameters owner={{ section: "world" }} parameters={types.world} /></details>
      {Object.entries(types.sections).map(([name, parameters]) => (
        <details key={name} data-param={name}><summary>{labelOf(name)}</summary><Parameters owner={{ section: name }} parameters={parameters} /></details>
      ))}
    </>
  );
}

/** Brings what is wanted into view, and gives it the keyboard. */
function useWanted() {
  const panel = useRef<HTMLDivElement>(null);
  const wanted = useStudio((s) => s.wanted);
  useEffect(() => {
    if (!wanted) return;
    if (wanted.module !== undefined) useStudio.setState({ module: wanted.module });
    // What holds it may still have to be opened.
    const timer = setTimeout(() => {
      const own = wanted.module === undefined ? "" : `[data-module="${wanted.module}"] `;
      const part = panel.current?.querySelector<HTMLElement>(own + (wanted.path ?? []).map((p) => `[data-param="${p}"]`).join(" "));
      for (let at: Element | null = part ?? null; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
      part?.scrollIntoView({ block: "nearest" });
      const field = part?.querySelector<HTMLElement>(wanted.path ? "input, select, textarea" : "button.title");
      field?.focus();
      // What is typed next takes the place of what stands there.
      if (field instanceof HTMLInputElement) field.select();
      useStudio.setState({ wanted: null });
    }, kShownMs);
    return () => clearTimeout(timer);
  }, [wanted]);
  return panel;
}

const kShownMs = 60;

export function PropertyPanel() {
  const watches = useStudio((s) => s.role === "viewer" && s.connected);
  return (
    <div ref={useWanted()} className={watches ? "watched" : undefined}>
      {watches && <p className="hint" role="status">Another window has the pen: values can be looked at here, and not changed.</p>}
      <Shown />
    </div>
  );
}

function Shown() {
  const types = useStudio((s) => s.types);
  const scene = useStudio((s) => s.scene);
  const selected = useStudio((s) => s.selected.filter((n) => n in s.scene.nodes).join());
  if (!types) return <p className="hint">Waiting for the server…</p>;
  const names = selected ? selected.split(",") : [];
  if (names.length === 0) return <SceneSettings />;
  if (names.length > 1)
    return (
      <>
        <h2>{names.length} nodes</h2>
        <StateField names={names} />
        <button onClick={() => edit((s) => removeNodes(s, names))}>Delete them</button>
      </>
    );
  const name = names[0]!;
  const typeName = scene.nodes[name]!.type;
  const type = types.nodes[typeName];
  return (
    <>
      <NameField name={name} />
      <StateField names={[name]} />
      <p className="doc"><button className="link" title="Its reference (F1)" onClick={() => useStudio.setState({ reference: typeName })}>{typeName}</button> {type?.doc ?? "No plugin here knows this type."}</p>
      {type && <Parameters key={name} owner={{ node: name }} parameters={type.parameters} />}
      <Modules key={`${name} modules`} node={name} />
    </>
  );
}
