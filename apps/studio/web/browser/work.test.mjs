// What makes work quick and safe: nodes put into links, links that are bent, an undo that goes on from scene to scene, versions,
// pictures of scenes, what a run will cost, probes, arrows, examples; and names for those who do not see the page.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { namesThatAreMissing } from "./names.mjs";
import { step } from "./steps.mjs";
import { openStudio } from "./studio.mjs";

const kScene = {
  weir: 1, title: "Blocks", world: { duration: 0.1, frame_rate: 100 },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0.05, 0, 0.05], max: [0.25, 0.2, 0.25] } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [0.3, 0.4, 0.3], inverted: true } },
    floor: { type: "StaticBoundary", params: { shape: "plane" } },
    water: { type: "ParticleFluid", params: { spacing: 0.04, rest_steps: 0 } },
  },
  links: ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
  layout: { nodes: { block: { x: 0, y: 0 }, tank: { x: 0, y: 260 }, floor: { x: 0, y: 480 }, water: { x: 620, y: 60 } } },
};

const { server, page, mistakes, hands, state, button, open } = await openStudio({ "blocks.json": kScene, "other.json": { ...kScene, title: "Other" } }, { width: 1280, height: 800 });

const title = (text) => page.locator(".bar .title").filter({ hasText: text }).waitFor();
const spacing = () => hands.aside().getByLabel("spacing", { exact: true });

async function saved(isRight) {
  await page.keyboard.press("Control+s");
  await server.written("blocks.json", (s) => s && isRight(s));
}

/** Drags from one place to another, in steps. */
async function drag(from, to) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 6 });
  await page.mouse.up();
}

const middleOf = async (locator) => {
  const { x, y, width, height } = await locator.boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
};
/** A place on a link, as a share of its length. */
const onLink = (text, share) => hands.edge(text).locator("path").first().evaluate((path, at) => {
  const { x, y } = path.getPointAtLength(at * path.getTotalLength()).matrixTransform(path.getScreenCTM());
  return { x, y };
}, share);

step("a node that is dropped on a link is put into it, in one step", async () => {
  await open("blocks");
  await hands.pressInGraph("f");
  await hands.stillness();
  const link = "tank.boundary -> water.boundaries";
  await drag(await middleOf(hands.node("floor").locator("strong")), await onLink(link, 0.5));
  await hands.edge("floor.boundary -> water.boundaries").waitFor({ state: "attached" });
  assert.equal(await hands.edge(link).count(), 0);
  await saved((s) => s.links.includes("tank.boundary -> floor.boundaries"));
  await hands.pressInGraph("Control+z");
  await hands.edge(link).waitFor({ state: "attached" });
  assert.equal(await hands.edge("floor.boundary -> water.boundaries").count(), 0);
  // The graph is fitted again when the line below it goes.
  await page.locator(".reset-hint").waitFor({ state: "detached" });
  await hands.stillness();
  // What fits into no link is only moved.
  await drag(await middleOf(hands.node("block").locator("strong")), await onLink(link, 0.5));
  await hands.edge(link).waitFor({ state: "attached" });
  await hands.pressInGraph("Control+z");
});

step("a link is bent where it is clicked twice, and its bends are dragged and taken away", async () => {
  const link = "tank.boundary -> water.boundaries";
  await hands.pressInGraph("f");
  await hands.stillness();
  const at = await onLink(link, 0.5);
  await hands.doubleClick(at);
  const bend = page.getByRole("button", { name: `Bend 1 of ${link}` });
  await bend.waitFor();
  const bends = (s) => s.layout.bends?.[link];
  await saved((s) => bends(s)?.length === 1);
  const [{ y }] = bends(await server.read("blocks.json")), before = await middleOf(bend);
  await drag(before, { x: before.x, y: before.y + 60 });
  await saved((s) => bends(s)[0].y > y + 40);
  // It goes along when a node gets another name.
  await hands.select("tank");
  await hands.type(page.getByLabel("Name", { exact: true }), "basin");
  const moved = page.getByRole("button", { name: "Bend 1 of basin.boundary -> water.boundaries" });
  await moved.focus();
  await page.keyboard.press("Delete");
  await moved.waitFor({ state: "detached" });
  await saved((s) => s.layout.bends === undefined && s.nodes.basin !== undefined);
});

