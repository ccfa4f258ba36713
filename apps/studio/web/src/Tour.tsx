// The first minute: water in a tank, built by who looks. Each step knows when it is done, and can be done by a click.
import { useEffect } from "react";
import { create } from "zustand";
import { surface } from "./graph/surface";
import { addLink, addNode, linksOf, setParam, type Scene } from "./model/scene";
import { askRun, edit, useStudio, type Studio } from "./model/store";
import type { Types } from "./model/types";

const kSeenKey = "weir-tour";

/** Which step is shown; null where none is. */
const useTour = create<{ at: number | null }>(() => ({ at: null }));

export const startTour = (): void => useTour.setState({ at: 0 });
export const tourWasSeen = (): boolean => localStorage.getItem(kSeenKey) !== null;

interface Step {
  title: string;
  text: React.ReactNode;
  done(s: Studio): boolean;
  /** What "Do it" does. */
  change?(scene: Scene): Scene;
  act?(): void;
}

/** The first node that gives something of a type. */
const giving = (scene: Scene, types: Types | null, port: string): string | null =>
  Object.keys(scene.nodes).find((n) => types?.nodes[scene.nodes[n]!.type]?.outputs.some((o) => o.type === port)) ?? null;

const kTank = "Boundary", kFluid = "Particles", kFilling = "ParticleBatch";
const has = (port: string) => (s: Studio): boolean => giving(s.scene, s.types, port) !== null;
const value = (s: Studio, port: string, name: string) => s.scene.nodes[giving(s.scene, s.types, port) ?? ""]?.params?.[name];
const linked = (s: Studio, from: string): boolean => linksOf(s.scene).some((l) => l.from === giving(s.scene, s.types, from) && l.to === giving(s.scene, s.types, kFluid));

/** Adds a node where there is room for it, and selects it. */
const adds = (type: string, column: number, row: number) => (scene: Scene): Scene => {
  const [next, name] = addNode(scene, type, { x: 60 + 300 * column, y: 60 + 190 * row });
  useStudio.setState({ selected: [name], selectedLinks: [] });
  return next;
};
const links = (port: string, output: string, input: string) => (scene: Scene): Scene => {
  const { types } = useStudio.getState();
  const [from, to] = [giving(scene, types, port), giving(scene, types, kFluid)];
  return from && to ? addLink(scene, { from, output, to, input }) : scene;
};
const sets = (port: string, values: { [name: string]: string | number | boolean }) => (scene: Scene): Scene => {
  const node = giving(scene, useStudio.getState().types, port);
  return Object.entries(values).reduce((s, [name, v]) => (node ? setParam(s, { node }, [name], v) : s), scene);
};

const kSteps: Step[] = [
  { title: "A tank", text: <>Press <kbd>A</kbd> in the graph below, type <i>tank</i>, and Enter: walls for the water.</>, done: has(kTank), change: adds("StaticBoundary", 0, 1) },
  {
    title: "Its shape", text: <>At the right, choose the shape <i>box</i> and switch <i>Inverted</i> on: the water will be inside.</>,
    done: (s) => value(s, kTank, "shape") === "box" && value(s, kTank, "inverted") === true, change: sets(kTank, { shape: "box", inverted: true }),
  },
  { title: "Water", text: <>Press <kbd>A</kbd> again and type <i>water</i>. A spacing of 0.05 m, at the right, makes few large particles: quick to try things with.</>, done: (s) => has(kFluid)(s) && value(s, kFluid, "spacing") === 0.05, change: (s) => sets(kFluid, { spacing: 0.05 })(giving(s, useStudio.getState().types, kFluid) ? s : adds("ParticleFluid", 1, 0)(s)) },
  { title: "A block of it", text: <>Press <kbd>A</kbd> and type <i>block</i>: the <i>BoxSampler</i> is where the water is at first.</>, done: has(kFilling), change: adds("BoxSampler", 0, 0) },
  {
    title: "Two links", text: <>Drag from <i>particles</i> of the box to <i>initial</i> of the water, and from <i>boundary</i> of the tank to <i>boundaries</i>. Ports that fit light up.</>,
    done: (s) => linked(s, kFilling) && linked(s, kTank), change: (s) => links(kTank, "boundary", "boundaries")(links(kFilling, "particles", "initial")(s)),
  },
  { title: "Play", text: <>Press <kbd>Space</kbd>. Drag in the view to look around it.</>, done: (s) => s.status.state === "playing" || (s.status.frame ?? 0) > 0, act: () => void askRun("play") },
];

function Card({ at }: { at: number }) {
  const step = kSteps[at];
  const done = useStudio((s) => step?.done(s) ?? false);
  const writer = useStudio((s) => s.role === "writer");
  const close = () => (localStorage.setItem(kSeenKey, "seen"), useTour.setState({ at: null }));
  useEffect(() => {
    if (done) useTour.setState({ at: at + 1 });
  }, [done, at]);
  const act = () => {
    if (step?.change) edit(step.change);
    step?.act?.();
    // What was added is to be seen.
    setTimeout(surface.fit);
  };
  return (
    <div className="tour" role="complementary" aria-label="Tour">
      {step ? (
        <>
          <h2>{at + 1} of {kSteps.length}: {step.title}</h2>
          <p aria-live="polite">{step.text}</p>
          <button className="wanted" disabled={!writer} onClick={act}>Do it for me</button> <button onClick={close}>End the tour</button>
        </>
      ) : (
        <>
          <h2>It moves</h2>
          <p aria-live="polite">Drag a number while it runs: gravity of the <i>World</i> (Escape in the graph shows it), or <i>Strength</i> of the water’s viscosity. <i>Compare</i> keeps this run beside the next. <kbd>Ctrl+K</kbd> finds everything, <kbd>F1</kbd> tells what a node does.</p>
          <button className="wanted" onClick={close}>Close</button>
        </>
      )}
      <progress aria-label="Steps of the tour" value={at} max={kSteps.length} />
    </div>
  );
}

export function Tour() {
  const at = useTour((s) => s.at);
  return at === null ? null : <Card at={at} />;
}

/** What an empty page says: where to begin. */
export function Welcome() {
  const writer = useStudio((s) => s.role === "writer");
  const at = useTour((s) => s.at);
  if (at !== null) return null;
  return (
    <div className="welcome">
      <p>
        <button className={tourWasSeen() ? "" : "wanted"} disabled={!writer} onClick={startTour}>Water in a minute</button>{" "}
        <button className={tourWasSeen() ? "wanted" : ""} disabled={!writer} onClick={() => useStudio.setState({ dialog: "templates" })}>Templates…</button>
      </p>
      <p>Or add a node: A, or a double click. Meshes and scenes are dropped here.</p>
    </div>
  );
}
