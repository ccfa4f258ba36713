// Files that are dropped on the page.
import { addNode, setParam, type Scene } from "../model/scene";
import { edit, say, useStudio } from "../model/store";
import { freePath, upload } from "../protocol/client";

const kBelow = 160;
const kBeside = 40;

/** Where nothing stands yet. */
function placeBelow(scene: Scene): { x: number; y: number } {
  const all = Object.values(scene.layout?.nodes ?? {});
  if (all.length === 0) return { x: 0, y: 0 };
  return { x: Math.min(...all.map((p) => p.x)), y: Math.max(...all.map((p) => p.y)) + kBelow };
}

/** Meshes are copied to the served folder, and become nodes, where they were dropped or below all others. */
export async function takeFiles(files: FileList, at?: { x: number; y: number }): Promise<void> {
  for (const [i, file] of [...files].entries())
    try {
      const path = await freePath(`meshes/${file.name}`);
      await upload(path, file);
      edit((s) => {
        const place = at ? { x: at.x + i * kBeside, y: at.y + i * kBeside } : placeBelow(s);
        const [next, name] = addNode(s, "MeshFile", place, file.name.replace(/\.[^.]*$/, ""));
        useStudio.setState({ selected: [name], selectedLinks: [] });
        return setParam(next, { node: name }, ["file"], path);
      });
    } catch (e) {
      say(e);
    }
}
