// The graph of nodes and links, and all that is done to it by mouse and keyboard.
import {
  Controls, ReactFlow, useReactFlow, useStore, ViewportPortal, type Connection, type Edge, type EdgeChange, type Node, type NodeChange,
  type OnConnectEnd, type OnConnectStart, type ReactFlowInstance, type Viewport, type XYPosition,
} from "@xyflow/react";
import { useCallback, useEffect, useMemo, useRef, useState, type RefObject } from "react";
import { takeFiles } from "../files/dropped";
import { bendsOf, bent, withBends, withNodeIn } from "../model/links";
import { addNote, moveAll, withCarried } from "../model/notes";
import {
  addGroupAround, addLink, addNode, freeNoteId, linkProblem, type LinkEnds, type Scene,
} from "../model/scene";
import { showMenu } from "../Menu";
import { Welcome } from "../Tour";
import { edit, say, useStudio } from "../model/store";
import type { Types } from "../model/types";
import { AddMenu, type Dangling } from "./AddMenu";
import { chosenNodes, focusNote, select } from "./actions";
import { canvasMenu, linkMenu, nodeMenu } from "./menus";
import { Dots } from "./Dots";
import { boundsOf, isFar, kLegible, placed, sizeOf, useFlow } from "./flow";
import { FarLinks, Link } from "./Link";
import { LinkMenu } from "./LinkMenu";
import { NoteNode } from "./NoteNode";
import { ModuleMenu } from "./ModuleMenu";
import { toggleModules } from "./NodeModules";
import { Overview } from "./Overview";
import { SceneNode } from "./SceneNode";
import { surface as asked } from "./surface";
import { takeModule } from "./takeModule";
import { useKeys, type Asked } from "./useKeys";

const kNodeTypes = { scene: SceneNode, note: NoteNode };
const kEdgeTypes = { default: Link };
/** Pixels that a hand may tremble in a click: no more than that, and a node is chosen, not moved. */
const kTremble = 3;
/** ms after which what was added is on the page */
const kMounted = 50;
// The same objects each time: other ones would have all nodes rendered again.
const kSelectMore = ["Shift", "Control", "Meta"];
const kNoMark = { hideAttribution: true };

const endsOf = (c: Connection | Edge): LinkEnds => ({
  from: c.source, output: c.sourceHandle ?? "", to: c.target, input: c.targetHandle ?? "",
});

function linksChosen(changes: EdgeChange[]): void {
  const links = new Set(useStudio.getState().selectedLinks);
  for (const c of changes) if (c.type === "select") c.selected ? links.add(c.id) : links.delete(c.id);
  useStudio.setState({ selectedLinks: [...links] });
}

const connected = (c: Connection): void => edit((s) => addLink(s, endsOf(c)));

function fits(c: Connection | Edge): boolean {
  const { scene, types } = useStudio.getState();
  return types !== null && linkProblem(scene, types, endsOf(c)) === null;
}

const unfold = (_: unknown, n: Node): void => toggleModules(n.id);

/** Where the list of nodes lies, and where the pointer was that asked for it. */
interface Menu {
  x: number;
  y: number;
  point: XYPosition;
  dangling: Dangling | null;
}

const kMenu = { width: 340, height: 350 };
const inside = (v: number, most: number): number => Math.max(0, Math.min(v, most));
/** Where a list lies in the graph that is asked for at a place of the page. */
function insideOf(surface: Element, { x, y }: XYPosition): XYPosition {
  const box = surface.getBoundingClientRect();
  return { x: inside(x - box.left, box.width - kMenu.width), y: inside(y - box.top, box.height - kMenu.height) };
}
/** A new node lies with its name under the pointer. */
const kGrip = { x: 40, y: 14 };
const kApart = 36;

/** The place, or one beside it where a node has its corner there already. */
function freePlace(scene: Scene, { x, y }: XYPosition): XYPosition {
  const taken = (p: XYPosition) => Object.values(scene.layout?.nodes ?? {}).some((q) => Math.abs(q.x - p.x) < kApart / 2 && Math.abs(q.y - p.y) < kApart / 2);
  let place = { x: Math.round(x), y: Math.round(y) };
  while (taken(place)) place = { x: place.x + kApart, y: place.y + kApart };
  return place;
}

