// A node of the graph: its name and type, ports, how long it takes, and what is wrong with it.
import { Handle, Position, type NodeProps } from "@xyflow/react";
import { memo } from "react";
import { Icon } from "../Icon";
import { collapse } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { msText } from "../model/time";
import type { JsonObject, NodeType } from "../model/types";
import { portColor } from "./ports";

export interface SceneNodeData extends Record<string, unknown> {
  name: string;
  typeName: string;
  type: NodeType | undefined;
  collapsed: boolean;
  muted: boolean;
  problem: string | null;
  /** The port that the problem names. */
  wrongPort: string | null;
}

/** Milliseconds a step of the last run, of a node and its modules. */
function useTime(name: string): number | null {
  return useStudio((s) => {
    const all = s.numbers?.["modules_ms"] as JsonObject | undefined;
    const entry = all?.[name] as JsonObject | undefined;
    return typeof entry?.["per_step"] === "number" ? entry["per_step"] : null;
  });
}

export const SceneNode = memo(function SceneNode({ data, selected }: NodeProps & { data: SceneNodeData }) {
  const { name, typeName, type, collapsed, muted, problem, wrongPort } = data;
  const time = useTime(name);
  const classes = ["scene-node", selected && "selected", muted && "muted", problem && "wrong", collapsed && "collapsed"];
  return (
    <div className={classes.filter(Boolean).join(" ")} title={problem ?? type?.doc} data-node={name}>
      <header>
        <button
          className="fold"
          aria-label={collapsed ? "Unfold" : "Fold"}
          onClick={(e) => (e.stopPropagation(), edit((s) => collapse(s, name, !collapsed)))}
        >
          {collapsed ? "▸" : "▾"}
        </button>
        <strong>{name}</strong>
        {time !== null && <span className="badge">{msText(time)}</span>}
        <small>{typeName} {type?.modules && <Icon name="modules" />}</small>
      </header>
      <div className="ports">
        <div>
          {type?.inputs.map((p) => (
            <div key={p.name} className={`port in${p.name === wrongPort ? " wrong" : ""}`} data-port={p.name} title={`${p.type}: ${p.doc}`}>
              <Handle
                type="target" position={Position.Left} id={p.name} isConnectableStart={!muted}
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
              <Handle type="source" position={Position.Right} id={p.name} style={{ background: portColor(p.type) }} />
            </div>
          ))}
        </div>
      </div>
      {!type && <p className="unknown">no plugin here knows this type</p>}
      {problem && !collapsed && <p className="problem">{problem}</p>}
    </div>
  );
});
