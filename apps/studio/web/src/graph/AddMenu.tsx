// The list from which nodes are added: only what fits where a link was dragged from.
import { useMemo } from "react";
import { Finder, type Found } from "../Finder";
import { kOther } from "../model/roles";
import { useStudio } from "../model/store";
import type { NodeType } from "../model/types";
import { modulesToAdd, nodesToAdd } from "./addable";

/** A port that waits to be linked to the new node. */
export interface Dangling {
  node: string;
  port: string;
  type: string;
  side: "input" | "output";
}

export interface AddMenuProps {
  at: { x: number; y: number };
  dangling: Dangling | null;
  onAdd(type: string): void;
  onModule(type: string): void;
  onNote(frame: boolean): void;
  onClose(): void;
}

const fits = (type: NodeType, d: Dangling | null): boolean =>
  !d || (d.side === "output" ? type.inputs : type.outputs).some((p) => p.type === d.type);

export function AddMenu({ at, dangling, onAdd, onModule, onNote, onClose }: AddMenuProps) {
  const types = useStudio((s) => s.types);
  const items = useMemo((): Found[] => {
    if (!types) return [];
    const nodes = nodesToAdd(types, (t) => fits(t, dangling), onAdd);
    if (dangling) return nodes;
    const extra = (name: string, doc: string, frame: boolean): Found => ({ id: name, name, doc, role: kOther, group: "Notes", take: () => onNote(frame) });
    return [
      ...nodes, extra("Note", "A text beside the nodes.", false), extra("Group", "A frame that takes the nodes on it along.", true),
      ...modulesToAdd(types, onModule),
    ];
  }, [types, dangling, onAdd, onModule, onNote]);
  return (
    <>
      <div className="shade" onClick={onClose} />
      <div className="add-menu finder" style={{ left: at.x, top: at.y }} role="dialog" aria-label="Add a node">
        <Finder items={items} label="Search nodes" placeholder={dangling ? `What ${dangling.side === "output" ? "takes" : "gives"} a ${dangling.type}?` : "Search nodes"} onClose={onClose} />
      </div>
    </>
  );
}
