// All keys and what the pointer does, by what they are for; and where more is told.
import { useState } from "react";
import { search } from "../model/search";
import { Dialog } from "./Dialog";

type Keys = [keys: string, what: string][];

const kGroups: { name: string; keys: Keys }[] = [
  { name: "Run", keys: [["Space", "play, pause"], [".", "one frame"], ["R", "reset"]] },
  { name: "Page", keys: [
    ["Ctrl+K", "find anything: nodes, modules, parameters, templates, commands"], ["Ctrl+S", "save"], ["Ctrl+Z, Ctrl+Shift+Z", "undo, redo"], ["right click, menu key", "what can be done there"], ["F1", "the reference of what is selected"], ["?", "this sheet"],
  ] },
  { name: "Graph: look", keys: [
    ["drag, wheel", "move the graph, zoom"], ["F", "show the whole graph"], ["Page up, page down", "select the node before, the next one"], ["Escape", "select nothing: the scene's settings"],
    ["Shift + drag, Ctrl+A", "select by a box, all"], ["Tab", "go on to the values of what is selected"], ["Shift+Tab", "leave the graph, by the keyboard"],
  ] },
  { name: "Graph: build", keys: [
    ["A, double click", "add a node; Tab, too, where nothing is selected"], ["drag from a port into the open", "add a node that fits"], ["K", "link a node to another one"],
    ["drag a node onto a link", "put it into the link"], ["double click on a link", "bend it there; the bend is dragged, Delete takes it away"],
    ["Delete", "delete what is selected"], ["Ctrl+C, X, V, D", "copy, cut, paste, duplicate, with links and notes"], ["Enter, double click on a node", "unfold its modules, or fold them"], ["F2", "rename a node, write a note"],
    ["M", "mute nodes, or bring them back"], ["B", "bypass nodes: what comes in is passed on"], ["C", "fold nodes, or unfold them"], ["G", "put a group around nodes"], ["L", "arrange nodes"],
    ["Arrows (with Shift)", "move nodes by 10 (50)"],
  ] },
  { name: "Modules in the graph", keys: [
    ["drag, Alt+Up, Alt+Down", "another place in the order"], ["Up, Down", "go through them"], ["Enter", "its values"], ["Space", "use it, or leave it out"], ["Insert", "a module behind it"], ["Delete", "take it out"],
  ] },
  { name: "Values", keys: [["drag a number, with Shift, with Ctrl", "change it, finely, coarsely"], ["Up, down", "change a number"], ["Enter, Escape", "take what is typed, take it back"]] },
  { name: "View", keys: [
    ["drag", "orbit"], ["right drag", "move the camera sideways"], ["wheel", "go nearer, farther"], ["click on a particle", "its attributes, and a probe there"], ["Shift + click on another", "how far it is from the first"], ["drag a handle", "move or turn the selected node"],
  ] },
];

export function Help({ onClose }: { onClose(): void }) {
  const [query, setQuery] = useState("");
  const groups = kGroups.map(({ name, keys }) => ({ name, keys: query ? search(query, keys, ([k, what]) => ({ name: k, doc: `${what} ${name}` })) : keys })).filter((g) => g.keys.length > 0);
  return (
    <Dialog title="Keys" className="help" onClose={onClose}>
      <h2>Keys and pointer</h2>
      <input aria-label="Search keys" data-first placeholder="Search, such as mute" value={query} onChange={(e) => setQuery(e.target.value)} />
      <div className="sheets">
        {groups.map(({ name, keys }) => (
          <section key={name} aria-label={name}>
            <h3>{name}</h3>
            <table className="keys">
              <tbody>{keys.map(([k, what]) => <tr key={k}><th>{k}</th><td>{what}</td></tr>)}</tbody>
            </table>
          </section>
        ))}
        {groups.length === 0 && <p className="hint">No key does that. Ctrl+K finds commands, too.</p>}
      </div>
      <p className="hint">More: docs/studio.md beside the program, and <code>weir nodes TYPE</code> of any type.</p>
      <button onClick={onClose}>Close</button>
    </Dialog>
  );
}
