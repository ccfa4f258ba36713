// The whole page: bar, graph, view, properties, insight, transport.
import { ReactFlowProvider } from "@xyflow/react";
import { useEffect, useRef, useState, type CSSProperties } from "react";
import { takeFiles } from "./files/dropped";
import { DropDialog } from "./files/DropDialog";
import { FileBar, save } from "./files/FileBar";
import { Offer } from "./files/Offer";
import { Reference, referenceFor } from "./files/Reference";
import { GraphEditor } from "./graph/GraphEditor";
import { surface } from "./graph/surface";
import { Menu } from "./Menu";
import { Insight } from "./insight/Insight";
import { redo, undo } from "./model/documents";
import { otherChoices } from "./model/remedy";
import { askRun, client, edit, problemOf, resetRun, togglePlay, useStudio } from "./model/store";
import { SweepDialog } from "./sweep/SweepDialog";
import { PropertyPanel } from "./properties/PropertyPanel";
import { Tour } from "./Tour";
import { Timeline } from "./transport/Timeline";
import { Transport } from "./transport/Transport";
import { Viewport } from "./viewport/Viewport";

const kThemeKey = "weir-theme";
const kMessageMs = 8000;

/** Whether something is typed there that is not taken yet, or is no value of the scene: the browser takes that back. */
const hasUndo = (at: Element): boolean =>
  at.closest("textarea, [role=dialog], input[data-draft]") !== null || (at.matches("input:not([type=range], [type=checkbox], [type=color])") && !at.closest(".parameters, .name-field"));

/** Keys that work everywhere but where somebody types. */
function useGlobalKeys(): void {
  useEffect(() => {
    const key = (e: KeyboardEvent) => {
      const { device } = useStudio.getState();
      if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "s") {
        e.preventDefault();
        return save();
      }
      if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "k") {
        e.preventDefault();
        return useStudio.setState({ dialog: "find" });
      }
      const at = e.target as Element;
      if ((e.ctrlKey || e.metaKey) && /^[zy]$/i.test(e.key) && !hasUndo(at)) {
        e.preventDefault();
        return void (e.shiftKey || e.key.toLowerCase() === "y" ? redo() : undo());
      }
      if (e.key === "F1") {
        e.preventDefault();
        return useStudio.setState((s) => ({ reference: s.reference === null ? referenceFor() : null }));
      }
      // Where nothing has the keyboard, the graph has it; but Tab goes into the page.
      if (at === document.body && e.key !== "Tab" && !document.querySelector("[aria-modal=true]")) surface.key(e);
      if (at.closest("input, textarea, select, [role=dialog]") || e.ctrlKey || e.metaKey || e.altKey) return;
      if (e.key === " " && at.closest("button, summary, a")) return;
      if (e.key === " ") togglePlay();
      else if (e.key === ".") void askRun("step");
      else if (e.key.toLowerCase() === "r") void resetRun(device);
      else if (e.key === "?") useStudio.setState({ dialog: "help" });
      else return;
      e.preventDefault();
    };
    addEventListener("keydown", key);
    return () => removeEventListener("keydown", key);
  }, []);
}

/** There is nobody at the other end. */
function Lost() {
  const connected = useStudio((s) => s.connected);
  const strange = useStudio((s) => s.strange);
  const greeted = useStudio((s) => s.server !== "");
  if (connected || !greeted) return null;
  return (
    <div className="banner" role="alert">
      {strange ? "The studio was started again: open the address that it printed. " : "There is no connection to the studio. "}
      What you change is kept in this window until there is.
    </div>
  );
}

/** A button that the pointer has pressed gives the keyboard away: Space plays, and does not press it again. */
function useReleasedButtons(): void {
  useEffect(() => {
    const release = (e: MouseEvent) => {
      const button = (e.target as Element).closest?.("button");
      if (e.detail > 0 && button && !button.closest("[role=dialog]")) button.blur();
    };
    addEventListener("click", release, true);
    return () => removeEventListener("click", release, true);
  }, []);
}

function Message() {
  const message = useStudio((s) => s.message);
  useEffect(() => {
    if (!message) return;
    const timer = setTimeout(() => useStudio.setState({ message: null }), kMessageMs);
    return () => clearTimeout(timer);
  }, [message]);
  if (!message) return null;
  return <div className="message" role="alert">{message} <button aria-label="Close" onClick={() => useStudio.setState({ message: null })}>×</button></div>;
}

