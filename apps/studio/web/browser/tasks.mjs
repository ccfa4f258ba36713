// What twenty tasks take, from an empty page to a shared video: node browser/tasks.mjs. Each is done by the pointer and the keyboard, and
// done only when the server, a file or the page has what was wanted. Prints a table for engineering/studio.md: presses of the pointer's
// button, keys, typed texts with their letters, and seconds, those of the server's work included.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdir, readFile, stat, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { Hands, openPage, savedBy, startServer } from "./studio.mjs";
import { User } from "./user.mjs";

const kPatience = 60_000;
const kPause = 50;
/** A cube of 0.3 m on the floor of the tank, as PLY. */
const kCube = [
  "ply", "format ascii 1.0", "element vertex 8", ...["x", "y", "z"].map((axis) => `property float ${axis}`), "element face 12", "property list uchar int vertex_indices", "end_header",
  ...[0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1, (i >> 1) & 1, i >> 2].map((b, axis) => 0.3 * b - (axis === 1 ? 0 : 0.45)).join(" ")),
  ..."015 054 267 273 046 062 137 175 023 031 457 476".split(" ").map((f) => `3 ${[...f].join(" ")}`),
].join("\n");

const server = await startServer();
const { browser, context, page, mistakes } = await openPage(server.address);
const user = new User(page), hands = new Hands(page);

// Beside the page: what the server holds.
const witness = await context.newPage();
await witness.goto(new URL("/api/files", server.address).href);
/** A further window, which only looks, asks once. */
const asked = () => witness.evaluate(() => new Promise((resolve, reject) => {
  const socket = new WebSocket(`ws://${location.host}/api/live`);
  socket.onopen = () => socket.send('{"id":1,"do":"hello"}');
  socket.onmessage = ({ data }) => typeof data === "string" && JSON.parse(data).id === 1 && (resolve(JSON.parse(data).result), socket.close());
  socket.onerror = () => reject(new Error("no answer"));
}));
const scene = async () => (await asked()).scene.scene;

/** Waits until what is asked for is as it is wanted. */
async function until(look, isRight) {
  let found;
  for (const start = Date.now(); Date.now() - start < kPatience; await page.waitForTimeout(kPause)) {
    found = await look().catch((e) => e);
    if (!(found instanceof Error) && isRight(found)) return found;
  }
  throw new Error(`not as it should be: ${JSON.stringify(found)?.slice(0, 2000) ?? found}; expected ${isRight}`);
}
const sceneHas = (isRight) => until(scene, isRight);
const stateIs = (state) => page.locator(`.state.${state}`).waitFor();
const frameIs = (isRight) => until(async () => (await asked()).status.frame ?? 0, isRight);
const onDisk = (name) => until(() => stat(join(server.folder, name)), (s) => s.size > 0);

const button = (name) => page.getByRole("button", { name, exact: true });
const field = (label) => hands.aside().getByLabel(label, { exact: true });
const middleOf = async (what) => {
  const { x, y, width, height } = await what.boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
};
const output = (node, port) => hands.node(node).locator(`.source[data-handleid="${port}"]`);
const input = (node, port) => hands.node(node).locator(`.target[data-handleid="${port}"]`);
/** A free place of the graph, as a share of its pane, or near it. */
const ground = (across, down) => page.evaluate(([across, down]) => {
  const box = document.querySelector(".graph").getBoundingClientRect();
  for (let r = 0; r < 400; r += 10)
    for (const [dx, dy] of [[0, 0], [r, 0], [-r, 0], [0, r], [0, -r]]) {
      const x = box.left + across * box.width + dx, y = box.top + down * box.height + dy;
      if (document.elementFromPoint(x, y)?.classList.contains("react-flow__pane")) return { x, y };
    }
  throw new Error("the graph has no free place");
}, [across, down]);
const menu = (of, name) => page.getByRole("menu", { name: of }).getByRole("menuitem", { name, exact: true });

/** Drags a link from a port into the open, where the list that opens has what fits. */
async function addAt(port, across, down, words) {
  await user.drag(await middleOf(port), await ground(across, down));
  await page.getByRole("combobox", { name: "Search nodes" }).waitFor();
  await user.write(words);
  await user.press("Enter");
}
async function find(words, first) {
  await user.press("Control+k");
  await page.getByRole("combobox", { name: "Find anything" }).waitFor();
  await user.write(words);
  await page.locator('.palette [aria-selected="true"]').filter({ hasText: first }).waitFor();
  await user.press("Enter");
}
const downloaded = (f) => savedBy(page, server.folder, f);
const framesOf = (video) => Number(String(execFileSync("ffprobe", ["-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", video])).trim());

