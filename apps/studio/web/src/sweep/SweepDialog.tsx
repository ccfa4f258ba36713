// Several values of one parameter, each run to its end: pictures side by side at one time, and a quantity against the value.
import { useEffect, useMemo, useRef, useState } from "react";
import { Dialog } from "../files/Dialog";
import { Plot } from "../insight/Plot";
import { copyText } from "../Menu";
import { evaluate } from "../model/expression";
import { labelOf, unitText } from "../model/parameters";
import { counted } from "../model/playback";
import { titleOf } from "../model/quantities";
import { paramsOf, setParam } from "../model/scene";
import { edit, resetRun, say, useStudio, type Sweepable } from "../model/store";
import { commandOf, evenly, firstValues, kMost, kReadings, readValues, tableOf, valueName, type Reading, type Tried } from "../model/sweep";
import type { Json } from "../model/types";
import { AgainstValue } from "./AgainstValue";
import { Pictures } from "./Pictures";
import { sweep } from "./sweep";

const kUsualQuantity = /compression\.mean|kinetic/;

/** Numbers from one to another. */
function Range({ onValues, first }: { onValues(values: number[]): void; first: number[] }) {
  const [[from, to, count, ratio], set] = useState<[string, string, number, boolean]>([String(first[0] ?? 0), String(first.at(-1) ?? 1), Math.max(first.length, 2), true]);
  const put = (f: string, t: string, n: number, r: boolean) => {
    set([f, t, n, r]);
    const [low, high] = [evaluate(f), evaluate(t)];
    if (low !== null && high !== null) onValues(evenly(low, high, n, r));
  };
  return (
    <div className="row"><span className="name">From, to, how many</span>
      <span className="range">
        <input aria-label="From" value={from} onChange={(e) => put(e.target.value, to, count, ratio)} />
        <input aria-label="To" value={to} onChange={(e) => put(from, e.target.value, count, ratio)} />
        <input aria-label="How many" type="number" min={2} max={kMost} value={count} onChange={(e) => put(from, to, Math.min(Math.max(Number(e.target.value), 2), kMost), ratio)} />
        <label title="Equal ratios in place of equal differences"><input type="checkbox" checked={ratio} onChange={(e) => put(from, to, count, e.target.checked)} /> by ratio</label>
      </span>
    </div>
  );
}

/** How long one run takes, as far as the present one tells. */
function usePace(): string {
  const { time = 0, duration = 0, stepping_seconds: spent = 0 } = useStudio((s) => s.status);
  return time > 0 && spent > 0 ? `about ${counted(Math.ceil((spent / time) * duration), "second")} each, as the present run` : `${duration.toFixed(2)} s of simulated time each`;
}

function Ask({ of, onStart, onClose }: { of: Sweepable; onStart(values: Json[]): void; onClose(): void }) {
  const p = of.parameter;
  const first = useMemo(() => {
    const { scene } = useStudio.getState();
    const given = of.path.reduce<Json | undefined>((v, k) => (v !== null && typeof v === "object" && !Array.isArray(v) ? v[k] : undefined), paramsOf(scene, of.owner));
    return firstValues(p, given ?? p.default);
  }, [of, p]);
  const [text, setText] = useState(first.map(valueName).join(", "));
  const { values, problem } = readValues(p, text);
  const pace = usePace();
  const file = useStudio((s) => s.sceneState.path);
  const command = commandOf(file, of.owner, of.path, values);
  return (
    <form onSubmit={(e) => (e.preventDefault(), problem === null && onStart(values))}>
      {typeof first[0] === "number" && <Range first={first as number[]} onValues={(v) => setText(v.join(", "))} />}
      <label className="row"><span className="name">Values{p.unit && <small> {p.unit}</small>}</span>
        <input data-first aria-label="Values" aria-invalid={problem !== null} value={text} onChange={(e) => setText(e.target.value)} />
      </label>
      {problem && <p role="alert">{problem}</p>}
      <p className="hint">{counted(values.length, "run")} of the scene, one after another: {pace}. The scene stays as it is.</p>
      {file && problem === null && (
        <details>
          <summary>On a cluster, or several at once</summary>
          <p className="hint">The same of the file as it was saved. Further parameters make a grid or samples; see <code>weir sweep --help</code>.</p>
          <pre aria-label="The sweep as a command">{command}</pre> <button type="button" onClick={() => void copyText(command)}>Copy the command</button>
        </details>
      )}
      <button type="submit" className="wanted" disabled={problem !== null}>Start</button> <button type="button" onClick={onClose}>Cancel</button>
    </form>
  );
}

export function SweepDialog() {
  const of = useStudio((s) => s.sweeping);
  return of ? <Sweep key={JSON.stringify([of.owner, of.path])} of={of} /> : null;
}

