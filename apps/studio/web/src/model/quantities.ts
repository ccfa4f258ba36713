// Names and units of the numbers that a run is told by.

const kUnits: [RegExp, string][] = [
  [/energy$/, "J"], [/momentum$/, "kg m/s"], [/speed$/, "m/s"], [/volume$/, "m³"], [/force$/, "N"], [/torque$/, "N m"], [/pressure(\.|$)/, "Pa"],
  [/center_of_mass$/, "m"], [/compression\.(mean|max)$/, "%"],
];

/** "" where there is none, or none is known. */
export const unitOf = (name: string): string => /\((.+)\)$/.exec(name)?.[1] ?? kUnits.find(([r]) => r.test(name))?.[1] ?? "";

/** What stands before the unit: "water: compression mean" of "water.compression.mean". */
export function titleOf(name: string): string {
  const [node, ...rest] = name.replace(/ \(.+\)$/, "").split(".");
  return rest.length === 0 ? node! : `${node}: ${rest.join(" ").replaceAll("_", " ")}`;
}

/** The number in its unit. */
export const inUnit = (name: string, v: number): number => (unitOf(name) === "%" ? 100 * v : v);
