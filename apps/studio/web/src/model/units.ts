// Numbers that are typed with a unit, "10cm" or "2*3 kPa", as scene files take them, too.
import { evaluate } from "./expression";

/** Powers of metre, kilogram, second and radian, and how many of these base units it is. */
interface Unit {
  powers: [number, number, number, number];
  size: number;
}

const unit = (size: number, m = 0, kg = 0, s = 0, rad = 0): Unit => ({ powers: [m, kg, s, rad], size });

const kPrefixed: { [name: string]: Unit } = {
  m: unit(1, 1), g: unit(1e-3, 0, 1), s: unit(1, 0, 0, 1), N: unit(1, 1, 1, -2), Pa: unit(1, -1, 1, -2), J: unit(1, 2, 1, -2), W: unit(1, 2, 1, -3),
  Hz: unit(1, 0, 0, -1), l: unit(1e-3, 3), L: unit(1e-3, 3), bar: unit(1e5, -1, 1, -2),
};
const kWhole: { [name: string]: Unit } = {
  min: unit(60, 0, 0, 1), h: unit(3600, 0, 0, 1), t: unit(1000, 0, 1), rad: unit(1, 0, 0, 0, 1), deg: unit(Math.PI / 180, 0, 0, 0, 1), degree: unit(Math.PI / 180, 0, 0, 0, 1),
  degrees: unit(Math.PI / 180, 0, 0, 0, 1), "°": unit(Math.PI / 180, 0, 0, 0, 1), rev: unit(2 * Math.PI, 0, 0, 0, 1), rpm: unit(Math.PI / 30, 0, 0, -1, 1), "1": unit(1),
};
const kPrefixes: { [prefix: string]: number } = { n: 1e-9, u: 1e-6, "µ": 1e-6, "μ": 1e-6, m: 1e-3, c: 1e-2, d: 0.1, h: 100, k: 1e3, M: 1e6, G: 1e9 };

const times = (a: Unit, b: Unit, power: number): Unit => ({ powers: a.powers.map((p, i) => p + power * b.powers[i]!) as Unit["powers"], size: a.size * b.size ** power });

function named(name: string): Unit | null {
  const known = kWhole[name] ?? kPrefixed[name];
  if (known) return known;
  const [prefix, base] = [kPrefixes[name[0]!], kPrefixed[name.slice(1)]];
  return prefix !== undefined && base ? { ...base, size: prefix * base.size } : null;
}

/** "kg/m^3", "Pa s", "1/(m^2 s)"; null where it is none. */
export function unitOf(text: string): Unit | null {
  const tokens = text.replaceAll("·", "*").replaceAll("²", "^2").replaceAll("³", "^3").match(/[a-zA-Zµμ°]+|1|\^-?\d|[*/()]|\S/g) ?? [];
  let at = 0;
  const factor = (): Unit | null => {
    if (tokens[at] === "(") {
      ++at;
      const inner = product();
      return tokens[at++] === ")" ? inner : null;
    }
    const found = named(tokens[at++] ?? "");
    return found && tokens[at]?.[0] === "^" ? times(unit(1), found, Number(tokens[at++]!.slice(1))) : found;
  };
  const product = (): Unit | null => {
    let all = factor();
    while (all && at < tokens.length && tokens[at] !== ")") {
      const power = tokens[at] === "/" ? -1 : 1;
      if (tokens[at] === "/" || tokens[at] === "*") ++at;
      const next = factor();
      all = next && times(all, next, power);
    }
    return all;
  };
  const all = product();
  return at === tokens.length ? all : null;
}

/** What was typed with a unit, in the unit of a parameter; null where that is not of its kind. */
export function quantityIn(text: string, parameterUnit: string): number | null {
  const own = unitOf(parameterUnit);
  if (!own) return null;
  for (let i = 1; i < text.length; ++i) {
    const [number, typed] = [evaluate(text.slice(0, i)), unitOf(text.slice(i).trim())];
    if (number !== null && typed && typed.powers.every((p, k) => p === own.powers[k])) return Number(((number * typed.size) / own.size).toPrecision(12));
  }
  return null;
}