export function GraphEditor() {
  const { nodes, edges, measured } = useFlow();
  const far = useStore(isFar);
  const [farLinks, setFarLinks] = useState<SVGSVGElement | null>(null);
  const flow = useReactFlow();
  const surface = useRef<HTMLDivElement>(null);
  const pointer = useRef({ x: 300, y: 200 });
  const [menu, setMenu] = useState<Menu | null>(null);
  const [dragged, setDragged] = useState<{ [id: string]: XYPosition }>({});
  const opened = useStudio((s) => s.opened);
  const types = useStudio((s) => s.types);

  const fit = useFit(flow, surface);
  // An empty graph would be fitted to its first node, which would leave the pointer.
  useEffect(() => void setTimeout(() => {
    if (flow.getNodes().length > 0) fit({ minZoom: kLegible });
  }, kMounted), [flow, fit, opened, types]);
  useEffect(() => {
    asked.middle = () => {
      const { left, top, width, height } = surface.current!.getBoundingClientRect();
      return freePlace(useStudio.getState().scene, flow.screenToFlowPosition({ x: left + width / 2, y: top + height / 2 }));
    };
    asked.fit = () => fit({ duration: kGlideMs });
  }, [flow, fit]);

  // What is chosen elsewhere, as by a message, a key or a drop, is brought into view.
  const chosen = useStudio((s) => (s.selected.length === 1 ? s.selected[0]! : null));
  useEffect(() => {
    if (chosen === null) return;
    const timer = setTimeout(() => bringIntoView(flow, surface.current!, chosen), kMounted);
    return () => clearTimeout(timer);
  }, [flow, chosen]);

  // So is a node that is unfolded: all of it.
  const unfolded = useStudio((s) => s.unfolded);
  const before = useRef(unfolded);
  useEffect(() => {
    const newest = unfolded.length > before.current.length ? unfolded.at(-1) : undefined;
    before.current = unfolded;
    if (newest === undefined) return;
    const timer = setTimeout(() => bringWholeIntoView(flow, surface.current!, newest), kMounted);
    return () => clearTimeout(timer);
  }, [flow, unfolded]);

  const openMenu = useCallback((x: number, y: number, dangling: Dangling | null = null) => {
    setMenu({ ...insideOf(surface.current!, { x, y }), point: { x, y }, dangling });
  }, []);

  const close = useCallback(() => (setMenu(null), surface.current?.focus({ preventScroll: true })), []);

  const add = useCallback((type: string) => {
    const at = flow.screenToFlowPosition(menu!.point);
    edit((s) => {
      const [next, name] = addNode(s, type, freePlace(s, { x: at.x - kGrip.x, y: at.y - kGrip.y }));
      useStudio.setState({ selected: [name], selectedLinks: [] });
      const link = menu!.dangling && types && linkTo(next, types, name, menu!.dangling);
      return link ? addLink(next, link) : next;
    });
    close();
  }, [flow, menu, types, close]);

  const module = useCallback((type: string) => {
    takeModule(type, flow.screenToFlowPosition(menu!.point));
    setMenu(null);
  }, [flow, menu]);

  const note = useCallback((frame: boolean) => {
    const at = flow.screenToFlowPosition(menu!.point);
    edit((s) => {
      const id = freeNoteId(s);
      useStudio.setState({ selected: [id], selectedLinks: [] });
      return addNote(s, { id, text: "", x: Math.round(at.x), y: Math.round(at.y), width: frame ? 420 : 200, height: frame ? 260 : 90, frame });
    });
    setMenu(null);
    setTimeout(focusNote, kMounted);
  }, [flow, menu]);

  const onNodesChange = useCallback((changes: NodeChange[]) => {
    measured(changes);
    let selected = new Set(useStudio.getState().selected);
    for (const c of changes) if (c.type === "select") c.selected ? selected.add(c.id) : selected.delete(c.id);
    if (changes.some((c) => c.type === "select")) useStudio.setState({ selected: [...selected] });
    // While nodes are dragged they move here only; the scene learns of it at the end.
    const moves = changes.flatMap((c): [string, XYPosition][] => (c.type === "position" && c.position && c.dragging ? [[c.id, c.position]] : []));
    if (moves.length > 0) setDragged((d) => ({ ...d, ...withCarried(useStudio.getState().scene, Object.fromEntries(moves)) }));
  }, [measured]);

  const dropped = useCallback((e: unknown, node: Node | undefined, all: Node[]) => {
    const moved = all.length > 0 ? all : node ? [node] : [];
    const into = moved.length === 1 ? linkBelow(surface.current!, e, moved[0]!.id) : null;
    markLink(surface.current!, null);
    edit((s) => {
      const next = moveAll(s, Object.fromEntries(moved.map((n) => [n.id, n.position])));
      return (into === null ? null : withNodeIn(next, useStudio.getState().types!, into, moved[0]!.id)) ?? next;
    });
    setDragged({});
  }, []);
  const dragging = useCallback((e: unknown, node: Node, all: Node[]) =>
    markLink(surface.current!, all.length > 1 ? null : linkBelow(surface.current!, e, node.id)), []);
  const selectionDropped = useCallback((e: unknown, all: Node[]) => dropped(e, undefined, all), [dropped]);

  const connectEnd = useCallback<OnConnectEnd>((event, state) => {
    markPorts(surface.current!, null);
    connectEnded(event, state, openMenu);
  }, [openMenu]);
  const connectStart = useCallback<OnConnectStart>((_, from) => markPorts(surface.current!, from), []);
  const moves = useCallback(() => void (surface.current!.dataset["moving"] = ""), []);
  // At whole pixels the layer of nodes is copied to the screen as it is, and texts are sharp.
  const moved = useCallback((_: unknown, { x, y, zoom }: Viewport) => {
    delete surface.current!.dataset["moving"];
    if (!Number.isInteger(x) || !Number.isInteger(y)) void flow.setViewport({ x: Math.round(x), y: Math.round(y), zoom });
  }, [flow]);

  const [linking, setLinking] = useState<{ node: string; x: number; y: number } | null>(null);
  const closeLinking = useCallback(() => (setLinking(null), surface.current?.focus({ preventScroll: true })), []);
  const inserting = useStudio((s) => s.inserting);
  const closeInserting = useCallback(() => (useStudio.setState({ inserting: null }), surface.current?.focus({ preventScroll: true })), []);
  const wishes = useMemo((): Asked => ({
    add: openMenu,
    link: () => {
      const [node] = chosenNodes();
      const at = node === undefined ? undefined : surface.current!.querySelector(`[data-node="${node}"]`)?.getBoundingClientRect();
      if (at) setLinking({ node: node!, ...insideOf(surface.current!, { x: at.left, y: at.bottom }) });
    },
    group: () => groupSelected(flow),
    fit: () => fit({ duration: kGlideMs }),
  }), [flow, fit, openMenu]);
  const key = useKeys(pointer, surface, wishes);
  useEffect(() => void (asked.key = key), [key]);
  const onNodeMenu = useCallback((e: React.MouseEvent, n: Node) => {
    e.preventDefault();
    if (!useStudio.getState().selected.includes(n.id)) select([n.id]);
    showMenu(e, "Node", nodeMenu(wishes));
  }, [wishes]);
  const onSelectionMenu = useCallback((e: React.MouseEvent) => (e.preventDefault(), showMenu(e, "Node", nodeMenu(wishes))), [wishes]);
  const onLinkMenu = useCallback((e: React.MouseEvent, link: Edge) => {
    e.preventDefault();
    select([], [link.id]);
    showMenu(e, "Link", linkMenu(link.id, () => bendAt(flow, link.id, { x: e.clientX, y: e.clientY })));
  }, [flow]);
  const onBend = useCallback((e: React.MouseEvent, link: Edge) => bendAt(flow, link.id, { x: e.clientX, y: e.clientY }), [flow]);
  const onCanvasMenu = useCallback((e: React.MouseEvent | MouseEvent) => {
    e.preventDefault();
    showMenu(e, "Graph", canvasMenu(wishes, e.clientX, e.clientY));
  }, [wishes]);
  /** By the menu key, for what is selected. */
  const onMenuKey = (e: React.MouseEvent) => {
    if (e.target !== e.currentTarget) return;
    e.preventDefault();
    const [first] = chosenNodes();
    const at = (first && surface.current!.querySelector(`[data-node="${first}"] strong`)?.getBoundingClientRect()) || surface.current!.getBoundingClientRect();
    showMenu({ clientX: at.left + 20, clientY: at.top + 20 }, first ? "Node" : "Graph", first ? nodeMenu(wishes) : canvasMenu(wishes, at.left + 20, at.top + 20));
  };
  const shown = useMemo(() => nodes.map((n) => (dragged[n.id] ? placed(n, dragged[n.id]!) : n)), [nodes, dragged]);
  const ground = useMemo(() => boundsOf(nodes), [nodes]);

  return (
    <div
      className="graph" ref={surface} data-far={far ? "" : undefined} tabIndex={0} role="application" aria-label="Node editor" onKeyDown={key} onContextMenu={onMenuKey}
      onPointerMove={(e) => (pointer.current = { x: e.clientX, y: e.clientY })}
      onDrop={(e) => {
        if (e.dataTransfer.files.length === 0) return;
        e.preventDefault();
        e.stopPropagation();
        void takeFiles(e.dataTransfer.files, flow.screenToFlowPosition({ x: e.clientX, y: e.clientY }));
      }}
      onDoubleClick={(e) => (e.target as Element).classList.contains("react-flow__pane") && openMenu(e.clientX, e.clientY)}
    >
      <FarLinks.Provider value={far ? farLinks : null}>
      <ReactFlow
        nodes={shown} edges={edges} nodeTypes={kNodeTypes} edgeTypes={kEdgeTypes} onNodesChange={onNodesChange} onNodeDrag={dragging} onNodeDragStop={dropped}
        onSelectionDragStop={selectionDropped}
        onEdgesChange={linksChosen} onConnect={connected} isValidConnection={fits} onConnectStart={connectStart} onConnectEnd={connectEnd}
        onNodeDoubleClick={unfold} onEdgeDoubleClick={onBend}
        onNodeContextMenu={onNodeMenu} onSelectionContextMenu={onSelectionMenu} onEdgeContextMenu={onLinkMenu} onPaneContextMenu={onCanvasMenu}
        onMoveStart={moves} onMoveEnd={moved}
        nodeDragThreshold={kTremble} nodeClickDistance={kTremble} paneClickDistance={kTremble}
        deleteKeyCode={null} multiSelectionKeyCode={kSelectMore} selectionKeyCode="Shift" minZoom={0.05}
        zoomOnDoubleClick={false} elevateNodesOnSelect={false} onlyRenderVisibleElements={!far} proOptions={kNoMark}
      >
        <Dots />
        <ViewportPortal>
          <div className="ground" style={ground} />
          <svg className="far-links" ref={setFarLinks} />
        </ViewportPortal>
        <Overview nodes={shown} />
        <Controls showInteractive={false} />
      </ReactFlow>
      </FarLinks.Provider>
      {nodes.length === 0 && types && <Welcome />}
      {menu && <AddMenu at={menu} dangling={menu.dangling} onAdd={add} onModule={module} onNote={note} onClose={close} />}
      {inserting && <ModuleMenu asked={inserting} at={insideOf(surface.current!, inserting)} onClose={closeInserting} />}
      {linking && <LinkMenu node={linking.node} at={linking} onClose={closeLinking} />}
    </div>
  );
}

