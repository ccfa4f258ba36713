// The same scene with several values of one parameter: which values, and what is read off the runs.
import { evaluate } from "./expression";
import { rangeProblem } from "./parameters";
import { pointsOf, type Run, type Sample } from "./runs";
import type { Owner } from "./scene";
import type { Json, Parameter } from "./types";

/** "0.1", or the name of a choice. */
export const valueName = (v: Json): string => (typeof v === "string" ? v : JSON.stringify(v));

/** Whether several values of a parameter can be tried: single numbers, choices and switches. */
export const canSweep = (p: Parameter): boolean => ["float", "int", "enum", "bool"].includes(p.kind);

const kDigits = 4;
const kUsual = 5;

/** Values to begin with: around a number, as far as it is allowed; or all choices. */
export function firstValues(p: Parameter, value: Json): Json[] {
  if (p.kind === "bool") return [false, true];
  if (p.kind === "enum") return Object.keys(p.choices ?? {});
  const v = typeof value === "number" ? value : (p.soft_max ?? 1);
  const low = p.soft_min ?? -Infinity, high = p.soft_max ?? Infinity;
  const [from, to] = v === 0 ? [Math.max(low, 0), Math.min(high, 1)] : [v / 2, v * 2];
  const all = evenly(from, to, kUsual, v > 0).map((x) => (p.kind === "int" ? Math.round(x) : x));
  return [...new Set(all)].filter((x) => x >= (p.min ?? -Infinity) && x > (p.above ?? -Infinity) && x <= (p.max ?? Infinity));
}

/** From one number to another, by equal differences or by equal ratios. */
export const evenly = (from: number, to: number, count: number, byRatio: boolean): number[] =>
  Array.from({ length: count }, (_, i) => {
    const share = count > 1 ? i / (count - 1) : 0;
    const x = byRatio && from > 0 ? from * (to / from) ** share : from + (to - from) * share;
    return Number(x.toPrecision(kDigits));
  });

/** What one value came to. */
export interface Tried {
  value: Json;
  run: Run | null;
  /** Why there is none. */
  problem?: string;
}

/** How one number is read off a run. */
export const kReadings = {
  last: (vs: number[]) => vs.at(-1)!,
  mean: (vs: number[]) => vs.reduce((a, b) => a + b, 0) / vs.length,
  most: (vs: number[]) => Math.max(...vs),
  least: (vs: number[]) => Math.min(...vs),
} as const;
export type Reading = keyof typeof kReadings;

/** A quantity of a run, read off over all of its samples; null where it has none. */
export function readOff(samples: Sample[], quantity: string, reading: Reading): number | null {
  const vs = pointsOf(quantity, samples).map(([, v]) => v);
  return vs.length > 0 ? kReadings[reading](vs) : null;
}

/** A table for other programs: the values, and all quantities at the end. */
export function tableOf(name: string, tried: Tried[]): string {
  const quantities = [...new Set(tried.flatMap((t) => Object.keys(t.run?.samples.at(-1)?.values ?? {})))];
  const row = (cells: (string | number)[]) => cells.map((c) => (/[",\n]/.test(String(c)) ? `"${String(c).replaceAll('"', '""')}"` : c)).join(",");
  const lines = tried.map((t) => row([valueName(t.value), ...quantities.map((q) => t.run?.samples.at(-1)?.values[q] ?? "")]));
  return [row([name, ...quantities]), ...lines].join("\n") + "\n";
}

export const kMost = 16;

/** The values that a text names, or what is wrong with it. */
export function readValues(p: Parameter, text: string): { values: Json[]; problem: string | null } {
  const words = text.split(/[,;\s]+/).filter(Boolean);
  const values: Json[] = [];
  for (const word of words) {
    const number = p.kind === "float" || p.kind === "int";
    const v: Json = number ? evaluate(word) : p.kind === "bool" ? (word === "true" ? true : word === "false" ? false : null) : word in (p.choices ?? {}) ? word : null;
    const allowed = v === null ? (number ? "numbers, parted by commas" : p.kind === "bool" ? "true, false" : Object.keys(p.choices ?? {}).join(", ")) : number ? rangeProblem(p, v as number) : null;
    if (allowed) return { values, problem: `${word} cannot be — allowed: ${allowed}` };
    values.push(v);
  }
  const problem = values.length < 2 ? "Two values at least." : values.length > kMost ? `At most ${kMost} values.` : null;
  return { values: [...new Set(values)], problem };
}

const quoted = (word: string): string => (/^[\w./=,:+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/** The same sweep of the scene's file by the command line, which runs several at once, as an array of Slurm too, and goes on where it was stopped. */
export function commandOf(file: string, owner: Owner, path: string[], values: Json[]): string {
  const of = "section" in owner ? owner.section : "module" in owner ? `${owner.node}.${owner.module}` : owner.node;
  return ["weir", "sweep", file, "--out", `${file.replace(/\.json$/, "")}_sweep`, "--set", `${of}.${path.join(".")}=${values.map(valueName).join(",")}`].map(quoted).join(" ");
}
