// What the page sends, as text.

/** From here on integers do not fit into 64 bits: the server takes such numbers with an exponent alone. */
const kLarge = 2 ** 63;
// A character that nobody types marks numbers that are to stand without quotes.
const kMark = "\uE0F7";
const kMarked = new RegExp(`"${kMark}([-+.0-9e]+)${kMark}"`, "g");

/** JSON in which every number can be read by the server: 1e20 is written as 1e+20, not as 100000000000000000000. */
export function writeMessage(message: object): string {
  let large = false;
  const text = JSON.stringify(message, (_, v: unknown) => {
    if (typeof v !== "number" || !Number.isFinite(v) || Math.abs(v) < kLarge) return v;
    large = true;
    return kMark + v.toExponential() + kMark;
  });
  return large ? text.replace(kMarked, "$1") : text;
}
