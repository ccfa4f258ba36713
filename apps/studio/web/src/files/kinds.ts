// What a file that was dropped may be, by its name.

export type FileKind = "scene" | "mesh" | "particles" | "carrier" | "other";

const kEndings: { [ending: string]: FileKind } = { json: "scene", csv: "particles", vtkhdf: "particles", html: "carrier", png: "carrier" };
for (const video of ["mp4", "mov", "mkv", "webm", "gif"]) kEndings[video] = "carrier";
for (const mesh of ["obj", "stl", "ply", "off", "gltf", "glb", "fbx", "dae", "3ds", "3mf"]) kEndings[mesh] = "mesh";

export const kindOfFile = (name: string): FileKind => kEndings[/\.([^./]+)$/.exec(name.toLowerCase())?.[1] ?? ""] ?? "other";

/** "cup" of "folder/cup.obj" */
export const stemOf = (name: string): string => name.split("/").at(-1)!.replace(/\.[^.]*$/, "");

/** Whether a text is a scene: what a file of another program holds is not. */
export function isScene(text: string): boolean {
  try {
    const v: unknown = JSON.parse(text);
    return typeof v === "object" && v !== null && "weir" in v && "nodes" in v;
  } catch {
    return false;
  }
}
