// What was is looked at again, by mouse and keyboard alone: recorded frames as pictures and in the table, and plots after a reload.
import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before } from "node:test";
import { step } from "./steps.mjs";
import { Hands, openPage, openWindow, startServer } from "./studio.mjs";

// Water that falls in a tank.
const kFrames = 12, kRate = 30;
const kScene = {
  weir: 1, title: "Falling", world: { duration: kFrames / kRate, frame_rate: kRate },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0.05, 0.05, 0.05], max: [0.25, 0.35, 0.25] } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [0.5, 0.5, 0.3], inverted: true } },
    water: { type: "ParticleFluid", params: { spacing: 0.03, rest_steps: 0 } },
  },
  links: ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
};

let server, browser, context, page, mistakes, hands;

before(async () => {
  server = await startServer();
  await writeFile(join(server.folder, "falling.json"), JSON.stringify(kScene));
  ({ browser, context, page, mistakes } = await openPage(server.address));
  hands = new Hands(page);
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const state = (name) => page.locator(`.state.${name}`).waitFor();
const button = (name) => page.getByRole("button", { name, exact: true });
const tab = (name) => page.getByRole("tab", { name, exact: true });
/** The frame that a text tells, of the picture or of the table. */
const frameIn = async (place) => Number(await page.locator(place).getAttribute("data-frame"));
const look = async (key) => {
  await page.getByRole("slider", { name: "Frame" }).focus();
  await page.keyboard.press(key);
};

step("a recorded frame is rendered, and told by its time", async () => {
  await button("Open").click();
  await page.getByRole("dialog", { name: "Open a scene" }).getByRole("button", { name: /^falling / }).click();
  await hands.node("water").waitFor();
  await state("paused");
  // One after another, so that each is kept whole.
  await hands.arrange();
  for (let frame = 1; frame <= kFrames; ++frame) {
    await hands.pressInGraph(".");
    await page.locator(".time").filter({ hasText: `frame ${frame}/${kFrames}` }).waitFor();
  }
  await button("Rendered").click();
  const picture = page.locator("img.rendered[src]");
  await picture.waitFor();
  await page.locator(".told.over").waitFor({ state: "detached" });
  const atEnd = await picture.getAttribute("src");
  await look("Home");
  await page.locator('.told.over[data-frame="0"]').filter({ hasText: "Frame 0, 0.000 s" }).waitFor();
  assert.notEqual(await picture.getAttribute("src"), atEnd);
  assert.equal(await page.locator(".stage .faces").count(), 0, "handles of the particles' view are shown");
  await page.locator(".time").filter({ hasText: "frame 0, 0.000 s" }).waitFor();
  await look("ArrowRight");
  await page.waitForFunction(() => document.querySelector(".told.over")?.dataset.asked === "1");
  const frame = await frameIn(".told.over");
  assert.match(await page.locator(".told.over").innerText(), new RegExp(`^Frame ${frame}, ${(frame / kRate).toFixed(3)} s`));
  await button("Follow the run").click();
  await page.locator(".told.over").waitFor({ state: "detached" });
});

step("the table shows the particles of the recorded frame", async () => {
  await tab("Particles").click();
  const lines = () => page.locator(".particle-table tbody tr").first().innerText();
  const end = (kFrames / kRate).toFixed(3);
  await page.locator(".pager small").filter({ hasText: `at ${end} s` }).waitFor();
  const atEnd = await lines();
  await look("Home");
  await page.locator('.pager small[data-frame="0"]').filter({ hasText: "at 0.000 s" }).waitFor();
  assert.notEqual(await lines(), atEnd);
  await look("End");
  await page.locator(".pager small").filter({ hasText: `at ${end} s` }).waitFor();
  assert.equal(await lines(), atEnd);
  await button("Rendered").click();
});

const plotted = (of) => of.locator('.plot[data-quantity="water.kinetic_energy"]');
const pointsOf = async (of) => (await plotted(of).locator("polyline").getAttribute("points")).split(" ").length;

step("plots are those of the whole run after a reload, and in a second window", async () => {
  await tab("Plots").click();
  const [points, value] = [await pointsOf(page), await plotted(page).getByRole("img").getAttribute("aria-label")];
  assert.ok(points >= 3, `${points} points`);
  await page.reload();
  await plotted(page).waitFor();
  const other = await openWindow(context, server.address, mistakes);
  await plotted(other).waitFor();
  for (const window of [page, other]) {
    assert.equal(await pointsOf(window), points);
    assert.equal(await plotted(window).getByRole("img").getAttribute("aria-label"), value);
  }
  await other.close();
});

step("nothing went wrong on the way", () => assert.deepEqual(mistakes, []));
