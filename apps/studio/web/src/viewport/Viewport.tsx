// The view with its tools: camera, colours, handles, and the particle that was clicked.
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { copyText, menuOf, showMenu, type MenuItems } from "../Menu";
import { forgetView, keepView, setParam, viewsOf } from "../model/scene";
import { lookAt, pinRun } from "../model/recorded";
import { canCut, cutsOf, withCut } from "../model/clips";
import { pullables } from "../model/pull";
import { edit, last, request, useStudio, viewers } from "../model/store";
import { shortText } from "../model/numbers";
import { forRunner, offOf } from "../model/switchedOff";
import type { JsonObject } from "../model/types";
import { gradient, isColorMap, kColorMaps, type Ramp } from "./colorMaps";
import { hexOf } from "../properties/fields";
import { Icon } from "../Icon";
import { savePicture } from "../share/picture";
import { ShareDialog } from "../share/ShareDialog";
import { Arrows } from "./Arrows";
import { Axes } from "./Axes";
import { BoxHandles } from "./BoxHandles";
import { Building } from "./Building";
import { Compared, Differences } from "./Compared";
import { Cuts } from "./Cuts";
import { Grab } from "./Grab";
import { handleOf, outlinesOf } from "./outlines";
import { PickedParticle } from "./PickedParticle";
import { Recorder } from "./Recorder";
import { Rendered } from "./Rendered";
import { kPresets, mainView, View, type Preset, type ViewEvents } from "./view";

const kMaxChoices = [50_000, 200_000, 1_000_000];

const shortCount = (n: number): string => (n < 1e6 ? `${n / 1000} k` : `${n / 1e6} M`);

/** Pixels that a hand may tremble in a click. */
const kTremble = 3;

interface Key {
  low: number;
  high: number;
  name: string;
  unit: string;
}


