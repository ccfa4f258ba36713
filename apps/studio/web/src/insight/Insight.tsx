// What the run is like: where its time goes, plots, the device and its memory, and the log.
import { Fragment, useMemo, useState } from "react";
import { useStudio } from "../model/store";
import { msText } from "../model/time";
import { partsOf, titleOf } from "../model/quantities";
import type { JsonObject } from "../model/types";
import { ParticleTable } from "./ParticleTable";
import { Plot } from "./Plot";

const kUsual = /compression\.mean|kinetic|potential|iterations|momentum|step \(ms\)|particles$|volume/;

function Times() {
  const times = useStudio((s) => s.numbers?.["modules_ms"]) as { [path: string]: { per_step: number } } | undefined;
  const rows = Object.entries(times ?? {}).filter(([path]) => path.split("/").length === 2).sort((a, b) => b[1].per_step - a[1].per_step);
  const most = rows[0]?.[1].per_step ?? 1;
  if (rows.length === 0) return <p className="hint">No steps yet.</p>;
  return (
    <table className="times">
      <tbody>
        {rows.map(([path, t]) => (
          <tr key={path}>
            <th>{path}</th>
            <td><i style={{ width: `${(100 * t.per_step) / most}%` }} /></td>
            <td>{msText(t.per_step)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Plots() {
  const samples = useStudio((s) => s.samples);
  const cursor = useStudio((s) => (s.looking === null ? null : s.shown?.time ?? null));
  const pinned = useStudio((s) => s.pinned);
  const others = useMemo(() => (pinned ? [pinned] : []), [pinned]);
  const [filter, setFilter] = useState("");
  // What the selected node measures comes first: it is there for nothing else, as it gives nothing on.
  const selected = useStudio((s) => {
    const one = s.selected.length === 1 ? s.selected[0]! : null;
    return one !== null && s.types?.nodes[s.scene.nodes[one]?.type ?? ""]?.outputs.length === 0 ? one : null;
  });
  const names = useMemo(() => Object.keys(samples.at(-1)?.values ?? {}), [samples]);
  const own = (n: string) => selected !== null && n.startsWith(`${selected}.`);
  const shown = names.filter((n) => (filter ? `${n} ${titleOf(n)}`.includes(filter) : own(n) || kUsual.test(n)))
    .sort((a, b) => Number(own(b)) - Number(own(a))).slice(0, 24);
  return (
    <>
      <input aria-label="Filter plots" placeholder="Filter, such as momentum" value={filter} onChange={(e) => setFilter(e.target.value)} />
      <div className="plots">
        {shown.map((n, i) => {
          const { node, quantity } = partsOf(n);
          // What stands above the plots of a node need not stand above each.
          return (
            <Fragment key={n}>
              {node !== partsOf(shown[i - 1] ?? "").node && <h3>{node || "The run"}</h3>}
              <Plot name={n} title={quantity} samples={samples} cursor={cursor} others={others} />
            </Fragment>
          );
        })}
      </div>
    </>
  );
}

function DeviceUse() {
  const busy = useStudio((s) => s.status.device_busy ?? 0);
  const memory = useStudio((s) => s.numbers?.["memory"]) as JsonObject | undefined;
  const rows = Object.entries(memory ?? {}).filter((r): r is [string, number] => typeof r[1] === "number");
  return (
    <table>
      <tbody>
        <tr title="The share of the last second that steps took"><th>device busy</th><td>{(100 * busy).toFixed(0)} %</td></tr>
        {rows.map(([name, v]) => (
          <tr key={name}><th>{name.replaceAll("_", " ")}</th><td>{name.endsWith("bytes") ? `${(v / 2 ** 20).toFixed(1)} MiB` : v}</td></tr>
        ))}
      </tbody>
    </table>
  );
}

function LogView() {
  const log = useStudio((s) => s.log);
  const warnings = useStudio((s) => s.sceneState.warnings);
  const events = useStudio((s) => s.numbers?.["rare_events"]) as { node: string; what: string; count: number }[] | undefined;
  const [level, setLevel] = useState("info");
  const [filter, setFilter] = useState("");
  const levels = ["debug", "info", "warning", "error"];
  const shown = log.filter((l) => levels.indexOf(l.level) >= levels.indexOf(level) && l.text.toLowerCase().includes(filter.toLowerCase()));
  return (
    <>
      <select aria-label="Least level" value={level} onChange={(e) => setLevel(e.target.value)}>{levels.map((l) => <option key={l}>{l}</option>)}</select>{" "}
      <input aria-label="Filter the log" placeholder="Filter" value={filter} onChange={(e) => setFilter(e.target.value)} />
      <div role="log" aria-label="Log">
      <ul className="log">
        {warnings.map((w) => <li key={w} className="warning">{w}</li>)}
        {events?.map((e) => <li key={e.node + e.what} className="warning">{e.node}: {e.count} {e.what}</li>)}
        {shown.map((l, i) => <li key={i} className={l.level}><time>{new Date(l.at).toLocaleTimeString()}</time> {l.text}</li>)}
      </ul>
      </div>
    </>
  );
}

const kTabs = { Time: Times, Plots, Particles: ParticleTable, Device: DeviceUse, Log: LogView } as const;

export function Insight() {
  const [tab, setTab] = useState<keyof typeof kTabs>("Plots");
  const Shown = kTabs[tab];
  return (
    <section className="insight" aria-label="Insight">
      <div role="tablist">
        {(Object.keys(kTabs) as (keyof typeof kTabs)[]).map((t) => (
          <button key={t} role="tab" aria-selected={t === tab} onClick={() => setTab(t)}>{t}</button>
        ))}
      </div>
      <div role="tabpanel"><Shown /></div>
    </section>
  );
}
