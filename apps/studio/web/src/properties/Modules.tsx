// The modules of the selected node, each with its values. Their order is changed in the graph.
import { useEffect } from "react";
import { enableModule, pipelineOf, replaceModule, type PlacedModule } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { focusModule, showModules } from "../graph/NodeModules";
import { Parameters } from "./Parameters";

/** What a module is, by which other one it may be replaced, and its parameters. */
function Opened({ node, module: m, family }: { node: string; module: PlacedModule; family: string | undefined }) {
  const types = useStudio((s) => s.types)!;
  const writer = useStudio((s) => s.role === "writer");
  const kin = Object.entries(types.modules).filter(([, type]) => type.family === family);
  return (
    <>
      <select aria-label={`Type of ${m.name}`} disabled={!writer} value={m.type} onChange={(e) => edit((s) => replaceModule(s, node, m.name, e.target.value))}>
        {kin.map(([t, { doc }]) => <option key={t} title={doc}>{t}</option>)}
      </select>
      <p className="doc">{types.modules[m.type]?.doc}</p>
      <Parameters owner={{ node, module: m.name }} parameters={types.modules[m.type]?.parameters ?? []} />
    </>
  );
}

export function Modules({ node }: { node: string }) {
  const scene = useStudio((s) => s.scene);
  const writer = useStudio((s) => s.role === "writer");
  const open = useStudio((s) => s.module);
  const type = useStudio((s) => s.types?.nodes[s.scene.nodes[node]?.type ?? ""]);
  // Each node begins with all of them closed.
  useEffect(() => () => useStudio.setState({ module: null }), []);
  if (!type?.modules) return null;
  return (
    <section className="modules" aria-label="Modules">
      <h3>Modules <button className="link" title="Unfold them in the graph, where they are ordered, inserted and taken out (Enter)" onClick={() => (showModules(node, true), focusModule(node))}>in the graph</button></h3>
      <ol>
        {pipelineOf(scene, node, type).map((m) => (
          <li key={m.name} className={[!m.enabled && "off", open === m.name && "open"].filter(Boolean).join(" ")} data-module={m.name}>
            <div className="module">
              <input type="checkbox" checked={m.enabled} disabled={!writer} aria-label={`Use ${m.name}`} onChange={(e) => edit((s) => enableModule(s, node, m.name, e.target.checked))} />
              <button className="title" aria-expanded={open === m.name} onClick={() => useStudio.setState({ module: open === m.name ? null : m.name })}>{m.name}</button>
            </div>
            {open === m.name && <Opened node={node} module={m} family={type.family} />}
          </li>
        ))}
      </ol>
    </section>
  );
}