/** What is wrong with the scene or the run, in one line; a click leads to the node. */
function Problem() {
  const p = useStudio(problemOf);
  const empty = useStudio((s) => Object.keys(s.scene.nodes).length === 0);
  const writer = useStudio((s) => s.role === "writer");
  const types = useStudio((s) => s.types);
  const scene = useStudio((s) => s.scene);
  if (!p || empty) return null;
  const show = () => p.node && useStudio.setState({ selected: [p.node], selectedLinks: [] });
  const remedies = writer && types ? otherChoices(p, scene, types) : [];
  return (
    <div className="problem-line" role="alert">
      <button title="Show it" onClick={show}>
        {p.node && <b>{p.node}{p.parameter ? `.${p.parameter}` : ""}: </b>}{p.message}{p.allowed && ` — allowed: ${p.allowed}`}{p.hint && `. ${p.hint}`}
      </button>
      {remedies.map((r) => <button key={r.text} className="chip" onClick={() => (edit(r.change), show())}>{r.text}</button>)}
    </div>
  );
}

const within = (v: number, least: number, most: number): number => Math.min(Math.max(v, least), most);

/** A number that the browser keeps. */
function useKeptNumber(key: string, first: () => number) {
  const [value, setValue] = useState(() => {
    const kept = Number(localStorage.getItem(key));
    return kept > 0 ? kept : first();
  });
  useEffect(() => localStorage.setItem(key, String(value)), [key, value]);
  return [value, setValue] as const;
}

/** Pixels that a key moves a bar by. */
const kKeyStep = 24;

/** A bar between two panes, which is dragged or moved by the arrow keys; `value`, in percent, is how large the one is that it is named after. */
function Divider({ name, value, onMove, vertical }: { name: string; value: number; onMove(by: number): void; vertical?: boolean }) {
  const from = useRef<number | null>(null);
  const [less, more] = vertical ? ["ArrowUp", "ArrowDown"] : ["ArrowLeft", "ArrowRight"];
  return (
    <div
      className={vertical ? "divider vertical" : "divider"} role="separator" aria-orientation={vertical ? "horizontal" : "vertical"}
      tabIndex={0} aria-label={name} aria-valuenow={Math.round(value)}
      onKeyDown={(e) => {
        if (e.key !== less && e.key !== more) return;
        e.preventDefault();
        onMove(e.key === less ? -kKeyStep : kKeyStep);
      }}
      onPointerDown={(e) => (e.currentTarget.setPointerCapture(e.pointerId), (from.current = vertical ? e.clientY : e.clientX))}
      onPointerMove={(e) => {
        if (from.current === null) return;
        const now = vertical ? e.clientY : e.clientX;
        onMove(now - from.current);
        from.current = now;
      }}
      onPointerUp={() => (from.current = null)}
    />
  );
}

export function App() {
  const [dark, setDark] = useState(() => (localStorage.getItem(kThemeKey) ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark")) === "dark");
  const [side, setSide] = useKeptNumber("weir-side", () => within(0.21 * innerWidth, 320, 420));
  const [graph, setGraph] = useKeptNumber("weir-graph", () => 0.5);
  const [insight, setInsight] = useKeptNumber("weir-insight", () => 0.38);
  useEffect(() => client.open(), []);
  useEffect(() => {
    document.documentElement.dataset["theme"] = dark ? "dark" : "light";
    localStorage.setItem(kThemeKey, dark ? "dark" : "light");
  }, [dark]);
  useGlobalKeys();
  useReleasedButtons();
  return (
    <div
      className="app" style={{ gridTemplateColumns: `minmax(0, 1fr) 5px ${side}px` }}
      onDragOver={(e) => e.preventDefault()}
      onDrop={(e) => (e.preventDefault(), e.dataTransfer.files.length > 0 && void takeFiles(e.dataTransfer.files))}
    >
      <FileBar dark={dark} onDark={() => setDark(!dark)} />
      <main style={{ gridTemplateRows: `${graph}fr 5px ${1 - graph}fr` }}>
        <Viewport dark={dark} />
        <Divider name="Height of the view" value={100 * graph} vertical onMove={(by) => setGraph((g) => within(g + by / innerHeight, 0.15, 0.85))} />
        <ReactFlowProvider><GraphEditor /></ReactFlowProvider>
      </main>
      <Divider name="Width of the properties" value={(100 * side) / innerWidth} onMove={(by) => setSide((s) => within(s - by, 240, 720))} />
      <aside style={{ "--insight": `${100 * insight}%` } as CSSProperties}>
        <div className="properties"><PropertyPanel /></div>
        <Divider name="Height of the insight" value={100 * insight} vertical onMove={(by) => setInsight((i) => within(i - by / innerHeight, 0.12, 0.8))} />
        <Insight />
      </aside>
      <div className="bottom"><Problem /><Timeline /><Transport /></div>
      <DropDialog />
      <SweepDialog />
      <Tour />
      <Reference />
      <Offer />
      <Lost />
      <Message />
      <Menu />
    </div>
  );
}
