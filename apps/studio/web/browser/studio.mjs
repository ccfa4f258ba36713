// A studio of its own with a page in a real browser, for tests and measurements; and what hands do there. WEIR names the
// program (weir). The browser is a Chromium, WEIR_CHROMIUM, or where WEIR_FIREFOX names one, a Firefox with a screen: under
// xvfb-run where there is none. Without a screen Firefox has no WebGL.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { copyFile, mkdtemp, readdir, readFile, rm, stat, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { chromium, firefox } from "playwright-core";
import { watch } from "./seen.mjs";

const kWeir = process.env.WEIR ?? "weir";
const kNice = "10";
const kLong = 60;
const kRestMs = 300;
const kWordMs = 1100;
const kRestFrames = 10;
// Far more than an idle machine needs.
const kPatience = 60_000;
// As where there is no graphics card: the page is drawn by the processor, WebGL too.
const kDrawn = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"];

/**
 * Whether the browser is one with which Playwright (1.60, Firefox 153 of Debian) cannot do all that hands can: it begins a drag of the
 * browser's own and never drops, its double click comes as two single ones, and it tells of no file that is saved. There the
 * page gets the events that the browser would send, and files are looked for where they come to lie.
 */
const kLimited = process.env.WEIR_FIREFOX !== undefined;

/** Where a Firefox puts what it saves. */
const kSaved = kLimited ? mkdtempSync(join(tmpdir(), "weir-saved-")) : "";
if (kLimited) process.once("exit", () => rmSync(kSaved, { recursive: true, force: true }));

/** The files there that are whole: before they are, they are empty, and one beside them has what came so far. */
async function wholeFiles() {
  const names = await readdir(kSaved);
  const sizes = await Promise.all(names.map((n) => stat(join(kSaved, n)).then((s) => s.size, () => 0)));
  return names.filter((n, i) => sizes[i] > 0 && !n.endsWith(".part") && !names.includes(`${n}.part`));
}