/** Puts a group around what is selected. */
function groupSelected(flow: ReactFlowInstance): void {
  const chosen = new Set(useStudio.getState().selected);
  const boxes = flow.getNodes().filter((n) => chosen.has(n.id))
    .map((n) => ({ ...n.position, width: n.measured?.width ?? n.initialWidth!, height: n.measured?.height ?? n.initialHeight! }));
  edit((s) => {
    const id = freeNoteId(s), next = addGroupAround(s, id, boxes);
    if (next !== s) select([id]);
    return next;
  });
}

const kGlideMs = 200;
const kResizedMs = 80;

/** Shows the whole graph; and again where its pane gets another size and nobody has moved it since. */
function useFit(flow: ReactFlowInstance, surface: RefObject<HTMLDivElement | null>): (more: { duration?: number; minZoom?: number }) => void {
  const fitted = useRef<{ at: Viewport; more: { minZoom?: number } } | null>(null);
  const fit = useCallback((more: { duration?: number; minZoom?: number }) => {
    void flow.fitView({ padding: 0.15, maxZoom: 1, ...more }).then(() => {
      const { duration: _, ...rest } = more;
      fitted.current = { at: flow.getViewport(), more: rest };
    });
  }, [flow]);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout>;
    const again = () => {
      const before = fitted.current, now = flow.getViewport();
      const near = (a: number, b: number) => Math.abs(a - b) <= 1;
      if (before && now.zoom === before.at.zoom && near(now.x, before.at.x) && near(now.y, before.at.y)) fit(before.more);
    };
    const observer = new ResizeObserver(() => (clearTimeout(timer), (timer = setTimeout(again, kResizedMs))));
    observer.observe(surface.current!);
    return () => (observer.disconnect(), clearTimeout(timer));
  }, [flow, fit, surface]);
  return fit;
}

