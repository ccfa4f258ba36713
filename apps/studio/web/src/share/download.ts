// Files that the browser saves.

/** Has the browser save something under a name. */
export function save(what: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(what);
  link.download = name;
  link.click();
  const kLongEnoughMs = 60_000;
  setTimeout(() => URL.revokeObjectURL(link.href), kLongEnoughMs);
}
