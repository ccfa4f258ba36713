// Names of files.

const kDigits = 3;

/** "A jet fills a goblet" → "a_jet_fills_a_goblet" */
export const fileNameOf = (title: string | undefined): string =>
  (title ?? "").toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_|_$/g, "") || "scene";

/** The path, or if it is taken, the first with a number that is not: "a_001.mp4". */
export function withNumber(path: string, isTaken: (path: string) => boolean): string {
  const [, stem, ending] = /^(.*?)(\.[^./]*)?$/s.exec(path)!;
  for (let n = 0; ; ++n) {
    const next = n === 0 ? path : `${stem}_${String(n).padStart(kDigits, "0")}${ending ?? ""}`;
    if (!isTaken(next)) return next;
  }
}

/** Why a scene cannot be saved under a name, or null. */
export function pathProblem(path: string): string | null {
  if (path === "") return "A file needs a name.";
  if (path.endsWith("/")) return "That is a folder: a name behind the last / makes it a file.";
  if (path.includes("\\")) return "Folders are parted by /, not by \\.";
  if (path.startsWith("/") || path.split("/").includes("..")) return "Only files below the served folder can be written: a path that begins with neither / nor ..";
  if (path.split("/").some((part) => part.startsWith("."))) return "Names that begin with a dot are hidden, and cannot be written.";
  return null;
}