/** The link from a dangling port to the first port of a new node that fits. */
function linkTo(scene: Scene, types: Types, name: string, d: Dangling): LinkEnds | null {
  const t = types.nodes[scene.nodes[name]!.type]!;
  const port = (d.side === "output" ? t.inputs : t.outputs).find((p) => p.type === d.type);
  if (!port) return null;
  return d.side === "output"
    ? { from: d.node, output: d.port, to: name, input: port.name }
    : { from: name, output: port.name, to: d.node, input: d.port };
}

/** While a link is dragged from a port, those that it may go to light up, and all others fade. */
function markPorts(surface: Element, from: { nodeId: string | null; handleId: string | null; handleType: string | null } | null): void {
  const { scene, types } = useStudio.getState();
  for (const port of surface.querySelectorAll<HTMLElement>(".react-flow__handle")) {
    const { nodeid, handleid } = port.dataset;
    delete port.dataset["fits"];
    if (!from || !types || !nodeid || !handleid || (nodeid === from.nodeId && handleid === from.handleId)) continue;
    const one = { node: from.nodeId ?? "", port: from.handleId ?? "" }, other = { node: nodeid, port: handleid };
    const [a, b] = from.handleType === "source" ? [one, other] : [other, one];
    const faces = port.classList.contains(from.handleType === "source" ? "target" : "source");
    port.dataset["fits"] = faces && linkProblem(scene, types, { from: a.node, output: a.port, to: b.node, input: b.port }) === null ? "yes" : "no";
  }
}

