// How fast a graph of many nodes moves: node browser/pan.mjs [NODES=500]. Prints JSON: the frames a second while the graph is dragged, one of its nodes is dragged, and it is zoomed; zoomed out to all of it, and
// at its usual size.
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { openPage, startServer } from "./studio.mjs";

const kNodes = Number(process.argv[2] ?? 500);
const kColumns = 25;
const kSteps = 120;

/** Emitters and boundaries that feed fluids, in rows. */
function largeScene() {
  const scene = { weir: 1, title: `${kNodes} nodes`, world: { duration: 1 }, nodes: {}, links: [], layout: { nodes: {} } };
  const add = (name, node, i) => {
    scene.nodes[name] = node;
    scene.layout.nodes[name] = { x: 300 * (i % kColumns), y: 240 * Math.floor(i / kColumns) };
  };
  for (let i = 0; i + 3 <= kNodes; i += 3) {
    add(`nozzle_${i}`, { type: "SquareEmitter", params: { position: [i, 1, 0] } }, i);
    add(`tank_${i}`, { type: "StaticBoundary", params: { shape: "box", inverted: true } }, i + 1);
    add(`water_${i}`, { type: "ParticleFluid" }, i + 2);
    scene.links.push(`nozzle_${i}.particles -> water_${i}.emitters`, `tank_${i}.boundary -> water_${i}.boundaries`);
  }
  for (let i = Object.keys(scene.nodes).length; i < kNodes; ++i) add(`tank_${i}`, { type: "StaticBoundary", params: { shape: "box" } }, i);
  return scene;
}

/** Counts what is drawn while something is done by many small steps. */
async function during(page, step) {
  await page.evaluate(() => {
    window.frameTimes = [];
    const note = (t) => (window.frameTimes.push(t), (window.frameTimer = requestAnimationFrame(note)));
    window.frameTimer = requestAnimationFrame(note);
  });
  for (let i = 0; i < kSteps; ++i) await step(i);
  const times = await page.evaluate(() => (cancelAnimationFrame(window.frameTimer), window.frameTimes));
  const gaps = times.slice(1).map((t, i) => t - times[i]).sort((a, b) => a - b);
  const round = (x) => Number(x.toFixed(1));
  return {
    frames: times.length, frames_per_second: round((1000 * (times.length - 1)) / (times.at(-1) - times[0])),
    median_ms: round(gaps[gaps.length >> 1]), slowest_ms: round(gaps.at(-1)),
  };
}

/** Drags by a button of the mouse, to and fro, and back to where it began. */
async function drag(page, at, button) {
  await page.mouse.move(at.x, at.y);
  await page.mouse.down({ button });
  const found = await during(page, (i) => page.mouse.move(at.x + 150 * Math.sin(i / 8), at.y + 60 * Math.sin(i / 5)));
  await page.mouse.move(at.x, at.y);
  await page.mouse.up({ button });
  return found;
}

const middleOf = (box) => ({ x: box.x + box.width / 2, y: box.y + box.height / 2 });

/** Of what is shown now. */
async function measure(page) {
  const nodes_shown = await page.locator(".scene-node").count();
  const middle = middleOf(await page.getByRole("application", { name: "Node editor" }).boundingBox());
  const pan = await drag(page, middle, "middle");
  const name = await page.evaluate(({ x, y }) => {
    const far = (n) => { const b = n.getBoundingClientRect(); return Math.hypot(b.x + b.width / 2 - x, b.y + b.height / 2 - y); };
    return [...document.querySelectorAll(".scene-node")].sort((a, b) => far(a) - far(b))[0].dataset.node;
  }, middle);
  const drag_of_a_node = await drag(page, middleOf(await page.locator(`[data-node="${name}"] strong`).boundingBox()), "left");
  await page.mouse.move(middle.x, middle.y);
  const zoom = await during(page, (i) => page.mouse.wheel(0, 12 * Math.cos(i / 8)));
  return { nodes_shown, pan, drag_of_a_node, zoom };
}

const server = await startServer();
try {
  await writeFile(join(server.folder, "large.json"), JSON.stringify(largeScene()));
  const { browser, page } = await openPage(server.address, { width: 1920, height: 1080 });
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.getByRole("dialog").getByRole("button", { name: "large" }).click();
  await page.locator(".scene-node").first().waitFor();
  const graph = page.getByRole("application", { name: "Node editor" });
  await graph.focus();
  await page.keyboard.press("f");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length > 0.9 * n, kNodes);
  const all_of_it = await measure(page);
  for (let i = 0; i < 12; ++i) await page.getByRole("button", { name: "Zoom In" }).click();
  await page.waitForFunction(() => document.querySelectorAll(".scene-node").length < 100);
  console.log(JSON.stringify({ nodes: kNodes, all_of_it, usual_size: await measure(page) }, null, 1));
  await browser.close();
} finally {
  await server.close();
}