const rows = [];
/** What comes before a task and between two is not counted. */
async function task(name, f) {
  user.told();
  const start = performance.now();
  try {
    await f();
  } catch (e) {
    await page.screenshot({ path: "task_failed.png" });
    throw new Error(`task ${rows.length + 1}, ${name}: ${e.message} (task_failed.png)`, { cause: e });
  }
  const seconds = (performance.now() - start) / 1000, { clicks, keys, texts, letters } = user.told();
  rows.push(`| ${rows.length + 1} | ${name} | ${clicks} | ${keys} | ${texts ? `${texts} (${letters})` : 0} | ${seconds.toFixed(1)} |`);
  console.error(rows.at(-1));
}
const pause = async () => {
  if ((await asked()).status.state === "playing") await button("Pause").click();
  await until(async () => (await asked()).status.state, (s) => s === "paused" || s === "finished");
};

async function build() {
  await mkdir(join(server.folder, "desktop"));
  await writeFile(join(server.folder, "desktop", "cube.ply"), kCube);
  await task("from an empty page to moving water, node by node", async () => {
    // The pointer rests where the node is to be.
    const { x, y } = await ground(0.6, 0.3);
    await page.mouse.move(x, y);
    await user.press("a");
    await page.getByRole("combobox", { name: "Search nodes" }).waitFor();
    await user.write("water");
    await user.press("Enter");
    await hands.node("particle_fluid").waitFor();
    await user.fill(field("spacing"), 0.05);
    await addAt(input("particle_fluid", "initial"), 0.2, 0.2, "block");
    await hands.node("box_sampler").waitFor();
    await addAt(input("particle_fluid", "boundaries"), 0.2, 0.7, "tank");
    await hands.node("static_boundary").waitFor();
    await user.choose(field("shape"), "box");
    await user.click(field("inverted"));
    await user.click(button("Play"));
    await frameIs((n) => n > 2);
  });
  await pause();
  await task("another spacing, and run with it", async () => {
    await user.click(hands.node("particle_fluid").locator("strong"));
    await user.fill(field("spacing"), 0.06);
    await user.click(button("Reset"));
    await sceneHas((s) => s.nodes.particle_fluid.params.spacing === 0.06);
    await until(async () => (await asked()).scene, (s) => s.reset === undefined);
  });
  await task("a mesh of the desktop as an obstacle", async () => {
    await user.drop(join(server.folder, "desktop", "cube.ply"), ".viewport");
    await user.click(page.getByRole("dialog", { name: "What shall it be?" }).getByRole("button", { name: /^Obstacle/ }));
    await sceneHas((s) => s.links.length >= 3 && Object.values(s.nodes).some((n) => n.type === "MeshFile"));
    await onDisk("meshes/cube.ply");
  });
  await task("an emitter", async () => {
    await addAt(input("particle_fluid", "emitters"), 0.35, 0.5, "square");
    await sceneHas((s) => s.links.includes("square_emitter.particles -> particle_fluid.emitters"));
  });
  await page.keyboard.press("Escape");
  await button("Play").click();
  await frameIs((n) => n > 0);
  await task("gravity, while it runs", async () => {
    await find("gravity", "gravity");
    await page.waitForFunction(() => document.activeElement.getAttribute("aria-label") === "gravity x");
    await user.press("Tab");
    await user.write("-3");
    await user.press("Enter");
    await sceneHas((s) => s.world.gravity[1] === -3);
    assert.equal((await asked()).status.state, "playing");
  });
  await pause();
}

