// Scenes inside pictures, videos and replays: how they are put there, and found again.

/** The keyword of the text in a PNG, and what stands before the scene in videos, in 16 letters. */
const kKeyword = "weir-scene";
export const kId = "weir-scene-json1";

const kTable = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c >>> 0;
});

/** CRC-32 as PNG has it (ISO 3309). */
export function crc32(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const b of bytes) c = kTable[(c ^ b) & 0xff]! ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

const kSignature = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
const isPng = (bytes: Uint8Array): boolean => kSignature.every((b, i) => bytes[i] === b);
const letters = (bytes: Uint8Array, at: number, count: number): string => String.fromCharCode(...bytes.subarray(at, at + count));
const viewOf = (bytes: Uint8Array): DataView => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

/** The chunks of a PNG: where each begins, its kind, and how long its data are. */
function* chunksOf(png: Uint8Array): Generator<{ at: number; kind: string; length: number }> {
  for (let at = kSignature.length; at + 12 <= png.length; ) {
    const length = viewOf(png).getUint32(at), kind = letters(png, at + 4, 4);
    if (at + 12 + length > png.length) return;
    yield { at, kind, length };
    at += 12 + length;
  }
}

/** A PNG with a scene in it, as an iTXt chunk before the pixels end. */
export function withScene(png: Uint8Array, scene: string): Uint8Array<ArrayBuffer> {
  const text = new TextEncoder().encode(`iTXt${kKeyword}\0\0\0\0\0${scene}`);
  const chunk = new Uint8Array(text.length + 8);
  viewOf(chunk).setUint32(0, text.length - 4);
  chunk.set(text, 4);
  viewOf(chunk).setUint32(chunk.length - 4, crc32(text));
  const end = [...chunksOf(png)].find((c) => c.kind === "IEND")?.at ?? png.length;
  const all = new Uint8Array(png.length + chunk.length);
  all.set(png.subarray(0, end));
  all.set(chunk, end);
  all.set(png.subarray(end), end + chunk.length);
  return all;
}

function inPng(png: Uint8Array): string | null {
  const head = `${kKeyword}\0\0\0\0\0`;
  for (const { at, kind, length } of chunksOf(png))
    if (kind === "iTXt" && letters(png, at + 8, head.length) === head) return new TextDecoder().decode(png.subarray(at + 8 + head.length, at + 8 + length));
  return null;
}

/** The scene of a box at the upper level of an MP4. */
function inMp4(file: Uint8Array): string | null {
  const view = viewOf(file), kHead = 8;
  for (let at = 0; at + kHead <= file.length; ) {
    const short = view.getUint32(at), kind = letters(file, at + 4, 4);
    const size = short === 1 && at + 16 <= file.length ? Number(view.getBigUint64(at + 8)) : short === 0 ? file.length - at : short;
    if (size < kHead || at + size > file.length) return null;
    if (kind === "uuid" && letters(file, at + kHead, kId.length) === kId) return new TextDecoder().decode(file.subarray(at + kHead + kId.length, at + size));
    at += size;
  }
  return null;
}

/** An integer of EBML (RFC 8794) and how long it is: the first bit that is set tells, and is no part of a size. */
function ebmlNumber(file: Uint8Array, at: number, isSize: boolean): { value: number; length: number } {
  const length = Math.clz32(file[at] ?? 0) - 23;
  let value = isSize ? file[at]! & (0xff >> length) : file[at]!;
  for (let i = 1; i < length; ++i) value = value * 256 + (file[at + i] ?? 0);
  return { value, length };
}

/** The scene of an element Void at the upper level of a Matroska or WebM. */
function inMatroska(file: Uint8Array): string | null {
  const kVoid = 0xec;
  for (let at = 0; at < file.length; ) {
    const id = ebmlNumber(file, at, false), size = ebmlNumber(file, at + id.length, true), body = at + id.length + size.length;
    if (id.length > 8 || size.length > 8 || body + size.value > file.length) return null;
    if (id.value === kVoid && letters(file, body, kId.length) === kId) return new TextDecoder().decode(file.subarray(body + kId.length, body + size.value));
    at = body + size.value;
  }
  return null;
}

/** The scene of the last comment of a GIF: blocks of at most 255 bytes, each behind its length, then a 0. */
function inGif(file: Uint8Array): string | null {
  const isBegin = (at: number) => file[at] === 0x21 && file[at + 1] === 0xfe && letters(file, at + 3, kId.length) === kId;
  let at = file.length - 1;
  while (at > 0 && !isBegin(at)) --at;
  if (at <= 0) return null;
  const parts: number[] = [];
  for (at += 2; file[at]; at += 1 + file[at]!) parts.push(...file.subarray(at + 1, at + 1 + file[at]!));
  return at < file.length ? new TextDecoder().decode(Uint8Array.from(parts.slice(kId.length))) : null;
}

const inHtml = (text: string): string | null => /<script type="application\/json" id="weir-scene">([^<]*)<\/script>/.exec(text)?.[1] ?? null;

/** The scene that a file carries, as JSON; null where there is none. */
export function sceneIn(bytes: Uint8Array): string | null {
  if (isPng(bytes)) return inPng(bytes);
  if (letters(bytes, 4, 4) === "ftyp") return inMp4(bytes);
  if (letters(bytes, 0, 4) === "\x1a\x45\xdf\xa3") return inMatroska(bytes);
  if (letters(bytes, 0, 4) === "GIF8") return inGif(bytes);
  // The scene stands before the numbers.
  const kHead = 2 ** 22;
  return inHtml(new TextDecoder().decode(bytes.subarray(0, kHead)));
}
