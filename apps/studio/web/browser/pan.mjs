// How fast a graph of many nodes pans: node browser/pan.mjs [NODES=500]. Prints JSON: the frames a second while the graph is dragged, zoomed out to all of it and at its usual size.
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

/** Drags the empty canvas by the middle button to and fro, and counts what is drawn meanwhile. */
async function pan(page) {
  const box = await page.getByRole("application", { name: "Node editor" }).boundingBox();
  const at = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  await page.mouse.move(at.x, at.y);
  await page.mouse.down({ button: "middle" });
  await page.evaluate(() => {
    window.frameTimes = [];
    const note = (t) => (window.frameTimes.push(t), (window.frameTimer = requestAnimationFrame(note)));
    window.frameTimer = requestAnimationFrame(note);
  });
  for (let i = 0; i < kSteps; ++i) await page.mouse.move(at.x + 150 * Math.sin(i / 8), at.y + 60 * Math.sin(i / 5));
  const times = await page.evaluate(() => (cancelAnimationFrame(window.frameTimer), window.frameTimes));
  await page.mouse.up({ button: "middle" });
  const gaps = times.slice(1).map((t, i) => t - times[i]).sort((a, b) => a - b);
  const round = (x) => Number(x.toFixed(1));
  return {
    frames: times.length, frames_per_second: round((1000 * (times.length - 1)) / (times.at(-1) - times[0])),
    median_ms: round(gaps[gaps.length >> 1]), slowest_ms: round(gaps.at(-1)),
  };
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
  const shown = () => page.locator(".scene-node").count();
  const all = { nodes_shown: await shown(), ...(await pan(page)) };
  for (let i = 0; i < 12; ++i) await page.getByRole("button", { name: "Zoom In" }).click();
  await page.waitForFunction(() => document.querySelectorAll(".scene-node").length < 100);
  console.log(JSON.stringify({ nodes: kNodes, all_of_it: all, usual_size: { nodes_shown: await shown(), ...(await pan(page)) } }, null, 1));
  await browser.close();
} finally {
  await server.close();
}
