// Records a video with the view's camera, on the server.
import { useEffect, useState } from "react";
import { Dialog } from "../files/Dialog";
import { fileNameOf } from "../model/names";
import { counted } from "../model/playback";
import { askRun, client, request, resetRun, useStudio, type Status } from "../model/store";
import { addressOfFile, freePath } from "../protocol/client";
import type { View } from "./view";

const kSizes: [number, number][] = [[1280, 720], [1920, 1080], [3840, 2160], [720, 720]];
const kCameraMs = 80;

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
  const ended = useStudio((s) => s.status.state === "finished");
  const [anew, setAnew] = useState(ended);
  const start = async () => {
    const [width, height] = kSizes[size]!;
    const pose = view.pose();
    if (anew) await toTheBeginning();
    if (!(await request("video.start", { path, ...pose, width, height }))) return;
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
        <label className="row"><span className="name">From the beginning</span>
          <input type="checkbox" className="switch" role="switch" aria-label="From the beginning" checked={anew} onChange={(e) => setAnew(e.target.checked)} />
        </label>
        <p className="hint">{wrong ? `The name ends in ${endings.join(", ")}.` : anew ? "The scene is reset and played, so that the video has all of its frames." : ended ? "The run has ended: the video would have its last frame alone." : "Every frame from this one on, seen from the view's camera, also while it moves."}</p>
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
        <button className="recording" aria-label={`Finish the video, ${counted(video.frames, "frame")}`} disabled={!writer} onClick={() => void request("video.stop")} title={`Finish ${video.path}`}>■ {counted(video.frames, "frame")}</button>
      ) : (
        <button aria-label="Record" disabled={!writer || why !== undefined || video.state === "finishing"} onClick={() => setAsking(true)} title={why ?? "Record a video with this camera"}>● Record</button>
      )}
      {video.state === "finishing" && <span role="status" className="told">finishing {video.path}…</span>}
      {video.state === "done" && <a className="told" href={addressOfFile(video.path)} target="_blank" rel="noreferrer">{video.path} ({counted(video.frames, "frame")})</a>}
      {video.state === "failed" && <span role="alert" className="told lost">the video failed: {video.problem?.message}</span>}
      {asking && view && <StartDialog view={view} onClose={() => setAsking(false)} />}
    </>
  );
}
