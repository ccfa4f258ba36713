// What the scene looked like last, kept beside its file: lists of scenes and versions show it.
import { useStudio } from "../model/store";
import { uploadPicture } from "../protocol/client";
import { mainView } from "../viewport/view";

const kWidth = 320;
const kHeight = 180;
const kQuality = 0.8;

/** Where the picture of a scene without a file lies. */
export const kUntitled = "untitled.json";

let at = "";

/** Keeps a picture of what is seen, unless there is one of the same frame of the same run. */
export function keepThumbnail(): void {
  const { sceneState, status, builds, role } = useStudio.getState();
  const now = `${sceneState.path} ${builds} ${status.frame}`;
  if (role !== "writer" || (status.coarser ?? 1) > 1 || !mainView.current || now === at) return;
  at = now;
  mainView.current.picture(kWidth, kHeight).toBlob((jpeg) => {
    // Without a picture a scene is as good as before.
    if (jpeg) void uploadPicture(sceneState.path || kUntitled, jpeg).catch(() => {});
  }, "image/jpeg", kQuality);
}

const kSeenMs = 400;

/** A run that comes to rest has something to show. */
useStudio.subscribe((now, before) => {
  const rests = (s: typeof now) => s.status.state === "paused" || s.status.state === "finished";
  if (rests(now) && !rests(before) && (now.status.frame ?? 0) > 0) setTimeout(keepThumbnail, kSeenMs);
});
