// Fuzzy search: all letters in order; early, consecutive and word-beginning ones count more.

/** The higher the better; null where it does not match. */
export function score(query: string, text: string): number | null {
  const q = query.toLowerCase().replace(/\s+/g, "");
  let at = 0;
  let total = 0;
  let before = -2;
  for (const letter of q) {
    const found = text.toLowerCase().indexOf(letter, at);
    if (found < 0) return null;
    const begins = found === 0 || /[A-Z]/.test(text[found]!) || /[^A-Za-z0-9]/.test(text[found - 1]!);
    total += (found === before + 1 ? 4 : 0) + (begins ? 3 : 0) - 0.1 * found;
    before = found;
    at = found + 1;
  }
  return total - 0.01 * text.length;
}

export function search<T>(query: string, items: T[], text: (item: T) => string): T[] {
  return items
    .map((item) => ({ item, s: score(query, text(item)) }))
    .filter((x): x is { item: T; s: number } => x.s !== null)
    .sort((a, b) => b.s - a.s)
    .map((x) => x.item);
}
