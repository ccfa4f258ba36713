// What is selected: its name, its parameters and its modules; or the scene's own settings.
import { useEffect, useRef, useState } from "react";
import {
  enableModule, insertModule, moveModule, nameProblem, pipelineOf, removeModule, removeNodes, renameNode, replaceModule,
} from "../model/scene";
import { edit, useStudio } from "../model/store";
import { labelOf } from "../model/parameters";
import { offOf, setOff, type Off } from "../model/switchedOff";
import { msText } from "../model/time";
import { Parameters } from "./Parameters";
import { useDraft } from "./useDraft";

function NameField({ name }: { name: string }) {
  const scene = useStudio((s) => s.scene);
  const { text, setText } = useDraft(name);
  const problem = nameProblem(scene, text, name);
  const take = () => {
    if (problem || text === name) return setText(name);
    edit((s) => renameNode(s, name, text));
    useStudio.setState({ selected: [text] });
  };
  return (
    <label className="name-field">
      <input aria-label="Name" value={text} aria-invalid={problem !== null} onChange={(e) => setText(e.target.value)} onBlur={take} onKeyDown={(e) => e.key === "Enter" && take()} />
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
  const states = useStudio((s) => names.map((n) => offOf(s.scene, n) ?? "on").join());
  return (
    <span className="axes" role="group" aria-label="State">
      {kStates.map(([label, off, doc]) => (
        <button key={label} title={doc} aria-pressed={states.split(",").every((x) => x === (off ?? "on"))} onClick={() => edit((s) => setOff(s, names, off))}>{label}</button>
      ))}
    </span>
  );
}

/** The modules of a node, in the order in which they run. */
export function Modules({ node }: { node: string }) {
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types)!;
  const times = useStudio((s) => s.numbers?.["modules_ms"]) as { [path: string]: { per_step?: number } } | undefined;
  const wanted = useStudio((s) => s.wanted?.module ?? null);
  const [open, setOpen] = useState<string | null>(wanted);
  useEffect(() => {
    if (wanted !== null) setOpen(wanted);
  }, [wanted]);
  const type = types.nodes[scene.nodes[node]?.type ?? ""];
  if (!type?.modules) return null;
  const family = Object.entries(types.modules).filter(([, m]) => m.family === type.family);
  const list = pipelineOf(scene, node, type);
  return (
    <section className="modules" aria-label="Modules">
      <h3>Modules, in their order</h3>
      <ol>
        {list.map((m, i) => (
          <li key={m.name} className={m.enabled ? "" : "off"} data-module={m.name}>
            <div className="module">
              <input type="checkbox" checked={m.enabled} aria-label={`Use ${m.name}`} onChange={(e) => edit((s) => enableModule(s, node, m.name, e.target.checked))} />
              <button className="title" aria-expanded={open === m.name} onClick={() => setOpen(open === m.name ? null : m.name)} title={types.modules[m.type]?.doc}>
                {m.name}
              </button>
              <select aria-label={`Type of ${m.name}`} value={m.type} onChange={(e) => edit((s) => replaceModule(s, node, m.name, e.target.value))}>
                {family.map(([t, d]) => <option key={t} title={d.doc}>{t}</option>)}
              </select>
              {times?.[`${node}/${m.name}`]?.per_step !== undefined && <span className="badge">{msText(times[`${node}/${m.name}`]!.per_step!)}</span>}
              <button aria-label={`Move ${m.name} up`} disabled={i === 0} onClick={() => edit((s) => moveModule(s, node, type, m.name, -1))}>↑</button>
              <button aria-label={`Move ${m.name} down`} disabled={i === list.length - 1} onClick={() => edit((s) => moveModule(s, node, type, m.name, 1))}>↓</button>
              {!m.own && <button aria-label={`Remove ${m.name}`} onClick={() => edit((s) => removeModule(s, node, m.name))}>×</button>}
            </div>
            {open === m.name && <Parameters owner={{ node, module: m.name }} parameters={types.modules[m.type]?.parameters ?? []} />}
          </li>
        ))}
      </ol>
      <select aria-label="Insert a module" value="" onChange={(e) => e.target.value && edit((s) => insertModule(s, node, type, e.target.value))}>
        <option value="">Insert a module…</option>
        {family.map(([t, d]) => <option key={t} value={t} title={d.doc}>{t}</option>)}
      </select>
    </section>
  );
}

function SceneSettings() {
  const types = useStudio((s) => s.types)!;
  const title = useStudio((s) => s.scene.title ?? "");
  return (
    <>
      <h2>Scene</h2>
      <label className="row"><span className="name">Title</span>
        <input aria-label="title" defaultValue={title} key={title} onBlur={(e) => e.target.value !== title && edit((s) => ({ ...s, title: e.target.value || undefined }))} />
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
    // What holds it may still have to be opened.
    const timer = setTimeout(() => {
      const own = wanted.module === undefined ? "" : `[data-module="${wanted.module}"] `;
      const part = panel.current?.querySelector<HTMLElement>(own + (wanted.path ?? []).map((p) => `[data-param="${p}"]`).join(" "));
      for (let at: Element | null = part ?? null; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
      part?.scrollIntoView({ block: "nearest" });
      part?.querySelector<HTMLElement>(wanted.path ? "input, select, textarea" : "button.title")?.focus();
      useStudio.setState({ wanted: null });
    }, kShownMs);
    return () => clearTimeout(timer);
  }, [wanted]);
  return panel;
}

const kShownMs = 60;

export function PropertyPanel() {
  return <div ref={useWanted()}><Shown /></div>;
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
      <p className="doc"><strong>{typeName}</strong> {type?.doc ?? "No plugin here knows this type."}</p>
      {type && <Parameters key={name} owner={{ node: name }} parameters={type.parameters} />}
      <Modules key={`${name} modules`} node={name} />
    </>
  );
}