/** The link that a node lies upon where it is let go, if it fits into it: by the pointer, or else by the middle of the node. */
function linkBelow(surface: Element, event: unknown, node: string): string | null {
  const { scene, types } = useStudio.getState();
  const type = types?.nodes[scene.nodes[node]?.type ?? ""];
  // Most nodes fit into no link at all.
  if (!types || !type?.inputs.some((i) => type.outputs.some((o) => o.type === i.type))) return null;
  const box = surface.querySelector(`[data-node="${node}"]`)?.getBoundingClientRect();
  const at = event as MouseEvent;
  const points = [{ x: at.clientX, y: at.clientY }, ...(box ? [{ x: box.left + box.width / 2, y: box.top + box.height / 2 }] : [])];
  for (const { x, y } of points)
    for (const element of document.elementsFromPoint(x, y)) {
      const link = element.closest<HTMLElement>(".react-flow__edge")?.dataset["id"];
      if (link !== undefined && withNodeIn(scene, types, link, node)) return link;
    }
  return null;
}

/** Shows into which link a node would be put. */
function markLink(surface: Element, link: string | null): void {
  for (const edge of surface.querySelectorAll<HTMLElement>(".react-flow__edge[data-into]")) if (edge.dataset["id"] !== link) delete edge.dataset["into"];
  if (link !== null) surface.querySelector<HTMLElement>(`.react-flow__edge[data-id="${link}"]`)!.dataset["into"] = "";
}

