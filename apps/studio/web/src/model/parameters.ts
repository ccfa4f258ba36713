// What people are told of parameters, and which of them mean anything.
import { isKeyframes } from "./keyframes";
import type { Json, JsonObject, Parameter } from "./types";

/** Names that stay as they are written in the field. */
const kSigns: { [word: string]: string } = { dt: "dt", cfl: "CFL", mu: "µ", fov: "Field of view", id: "ID" };

/** "Rest density" of "rest_density" */
export function labelOf(name: string): string {
  const text = name.split("_").map((w) => kSigns[w] ?? w).join(" ");
  return name.split("_")[0]! in kSigns ? text : text.charAt(0).toUpperCase() + text.slice(1);
}

/** What is given, or the default; of keyframes the first value. */
function valueOf(p: Parameter, values: JsonObject): Json {
  const given = values[p.name];
  return given === undefined ? p.default : isKeyframes(given) ? ((given.keyframes[0] as Json[])[1] ?? p.default) : given;
}

/** Whether a parameter means anything with what is given to the others of its owner. */
export function isUsed(p: Parameter, all: Parameter[], values: JsonObject): boolean {
  const chooser = p.only_for && all.find((q) => q.name === p.only_for!.parameter);
  return !chooser || p.only_for!.choices.includes(String(valueOf(chooser, values)));
}

/**
 * The values after a choice: without those that it leaves without a meaning, with which the scene would be refused, and with
 * those that it gives one again. `left` are those that were left out before, and now.
 */
export function afterChoice(all: Parameter[], values: JsonObject, left: JsonObject): { values: JsonObject; left: JsonObject } {
  const isLeft = (name: string) => {
    const p = all.find((q) => q.name === name);
    return p !== undefined && !isUsed(p, all, values);
  };
  const part = (of: JsonObject, out: boolean) => Object.fromEntries(Object.entries(of).filter(([name]) => isLeft(name) === out));
  return { values: { ...part(left, false), ...part(values, false) }, left: { ...part(left, true), ...part(values, true) } };
}

/** Why a number is refused, or null. */
export function rangeProblem(p: Parameter, v: number): string | null {
  if (p.kind === "int" && !Number.isInteger(v)) return "a whole number";
  if (p.min !== undefined && v < p.min) return `at least ${p.min}`;
  if (p.above !== undefined && v <= p.above) return `above ${p.above}`;
  if (p.max !== undefined && v > p.max) return `at most ${p.max}`;
  return null;
}

/** "kg/m³" of "kg/m^3". */
export const unitText = (unit: string): string => (unit === "degrees" ? "°" : unit).replaceAll("^2", "²").replaceAll("^3", "³");

/** "at least 0, at most 1", or "". */
export const limitsOf = (p: Parameter): string =>
  [p.min !== undefined && `at least ${p.min}`, p.above !== undefined && `above ${p.above}`, p.max !== undefined && `at most ${p.max}`].filter(Boolean).join(", ");
