// Play, pause, step, reset, and what the run and the view are at.
import { Icon } from "../Icon";
import { counted } from "../model/playback";
import { askRun, isPlaying, resetRun, togglePlay, useStudio } from "../model/store";
import { Cost } from "./Cost";
import { Health } from "./Health";

/** Of a preview, in spacings of the scene. */
const kCoarser = 2;

export function Transport() {
  const status = useStudio((s) => s.status);
  const devices = useStudio((s) => s.devices);
  const device = useStudio((s) => s.device);
  const reset = useStudio((s) => s.sceneState.reset);
  const problem = useStudio((s) => s.sceneState.problem);
  const writer = useStudio((s) => s.role === "writer");
  const shown = useStudio((s) => (s.looking === null || s.looking === s.status.frame ? null : s.shown));
  const playing = isPlaying(status), waits = playing && status.state === "building";
  const coarser = status.coarser ?? 1;

  const frame = status.frame ?? 0;
  const frames = status.frames ?? 0;
  const perStep = status.steps ? (1000 * (status.stepping_seconds ?? 0)) / status.steps : null;
  return (
    <footer className="transport" role="toolbar" aria-label="Run">
      <button disabled={!writer} onClick={() => void resetRun(device)} title="Build the scene again, and go to time 0 (R)" className={reset ? "wanted" : ""}><Icon name="reset" /> Reset</button>
      {playing ? (
        <button disabled={!writer} onClick={togglePlay} title={waits ? "Do not play when it is built (Space)" : "Pause (Space)"}><Icon name="pause" /> Pause</button>
      ) : (
        <button disabled={!writer || problem !== undefined} onClick={togglePlay} title="Play (Space)"><Icon name="play" /> Play</button>
      )}
      <button
        aria-pressed={coarser > 1} disabled={!writer || problem !== undefined} onClick={() => void resetRun(device, coarser > 1 ? 1 : kCoarser)}
        title={coarser > 1 ? "End the preview: the scene as it is, from time 0" : `A quick preview: ${kCoarser} times the spacing, from time 0. The scene stays as it is`}
      >
        Preview
      </button>
      {coarser > 1 && <span className="preview-hint" role="status">{coarser} × the spacing, no exports</span>}
      <button disabled={!writer || playing} onClick={() => void askRun("step")} title="One frame (.)"><Icon name="frame" /> Frame</button>
      <span className="time">
        {shown && <><b>frame {shown.frame}, {shown.time.toFixed(3)} s</b> · run: </>}
        {(status.time ?? 0).toFixed(3)} / {(status.duration ?? 0).toFixed(2)} s · frame {frame}/{frames}
      </span>
      <span className="load">
        {counted(status.particles ?? 0, "particle")}{perStep !== null && ` · ${perStep.toPrecision(3)} ms a step`}
      </span>
      <Cost />
      <Health />
      <span className={`state ${status.state}`}>{waits ? "building, then plays" : status.state}</span>
      <select aria-label="Device" value={device} disabled={!writer} onChange={(e) => useStudio.setState({ device: e.target.value })} title={status.device}>
        {["auto", ...devices.map((d) => d.name)].map((d) => <option key={d} value={d}>{d}</option>)}
      </select>
      {reset && <span className="reset-hint" role="status" title={`${reset} changed: reset to see it`}>{reset} changed: reset to see it</span>}
    </footer>
  );
}
