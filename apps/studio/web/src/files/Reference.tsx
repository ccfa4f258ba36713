// The reference of a type beside the graph: what it is for, its ports, parameters and modules, as the server tells them.
import { useEffect, useState } from "react";
import { Icon } from "../Icon";
import { roleColor } from "../graph/ports";
import { surface } from "../graph/surface";
import { limitsOf, labelOf, unitText } from "../model/parameters";
import { kModuleRole, roleOf } from "../model/roles";
import { openScene } from "../model/documents";
import { examplesOf } from "../model/examples";
import { addNode, pipelineOf, type NodeSpec } from "../model/scene";
import { search } from "../model/search";
import { edit, say, useStudio } from "../model/store";
import { fetchTemplates, type Template } from "../protocol/client";
import type { InputType, OutputType, Parameter } from "../model/types";
import { Dialog } from "./Dialog";

/** Parameters in one list, those of groups with the group's name before theirs. */
const flat = (all: Parameter[], before = ""): { name: string; parameter: Parameter }[] =>
  all.flatMap((p) => (p.parameters ? flat(p.parameters, `${before}${labelOf(p.name)} / `) : [{ name: before + labelOf(p.name), parameter: p }]));

/** What stands between backquotes is as it is written in a scene. */
const prose = (text: string) => text.split("`").map((part, i) => (i % 2 === 1 ? <code key={i}>{part}</code> : part));

function Ports({ title, ports }: { title: string; ports: (InputType | OutputType)[] }) {
  if (ports.length === 0) return null;
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      <dl>{ports.map((p) => <div key={p.name}><dt>{p.name} <small>{p.type}{"required" in p && p.required ? ", required" : ""}{"many" in p && p.many ? ", any number of links" : ""}</small></dt><dd>{prose(p.doc)}</dd></div>)}</dl>
    </section>
  );
}

const usesOf = (node: NodeSpec): (string | undefined)[] => [node.type, ...Object.values(node.modules ?? {}).map((m) => m.type)];

function ParameterList({ parameters, query }: { parameters: Parameter[]; query: string }) {
  const all = flat(parameters);
  const shown = query ? search(query, all, ({ name, parameter }) => ({ name: `${name} ${parameter.name}`, doc: parameter.doc, synonyms: parameter.also ?? [] })) : all;
  if (all.length === 0) return null;
  return (
    <section aria-label="Parameters">
      <h3>Parameters</h3>
      <dl>
        {shown.map(({ name, parameter: p }) => (
          <div key={name}>
            <dt>{name} <small>{p.unit && `${unitText(p.unit)}, `}{p.kind}, default {p.default === null ? "not set" : JSON.stringify(p.default)}{limitsOf(p) && `; ${limitsOf(p)}`}{p.live ? "; while it runs" : ""}{p.animated ? "; by keyframes" : ""}</small></dt>
            <dd>
              {prose(p.doc)}
              {p.choices && <ul>{Object.entries(p.choices).map(([choice, doc]) => <li key={choice}><b>{choice}</b> {prose(doc)}</li>)}</ul>}
            </dd>
          </div>
        ))}
      </dl>
      {shown.length === 0 && <p className="hint">No parameter fits.</p>}
    </section>
  );
}

