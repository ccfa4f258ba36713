// All keys on one sheet.
import { Dialog } from "./Dialog";

const kKeys: [string, string][] = [
  ["Tab, A, double click", "add a node"], ["drag from a port into the open", "add a node that fits"],
  ["drag a number, with Shift, with Ctrl", "change it, finely, coarsely"], ["Delete", "delete what is selected"], ["Shift + drag", "select by a box"], ["Ctrl+A", "select all"],
  ["Ctrl+C, X, V, D", "copy, cut, paste, duplicate, with links and notes"], ["Ctrl+Z, Ctrl+Shift+Z", "undo, redo"],
  ["M", "mute nodes, or bring them back"], ["B", "bypass nodes: what comes in is passed on"], ["L", "arrange nodes"], ["C", "fold nodes, or unfold them"], ["G", "put a group around nodes"], ["F2", "rename a node, write a note"],
  ["Page up, page down", "select the node before, the next one"], ["Escape", "select nothing: the scene's settings"], ["F", "show the whole graph"],
  ["Arrows (with Shift)", "move nodes by 10 (50)"], ["Enter, double click on a node", "its modules"], ["Shift+Tab", "leave the graph, by the keyboard"],
  ["Space", "play, pause"], [".", "one frame"], ["R", "reset"], ["Ctrl+K", "find anything: nodes, modules, parameters, templates, commands"], ["Ctrl+S", "save"], ["?", "this sheet"],
];

export function Help({ onClose }: { onClose(): void }) {
  return (
    <Dialog title="Keys" onClose={onClose}>
      <h2>Keys</h2>
      <table className="keys">
        <tbody>{kKeys.map(([k, what]) => <tr key={k}><th>{k}</th><td>{what}</td></tr>)}</tbody>
      </table>
      <button data-first onClick={onClose}>Close</button>
    </Dialog>
  );
}
