// Files that are dropped on the page: scenes are opened, meshes are asked about, particles are read; all else is refused.
import { surface } from "../graph/surface";
import { withMesh, withParticles, type Reading, type Use } from "../model/fromFile";
import type { Scene } from "../model/scene";
import { openScene } from "../model/documents";
import { edit, resetRun, say, useStudio } from "../model/store";
import type { Types } from "../model/types";
import { freePath, upload } from "../protocol/client";
import { sceneIn } from "../share/carried";
import { isScene, kindOfFile, stemOf } from "./kinds";

type Place = { x: number; y: number };

const kBeside = 40;

/** Copies a file to the served folder, beside what is there. */
async function put(wish: string, file: File): Promise<string> {
  const path = await freePath(wish);
  await upload(path, file);
  return path;
}

/** Changes the scene; what is not yet under way is built again, so that the change is seen. */
function add(change: (scene: Scene, types: Types) => [Scene, string]): void {
  const { types, status } = useStudio.getState();
  if (!types) return;
  edit((s) => {
    const [next, name] = change(s, types);
    useStudio.setState({ selected: [name], selectedLinks: [] });
    return next;
  });
  if ((status.frame ?? 0) === 0 && status.state !== "playing") void resetRun();
}

export async function useMesh(file: File, use: Use, at: Place, how: Reading = {}): Promise<void> {
  try {
    const path = await put(`meshes/${file.name}`, file);
    add((s, types) => withMesh(s, types, path, stemOf(file.name), use, at, how));
  } catch (e) {
    say(e);
  }
}

async function take(file: File, at: Place): Promise<void> {
  const kind = kindOfFile(file.name);
  if (kind === "mesh") return useStudio.setState((s) => ({ dropped: [...s.dropped, { file, at }] }));
  if (kind === "particles") {
    const path = await put(`particles/${file.name}`, file);
    return add((s, types) => withParticles(s, types, path, stemOf(file.name), at));
  }
  if (kind === "scene" && isScene(await file.text())) return openScene({ path: await put(file.name, file) });
  if (kind === "carrier") {
    const scene = sceneIn(new Uint8Array(await file.arrayBuffer()));
    if (scene !== null && isScene(scene)) return openScene({ path: await put(`${stemOf(file.name)}.json`, new File([scene], "scene.json")) });
    throw new Error(`${file.name} carries no scene: pictures, videos and replays that the studio writes do`);
  }
  throw new Error(
    kind === "scene"
      ? `${file.name} is not a scene of Weir: it has no "weir" and "nodes"`
      : `${file.name} is neither a scene (.json, or a picture, video or replay of the studio) nor a mesh (.obj, .stl, .ply, .gltf and others) nor particles (.csv, .vtkhdf)`,
  );
}

export async function takeFiles(files: FileList, at: Place = surface.middle()): Promise<void> {
  if (useStudio.getState().role !== "writer") return say(new Error("another window has the pen: take it to make changes here"));
  for (const [i, file] of [...files].entries()) await take(file, { x: at.x + i * kBeside, y: at.y + i * kBeside }).catch(say);
}