export function Reference() {
  const asked = useStudio((s) => s.reference);
  const types = useStudio((s) => s.types);
  const writer = useStudio((s) => s.role === "writer");
  const [query, setQuery] = useState("");
  useEffect(() => setQuery(""), [asked]);
  const [templates, setTemplates] = useState<Template[]>([]);
  const open = asked !== null;
  useEffect(() => {
    if (open) void fetchTemplates().then(setTemplates, say);
  }, [open]);
  if (asked === null || !types) return null;
  const close = () => useStudio.setState({ reference: null });
  const show = (name: string) => useStudio.setState({ reference: name });
  const node = types.nodes[asked], module = types.modules[asked], type = node ?? module;
  const role = node ? roleOf(node) : kModuleRole;
  const add = () =>
    edit((s) => {
      const [next, name] = addNode(s, asked, surface.middle());
      useStudio.setState({ selected: [name], selectedLinks: [] });
      return next;
    });
  const inside = node ? pipelineOf({ weir: 1, nodes: { it: { type: asked } } }, "it", node).filter((m) => m.type in types.modules) : [];
  /** Opens it, with the node selected that is read about. */
  const tryExample = async (t: Template) => {
    await openScene({ template: t.path });
    const { scene } = useStudio.getState();
    const names = Object.keys(scene.nodes), isHost = (n: string) => hosts.some(([type]) => type === scene.nodes[n]!.type);
    const there = names.find((n) => usesOf(scene.nodes[n]!).includes(asked)) ?? names.find(isHost);
    if (there !== undefined) useStudio.setState({ selected: [there], selectedLinks: [] });
  };
  const hosts = module ? Object.entries(types.nodes).filter(([, n]) => n.family === module.family) : [];
  // What a type of node has by default is in all of its scenes.
  const examples = [asked, ...hosts.filter(([, n]) => n.modules?.some((m) => m.type === asked)).map(([name]) => name)]
    .map((name) => examplesOf(name, templates)).find((found) => found.length > 0) ?? [];
  const kin = Object.entries(module ? types.modules : types.nodes).filter(([name, t]) => name !== asked && (module ? (t as typeof module).family === module.family : roleOf(t as typeof node).name === role.name));
  return (
    <Dialog title={`Reference: ${asked}`} className="reference" beside onClose={close}>
      <header><h2><span className="sign" style={{ color: roleColor(role) }}><Icon name={role.icon} /></span> {asked}</h2></header>
      <p>{type ? prose(type.doc) : "No plugin here knows this type."}</p>
      {type && <p className="hint">{role.name}, from {type.source}{type.also?.length ? `. Also: ${type.also.join(", ")}` : ""}</p>}
      {type && <input data-first aria-label="Search parameters" placeholder="Search parameters" value={query} onChange={(e) => setQuery(e.target.value)} />}
      {node && !query && <><Ports title="Inputs" ports={node.inputs} /><Ports title="Outputs" ports={node.outputs} /></>}
      {type && <ParameterList parameters={type.parameters} query={query} />}
      {inside.length > 0 && !query && (
        <section aria-label="Modules"><h3>Modules, in their order</h3>
          <dl>{inside.map((m) => <div key={m.name}><dt><button className="link" onClick={() => show(m.type)}>{m.name}</button> <small>{m.type}{m.enabled ? "" : ", off"}</small></dt><dd>{prose(types.modules[m.type]!.doc)}</dd></div>)}</dl>
        </section>
      )}
      {hosts.length > 0 && !query && <p>A module of {hosts.map(([name], i) => <span key={name}>{i > 0 && ", "}<button className="link" onClick={() => show(name)}>{name}</button></span>)}.</p>}
      {kin.length > 0 && !query && <p className="kin">See also {kin.map(([name], i) => <span key={name}>{i > 0 && ", "}<button className="link" onClick={() => show(name)}>{name}</button></span>)}.</p>}
      {examples.length > 0 && writer && !query && (
        <section aria-label="Examples that run"><h3>Examples that run</h3>
          <ul className="cards">
            {examples.map((t) => (
              <li key={t.path}>
                <button onClick={() => void tryExample(t)} title={`${t.description} Undo brings your scene back.`}>
                  {t.thumbnail ? <img src={t.thumbnail} alt="" width={192} height={108} loading="lazy" /> : <span className="blank" />}<b>{t.title || t.path}</b>
                </button>
              </li>
            ))}
          </ul>
        </section>
      )}
      {node && writer && <button onClick={add}>Add one to the scene</button>}
      <button className="close" aria-label="Close the reference" onClick={close}>×</button>
    </Dialog>
  );
}

/** The type that the reference is to show: that of the module which has the keyboard, of the selected node, or of the last one. */
export function referenceFor(): string | null {
  const { scene, selected, types } = useStudio.getState();
  const name = selected.find((n) => n in scene.nodes) ?? Object.keys(scene.nodes).at(-1);
  if (name === undefined || !types) return null;
  const own = scene.nodes[name]!.type, type = types.nodes[own];
  const module = document.activeElement?.closest<HTMLElement>("[data-module]")?.dataset["module"];
  const at = type && module !== undefined ? pipelineOf(scene, name, type).find((m) => m.name === module) : undefined;
  return at && at.type in types.modules ? at.type : own;
}