/** Leads a link through a place of the page. */
function bendAt(flow: ReactFlowInstance, link: string, at: XYPosition): void {
  const path = document.querySelector<SVGPathElement>(`.react-flow__edge[data-id="${link}"] path`);
  if (!path) return;
  const [from, to] = [path.getPointAtLength(0), path.getPointAtLength(path.getTotalLength())];
  edit((s) => withBends(s, link, bent(bendsOf(s, link), flow.screenToFlowPosition(at), from, to)));
}

/** A link that ends nowhere opens the list; one that ends at a wrong port says why it is wrong. */
function connectEnded(
  event: MouseEvent | TouchEvent,
  state: { isValid: boolean | null; fromNode: unknown; fromHandle: unknown; toHandle: unknown; toNode: unknown },
  openMenu: (x: number, y: number, d: Dangling) => void,
): void {
  const { scene, types } = useStudio.getState();
  const fromNode = state.fromNode as Node | null;
  const from = state.fromHandle as { id: string; type: "source" | "target" } | null;
  if (state.isValid || !types || !fromNode || !from) return;
  const to = state.toHandle as { id: string } | null;
  const toNode = state.toNode as Node | null;
  if (to && toNode) {
    const ends = from.type === "source"
      ? { from: fromNode.id, output: from.id, to: toNode.id, input: to.id }
      : { from: toNode.id, output: to.id, to: fromNode.id, input: from.id };
    return say(new Error(linkProblem(scene, types, ends) ?? "an output is linked to an input"));
  }
  const t = types.nodes[scene.nodes[fromNode.id]?.type ?? ""];
  const side = from.type === "source" ? "output" : "input";
  const type = (side === "output" ? t?.outputs : t?.inputs)?.find((p) => p.name === from.id)?.type;
  const at = "changedTouches" in event ? event.changedTouches[0]! : event;
  if (type) openMenu(at.clientX, at.clientY, { node: fromNode.id, port: from.id, type, side });
}

const kEdge = 12;

/** Moves the graph so that all of a node is seen, beside the map, and makes it smaller where it must be. */
function bringWholeIntoView(flow: ReactFlowInstance, surface: Element, id: string): void {
  const node = surface.querySelector(`[data-node="${id}"]`)?.getBoundingClientRect(), pane = surface.getBoundingClientRect();
  if (!node) return;
  const view = flow.getViewport(), scale = Math.min(1, (pane.height - 2 * kEdge) / node.height);
  // Of the node at the new scale, in pixels of the pane.
  const place = (at: number, size: number, most: number) => Math.max(kEdge, Math.min(at, most - size * scale - kEdge));
  const left = node.left - pane.left, top = node.top - pane.top, toTop = place(top, node.height, pane.height);
  const map = surface.querySelector(".overview:not([data-needless])")?.getBoundingClientRect();
  const reachesMap = map !== undefined && toTop + scale * node.height > map.top - pane.top;
  const x = place(left, node.width, reachesMap ? map.left - pane.left : pane.width) - scale * (left - view.x), y = toTop - scale * (top - view.y);
  if (x !== view.x || y !== view.y) void flow.setViewport({ x: Math.round(x), y: Math.round(y), zoom: view.zoom * scale }, { duration: kGlideMs });
}

/** Moves the graph where nothing of a node is seen. */
function bringIntoView(flow: ReactFlowInstance, surface: Element, id: string): void {
  const node = flow.getNode(id);
  if (!node) return;
  const { width, height } = surface.getBoundingClientRect();
  const { x, y, zoom } = flow.getViewport();
  const size = sizeOf(node), left = node.position.x * zoom + x, top = node.position.y * zoom + y;
  if (left < width && top < height && left + size.width * zoom > 0 && top + size.height * zoom > 0) return;
  void flow.setCenter(node.position.x + size.width / 2, node.position.y + size.height / 2, { zoom, duration: 200 });
}
