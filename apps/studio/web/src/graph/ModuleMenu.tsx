// The list from which a module is inserted behind another one of a node.
import { useMemo } from "react";
import { Finder, type Found } from "../Finder";
import { insertModule, pipelineOf } from "../model/scene";
import { edit, useStudio, type Studio } from "../model/store";
import { modulesToAdd } from "./addable";
import { showModules } from "./NodeModules";

/** Inserts a module, and shows its values. */
function insert(node: string, after: string, module: string): void {
  const type = useStudio.getState().types?.nodes[useStudio.getState().scene.nodes[node]?.type ?? ""];
  if (!type) return;
  showModules(node, true);
  edit((s) => {
    const before = new Set(pipelineOf(s, node, type).map((m) => m.name));
    const next = insertModule(s, node, type, module, after);
    useStudio.setState({ selected: [node], selectedLinks: [], wanted: { module: pipelineOf(next, node, type).find((m) => !before.has(m.name))?.name } });
    return next;
  });
}

export function ModuleMenu({ asked: { node, after }, at, onClose }: { asked: NonNullable<Studio["inserting"]>; at: { x: number; y: number }; onClose(): void }) {
  const types = useStudio((s) => s.types);
  const family = useStudio((s) => s.types?.nodes[s.scene.nodes[node]?.type ?? ""]?.family);
  const items = useMemo((): Found[] => {
    if (!types) return [];
    const fitting = { ...types, modules: Object.fromEntries(Object.entries(types.modules).filter(([, m]) => m.family === family)) };
    return modulesToAdd(fitting, (module) => (onClose(), insert(node, after, module)));
  }, [types, family, node, after, onClose]);
  return (
    <>
      <div className="shade" onClick={onClose} />
      <div className="add-menu finder" style={{ left: at.x, top: at.y }} role="dialog" aria-label={`Insert a module into ${node}`}>
        <Finder items={items} label="Search modules" placeholder={after ? `A module behind ${after}` : "Search modules"} onClose={onClose} />
      </div>
    </>
  );
}
