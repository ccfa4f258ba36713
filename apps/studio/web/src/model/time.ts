// Durations as badges and tables show them.

const kMinMs = 0.01;
/** Milliseconds below which nobody asks where the time goes. */
export const kWorthTelling = kMinMs;

/** "4.4 ms"; what is too short to matter is "< 0.01 ms". */
export const msText = (ms: number): string => `${ms < kMinMs ? `< ${kMinMs}` : Number(ms.toPrecision(3)) < 10 ? ms.toPrecision(2) : ms.toFixed(0)} ms`;

const kUnits: [Intl.RelativeTimeFormatUnit, number][] = [["day", 86_400], ["hour", 3600], ["minute", 60], ["second", 1]];

/** "5 minutes ago" */
export function ageOf(written: number, now = Date.now() / 1000): string {
  const seconds = Math.max(0, now - written);
  const [unit, length] = kUnits.find(([, l]) => seconds >= l) ?? kUnits.at(-1)!;
  return new Intl.RelativeTimeFormat("en", { numeric: "auto" }).format(-Math.floor(seconds / length), unit);
}

/** "40 s", "3 min", "2.5 h": as exact as an estimate is. */
export function durationText(seconds: number): string {
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`;
  if (seconds < 90 * 60) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toPrecision(2)} h`;
}
