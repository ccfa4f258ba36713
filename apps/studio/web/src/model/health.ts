// Whether a run can be trusted: lights, each with what it means and what helps.
import { counted } from "./playback";
import type { Sample } from "./runs";
import type { LogLine } from "./store";
import type { Scene } from "./scene";
import type { JsonObject, Parameter, Types } from "./types";

export type Level = "unknown" | "good" | "watch" | "bad";

export interface Light {
  name: string;
  level: Level;
  /** The number in short. */
  value: string;
  why: string;
  node?: string | undefined;
}

export interface Warning {
  text: string;
  node: string | null;
  /** How often it was said. */
  count: number;
}

const kOrder: Level[] = ["unknown", "good", "watch", "bad"];
export const worst = (lights: { level: Level }[]): Level => lights.reduce<Level>((w, l) => (kOrder.indexOf(l.level) > kOrder.indexOf(w) ? l.level : w), "unknown");

const level = (v: number, watch: number, bad: number): Level => (v > bad ? "bad" : v > watch ? "watch" : "good");

/** Mean compression above which a liquid is soft, and above which it is not a liquid any more. */
const kCompression = { watch: 0.01, bad: 0.05 };
/** Share of the particles. */
const kLost = { watch: 0, bad: 0.001 };
/** Growth of the energy where nothing flows in, as a share of the largest that there was: the first steps of a block at a wall take some. */
const kEnergy = { watch: 0.2, bad: 0.5 };

type Reports = [node: string, report: JsonObject][];

const numberAt = (o: JsonObject, key: string): number => (typeof o[key] === "number" ? o[key] : 0);
/** The values at some place of the reports that have one, with their nodes. */
const all = (reports: Reports, value: (r: JsonObject) => number | undefined): [string, number][] =>
  reports.flatMap(([node, r]): [string, number][] => {
    const v = value(r);
    return v === undefined ? [] : [[node, v]];
  });

const percent = (v: number): string => `${Number((100 * v).toPrecision(2))} %`;

function compression(reports: Reports): Light {
  const means = all(reports, (r) => (r["compression"] as JsonObject | undefined)?.["mean"] as number | undefined);
  if (means.length === 0) return { name: "Compression", level: "unknown", value: "–", why: "Nothing of it is known yet." };
  const [node, mean] = means.reduce((a, b) => (b[1] > a[1] ? b : a));
  const found = level(mean, kCompression.watch, kCompression.bad);
  const means_ = `The particles of ${node} are ${percent(mean)} denser than at rest, on average. `;
  const why = found === "good"
    ? `${means_}A liquid keeps its volume: up to 1 % is good.`
    : `${means_}Above 1 % the liquid loses volume, above 5 % it is not a liquid any more. A smaller time step (world.cfl or dt), more iterations of the solver, or slower flow help.`;
  return { name: "Compression", level: found, value: percent(mean), why, node };
}

function lost(reports: Reports): Light {
  const of = (r: JsonObject) => ("particles_escaped" in r ? numberAt(r, "particles_escaped") + numberAt(r, "particles_not_finite") : undefined);
  const gone = all(reports, of);
  if (gone.length === 0) return { name: "Lost", level: "unknown", value: "–", why: "Nothing of it is known yet." };
  const total = gone.reduce((sum, [, v]) => sum + v, 0);
  const there = reports.reduce((sum, [, r]) => sum + ("particles_escaped" in r ? numberAt(r, "particles") : 0), 0);
  const node = gone.find(([, v]) => v > 0)?.[0];
  const why = total === 0
    ? "No particle left the domain, and none has a position or velocity that is not finite."
    : `${total.toLocaleString("en")} particles of ${node} left the domain or are not finite. Walls that are closed and thicker than the spacing, or a smaller time step, keep them in; a Sink takes away on purpose.`;
  return { name: "Lost", level: level(total / Math.max(there + total, 1), kLost.watch, kLost.bad), value: total.toLocaleString("en"), why, node };
}

const energyOf = (s: Sample): number | null => {
  const parts = Object.entries(s.values).filter(([n]) => /\.(kinetic|potential)_energy$/.test(n));
  return parts.length === 0 ? null : parts.reduce((sum, [, v]) => sum + v, 0);
};
/** The larger of both, summed over the fluids. */
const scaleOf = (s: Sample): number =>
  Math.max(...["kinetic", "potential"].map((kind) => Object.entries(s.values).reduce((sum, [n, v]) => sum + (n.endsWith(`.${kind}_energy`) ? Math.abs(v) : 0), 0)));

