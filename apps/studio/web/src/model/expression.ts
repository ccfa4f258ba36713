// Numbers as people type them: "2*pi/3", "1e-3", "sqrt(2)". A small recursive-descent reader, nothing is executed.

const kConstants: { [name: string]: number } = { pi: Math.PI, e: Math.E, tau: 2 * Math.PI };
const kFunctions: { [name: string]: (x: number) => number } = {
  sqrt: Math.sqrt, sin: Math.sin, cos: Math.cos, tan: Math.tan, abs: Math.abs, exp: Math.exp, log: Math.log,
  rad: (d) => (d * Math.PI) / 180, deg: (r) => (r * 180) / Math.PI,
};

/** The value, or null where it is not an expression or not finite. */
export function evaluate(text: string): number | null {
  const tokens = text.match(/\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?|[a-z]+|\*\*|[-+*/^()]/gi) ?? [];
  if (tokens.join("") !== text.replace(/\s+/g, "") || tokens.length === 0) return null;
  let at = 0;
  const take = (token: string) => (tokens[at] === token ? (++at, true) : false);
  const fail = (): never => {
    throw new Error(text);
  };

  const atom = (): number => {
    if (take("(")) {
      const v = sum();
      return take(")") ? v : fail();
    }
    const token = tokens[at++] ?? fail();
    if (/^[a-z]/i.test(token)) {
      const name = token.toLowerCase();
      const f = kFunctions[name];
      if (f && take("(")) {
        const v = f(sum());
        return take(")") ? v : fail();
      }
      return kConstants[name] ?? fail();
    }
    return /^[\d.]/.test(token) ? Number(token) : fail();
  };
  const power = (): number => {
    const base = atom();
    return take("^") || take("**") ? base ** signed() : base;
  };
  const signed = (): number => (take("-") ? -signed() : take("+") ? signed() : power());
  const product = (): number => {
    let v = signed();
    for (;;) {
      if (take("*")) v *= signed();
      else if (take("/")) v /= signed();
      else return v;
    }
  };
  const sum = (): number => {
    let v = product();
    for (;;) {
      if (take("+")) v += product();
      else if (take("-")) v -= product();
      else return v;
    }
  };

  try {
    const v = sum();
    return at === tokens.length && Number.isFinite(v) ? v : null;
  } catch {
    return null;
  }
}

/** As short as it can be without losing what a float can tell. */
export const numberText = (v: number): string => String(Number(v.toPrecision(9)));
