// Names and units of the numbers that a run is told by.

const kUnits: [RegExp, string][] = [
  [/energy$/, "J"], [/momentum$/, "kg m/s"], [/speed$/, "m/s"], [/volume$/, "m³"], [/force$/, "N"], [/torque$/, "N m"], [/pressure(\.|$)/, "Pa"],
  [/center_of_mass$/, "m"], [/compression\.(mean|max)$/, "%"],
];

/** "" where there is none, or none is known. */
export const unitOf = (name: string): string => /\((.+)\)$/.exec(name)?.[1] ?? kUnits.find(([r]) => r.test(name))?.[1] ?? "";

/** "water" and "compression mean" of "water.compression.mean"; no node of what is the run's. */
export function partsOf(name: string): { node: string; quantity: string } {
  const [first, ...rest] = name.replace(/ \(.+\)$/, "").split(".");
  return rest.length === 0 ? { node: "", quantity: first! } : { node: first!, quantity: rest.join(" ").replaceAll("_", " ") };
}

/** What stands before the unit: "water: compression mean" of "water.compression.mean". */
export function titleOf(name: string): string {
  const { node, quantity } = partsOf(name);
  return node ? `${node}: ${quantity}` : quantity;
}

/** The number in its unit. */
export const inUnit = (name: string, v: number): number => (unitOf(name) === "%" ? 100 * v : v);