const nameOf = (of: Sweepable): string => {
  const owner = "section" in of.owner ? labelOf(of.owner.section) : "module" in of.owner ? `${of.owner.node} / ${of.owner.module}` : of.owner.node;
  return `${owner}: ${of.path.map(labelOf).join(" / ")}`;
};

function Sweep({ of }: { of: Sweepable }) {
  const [values, setValues] = useState<Json[] | null>(null);
  const [tried, setTried] = useState<Tried[]>([]);
  const [running, setRunning] = useState(false);
  const stop = useRef<AbortController | null>(null);
  const status = useStudio((s) => s.status);
  useEffect(() => () => stop.current?.abort(), []);
  const close = () => {
    stop.current?.abort();
    useStudio.setState({ sweeping: null });
  };
  const start = async (chosen: Json[]) => {
    setValues(chosen);
    setRunning(true);
    stop.current = new AbortController();
    await sweep(chosen, of.owner, of.path, (i, t) => setTried((all) => Object.assign([...all], { [i]: t })), stop.current.signal).catch(say);
    setRunning(false);
    await resetRun();
  };
  const name = nameOf(of);
  const use = (t: Tried) => {
    edit((s) => setParam(s, of.owner, of.path, t.value));
    close();
    void resetRun();
  };
  return (
    <Dialog title={`Sweep ${name}`} className={values ? "sweep wide" : "sweep"} onClose={close}>
      <h2>Sweep {name}{of.parameter.unit && <small> {unitText(of.parameter.unit)}</small>}</h2>
      {!values && <Ask of={of} onStart={(v) => void start(v)} onClose={close} />}
      {values && (
        <>
          {running && (
            <p role="status" className="progress">
              <progress aria-label="Runs" value={tried.length + (status.frames ? (status.frame ?? 0) / status.frames : 0)} max={values.length} />
              {valueName(values[Math.min(tried.length, values.length - 1)]!)}, run {Math.min(tried.length + 1, values.length)} of {values.length}, {status.state}
              <button onClick={() => stop.current?.abort()}>Stop</button>
            </p>
          )}
          <Results name={name} tried={tried} unit={of.parameter.unit ?? ""} onUse={running ? null : use} onCompare={running ? null : (t) => (useStudio.setState({ pinned: t.run && { ...t.run, label: "A" } }), close())} />
          <button onClick={() => void copyText(tableOf(of.path.at(-1)!, tried))} disabled={tried.length === 0} title="All quantities at the end of each run">Copy the table (CSV)</button>{" "}
          <button onClick={close}>{running ? "Stop and close" : "Close"}</button>
        </>
      )}
    </Dialog>
  );
}

function Results({ name, tried, unit, onUse, onCompare }: {
  name: string; tried: Tried[]; unit: string; onUse: ((t: Tried) => void) | null; onCompare: ((t: Tried) => void) | null;
}) {
  const names = useMemo(() => [...new Set(tried.flatMap((t) => Object.keys(t.run?.samples.at(-1)?.values ?? {})))].sort(), [tried]);
  const [wish, setWish] = useState<string | null>(null);
  const quantity = wish ?? names.find((n) => kUsualQuantity.test(n)) ?? names[0] ?? null;
  const [reading, setReading] = useState<Reading>("last");
  const [time, setTime] = useState<number | null>(null);
  const runs = useMemo(() => tried.flatMap((t) => (t.run ? [t.run] : [])), [tried]);
  const longest = Math.max(0, ...runs.map((r) => r.frames.at(-1)?.time ?? 0));
  return (
    <>
      <Pictures tried={tried} unit={unit} time={time ?? longest} onUse={onUse} onCompare={onCompare} />
      {runs.length > 0 && (
        <label className="row"><span className="name">Time <small>{(time ?? longest).toFixed(3)} s</small></span>
          <input type="range" aria-label="Time of the pictures" min={0} max={longest} step={longest / 200 || 1} value={time ?? longest} onChange={(e) => setTime(Number(e.target.value))} />
        </label>
      )}
      {quantity !== null && (
        <div className="read">
          <div>
            <select aria-label="Quantity" value={quantity} onChange={(e) => setWish(e.target.value)}>{names.map((n) => <option key={n} value={n}>{titleOf(n)}</option>)}</select>{" "}
            <select aria-label="Reading" value={reading} onChange={(e) => setReading(e.target.value as Reading)}>{Object.keys(kReadings).map((r) => <option key={r}>{r}</option>)}</select>
            <AgainstValue name={name} unit={unit} tried={tried} quantity={quantity} reading={reading} />
          </div>
          {runs.length > 0 && <Plot name={quantity} samples={runs[0]!.samples} cursor={time} others={runs.slice(1)} />}
        </div>
      )}
    </>
  );
}