function energy(samples: Sample[]): Light {
  const unknown = (why: string): Light => ({ name: "Energy", level: "unknown", value: "–", why });
  const now = samples.at(-1);
  if (!now || energyOf(now) === null) return unknown("Nothing of it is known yet.");
  // What flows in or out brings energy along.
  const count = now.values["particles"];
  let from = samples.length - 1;
  while (from > 0 && samples[from - 1]!.values["particles"] === count) --from;
  const closed = samples.slice(from);
  const scale = Math.max(...closed.map(scaleOf));
  if (closed.length < 2 || !(scale > 0)) return unknown("It is judged while no particles come or go.");
  const least = closed.reduce((m, s) => Math.min(m, energyOf(s)!), Infinity);
  const grown = (energyOf(now)! - least) / scale;
  const found = level(grown, kEnergy.watch, kEnergy.bad);
  const why = found === "good"
    ? "Kinetic and potential energy together do not grow: nothing drives the liquid that should not."
    : `Kinetic and potential energy together have grown by ${percent(grown)} of the largest that there was, though no particles came. Moving solids, a turned gravity and changes by hand do that; if there are none, the run is unstable: a smaller time step helps.`;
  return { name: "Energy", level: found, value: grown > kEnergy.watch ? `+${percent(grown)}` : "steady", why };
}

/** Steps that ended before the tolerance of a solve was met, as a share of all. */
const kMissed = { watch: 0.01, bad: 0.1 };

/** What the solves of a node came to: pressure, and viscosity where it is solved for. */
const solvesOf = (r: JsonObject): { missed: number; mean: number }[] => {
  const pressure = r["solver_iterations"];
  return [
    ...(pressure !== null && typeof pressure === "object" ? [{ missed: numberAt(pressure as JsonObject, "not_converged"), mean: numberAt(pressure as JsonObject, "mean") }] : []),
    ...("viscosity_steps_not_converged" in r ? [{ missed: numberAt(r, "viscosity_steps_not_converged"), mean: numberAt(r, "viscosity_iterations_mean") }] : []),
  ];
};

/** Whether the solves of the steps came as near as they were asked to. */
function convergence(numbers: JsonObject | null, reports: Reports): Light {
  const name = "Convergence";
  const unknown = (why: string): Light => ({ name, level: "unknown", value: "–", why });
  const steps = numbers?.["steps"];
  const fixed = all(reports, (r) => (typeof r["solver_iterations"] === "number" ? r["solver_iterations"] : undefined));
  const solves = reports.flatMap(([node, r]) => solvesOf(r).map((solve) => ({ node, ...solve })));
  if (solves.length === 0 && fixed.length > 0) return unknown(`The solver of ${fixed[0]![0]} makes ${counted(fixed[0]![1], "iteration")} in each step, whatever they come to, as it has no tolerance: compression tells whether they are enough.`);
  if (typeof steps !== "number" || !(steps > 0) || solves.length === 0) return unknown("Nothing of it is known yet.");
  const { node, missed, mean } = solves.reduce((a, b) => (b.missed > a.missed || (b.missed === a.missed && b.mean > a.mean) ? b : a));
  const found = level(missed / steps, kMissed.watch, kMissed.bad);
  const took = `With ${counted(Number(mean.toPrecision(2)), "iteration")} on average, `;
  const told = missed === 0
    ? `${took}each step of ${node} met the solver's tolerance.`
    : `${took}${missed.toLocaleString("en")} of ${counted(steps, "step")} of ${node} ended before the solver's tolerance was met. `;
  const helps = missed === 0 ? "" : found === "good" ? "Up to 1 % is good." : "Beyond 1 % the liquid is softer, or thinner, than the scene says. Shorter steps (world.cfl or dt) need fewer iterations; a larger max_iterations allows more.";
  // Rounded down, so that "100 %" means all steps.
  return { name, level: found, value: `${Math.floor(1000 * (1 - missed / steps)) / 10} %`, why: told + helps, node };
}

/** How far a particle may fly in a step, in spacings. */
const kTravel = { watch: 0.5, bad: 1 };