export function Viewport({ dark }: { dark: boolean }) {
  const element = useRef<HTMLDivElement>(null);
  const [view, setView] = useState<View | null>(null);
  const [key, setKey] = useState<Key | null>(null);
  const [mode, setMode] = useState<"translate" | "rotate">("translate");
  const [noView, setNoView] = useState(false);
  const [sharing, setSharing] = useState(false);
  const [grabbing, setGrabbing] = useState(false);
  const rendered = useStudio((s) => s.rendered);
  const setRendered = (on: boolean) => useStudio.setState({ rendered: on });
  const pinned = useStudio((s) => s.pinned);
  const gathering = useStudio((s) => s.gathering);
  const writer = useStudio((s) => s.role === "writer");
  const canPin = useStudio((s) => (s.status.frame ?? 0) > 0 && s.status.state !== "building");
  const preview = useStudio((s) => (s.status.coarser ?? 1) > 1);
  const noPictures = useStudio((s) => s.pictures.problem?.message);
  const stopRendered = useCallback(() => useStudio.setState({ rendered: false }), []);
  const [most, setMost] = useState(kMaxChoices[1]!);
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const selected = useStudio((s) => s.selected);
  const attribute = useStudio((s) => s.attribute);
  const attributes = useStudio((s) => s.attributes);
  const opened = useStudio((s) => s.opened);
  const building = useStudio((s) => s.status.state === "building");
  const render = scene["render"] as JsonObject | undefined;
  const color = render?.["color"] as JsonObject | undefined;
  const table = color?.["table"];
  const name = isColorMap(color?.["map"]) ? color["map"] : "viridis";
  const ramp: Ramp = useMemo(() => (Array.isArray(table) && table.length > 1 ? table.map(hexOf) : kColorMaps[name]), [table, name]);
  const range = useMemo(
    () => (attribute === (color?.["by"] ?? "speed") && Array.isArray(color?.["range"]) ? (color["range"] as [number, number]) : null),
    [attribute, color],
  );

  useEffect(() => {
    let made: View;
    const events: ViewEvents = {
      moved: (node, position, rotation) =>
        edit((s) => {
          const placed = setParam(s, { node }, ["position"], position);
          const turned = useStudio.getState().types && handleOf(s, useStudio.getState().types!, node)?.rotates && rotation.some((r) => r !== 0);
          return turned ? setParam(placed, { node }, ["rotation"], rotation) : placed;
        }),
      picked: (node, id, more) => useStudio.setState((s) => ({ picked: { node, id }, pickedBefore: more ? s.picked : null })),
      selected: (node, more) => useStudio.setState((s) => (node in s.scene.nodes ? { selected: more ? [...s.selected.filter((n) => n !== node), node] : [node], selectedLinks: [] } : {})),
      range: (low, high, name, unit) => setKey((k) => (k && k.low === low && k.high === high && k.name === name ? k : { low, high, name, unit })),
    };
    try {
      made = new View(element.current!, events);
    } catch {
      // The rest of the page works without it.
      return setNoView(true);
    }
    setView(made);
    viewers.frame = (p) => made.frame(p);
    viewers.geometry = (p) => made.geometry(p);
    viewers.clear = () => (made.clear(), setKey(null));
    mainView.current = made;
    if (last.geometry) made.geometry(last.geometry);
    if (last.frame) made.frame(last.frame);
    return () => {
      viewers.frame = viewers.geometry = viewers.clear = () => {};
      mainView.current = null;
      made.dispose();
    };
  }, []);

  const picked = useStudio((s) => s.picked);
  useEffect(() => view?.choose(picked), [view, picked]);
  useEffect(() => view?.setBackground(dark ? "#171c22" : "#eef2f6"), [view, dark]);
  useEffect(() => view?.setColors(ramp, range), [view, ramp, range]);
  useEffect(() => view?.setCuts(cutsOf(scene)), [view, render?.["clips"]]); // eslint-disable-line
  // Of the layout only what is switched off: a node that is dragged in the graph stays as it is here.
  const off = Object.keys(scene.nodes).filter((n) => offOf(scene, n)).join();
  useEffect(() => {
    if (view && types) view.setOutlines(outlinesOf(forRunner(scene, types), types));
  }, [view, scene.nodes, off, types]); // eslint-disable-line
  useEffect(() => {
    const one = selected.length === 1 ? selected[0]! : null;
    view?.hold(one && types && handleOf(scene, types, one) ? one : null, mode);
  }, [view, selected, mode, scene.nodes, types]); // eslint-disable-line
  useEffect(() => {
    const camera = render?.["camera"] as JsonObject | undefined;
    if (view && Array.isArray(camera?.["eye"]) && Array.isArray(camera["target"]))
      view.setPose(camera["eye"] as number[], camera["target"] as number[], Number(camera["fov"] ?? 40));
    else view?.fitAnew();
  }, [view, opened, types]); // eslint-disable-line

  // Where the server cannot draw recorded frames, the page shows them as particles, and says why.
  const [unkept, setUnkept] = useState<string | null>(null);
  const builds = useStudio((s) => s.builds);
  const looking = useStudio((s) => s.looking !== null);
  const pictured = rendered && !(looking && unkept !== null);
  useEffect(() => setUnkept(null), [builds, rendered]);
  useEffect(() => {
    const { looking: frame } = useStudio.getState();
    if (!pictured && frame !== null) void lookAt(frame, true);
  }, [pictured]);

  const show = (name: string, count: number) => {
    useStudio.setState({ attribute: name, looking: null });
    setMost(count);
    void request("view.set", { attribute: name, most: count });
  };
  const keepCamera = () => {
    const pose = view!.pose();
    edit((s) => setParam(s, { section: "render" }, ["camera"], { ...((s["render"] as JsonObject)?.["camera"] as JsonObject), ...pose }));
  };

  const views = (): MenuItems => menuOf(
    { name: "Show everything", take: () => view?.fit() },
    ...Object.keys(kPresets).map((p) => ({ name: `From ${p === "iso" ? "a corner" : p}`, take: () => view?.fit(p as Preset) })), null,
    ...viewsOf(scene).map((v) => ({ name: v.name, take: () => view?.setPose(v.eye, v.target, v.fov) })), null,
    { name: "Use this camera for videos", off: !view || !writer, take: keepCamera },
    { name: "Keep this view", off: !view || !writer, take: () => edit((s) => keepView(s, view!.pose())) },
    ...viewsOf(scene).map((v) => ({ name: `Forget ${v.name}`, off: !writer, take: () => edit((s) => forgetView(s, v.name)) })),
  );
  const tools = (): MenuItems => menuOf(
    ...views(), null,
    ...(types && canCut(types) ? [{ name: "Cut the fluids open", off: !view || !writer, take: () => (useStudio.setState({ selected: [], selectedLinks: [] }), edit((s) => withCut(s, view!.extent().center))) }] : []),
    { name: "Copy the camera as JSON", off: !view, take: () => void copyText(JSON.stringify(view!.pose())) }, null,
    { name: pinned ? "End comparison" : "Compare with the next run", off: !pinned && !canPin, take: () => void pinRun() },
    { name: "Save a picture", off: preview, take: () => void savePicture() },
    { name: "Share the run as one file", off: !canPin || preview, take: () => setSharing(true) },
    { name: rendered ? "Particles" : "Rendered", off: noPictures !== undefined, take: () => setRendered(!rendered) },
  );
  // A right drag moves the camera, a right click opens the menu.
  const pressed = useRef({ x: 0, y: 0 });
  const menu = (e: React.PointerEvent) => {
    const { x, y } = pressed.current;
    if (e.button === 2 && Math.hypot(e.clientX - x, e.clientY - y) <= kTremble) showMenu(e, "View", tools());
  };

  return (
    <div className={["viewport", pictured && "pictured", pinned && "comparing"].filter(Boolean).join(" ")} aria-label="Simulation view">
      {building && <Building />}
      <div className="view-tools" role="toolbar" aria-label="View">
        <button
          aria-pressed={rendered} disabled={noPictures !== undefined} onClick={() => setRendered(!rendered)}
          title={noPictures ?? "Pictures by the renderer of the videos, drawn by the server"}
        >
          Rendered
        </button>
        <Recorder view={view} />
        <button
          aria-pressed={pinned !== null} disabled={!pinned && (!canPin || gathering !== null)} onClick={() => void pinRun()}
          title={pinned ? "Show the present run alone" : "Keep this run: the next one is shown beside it"}
        >
          {gathering && !pinned ? `${gathering.done} of ${gathering.all}` : "Compare"}
        </button>
        <button aria-label="Save a picture" disabled={preview} onClick={() => void savePicture()} title="Save what is seen as a PNG that carries its scene"><Icon name="camera" /></button>
        <button disabled={!canPin || preview} onClick={() => setSharing(true)} title={preview ? "A preview is not shared: end it, and play" : "Save the run as one HTML file that replays it"}>Share</button>
        <button onClick={() => view?.fit()} title="Show everything">Fit</button>
        <button aria-haspopup="menu" onClick={(e) => showMenu({ clientX: e.currentTarget.getBoundingClientRect().left, clientY: e.currentTarget.getBoundingClientRect().bottom }, "Views", views())} title="Cameras: those of the scene, from the sides, and that of videos">View…</button>
        <button onClick={() => setMode(mode === "translate" ? "rotate" : "translate")} title="What the handle of the selected node does">
          {mode === "translate" ? "Move" : "Turn"}
        </button>
        {writer && types && pullables(scene, types).length > 0 && (
          <button aria-pressed={grabbing} onClick={() => setGrabbing(!grabbing)} title="Pull bodies with the pointer while the scene runs">Grab</button>
        )}
        <select aria-label="Colour by" value={attribute} onChange={(e) => show(e.target.value, most)}>
          {attributes.map((a) => <option key={a}>{a}</option>)}
        </select>
        <select aria-label="Colour map" value={name} onChange={(e) => edit((s) => setParam(s, { section: "render" }, ["color", "map"], e.target.value))}>
          {Object.keys(kColorMaps).map((m) => <option key={m}>{m}</option>)}
        </select>
        <select aria-label="Most particles" title="At most that many particles are shown" value={most} onChange={(e) => show(attribute, Number(e.target.value))}>
          {kMaxChoices.map((n) => <option key={n} value={n}>{shortCount(n)}</option>)}
        </select>
      </div>
      {pinned && <Differences run={pinned} />}
      <div className="stages">
      {pinned && view && <Compared run={pinned} view={view} ramp={ramp} range={key} dark={dark} />}
      <div
        className="stage" ref={element} onContextMenu={(e) => e.preventDefault()} onPointerUpCapture={menu}
        onPointerDownCapture={(e) => (pressed.current = { x: e.clientX, y: e.clientY })}
      >{pictured && view && <Rendered view={view} onFailed={stopRendered} onUnkept={setUnkept} />}{view && !pictured && <BoxHandles view={view} />}{view && !pictured && <Arrows view={view} />}{view && !pictured && <Cuts view={view} />}{view && !pictured && writer && grabbing && <Grab view={view} stage={element} />}{view && <Axes view={view} />}{pinned && <p className="side"><b>B</b> the present run</p>}</div>
      </div>
      {rendered && looking && unkept !== null && <p className="told over" role="status">A recorded frame, as particles: it cannot be rendered, as {unkept}.</p>}
      {noView && <p className="empty-hint" role="status">This browser has no WebGL, so there is no view here. All else works.</p>}
      {key && !pictured && (
        <div className="color-key">
          <span>{shortText(key.low)}</span>
          <i style={{ background: gradient(ramp) }} />
          <span>{shortText(key.high)} {key.unit}</span>
          <b>{key.name}</b>
        </div>
      )}
      <PickedParticle />
      {sharing && view && <ShareDialog look={() => ({ colors: ramp, range, camera: view.pose(), dark })} onClose={() => setSharing(false)} />}
    </div>
  );
}
