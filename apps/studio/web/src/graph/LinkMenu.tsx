// The links that a node can have, to be made by the keyboard alone.
import { useMemo } from "react";
import { Finder, type Found } from "../Finder";
import { roleOf } from "../model/roles";
import { addLink, linksFor, linkText, type LinkEnds } from "../model/scene";
import { edit, useStudio } from "../model/store";

export function LinkMenu({ node, at, onClose }: { node: string; at: { x: number; y: number }; onClose(): void }) {
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const items = useMemo((): Found[] => {
    if (!types) return [];
    const make = (l: LinkEnds) => () => (onClose(), edit((s) => addLink(s, l)));
    return linksFor(scene, types, node).map((l): Found => {
      const gives = l.from === node, other = gives ? l.to : l.from;
      const type = types.nodes[scene.nodes[other]!.type];
      return {
        id: linkText(l), name: gives ? `${l.output} to ${l.to}.${l.input}` : `${l.from}.${l.output} to ${l.input}`, beside: scene.nodes[other]!.type, role: roleOf(type),
        group: gives ? `What ${node} gives` : `What ${node} takes`, take: make(l),
      };
    });
  }, [scene, types, node, onClose]);
  return (
    <>
      <div className="shade" onClick={onClose} />
      <div className="add-menu finder" style={{ left: at.x, top: at.y }} role="dialog" aria-label={`Link ${node}`}>
        <Finder items={items} label="Search links" placeholder={`Link ${node} to…`} onClose={onClose} nothing={`No port of another node fits ${node}.`} />
      </div>
    </>
  );
}