async function tune() {
  await task("a parameter by its name, from anywhere", async () => {
    await find("rest dens", "rest_density");
    await page.waitForFunction(() => document.activeElement.getAttribute("aria-label") === "rest_density");
    await user.write("900");
    await user.press("Enter");
    await sceneHas((s) => s.nodes.particle_fluid.params.rest_density === 900);
  });
  const before = await scene();
  await task("five steps taken back", async () => {
    await user.press(...Array(5).fill("Control+z"));
    await sceneHas((s) => s.nodes.particle_fluid.params.rest_density === undefined && !("square_emitter" in s.nodes) && s.world?.gravity === undefined);
  });
  for (let i = 0; i < 5; ++i) await page.keyboard.press("Control+Shift+z");
  await sceneHas((s) => JSON.stringify(s) === JSON.stringify(before));
  await task("saved under a name", async () => {
    await user.click(button("Save as"));
    await page.getByRole("textbox", { name: "File name" }).waitFor();
    await user.write("tank");
    await user.press("Enter");
    const kept = await until(() => server.read("tank.json"), (s) => s.nodes !== undefined);
    assert.equal(kept.nodes.particle_fluid.params.rest_density, 900);
    await page.getByRole("dialog").waitFor({ state: "detached" });
  });
  await task("a module found and put before another one", async () => {
    await find("surface tension", "SurfaceTension");
    const place = (name) => middleOf(hands.node("particle_fluid").locator(`[data-module="${name}"] .handle`));
    await hands.node("particle_fluid").locator('[data-module="surface_tension"]').waitFor();
    await hands.stillness();
    await user.drag(await place("surface_tension"), await place("viscosity"));
    await sceneHas((s) => s.nodes.particle_fluid.modules.surface_tension.before === "viscosity");
  });
  await task("nodes in a group, and one of them bypassed", async () => {
    await user.click(hands.node("square_emitter").locator("strong"));
    await user.press("b", "Control+a", "g");
    await sceneHas((s) => s.layout.notes?.some((n) => n.frame) && !("square_emitter" in s.nodes));
  });
  await page.keyboard.press("Control+s");
  await server.written("tank.json", (s) => s.layout.notes !== undefined);
  await task("a version taken back", async () => {
    await user.click(button("Versions"));
    const box = page.getByRole("dialog", { name: "Versions" });
    await user.click(box.getByRole("listitem").first().getByRole("button"));
    await user.click(box.getByRole("button", { name: "Take it back" }));
    await sceneHas((s) => "square_emitter" in s.nodes && s.nodes.particle_fluid.modules === undefined);
  });
  await hands.select("square_emitter");
  await page.keyboard.press("Delete");
  await hands.addNode("SquareEmitter", "tap");
  await page.keyboard.press("Escape");
  await hands.pressInGraph("Escape");
  await task("a link, by the keyboard alone", async () => {
    const chosen = () => page.locator(".scene-node.selected").evaluateAll((all) => all.map((n) => n.dataset.node).join());
    for (let i = 0; i < 9 && (await chosen()) !== "tap"; ++i) {
      await user.press("PageDown");
      await page.waitForTimeout(kPause);
    }
    await user.press("k");
    await page.getByRole("combobox", { name: "Search links" }).waitFor();
    await user.write("emitters");
    await user.press("Enter");
    await sceneHas((s) => s.links.includes("tap.particles -> particle_fluid.emitters"));
  });
}

async function watch() {
  // Whole runs of nine frames.
  await hands.pressInGraph("Escape");
  await hands.type(field("duration"), 0.3);
  await button("Reset").click();
  await stateIs("paused");
  await task("a video", async () => {
    await user.click(button("Record"));
    await page.getByRole("textbox", { name: "Video file" }).waitFor();
    await user.press("Enter");
    await page.locator(".recording").waitFor();
    await user.click(button("Play"));
    await frameIs((n) => n >= 6);
    await user.click(page.locator(".recording"));
    const name = await page.getByRole("link", { name: /\.mp4/ }).getAttribute("href");
    assert.ok(framesOf(join(server.folder, decodeURIComponent(name.split("/api/file/")[1]))) >= 6);
  });
  await pause();
  await task("back to a frame, and on from there with another value", async () => {
    const ruler = await page.getByRole("slider", { name: "Frame" }).boundingBox();
    const { frame, frames } = (await asked()).status;
    await user.clickAt({ x: ruler.x + 6 + (ruler.width - 12) * (0.5 * frame / frames), y: ruler.y + ruler.height / 2 });
    await user.click(button("Go back to this frame"));
    const back = await frameIs((n) => n < frame);
    await hands.pressInGraph("Escape");
    await user.fill(field("gravity y"), "5");
    await user.click(button("Play"));
    await frameIs((n) => n > back);
    assert.equal((await scene()).world.gravity[1], 5);
  });
  await pause();
  await task("a run beside the one before, with another value", async () => {
    await user.click(button("Compare"));
    await page.getByLabel("The run that was kept").waitFor();
    await user.fill(field("gravity y"), "-9.8");
    await user.click(button("Reset"));
    await frameIs((n) => n === 0);
    await user.click(button("Play"));
    await page.locator(".plot polyline.other").first().waitFor({ state: "attached" });
    await page.getByRole("group", { name: "In what the runs differ" }).getByRole("button", { name: /Gravity/ }).waitFor();
  });
  await pause();
  await button("End comparison").or(button("Compare")).first().click();
  await task("five values of a parameter tried, and one used", async () => {
    await user.click(hands.node("particle_fluid").locator("strong"));
    await user.click(hands.aside().locator('[data-param="rest_density"] .name'), { button: "right" });
    await user.click(menu("rest_density", "Sweep this value…"));
    const box = page.getByRole("dialog", { name: /^Sweep/ });
    await user.click(box.getByRole("button", { name: "Start" }));
    await box.locator(".progress").waitFor();
    await box.locator(".progress").waitFor({ state: "detached", timeout: 5 * kPatience });
    assert.equal(await box.locator(".multiples li").count(), 5);
    await user.click(box.getByRole("button", { name: "Use it" }).first());
    await sceneHas((s) => s.nodes.particle_fluid.params.rest_density !== 900);
  });
  await button("Reset").click();
  await stateIs("paused");
}

