// What is on the pages of a test that fails: a picture of each, and what was done to it and came of it, as JSON.
import { mkdir, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";

const kFolder = fileURLToPath(new URL("../failures/", import.meta.url));
/** A page that hangs is not waited for. */
const kPatience = 30_000;

const pages = new Map();

/** Notes what a page is told by hands, and where that arrives. */
function noteEvents(most) {
  const notes = (window.whatHappened = []);
  const nameOf = (e) => (e instanceof Element ? [e.localName, e.id && `#${e.id}`, e.className?.baseVal ?? e.className, e.getAttribute("aria-label")].filter(Boolean).join(" ") : String(e));
  const note = (e) => {
    notes.push([
      Math.round(e.timeStamp), Math.round(performance.now()), e.type, nameOf(e.target), e.clientX === undefined ? e.key : `${e.clientX},${e.clientY}`,
      e.isTrusted ? "" : "made by a script", e.button ?? "",
    ].join(" | "));
    if (notes.length > most) notes.shift();
  };
  for (const type of ["pointerdown", "pointerup", "pointermove", "pointercancel", "mousedown", "mouseup", "mousemove", "click", "dragstart", "keydown", "keyup", "focusin", "blur"])
    window.addEventListener(type, note, { capture: true, passive: true });
}

function stateOfPage() {
  const text = (selector) => document.querySelector(selector)?.textContent ?? null;
  return {
    now: performance.now(), focus: document.activeElement?.outerHTML.slice(0, 300), has_focus: document.hasFocus(), size: [innerWidth, innerHeight],
    run: text(".transport"), message: text(".message"), problem: text(".problem-line"),
    graph: document.querySelector(".react-flow__viewport")?.style.transform,
    nodes: [...document.querySelectorAll(".scene-node")].map((n) => {
      const { x, y, width, height } = n.getBoundingClientRect();
      return { name: n.dataset.node, classes: n.className, outer: n.parentElement.className, box: [x, y, width, height].map(Math.round) };
    }),
    properties: [...document.querySelectorAll("aside .properties input")].map((i) => `${i.ariaLabel}: ${i.value}`),
    what_happened: window.whatHappened,
  };
}

/** Watches a page, before it is loaded. `mistakes` is what its console complains of. */
export async function watch(page, mistakes) {
  pages.set(page, mistakes);
  page.once("close", () => pages.delete(page));
  await page.addInitScript(noteEvents, 200);
}

export async function keepWhatIsSeen(name) {
  await mkdir(kFolder, { recursive: true });
  const file = `${kFolder}${process.env.WEIR_FIREFOX ? "firefox" : "chromium"} ${name}`;
  for (const [i, [page, mistakes]] of [...pages].entries()) {
    const at = `${file}${i > 0 ? ` ${i + 1}` : ""}`;
    const late = new Promise((_, reject) => setTimeout(reject, kPatience, new Error("the page does not answer")).unref());
    const state = await Promise.race([page.evaluate(stateOfPage), late]).catch((e) => ({ unknown: e.message }));
    await writeFile(`${at}.json`, JSON.stringify({ ...state, mistakes }, null, 1));
    await page.screenshot({ path: `${at}.png`, timeout: kPatience }).catch((e) => console.error(`no picture: ${e.message}`));
    console.error(`what was seen: ${at}.png, .json`);
  }
}
