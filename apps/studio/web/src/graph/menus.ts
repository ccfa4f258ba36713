// The menus of the graph: of nodes, of a link, and of the ground.
import { copyText, menuOf, type MenuItems } from "../Menu";
import { bendsOf, withBends } from "../model/links";
import { copyNodes, parseLink, removeLinks } from "../model/scene";
import { edit, useStudio } from "../model/store";
import {
  arrangeNodes, chosenNodes, copy, cut, disconnect, duplicate, focusName, focusNote, fold, linksAt, paste, remove, select, selectAll, switchOff,
} from "./actions";
import { toggleModules } from "./NodeModules";
import type { Asked } from "./useKeys";

/** Of what is selected. */
export function nodeMenu(asked: Asked): MenuItems {
  const { scene, selected, types } = useStudio.getState();
  const nodes = chosenNodes(), one = selected.length === 1 ? selected[0]! : null;
  const type = one === null ? undefined : types?.nodes[scene.nodes[one]?.type ?? ""];
  const isNode = nodes.length > 0;
  return menuOf(
    one !== null && { name: isNode ? "Rename" : "Write", keys: "F2", take: isNode ? focusName : focusNote },
    type?.modules !== undefined && { name: "Modules", keys: "Enter", take: () => toggleModules(one!) },
    type !== undefined && { name: "Reference", keys: "F1", take: () => useStudio.setState({ reference: scene.nodes[one!]!.type }) },
    nodes.length === 1 && { name: "Link to…", keys: "K", take: asked.link },
    isNode && { name: "Disconnect", off: linksAt(scene, nodes).length === 0, take: disconnect },
    null,
    isNode && { name: "Bypass", keys: "B", take: () => switchOff("bypassed") },
    isNode && { name: "Mute", keys: "M", take: () => switchOff("muted") },
    isNode && { name: "Fold or unfold", keys: "C", take: fold },
    isNode && { name: "Put a group around", keys: "G", take: asked.group },
    null,
    { name: "Cut", keys: "Ctrl+X", take: cut }, { name: "Copy", keys: "Ctrl+C", take: copy }, { name: "Duplicate", keys: "Ctrl+D", take: duplicate },
    isNode && { name: "Copy as JSON", take: () => void copyText(JSON.stringify(copyNodes(scene, nodes).nodes, null, 2)) },
    null,
    { name: "Delete", keys: "Delete", take: remove },
  );
}

export function linkMenu(link: string, bend: () => void): MenuItems {
  const ends = parseLink(link);
  const bends = bendsOf(useStudio.getState().scene, link).length;
  return [
    { name: "Bend it here", keys: "double click", take: bend }, { name: "Straighten it", off: bends === 0, take: () => edit((s) => withBends(s, link, [])) }, null,
    { name: `Go to ${ends?.from}`, take: () => select([ends!.from]) }, { name: `Go to ${ends?.to}`, take: () => select([ends!.to]) }, null,
    { name: "Delete the link", keys: "Delete", take: () => edit((s) => removeLinks(s, [link])) },
  ];
}

export function canvasMenu(asked: Asked, x: number, y: number): MenuItems {
  const { clip, scene } = useStudio.getState();
  const empty = Object.keys(scene.nodes).length === 0;
  return [
    { name: "Add a node…", keys: "A", take: () => asked.add(x, y) }, { name: "Paste", keys: "Ctrl+V", off: !clip, take: paste }, null,
    { name: "Select all", keys: "Ctrl+A", off: empty, take: selectAll }, { name: "Arrange", keys: "L", off: empty, take: arrangeNodes },
    { name: "Show the whole graph", keys: "F", off: empty, take: asked.fit }, null,
    { name: "Scene settings", keys: "Escape", take: () => select([]) },
  ];
}