/** What the browser saves when `f` is done, as a file of a folder under the name that it gave. */
export async function savedBy(page, folder, f) {
  if (!kLimited) {
    const [download] = await Promise.all([page.waitForEvent("download"), f()]);
    const path = join(folder, download.suggestedFilename());
    await download.saveAs(path);
    return path;
  }
  const before = new Set(await wholeFiles());
  await f();
  for (let waited = 0; waited < kPatience; waited += 100) {
    const name = (await wholeFiles()).find((n) => !before.has(n));
    if (name !== undefined) {
      await copyFile(join(kSaved, name), join(folder, name));
      return join(folder, name);
    }
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  throw new Error(`no file was saved: ${await readdir(kSaved)}`);
}

/** The address that a server prints when it is ready. */
async function addressOf(server) {
  let text = "";
  for await (const chunk of server.stdout) {
    text += chunk;
    if (text.includes("\n")) return text.trim();
  }
  throw new Error("weir studio ended before it said where it is");
}

/**
 * Starts a server in a folder, or in one of its own. `close` ends it and removes the folder; `crash` ends it at once, and
 * leaves the folder. `read` gives back what a JSON file in it holds; `written` waits until that is as it
 * should be. `meanwhile` does something while the server stands still.
 */
export async function startServer(options = [], { folder, env = {} } = {}) {
  const own = folder ?? (await mkdtemp(join(tmpdir(), "weir-studio-")));
  // What hands do comes first where a simulation would take all that the machine has.
  const server = spawn("nice", ["-n", kNice, kWeir, "studio", "--no-browser", "--folder", own, "--device", "cpu", "--threads", "2", ...options], {
    stdio: ["ignore", "pipe", "inherit"], env: { ...process.env, XDG_STATE_HOME: join(own, ".state"), ...env },
  });
  const ended = new Promise((resolve) => server.once("close", resolve));
  const end = async (signal) => {
    server.kill(signal);
    await ended;
  };
  const close = async () => {
    await end("SIGINT");
    await rm(own, { recursive: true });
  };
  try {
    const read = async (name) => JSON.parse(await readFile(join(own, name), "utf8"));
    const written = async (name, isRight) => {
      for (let waited = 0; waited < kPatience; waited += 100) {
        if (isRight(await read(name).catch(() => null))) return;
        await new Promise((resolve) => setTimeout(resolve, 100));
      }
      throw new Error(`${name} is not as it should be: ${JSON.stringify(await read(name))}`);
    };
    const meanwhile = async (f) => {
      server.kill("SIGSTOP");
      try {
        await f();
      } finally {
        server.kill("SIGCONT");
      }
    };
    return { folder: own, address: await addressOf(server), close, crash: () => end("SIGKILL"), read, written, meanwhile };
  } catch (e) {
    await close();
    throw e;
  }
}

/** Runs the program and waits for its end. */
export function weir(...words) {
  const child = spawn(kWeir, words, { stdio: ["ignore", "ignore", "inherit"] });
  return new Promise((resolve, reject) =>
    child.once("close", (code) => (code === 0 ? resolve() : reject(new Error(`weir ${words.join(" ")} ended with ${code}`)))),
  );
}

/** Firefox cannot be told which colours are preferred through its WebDriver; a setting of its own does that. */
const launch = (dark) =>
  process.env.WEIR_FIREFOX
    ? firefox.launch({
        channel: "moz-firefox", executablePath: process.env.WEIR_FIREFOX, headless: false, downloadsPath: kSaved,
        firefoxUserPrefs: { "webgl.force-enabled": true, "layout.css.prefers-color-scheme.content-override": dark ? 0 : 1 },
      })
    : chromium.launch({ executablePath: process.env.WEIR_CHROMIUM ?? "/usr/bin/chromium", args: kDrawn });

/** Another window of a browser. `mistakes` gathers what its console complains of. */
export async function openWindow(context, address, mistakes = []) {
  const page = await context.newPage();
  page.setDefaultTimeout(kPatience);
  page.on("console", (m) => m.type() === "error" && mistakes.push(`${m.text()} (${m.location().url})`));
  page.on("pageerror", (e) => mistakes.push(e.message));
  page.on("dialog", (d) => d.accept());
  await watch(page, mistakes);
  await page.goto(address);
  await page.locator(".bar .title").waitFor();
  await page.getByLabel("title", { exact: true }).or(page.getByLabel("Name", { exact: true })).waitFor();
  return page;
}

/** A page at an address, in a browser of its own. */
export async function openPage(address, { width = 1600, height = 1000, colorScheme = "dark" } = {}) {
  const browser = await launch(colorScheme === "dark");
  const context = await browser.newContext({ viewport: { width, height }, ...(process.env.WEIR_FIREFOX ? {} : { colorScheme }) });
  const mistakes = [];
  return { browser, context, mistakes, page: await openWindow(context, address, mistakes) };
}

/**
 * What a test of one page begins with: a server in a folder with these scenes, `{"name.json": {…}}`, a page of it, and hands on
 * it. All of it is closed after the file's last test. `state` waits for a state of the run, `button` is one by its whole name, and
 * `open` opens a scene by its name, without ".json", and waits until it stands at its beginning.
 */
export async function openStudio(scenes, size = {}) {
  const server = await startServer();
  for (const [name, scene] of Object.entries(scenes)) await writeFile(join(server.folder, name), JSON.stringify(scene));
  const opened = await openPage(server.address, size).catch(async (e) => {
    await server.close();
    throw e;
  });
  after(async () => {
    await opened.browser.close();
    await server.close();
  });
  const { page } = opened;
  const state = (name) => page.locator(`.state.${name}`).waitFor();
  const button = (name) => page.getByRole("button", { name, exact: true });
  const open = async (name) => {
    await button("Open").click();
    await page.getByRole("dialog", { name: "Open a scene" }).getByRole("button", { name: new RegExp(`^${name} `) }).click();
    await page.locator(".bar .title").filter({ hasText: `${name}.json` }).waitFor();
    await state("paused");
  };
  return { server, ...opened, hands: new Hands(page), state, button, open };
}

/** What hands do on a page: nothing here reaches behind the page's face. */
export class Hands {
  constructor(page) {
    this.page = page;
  }

  /** The panel of properties. */
  aside() {
    return this.page.locator("aside .properties");
  }

  node(name) {
    return this.page.locator(`[data-node="${name}"]`);
  }

  /** Replaces what a field holds. */
  async type(field, text, end = "Enter") {
    await field.click({ clickCount: 3 });
    await this.page.keyboard.press("Control+A");
    // Long texts come at once, as from an input method.
    if (String(text).length > kLong) await this.page.keyboard.insertText(text);
    else await this.page.keyboard.type(String(text));
    await this.page.keyboard.press(end);
  }

  /** Clicks where the graph is empty: then nothing is selected, and the graph has the keyboard. */
  async pointAtGraph() {
    const spot = await this.page.evaluate(() => {
      const box = document.querySelector(".graph").getBoundingClientRect();
      for (let y = box.top + 12; y < box.bottom; y += 12)
        for (let x = box.left + 100; x < box.right - 340; x += 20)
          if (document.elementFromPoint(x, y)?.classList.contains("react-flow__pane")) return { x, y };
      return null;
    });
    if (!spot) throw new Error("the graph has no empty place");
    await this.page.mouse.click(spot.x, spot.y);
  }

  async pressInGraph(...keys) {
    await this.page.getByRole("application", { name: "Node editor" }).focus();
    for (const key of keys) await this.page.keyboard.press(key);
  }

  /** Adds a node by its type's name, and gives it one. */
  async addNode(type, name) {
    await this.pointAtGraph();
    await this.pressInGraph("Tab");
    await this.page.getByRole("combobox", { name: "Search" }).waitFor();
    await this.page.keyboard.type(type);
    await this.page.keyboard.press("Enter");
    await this.type(this.page.getByLabel("Name", { exact: true }), name);
    await this.node(name).waitFor();
  }

  async arrange() {
    await this.pointAtGraph();
    await this.pressInGraph("l", "f");
    await this.stillness();
  }

  /** Waits until the graph has come to rest: for some time, and for as many frames as a move needs to begin where they are slow. */
  async stillness() {
    await this.page.evaluate(async ([rest, frames]) => {
      const place = () => document.querySelector(".react-flow__viewport").style.transform;
      const moves = () => document.querySelector(".graph").dataset.moving !== undefined;
      let last = place(), since = performance.now(), still = 0;
      while (still < frames || performance.now() - since < rest) {
        await new Promise(requestAnimationFrame);
        if (place() === last && !moves()) ++still;
        else [last, since, still] = [place(), performance.now(), 0];
      }
    }, [kRestMs, kRestFrames]);
  }

  /** Shows the whole graph where a node lies outside of what is seen: there it is not drawn at all. */
  async bringIntoView(name) {
    if ((await this.node(name).count()) > 0) return;
    await this.pressInGraph("f");
    await this.stillness();
  }

  async select(name) {
    await this.bringIntoView(name);
    await this.node(name).locator("strong").click();
    await this.page.getByLabel("Name", { exact: true }).and(this.page.locator(`[value="${name}"]`)).waitFor();
  }

  async link(text) {
    const [, from, output, to, input] = /^(\w+)\.(\w+) -> (\w+)\.(\w+)$/.exec(text);
    for (const name of [from, to]) await this.bringIntoView(name);
    await this.drag(this.node(from).locator(`.source[data-handleid="${output}"]`), this.node(to).locator(`.target[data-handleid="${input}"]`));
    await this.edge(text).waitFor({ state: "attached" });
  }

  edge(text) {
    return this.page.locator(`.react-flow__edge[data-id="${text}"]`);
  }

  /** Clicks a link where nothing lies upon it. */
  async clickLink(text) {
    const spot = await this.edge(text).evaluate((edge) => {
      const path = edge.querySelector("path");
      for (let i = 1; i < 40; ++i) {
        const { x, y } = path.getPointAtLength((i / 40) * path.getTotalLength()).matrixTransform(path.getScreenCTM());
        if (edge.contains(document.elementFromPoint(x, y))) return { x, y };
      }
      return null;
    });
    if (!spot) throw new Error(`the link ${text} is hidden`);
    await this.page.mouse.click(spot.x, spot.y);
  }

  async doubleClick({ x, y }) {
    await this.page.mouse.dblclick(x, y);
    if (kLimited)
      await this.page.evaluate(([left, top]) =>
        document.elementFromPoint(left, top).dispatchEvent(new MouseEvent("dblclick", { bubbles: true, cancelable: true, clientX: left, clientY: top, detail: 2 })), [x, y]);
  }

  /** A drag of the browser's own, of what the page lets it drag; `over` is what the page shows before it is dropped. */
  async dragOwn(from, to, over) {
    if (!kLimited) {
      await from.hover();
      await this.page.mouse.down();
      // The first move begins the drag, the second one comes over the other place.
      for (let i = 0; i < 2; ++i) await to.hover();
      await over.waitFor();
      return this.page.mouse.up();
    }
    const data = await this.page.evaluateHandle(() => new DataTransfer());
    await from.dispatchEvent("dragstart", { dataTransfer: data });
    for (const type of ["dragenter", "dragover"]) await to.dispatchEvent(type, { dataTransfer: data });
    await over.waitFor();
    await to.dispatchEvent("drop", { dataTransfer: data });
    await from.dispatchEvent("dragend", { dataTransfer: data });
  }

  async drag(from, to) {
    await from.hover();
    await this.page.mouse.down();
    await to.hover();
    await this.page.mouse.up();
  }

  /** Sets a value by the editor of its kind, within a part of the page. */
  async set(within, label, kind, value) {
    const field = (suffix = "") => within.getByLabel(`${label}${suffix}`, { exact: true });
    if (kind === "bool") {
      if ((await field().isChecked()) !== value) await field().click();
    } else if (kind === "enum") {
      await field().focus();
      // A Firefox takes what follows within a second as the same word.
      if (kLimited) await this.page.waitForTimeout(kWordMs);
      await this.page.keyboard.type(value);
    } else if (kind === "curve") {
      await within.getByRole("button", { name: `${label} as text` }).click();
      await this.type(within.getByRole("textbox", { name: `${label}, points` }), value.map((p) => p.join(" ")).join("\n"), "Control+Enter");
    } else if (Array.isArray(value)) {
      for (const [i, axis] of ["x", "y", "z"].slice(0, value.length).entries()) await this.type(field(` ${axis}`), value[i]);
    } else {
      await this.type(field(), value);
    }
  }

  /** Sets many parameters, groups and lists of groups too. */
  async setAll(within, parameters, values) {
    for (const [name, value] of Object.entries(values)) {
      const p = parameters.find((q) => q.name === name);
      const part = within.locator(`[data-param="${name}"]`).first();
      if (p.kind === "group list") await this.setList(part, p, value);
      else if (p.parameters) await this.setAll(await this.open(part), p.parameters, value);
      else await this.set(part, name, p.kind, value);
    }
  }

  async setList(part, parameter, items) {
    await this.open(part);
    for (const [i, item] of items.entries()) {
      await part.getByRole("button", { name: `Add to ${parameter.name}`, exact: true }).click();
      for (const [name, value] of Object.entries(item))
        await this.set(part, `${parameter.name} ${i + 1} ${name}`, parameter.parameters.find((q) => q.name === name).kind, value);
    }
  }

  /** Unfolds what can be folded. */
  async open(part) {
    if ((await part.getAttribute("open")) === null) await part.locator("summary").first().click();
    return part;
  }
}
