// Play, pause, step, reset, and a slider through the frames that were recorded.
import { useEffect, useState } from "react";
import { Icon } from "../Icon";
import { askRun, request, resetRun, useStudio } from "../model/store";

export function Transport() {
  const status = useStudio((s) => s.status);
  const devices = useStudio((s) => s.devices);
  const device = useStudio((s) => s.device);
  const reset = useStudio((s) => s.sceneState.reset);
  const problem = useStudio((s) => s.sceneState.problem);
  const writer = useStudio((s) => s.role === "writer");
  const [seek, setSeek] = useState<number | null>(null);
  const playing = status.state === "playing";
  useEffect(() => {
    if (playing) setSeek(null);
  }, [playing]);

  const frame = status.frame ?? 0;
  const frames = status.frames ?? 0;
  const perStep = status.steps ? (1000 * (status.stepping_seconds ?? 0)) / status.steps : null;
  const go = (to: number) => {
    setSeek(to);
    void request("run.seek", { frame: to });
  };
  return (
    <footer className="transport" role="toolbar" aria-label="Run">
      <button disabled={!writer} onClick={() => void resetRun(device)} title="Build the scene again, and go to time 0 (R)" className={reset ? "wanted" : ""}><Icon name="reset" /> Reset</button>
      {playing ? (
        <button disabled={!writer} onClick={() => void askRun("pause")} title="Pause (Space)"><Icon name="pause" /> Pause</button>
      ) : (
        <button disabled={!writer || problem !== undefined} onClick={() => void askRun("play")} title="Play (Space)"><Icon name="play" /> Play</button>
      )}
      <button disabled={!writer || playing} onClick={() => void askRun("step")} title="One frame (.)"><Icon name="frame" /> Frame</button>
      <input
        type="range" aria-label="Frame" min={0} max={Math.max(frame, 1)} value={seek ?? frame} disabled={frame === 0}
        onChange={(e) => go(Number(e.target.value))}
      />
      <span className="time">
        {seek !== null && seek !== frame ? `frame ${seek}, ` : ""}
        {(status.time ?? 0).toFixed(3)} / {(status.duration ?? 0).toFixed(2)} s · frame {frame}/{frames}
      </span>
      <span className="load">
        {(status.particles ?? 0).toLocaleString("en")} particles{perStep !== null && ` · ${perStep.toPrecision(3)} ms a step`}
      </span>
      <span className={`state ${status.state}`}>{status.state}</span>
      <select aria-label="Device" value={device} disabled={!writer} onChange={(e) => useStudio.setState({ device: e.target.value })} title={status.device}>
        {["auto", ...devices.map((d) => d.name)].map((d) => <option key={d} value={d}>{d}</option>)}
      </select>
      {reset && <span className="reset-hint" role="status">{reset} changed: reset to see it</span>}
    </footer>
  );
}
