// Search that ranks whole words above parts of words, names above synonyms and texts, and forgives slips of the fingers.

export interface Findable {
  name: string;
  /** Other words for it. */
  synonyms?: string[];
  doc?: string;
}

/** "static", "boundary" of "StaticBoundary" or "static_boundary". */
export const wordsOf = (text: string): string[] => text.match(/[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+/g)?.map((w) => w.toLowerCase()) ?? [];

/** How many letters are wrong, missing, too many or exchanged. */
export function distance(a: string, b: string): number {
  let two: number[] = [], one = Array.from({ length: b.length + 1 }, (_, j) => j);
  for (let i = 1; i <= a.length; ++i) {
    const now = [i];
    for (let j = 1; j <= b.length; ++j) {
      const same = a[i - 1] === b[j - 1];
      now[j] = Math.min(one[j]! + 1, now[j - 1]! + 1, one[j - 1]! + (same ? 0 : 1));
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1]) now[j] = Math.min(now[j]!, two[j - 2]! + 1);
    }
    [two, one] = [one, now];
  }
  return one[b.length]!;
}

/** Whether the letters begin words, in their order: "sqem" of "square emitter". */
function abbreviates(letters: string, words: string[]): boolean {
  if (letters === "") return true;
  return words.some((w, i) => {
    for (let n = 1; n <= Math.min(w.length, letters.length) && w[n - 1] === letters[n - 1]; ++n)
      if (abbreviates(letters.slice(n), words.slice(i + 1))) return true;
    return false;
  });
}

const kLater = 0.5;
const kForgiven = (length: number): number => (length < 4 ? 0 : length < 6 ? 1 : 2);

/** The fewest slips with which one of the words, or its beginning, was meant; null where there are too many. */
function slips(term: string, words: string[]): number | null {
  const most = kForgiven(term.length);
  if (most === 0) return null;
  let best = most + 1;
  for (const w of words)
    // Nobody misses the first letter and another one.
    for (let n = term.length - 1; n <= term.length + 1; ++n) best = Math.min(best, distance(term, w.slice(0, n)) + (w[0] === term[0] ? 0 : 1));
  return best <= most ? best : null;
}

/** How well one word fits; null where it does not. */
function scoreOf(term: string, { name, synonyms = [], doc = "" }: Findable): number | null {
  const lower = name.toLowerCase(), words = wordsOf(name), others = synonyms.map((s) => s.toLowerCase());
  if (lower === term) return 100;
  if (lower.startsWith(term)) return 90;
  // The first of its synonyms is what it is called most: water is the fluid, before what has water in its name.
  const whole = others.indexOf(term);
  if (whole === 0) return 85;
  if (words.some((w) => w.startsWith(term))) return 80;
  const begun = others.findIndex((s) => s.split(" ").some((w) => w.startsWith(term)));
  if (whole >= 0) return 75 - kLater * whole;
  if (begun >= 0) return 65 - kLater * begun;
  if (term.length > 1 && lower.includes(term)) return 55;
  if (abbreviates(term, words)) return 45;
  const texts = wordsOf(doc);
  if (term.length > 1 && texts.some((w) => w.startsWith(term))) return 35;
  const near = slips(term, [...words, ...others.flatMap((s) => s.split(" "))]);
  return near === null ? null : 25 - 5 * near;
}

/** The higher the better; null where a word of the query does not match. */
export function score(query: string, item: Findable): number | null {
  let total = 0;
  for (const term of query.toLowerCase().split(/\s+/).filter(Boolean)) {
    const one = scoreOf(term, item);
    if (one === null) return null;
    total += one;
  }
  return total - 0.01 * item.name.length;
}

/** What fits, best first; all of it, as it is, where nothing is asked for. */
export function search<T>(query: string, items: T[], of: (item: T) => Findable | string): T[] {
  if (query.trim() === "") return items;
  const findable = (item: T): Findable => {
    const f = of(item);
    return typeof f === "string" ? { name: f } : f;
  };
  return items
    .map((item) => ({ item, s: score(query, findable(item)) }))
    .filter((x): x is { item: T; s: number } => x.s !== null)
    .sort((a, b) => b.s - a.s)
    .map((x) => x.item);
}
