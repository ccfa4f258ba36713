// All frames of the run on a ruler: which are recorded, which one is shown, and their playback.
import { useEffect, useState } from "react";
import { Icon } from "../Icon";
import { advance, recordedFrames, ticks } from "../model/playback";
import { goOnFrom, lookAt } from "../model/recorded";
import { useStudio } from "../model/store";

const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 4];
const kTicks = 12;
/** Marks of frames that lie closer than this are one band. */
const kBand = 0.006;

/** Plays recorded frames while `way` is not 0. */
function usePlayback(speed: number, loop: boolean) {
  const [way, setWay] = useState<1 | -1 | 0>(0);
  const looking = useStudio((s) => s.looking !== null);
  // A step, Play and Reset end it.
  useEffect(() => {
    if (!looking) setWay(0);
  }, [looking]);
  useEffect(() => {
    if (way === 0) return;
    let stopped = false, before = performance.now();
    const begin = useStudio.getState();
    const end = begin.status.frame ?? 0;
    let at = begin.looking ?? end;
    const tick = async (now: number) => {
      const { status, looking: still } = useStudio.getState();
      if (stopped || still === null) return;
      const last = status.frame ?? 0;
      const rate = status.duration ? (status.frames ?? 0) / status.duration : 30;
      const next = advance(at, (now - before) / 1000, { rate, speed, way, loop, last });
      before = now;
      at = next.at;
      const frame = Math.min(Math.round(at), last);
      if (frame !== still || next.ended) await lookAt(frame, !next.ended || way < 0);
      if (stopped) return;
      if (next.ended) setWay(0);
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    return () => void (stopped = true);
  }, [way, speed, loop]);
  const play = async (to: 1 | -1) => {
    if (way === to) return setWay(0);
    const { looking: at, status } = useStudio.getState();
    const last = status.frame ?? 0;
    // From the end forwards is from the beginning.
    if (at === null || (to > 0 && at >= last) || (to < 0 && at === 0)) await lookAt(to > 0 ? 0 : last, true);
    setWay(to);
  };
  return { way, play, stop: () => setWay(0) };
}

export function Timeline() {
  const status = useStudio((s) => s.status);
  const looking = useStudio((s) => s.looking);
  const writer = useStudio((s) => s.role === "writer");
  const reset = useStudio((s) => s.sceneState.reset);
  const [speed, setSpeed] = useState(1);
  const [loop, setLoop] = useState(true);
  const { way, play, stop } = usePlayback(speed, loop);
  const frame = status.frame ?? 0;
  const frames = Math.max(status.frames ?? 0, frame, 1);
  const at = looking ?? frame;
  const share = (f: number) => `${(100 * f) / frames}%`;
  const idle = frame === 0;
  const go = (f: number) => (stop(), void lookAt(f));
  const every = status.recorded_every ?? 1;
  const dense = every / frames < kBand;
  const marks = dense ? [] : recordedFrames(frame, every);
  return (
    <div className="timeline" role="group" aria-label="Recorded frames">
      <button aria-label="First frame" title="First frame" disabled={idle} onClick={() => go(0)}><Icon name="first" /></button>
      <button aria-label="Recorded backwards" aria-pressed={way < 0} title="Play what is recorded, backwards" disabled={idle} onClick={() => void play(-1)}><Icon name={way < 0 ? "pause" : "back"} /></button>
      <button aria-label="Recorded forwards" aria-pressed={way > 0} title="Play what is recorded" disabled={idle} onClick={() => void play(1)}><Icon name={way > 0 ? "pause" : "play"} /></button>
      <button aria-label="Follow the run" title="The present frame: follow the run" disabled={looking === null} onClick={() => go(frame)}><Icon name="last" /></button>
      <button
        aria-label="Go back to this frame" disabled={!writer || looking === null || reset !== undefined} onClick={() => (stop(), void goOnFrom(at))}
        title={reset ? `${reset} has changed, which asks for a reset` : "The run goes back to the frame that is shown: from there it goes on with the values as they are now"}
      >
        <Icon name="branch" />
      </button>
      <button aria-label="Loop" aria-pressed={loop} title="Begin anew at the end" onClick={() => setLoop(!loop)}><Icon name="loop" /></button>
      <select aria-label="Speed of playback" title="Of playback, against real time" value={speed} onChange={(e) => setSpeed(Number(e.target.value))}>
        {kSpeeds.map((s) => <option key={s} value={s}>{s}×</option>)}
      </select>
      <div className="ruler" title={every > 1 ? `Memory is short: every ${every}th frame is kept, the nearest is shown` : undefined}>
        <i className={dense ? "recorded band" : "recorded"} style={{ width: share(frame) }} />
        {marks.map((f) => <i key={f} className="mark" style={{ left: share(f) }} />)}
        {status.frames !== undefined && ticks(0, frames, kTicks).filter(Number.isInteger).map((t) => <span key={t} className={t > 0.97 * frames ? "tick last" : "tick"} style={{ left: share(t) }}>{t.toLocaleString("en")}</span>)}
        <i className="present" style={{ left: share(frame) }} />
        <input
          type="range" aria-label="Frame" min={0} max={frames} value={at} disabled={idle}
          aria-valuetext={`frame ${at} of ${frames}`} onChange={(e) => go(Number(e.target.value))}
        />
      </div>
    </div>
  );
}
