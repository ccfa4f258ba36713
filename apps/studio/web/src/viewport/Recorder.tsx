// Records a video with the view's camera, on the server.
import { useEffect, useState } from "react";
import { Dialog } from "../files/Dialog";
import { fileNameOf } from "../model/names";
import { counted } from "../model/playback";
import { askRun, client, request, resetRun, useStudio, type Status, type Video } from "../model/store";
import { addressOfFile, freePath } from "../protocol/client";
import type { View } from "./view";

const kSizes: [number, number][] = [[1280, 720], [1920, 1080], [3840, 2160], [720, 720]];
const kCameraMs = 80;

/** Which frames a video has: those recorded so far, those that come, or all of a run that begins anew. */
type Frames = "recorded" | "coming" | "anew";

const recordedHint = (frames: number, whole: number): string =>
  whole < frames
    ? `Of ${counted(frames, "frame")} ${whole.toLocaleString("en")} are kept whole. The others are too fast to keep, or memory is short: the video repeats the one before. "All, run again" has each.`
    : `All ${counted(frames, "frame")} of the run as they were, seen from the view's camera as it is now. Nothing is run again.`;

/** "12 frames", and of recorded ones how many they will be, or how many of them were kept. */
function framesText({ state, frames, of, whole }: Video): string {
  if (of === undefined) return counted(frames, "frame");
  if (state === "recording") return `${frames.toLocaleString("en")} of ${of.toLocaleString("en")}`;
  return whole !== undefined && whole < frames ? `${counted(frames, "frame")}, ${whole.toLocaleString("en")} of them kept` : counted(frames, "frame");
}

/** Resets the run, and waits until it is built or has failed. */
async function toTheBeginning(): Promise<void> {
  await resetRun();
  await new Promise<void>((resolve) => {
    const built = (s: { status: Status }) => s.status.state === "failed" || (s.status.state === "paused" && s.status.frame === 0);
    if (built(useStudio.getState())) return resolve();
    const leave = useStudio.subscribe((s) => built(s) && (leave(), resolve()));
  });
}

function StartDialog({ view, onClose }: { view: View; onClose(): void }) {
  const title = useStudio((s) => s.scene.title);
  const endings = useStudio((s) => s.pictures.videos);
  const [path, setPath] = useState(() => `${fileNameOf(title)}${endings[0] ?? ".mp4"}`);
  // No video takes the place of an earlier one.
  useEffect(() => void freePath(path).then((free) => setPath((now) => (now === path ? free : now))), []);
  const [size, setSize] = useState(0);
  const wrong = !endings.some((e) => path.endsWith(e));
  const status = useStudio((s) => s.status);
  const ended = status.state === "finished" || status.state === "failed";
  const there = (status.frame ?? 0) + 1, whole = status.whole ?? 0;
  const canReplay = there > 1 && whole > 1 && status.state !== "playing" && status.state !== "building";
  const [frames, setFrames] = useState<Frames>(!ended ? "coming" : canReplay ? "recorded" : "anew");
  const anew = frames === "anew", recorded = frames === "recorded" && canReplay;
  const start = async () => {
    const [width, height] = kSizes[size]!;
    const pose = view.pose();
    if (anew) await toTheBeginning();
    if (!(await request("video.start", { path, ...pose, width, height, ...(recorded && { recorded }) }))) return;
    onClose();
    if (anew) void askRun("play");
  };
  return (
    <Dialog title="Record a video" onClose={onClose}>
      <h2>Record a video</h2>
      <form onSubmit={(e) => (e.preventDefault(), void start())}>
        <label className="row"><span className="name">File</span>
          <input aria-label="Video file" data-first aria-invalid={wrong} value={path} onChange={(e) => setPath(e.target.value)} />
        </label>
        <label className="row"><span className="name">Size</span>
          <select aria-label="Video size" value={size} onChange={(e) => setSize(Number(e.target.value))}>
            {kSizes.map(([w, h], i) => <option key={i} value={i}>{w} × {h}</option>)}
          </select>
        </label>
        <label className="row"><span className="name">Frames</span>
          <select aria-label="Frames of the video" value={frames} onChange={(e) => setFrames(e.target.value as Frames)}>
            {canReplay && <option value="recorded">recorded so far</option>}
            <option value="coming">from this one on</option>
            <option value="anew">all, run again</option>
          </select>
        </label>
        <p className="hint">{wrong ? `The name ends in ${endings.join(", ")}.` : recorded ? recordedHint(there, whole) : anew ? "The scene is reset and played, so that the video has all of its frames." : ended ? "The run has ended: the video would have its last frame alone." : "Every frame from this one on, seen from the view's camera, also while it moves."}</p>
        <button type="submit" className="wanted" disabled={wrong}>Record</button> <button type="button" onClick={onClose}>Cancel</button>
      </form>
    </Dialog>
  );
}

export function Recorder({ view }: { view: View | null }) {
  const [asking, setAsking] = useState(false);
  const video = useStudio((s) => s.video);
  const pictures = useStudio((s) => s.pictures);
  const writer = useStudio((s) => s.role === "writer");
  const recording = video.state === "recording";
  useEffect(() => {
    if (!view || !recording || !writer) return;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const send = () => ((timer = undefined), void client.ask("video.camera", view.pose()).catch(() => {}));
    const leave = view.onCamera(() => (timer ??= setTimeout(send, kCameraMs)));
    return () => (clearTimeout(timer), leave());
  }, [view, recording, writer]);
  const preview = useStudio((s) => (s.status.coarser ?? 1) > 1);
  const why = preview ? "A preview is not written as a video: end it, and play" : pictures.problem?.message;
  return (
    <>
      {recording ? (
        <button className="recording" aria-label={`Finish the video, ${framesText(video)}`} disabled={!writer} onClick={() => void request("video.stop")} title={`Finish ${video.path}`}>■ {framesText(video)}</button>
      ) : (
        <button aria-label="Record" disabled={!writer || why !== undefined || video.state === "finishing"} onClick={() => setAsking(true)} title={why ?? "Record a video with this camera"}>● Record</button>
      )}
      {video.state === "finishing" && <span role="status" className="told">finishing {video.path}…</span>}
      {video.state === "done" && <a className="told" href={addressOfFile(video.path)} target="_blank" rel="noreferrer">{video.path} ({framesText(video)})</a>}
      {video.state === "failed" && <span role="alert" className="told lost">the video failed: {video.problem?.message}</span>}
      {asking && view && <StartDialog view={view} onClose={() => setAsking(false)} />}
    </>
  );
}