/** What a run is measured by: the spacings of its fluids, m, and the bound that its steps follow, where it has one. */
export interface Measures {
  spacings: { [node: string]: number };
  cfl: number | null;
}

/** How many spacings the fastest particle flies in a step: the Courant number v·dt/d. */
function travel(numbers: JsonObject | null, reports: Reports, { spacings, cfl }: Measures): Light {
  const dt = (numbers?.["time_step"] as JsonObject | undefined)?.["longest"];
  const speeds = all(reports, (r) => r["max_speed"] as number | undefined).filter(([node]) => spacings[node] !== undefined);
  if (typeof dt !== "number" || !(dt > 0) || speeds.length === 0) return { name: "CFL", level: "unknown", value: "–", why: "Nothing of it is known yet." };
  const [node, far, speed] = speeds.map(([n, v]) => [n, (v * dt) / spacings[n]!, v] as const).reduce((a, b) => (b[1] > a[1] ? b : a));
  // Steps that follow the motion are shorter now than the longest that there was.
  const kept = cfl !== null && !((numbers?.["rare_events"] as { node: string }[] | undefined) ?? []).some((e) => e.node === "world");
  const found = kept ? Math.min(far, cfl) : far;
  const short = (v: number) => Number(v.toPrecision(2));
  const flies = `The fastest particle of ${node}, at ${short(speed)} m/s, flies ${short(found)} spacings in a step${kept ? ", which world.cfl bounds" : ` of ${short(dt)} s`}. `;
  // As it is told: "0.5" is not more than half a spacing.
  const judged = level(short(found), kTravel.watch, kTravel.bad);
  return { name: "CFL", level: judged, value: String(short(found)), node, why: judged === "good" ? `${flies}Up to half a spacing is good.` : `${flies}Beyond half a spacing it may pass what it should meet, and walls. A smaller world.dt, or world.cfl, which makes steps follow the motion, helps.` };
}

export function lightsOf(numbers: JsonObject | null, samples: Sample[], measures: Measures = { spacings: {}, cfl: null }): Light[] {
  const reports = Object.entries((numbers?.["nodes"] as JsonObject | undefined) ?? {}) as Reports;
  return [compression(reports), lost(reports), energy(samples), travel(numbers, reports, measures), convergence(numbers, reports)];
}

/** Of a scene that runs, `coarser` times as coarse as it says. */
export function measuresOf(scene: Scene, types: Types, coarser: number): Measures {
  const given = (params: JsonObject | undefined, parameters: Parameter[], name: string): unknown => params?.[name] ?? parameters.find((p) => p.name === name)?.default;
  const spacings = Object.entries(scene.nodes).flatMap(([node, { type, params }]): [string, number][] => {
    const spacing = given(params, types.nodes[type]?.parameters ?? [], "spacing");
    return typeof spacing === "number" ? [[node, coarser * spacing]] : [];
  });
  const cfl = given(scene.world, types.world, "cfl");
  return { spacings: Object.fromEntries(spacings), cfl: typeof cfl === "number" ? cfl : null };
}

/** The node that a message names: "node 'water': …", or "water: …". */
export function nodeIn(text: string, names: string[]): string | null {
  const name = /node '([^'.]+)/.exec(text)?.[1] ?? /'([^'.]+)[.']/.exec(text)?.[1] ?? /^([\w-]+):/.exec(text)?.[1];
  return name !== undefined && names.includes(name) ? name : null;
}

/** What the server warns of: the scene, rare events of the run, and the log since the run was built. */
export function warningsOf(scene: string[], numbers: JsonObject | null, log: LogLine[], since: number, names: string[]): Warning[] {
  const found = new Map<string, Warning>();
  const add = (text: string, node: string | null) => {
    const before = found.get(text);
    if (before) ++before.count;
    else found.set(text, { text, node, count: 1 });
  };
  for (const text of scene) add(text, nodeIn(text, names));
  for (const e of (numbers?.["rare_events"] as { node: string; what: string; count: number }[] | undefined) ?? []) add(`${e.node}: ${e.count.toLocaleString("en")} ${e.what}`, e.node);
  for (const l of log) if (l.at >= since && (l.level === "warning" || l.level === "error")) add(l.text, nodeIn(l.text, names));
  return [...found.values()];
}
