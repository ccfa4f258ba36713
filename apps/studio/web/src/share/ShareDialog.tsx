// The run as one HTML file, which replays it wherever there is a browser.
import { useState } from "react";
import { Dialog } from "../files/Dialog";
import { fileNameOf } from "../model/names";
import { counted } from "../model/playback";
import { gatherRun } from "../model/recorded";
import { askRun, say, useStudio } from "../model/store";
import { linesOf, outlinesOf } from "../viewport/outlines";
import { save } from "./download";
import { replayPage, type ReplayLook } from "./replay";

const kEvery = [1, 2, 4, 8];
/** Bytes of a particle in a frame, as text in the page: two thirds of 8, times 4 / 3. */
const kBytes = 7;

const sizeText = (bytes: number): string => (bytes < 2 ** 20 ? "less than 1 MB" : `about ${Math.round(bytes / 2 ** 20)} MB`);

export function ShareDialog({ look, onClose }: { look(): Omit<ReplayLook, "lines">; onClose(): void }) {
  const status = useStudio((s) => s.status);
  const gathering = useStudio((s) => s.gathering);
  const [every, setEvery] = useState(1);
  const [busy, setBusy] = useState(false);
  const recorded = Math.floor((status.frame ?? 0) / (status.recorded_every ?? 1)) + 1;
  const frames = Math.ceil(recorded / every);
  const write = async () => {
    setBusy(true);
    try {
      if (useStudio.getState().status.state === "playing") await askRun("pause");
      const run = await gatherRun("A", Infinity);
      const kept = { ...run, frames: run.frames.filter((_, i) => i % every === 0) };
      const { types } = useStudio.getState();
      const lines = linesOf(types ? outlinesOf(run.scene, types).values() : []);
      save(await replayPage(kept, run.scene, { ...look(), lines }), `${fileNameOf(run.scene.title)}.html`);
      onClose();
    } catch (e) {
      say(e);
    }
    setBusy(false);
  };
  return (
    <Dialog title="Share the run" onClose={onClose}>
      <h2>Share the run as one file</h2>
      <p>An HTML file that replays what is recorded in any browser, without Weir: it is turned, zoomed and played there. It carries the scene: dropped on the studio, that opens.</p>
      <form onSubmit={(e) => (e.preventDefault(), void write())}>
        <label className="row"><span className="name">Frames</span>
          <select aria-label="Frames" value={every} onChange={(e) => setEvery(Number(e.target.value))}>
            {kEvery.map((n) => <option key={n} value={n}>{n === 1 ? "all that are recorded" : `every ${n}${n === 2 ? "nd" : "th"}`}</option>)}
          </select>
        </label>
        <p className="hint" role="status">{gathering ? `Frame ${gathering.done} of ${gathering.all}…` : `${counted(frames, "frame")} of ${counted(status.particles ?? 0, "particle")}, ${sizeText(frames * (status.particles ?? 0) * kBytes)}.`}</p>
        <button type="submit" data-first className="wanted" disabled={busy}>Save the file</button> <button type="button" onClick={onClose}>Cancel</button>
      </form>
    </Dialog>
  );
}