async function show() {
  await task("a probe in the water, and its plots", async () => {
    const view = await page.locator(".stage > canvas").boundingBox();
    const card = page.getByRole("region", { name: /^Particle \d+ of/ });
    // A user sees where the water is; what is tried here beside it is not counted.
    for (let y = 0.8; (await card.count()) === 0; y -= 0.02) await page.mouse.click(view.x + view.width / 2, view.y + y * view.height);
    ++user.did.clicks;
    await user.click(card.getByRole("button", { name: "Measure here" }));
    await user.click(button("Reset"));
    await sceneHas((s) => s.links.includes("particle_fluid.fluid -> probe.particles"));
    await page.locator('.plot[data-quantity^="probe."]').first().waitFor();
  });
  await button("Close").click();
  await task("a surface of the water, its look, and a rendered view of it", async () => {
    await addAt(output("particle_fluid", "fluid"), 0.8, 0.6, "surface");
    await hands.node("fluid_surface").waitFor();
    await look();
    await user.click(button("Reset"));
    await until(async () => (await asked()).scene, (s) => s.reset === undefined);
    await user.click(button("Rendered"));
    await page.waitForFunction(() => document.querySelector(".rendered")?.naturalWidth > 0);
    await sceneHas((s) => s.render.surfaces[0].node === "fluid_surface" && s.render.surfaces[0].look === "glass");
  });
  await button("Rendered").click();
  await button("Play").click();
  await frameIs((n) => n > 1);
  await pause();
  await task("the run as one file that replays anywhere", async () => {
    const file = await downloaded(async () => {
      await user.click(button("Share"));
      await page.getByRole("dialog", { name: "Share the run" }).waitFor();
      await user.press("Enter");
    });
    assert.match(await readFile(file, "utf8"), /<canvas|createElement\("canvas"\)/);
  });
  await task("a picture that carries its scene, opened again", async () => {
    const wanted = Object.keys((await scene()).nodes).sort().join();
    const picture = await downloaded(() => user.click(button("Save a picture")));
    await user.click(button("New"));
    await sceneHas((s) => Object.keys(s.nodes).length === 0);
    await user.drop(picture, ".viewport");
    await sceneHas((s) => Object.keys(s.nodes).sort().join() === wanted);
  });
}

/** Of the surface, in pictures. */
async function look() {
  await find("surfaces", "render");
  const part = hands.aside().locator('[data-param="render"] [data-param="surfaces"]');
  await user.click(part.getByRole("button", { name: "Add to surfaces" }));
  await user.fill(part.getByLabel("surfaces 1 node"), "fluid_surface");
  await user.choose(part.getByLabel("surfaces 1 look"), "glass");
}

try {
  for (const part of [build, tune, watch, show]) await part();
  assert.deepEqual(mistakes, []);
  console.log(["| | task | clicks | keys | texts (letters) | s |", "|---:|---|---:|---:|---:|---:|", ...rows].join("\n"));
} finally {
  await browser.close();
  await server.close();
}
