// A node of the graph: its name and type, ports, how long it takes, and what is wrong with it.
import { Handle, Position, type HandleProps, type NodeProps } from "@xyflow/react";
import { memo, useContext } from "react";
import { Icon } from "../Icon";
import { collapse } from "../model/scene";
import { roleOf } from "../model/roles";
import { edit, useStudio } from "../model/store";
import { inputFor, type Off } from "../model/switchedOff";
import { kWorthTelling, msText } from "../model/time";
import type { JsonObject, NodeType } from "../model/types";
import { FarLinks } from "./Link";
import { NodeModules, showModules } from "./NodeModules";
import { portColor, roleColor } from "./ports";

export interface SceneNodeData extends Record<string, unknown> {
  name: string;
  typeName: string;
  type: NodeType | undefined;
  collapsed: boolean;
  off: Off | undefined;
  problem: string | null;
  /** The port that the problem names. */
  wrongPort: string | null;
  /** What the scene or the run warns of here. */
  warning: string | null;
}

/** Milliseconds a step of the last run, of a node and its modules. */
function useTime(name: string): number | null {
  return useStudio((s) => {
    const all = s.numbers?.["modules_ms"] as JsonObject | undefined;
    const entry = all?.[name] as JsonObject | undefined;
    return typeof entry?.["per_step"] === "number" ? entry["per_step"] : null;
  });
}

/** The share of the time of all nodes, 0 to 1. */
function useShare(name: string): number {
  return useStudio((s) => {
    const all = Object.entries((s.numbers?.["modules_ms"] as JsonObject | undefined) ?? {}).filter(([path]) => !path.includes("/"));
    const of = (entry: unknown) => Number((entry as JsonObject)["per_step"] ?? 0);
    const total = all.reduce((sum, [, entry]) => sum + of(entry), 0);
    const own = all.find(([path]) => path === name);
    return own && total > 0 ? Math.round((100 * of(own[1])) / total) / 100 : 0;
  });
}

/** From which input to which output a bypassed node passes things on. */
function Passages({ type }: { type: NodeType }) {
  const lines = type.outputs.flatMap((p, to) => {
    const from = type.inputs.findIndex((i) => i.name === inputFor(type, p.name));
    return from < 0 ? [] : [{ from, to, color: portColor(p.type) }];
  });
  const rows = Math.max(type.inputs.length, type.outputs.length);
  return (
    <svg className="passages" viewBox={`0 0 100 ${rows}`} preserveAspectRatio="none" aria-hidden>
      {lines.map((l) => <path key={l.to} d={`M0 ${l.from + 0.5}C50 ${l.from + 0.5} 50 ${l.to + 0.5} 100 ${l.to + 0.5}`} stroke={l.color} />)}
    </svg>
  );
}

/** Where links end. From far a port is only a place: one that can be dragged listens to all that happens in the graph. */
function Port({ far, ...port }: HandleProps & { far: boolean; style: React.CSSProperties }) {
  if (!far) return <Handle {...port} />;
  return <div className={`react-flow__handle react-flow__handle-${port.position} ${port.type} ${port.className ?? ""}`} data-handleid={port.id} data-handlepos={port.position} style={port.style} />;
}

export const SceneNode = memo(function SceneNode({ data, selected }: NodeProps & { data: SceneNodeData }) {
  const { name, typeName, type, collapsed, off, problem, wrongPort, warning } = data;
  const role = roleOf(type);
  const time = useTime(name);
  const share = useShare(name);
  const costs = !off && time !== null && time >= kWorthTelling;
  const far = useContext(FarLinks) !== null;
  const unfolded = useStudio((s) => s.unfolded.includes(name));
  const classes = ["scene-node", selected && "selected", off, problem && "wrong", collapsed && "collapsed"];
  return (
    <div className={classes.filter(Boolean).join(" ")} title={problem ?? type?.doc} data-node={name} style={{ "--role": roleColor(role) } as React.CSSProperties}>
      <header>
        <button
          className="fold"
          aria-label={`${collapsed ? "Unfold" : "Fold"} ${name}`}
          onClick={(e) => (e.stopPropagation(), edit((s) => collapse(s, [name], !collapsed)))}
        >
          {collapsed ? "▸" : "▾"}
        </button>
        <strong>{name}</strong>
        {warning && <span className="badge warns" title={warning} role="img" aria-label={`Warning: ${warning}`}><Icon name="warning" /></span>}
        {off && <span className="badge">{off}</span>}
        {type?.modules && (
          <button className="unfold" aria-expanded={unfolded} aria-label={`Modules of ${name}`} title="Its modules, in their order (Enter)" onClick={() => showModules(name, !unfolded)}><Icon name="modules" /></button>
        )}
        <small><span className="sign" title={role.name}><Icon name={role.icon} /></span> {typeName}</small>
      </header>
      {costs && <span className="took">{msText(time)}</span>}
      {costs && <i className="share" title={`${msText(time)} a step, ${Math.round(100 * share)} % of all nodes`} style={{ width: `${100 * share}%` }} />}
      <div className="ports">
        {off === "bypassed" && type && <Passages type={type} />}
        <div>
          {type?.inputs.map((p) => (
            <div key={p.name} className={`port in${p.name === wrongPort ? " wrong" : ""}`} data-port={p.name} title={`${p.type}: ${p.doc}`}>
              <Port
                far={far} type="target" position={Position.Left} id={p.name}
                className={p.many ? "many" : ""} style={{ background: portColor(p.type) }}
              />
              {!collapsed && <span className={p.required ? "required" : ""}>{p.name}</span>}
            </div>
          ))}
        </div>
        <div>
          {type?.outputs.map((p) => (
            <div key={p.name} className={`port out${p.name === wrongPort ? " wrong" : ""}`} data-port={p.name} title={`${p.type}: ${p.doc}`}>
              {!collapsed && <span>{p.name}</span>}
              <Port far={far} type="source" position={Position.Right} id={p.name} style={{ background: portColor(p.type) }} />
            </div>
          ))}
        </div>
      </div>
      {unfolded && !collapsed && type?.modules && <NodeModules node={name} type={type} />}
      {!type && <p className="unknown">no plugin here knows this type</p>}
      {problem && !collapsed && <p className="problem">{problem}</p>}
    </div>
  );
});