step("what a file held before each save can be looked at, and taken back", async () => {
  await hands.select("water");
  await hands.type(spacing(), 0.05);
  await saved((s) => s.nodes.water.params.spacing === 0.05);
  await button("Versions").click();
  const box = page.getByRole("dialog", { name: "Versions" });
  await box.getByRole("button", { name: /^Version/ }).first().click();
  await box.getByText("Since then 1 thing changed").waitFor();
  await box.getByText("water: Spacing 0.04 → 0.05").waitFor();
  await box.getByRole("button", { name: "Take it back" }).click();
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.04");
  assert.equal((await server.read("blocks.json")).nodes.water.params.spacing, 0.05);
  await hands.pressInGraph("Control+z");
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.05");
});

step("what a run will cost is told before it is made", async () => {
  await hands.type(spacing(), 0.02);
  const cost = page.getByRole("status", { name: "Cost of the run" });
  await cost.filter({ hasText: /≤ [12],\d+ particles, \d+ MiB/ }).waitFor();
  const many = Number((await cost.innerText()).match(/≤ ([\d,]+)/)[1].replaceAll(",", ""));
  // Cubes of 2 cm in a block of 20 cm, with what its faces add.
  assert.ok(many >= 1000 && many < 2200, String(many));
  await hands.type(spacing(), 2.5e-4);
  await cost.filter({ hasText: "more than there is" }).waitFor();
  await hands.type(spacing(), 1e-5);
  await cost.filter({ hasText: "cannot be built" }).waitFor();
  // Of the scene as it was: it goes with that, before the server says anything of the next one.
  await server.meanwhile(async () => {
    await hands.type(spacing(), 0.05);
    await cost.filter({ hasText: "cannot be built" }).waitFor({ state: "detached" });
  });
  await cost.filter({ hasText: /≤ \d+ particles/ }).waitFor();
});

step("a module that is inserted by Ctrl+K into a run that is paused can be built", async () => {
  await hands.type(spacing(), 1e-5);
  await page.getByRole("status", { name: "Cost of the run" }).filter({ hasText: "cannot be built" }).waitFor();
  await hands.type(spacing(), 0.05);
  await hands.pressInGraph("r", ".");
  await page.locator(".time").filter({ hasText: "frame 1/" }).waitFor();
  await state("paused");
  await page.evaluate(() => {
    window.costs = [];
    new MutationObserver(() => window.costs.push(document.querySelector(".cost")?.textContent ?? "")).observe(document.querySelector(".transport"), { subtree: true, childList: true, characterData: true });
  });
  await page.keyboard.press("Control+k");
  await page.getByRole("combobox", { name: "Find anything" }).waitFor();
  await page.keyboard.type("surface tension");
  await page.locator('.palette [aria-selected="true"]').filter({ hasText: "SurfaceTension" }).waitFor();
  await page.keyboard.press("Enter");
  await page.locator(".reset-hint").filter({ hasText: "the modules of water" }).waitFor();
  await page.getByRole("status", { name: "Cost of the run" }).filter({ hasText: /≤ \d+ particles/ }).waitFor();
  assert.deepEqual((await page.evaluate(() => window.costs)).filter((text) => text.includes("cannot")), []);
  await hands.pressInGraph("Control+z", "r");
  await state("paused");
});

step("scenes in Open have a picture of how their run ended", async () => {
  await hands.pressInGraph("r");
  await state("paused");
  await hands.pressInGraph("Space");
  await state("finished");
  // The time is told, too, as a run has been here.
  await page.keyboard.press("r");
  await page.getByRole("status", { name: "Cost of the run" }).filter({ hasText: /~\d+ s/ }).waitFor();
  while (!(await readFile(join(server.folder, ".blocks.json.jpg")).catch(() => null))) await page.waitForTimeout(100);
  await button("Open").click();
  const entry = page.getByRole("dialog").getByRole("listitem").filter({ hasText: "blocks" });
  await page.waitForFunction((img) => img.complete && img.naturalWidth === 320, await entry.locator("img").elementHandle());
  await page.keyboard.press("Escape");
});

step("undo goes back to the scene before, with its file, and redo to the one after", async () => {
  await hands.select("water");
  await hands.type(spacing(), 0.06);
  await open("other");
  await hands.node("tank").waitFor();
  await hands.pressInGraph("Control+z");
  await title("blocks.json · changed");
  await hands.node("basin").waitFor();
  await state("paused");
  await hands.pressInGraph("Control+Shift+z");
  await title("other.json");
  await hands.node("tank").waitFor();
  await hands.pressInGraph("Control+z", "Control+z");
  await title("blocks.json");
  await hands.select("water");
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.05");
  // Nothing of one scene came into the file of the other.
  assert.ok((await server.read("other.json")).nodes.tank);
});

