// A quantity of the runs of a sweep against the value that was tried.
import { useMemo } from "react";
import { shortText } from "../model/numbers";
import { someTicks } from "../model/playback";
import { titleOf, unitOf } from "../model/quantities";
import { readOff, valueName, type Reading, type Tried } from "../model/sweep";

const kMargin = 6;
/** Values whose ends are that many times apart are drawn by their ratios. */
const kByRatio = 8;

export function AgainstValue({ name, unit, tried, quantity, reading }: { name: string; unit: string; tried: Tried[]; quantity: string; reading: Reading }) {
  const points = useMemo(
    () => tried.flatMap((t) => {
      const v = t.run && readOff(t.run.samples, quantity, reading);
      return v === null ? [] : [{ value: t.value, v }];
    }),
    [tried, quantity, reading],
  );
  const numbers = points.every((p) => typeof p.value === "number");
  const sorted = numbers ? [...points].sort((a, b) => (a.value as number) - (b.value as number)) : points;
  const [first, last] = [sorted[0]?.value as number, sorted.at(-1)?.value as number];
  const byRatio = numbers && first > 0 && last / first > kByRatio;
  const along = (i: number): number => {
    if (!numbers) return sorted.length > 1 ? i / (sorted.length - 1) : 0.5;
    const [a, b, x] = byRatio ? [Math.log(first), Math.log(last), Math.log(sorted[i]!.value as number)] : [first, last, sorted[i]!.value as number];
    return b > a ? (x - a) / (b - a) : 0.5;
  };
  const low = Math.min(...sorted.map((p) => p.v)), high = Math.max(...sorted.map((p) => p.v));
  const half = high > low ? 0 : Math.abs(high) || 1;
  const x = (i: number) => kMargin + along(i) * (100 - 2 * kMargin);
  const y = (v: number) => 100 - kMargin - ((v - (low - half)) / (high - low + 2 * half)) * (100 - 2 * kMargin);
  if (sorted.length === 0) return null;
  const told = sorted.map((p) => `${valueName(p.value)}: ${shortText(p.v)}`).join(", ");
  return (
    <figure className="plot against" data-quantity={quantity}>
      <div className="field" role="img" aria-label={`${titleOf(quantity)}, ${unitOf(quantity)}, against ${name}: ${told}`}>
        {someTicks(low - half, high + half, 3).map((v) => <i key={v} className="line" style={{ top: `${y(v)}%` }}><span>{shortText(v)}</span></i>)}
        <svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden>{numbers && <polyline points={sorted.map((p, i) => `${x(i)},${y(p.v)}`).join(" ")} />}</svg>
        {sorted.map((p, i) => <i key={i} className="dot" title={`${valueName(p.value)} ${unit}: ${shortText(p.v)} ${unitOf(quantity)}`} style={{ left: `${x(i)}%`, top: `${y(p.v)}%` }} />)}
      </div>
      <div className="axis">{sorted.map((p, i) => <span key={i} style={{ left: `${x(i)}%` }}>{valueName(p.value)}</span>)}<small>{unit}</small></div>
    </figure>
  );
}