step("there are examples of all nodes and modules, but of those that read a file of the user's", async () => {
  const without = await page.evaluate(async () => {
    const [types, templates] = await Promise.all(["types", "templates"].map((what) => fetch(`/api/${what}`).then((r) => r.json())));
    // What a node has by default is in its scenes.
    const used = new Set(templates.flatMap((t) => t.types).flatMap((t) => [t, ...(types.nodes[t]?.modules ?? []).map((m) => m.type)]));
    return [...Object.keys(types.nodes), ...Object.keys(types.modules)].filter((t) => !used.has(t));
  });
  assert.deepEqual(without, ["ParticleFile"]);
});

step("an example of the reference opens, and undo brings the scene back", async () => {
  await hands.select("water");
  await page.keyboard.press("F1");
  const reference = page.getByRole("dialog", { name: /^Reference/ });
  await reference.getByRole("region", { name: "Examples that run" }).getByRole("button").first().click();
  await title("not saved");
  await page.locator(".scene-node.selected").filter({ hasText: "ParticleFluid" }).waitFor();
  await page.keyboard.press("F1");
  await hands.pressInGraph("Control+z");
  await title("blocks.json");
});

step("a click on the water puts a probe there, whose plot comes first", async () => {
  await state("paused");
  await button("Fit").click();
  const view = await page.locator(".stage > canvas").boundingBox();
  const card = page.getByRole("region", { name: /^Particle \d+ of water/ });
  const at = { x: view.x + view.width / 2, y: view.y + 0.75 * view.height };
  for (; (await card.count()) === 0; at.y -= 8) await page.mouse.click(at.x, at.y);
  await card.getByText("position").waitFor();
  const first = await card.getAttribute("aria-label");
  await page.keyboard.down("Shift");
  for (let x = at.x - 80; (await card.getAttribute("aria-label")) === first; x += 12) await page.mouse.click(x, at.y + 8);
  await page.keyboard.up("Shift");
  await card.locator(".distance").filter({ hasText: /0\.\d+ m/ }).waitFor();
  await card.getByRole("button", { name: "Measure here" }).click();
  await hands.edge("water.fluid -> probe.particles").waitFor({ state: "attached" });
  await page.keyboard.press("r");
  await state("paused");
  await page.getByRole("tab", { name: "Plots" }).click();
  await page.locator(".plot").first().and(page.locator('[data-quantity^="probe."]')).waitFor();
  await page.getByRole("button", { name: "Close", exact: true }).click();
});

step("gravity is an arrow in the view, dragged and moved by keys", async () => {
  await hands.pressInGraph("Escape");
  const tip = page.getByRole("slider", { name: "Gravity" });
  await tip.waitFor();
  await tip.focus();
  await page.keyboard.press("ArrowRight");
  await saved((s) => s.world.gravity?.[1] < -9.9 && s.world.gravity[0] === 0);
  const at = await middleOf(tip);
  await drag(at, { x: at.x + 3, y: at.y + 25 });
  await saved((s) => s.world.gravity[1] < -10.5 && s.world.gravity[0] === 0);
});

step("everything that can be used has a name and a role", async () => {
  // What stands in the graph is told by name and type, and bars between panes move by keys.
  await page.getByRole("group", { name: "water, ParticleFluid" }).waitFor();
  await page.getByRole("group", { name: "Link block.particles -> water.initial" }).waitFor({ state: "attached" });
  await button("Fold water").waitFor();
  const tall = async () => (await page.locator(".stage").boundingBox()).height, before = await tall();
  await page.getByRole("separator", { name: "Height of the view" }).focus();
  await page.keyboard.press("ArrowUp");
  assert.ok((await tall()) < before);
  await page.keyboard.press("ArrowDown");
  const missing = {};
  const look = async (where) => {
    const found = await namesThatAreMissing(page);
    if (found.length > 0) missing[where] = found;
  };
  await look("scene");
  await hands.select("water");
  await look("node");
  await hands.pressInGraph("Enter");
  await hands.node("water").locator(".inner").waitFor();
  await look("modules in the graph");
  await hands.pressInGraph("Enter");
  for (const name of ["Open", "Templates", "Versions", "Help", "Find"]) {
    await button(name).click();
    await page.getByRole("dialog").waitFor();
    await look(name);
    await page.keyboard.press("Escape");
  }
  for (const tab of ["Time", "Particles", "Device", "Log"]) {
    await page.getByRole("tab", { name: tab }).click();
    await look(tab);
  }
  assert.deepEqual(missing, {});
});

step("the page had nothing to complain of", () => assert.deepEqual(mistakes, []));
