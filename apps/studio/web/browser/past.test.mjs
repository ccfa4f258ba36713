// What was is looked at again, by mouse and keyboard alone: recorded frames as pictures and in the table, and plots after a reload.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { step } from "./steps.mjs";
import { openStudio, openWindow } from "./studio.mjs";

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

const { server, context, page, mistakes, hands, state, button, open } = await openStudio({ "falling.json": kScene });

const tab = (name) => page.getByRole("tab", { name, exact: true });
/** The frame that a text tells, of the picture or of the table. */
const frameIn = async (place) => Number(await page.locator(place).getAttribute("data-frame"));
const look = async (key) => {
  await page.getByRole("slider", { name: "Frame" }).focus();
  await page.keyboard.press(key);
};

/** Notes the states that the run comes to from now on; what is given back tells them. */
async function watchStates() {
  await page.evaluate(() => {
    const told = document.querySelector(".state");
    window.statesSeen = [];
    new MutationObserver(() => window.statesSeen.push(told.textContent)).observe(told, { characterData: true, subtree: true, childList: true });
  });
  return () => page.evaluate(() => window.statesSeen);
}

step("a recorded frame is rendered, and told by its time", async () => {
  await open("falling");
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

step("a video of a run that has ended is of its recorded frames, and the run stays as it is", async () => {
  if (!(await page.evaluate(() => fetch("/api/types").then((r) => r.json()))).sections.render) return;
  await state("finished");
  await button("Record").click();
  const dialog = page.getByRole("dialog", { name: "Record a video" });
  await dialog.getByRole("combobox", { name: "Frames of the video" }).and(page.locator(":has(option[value=recorded]:checked)")).waitFor();
  await dialog.locator(".hint").filter({ hasText: /Nothing is run again|kept whole/ }).waitFor();
  const states = await watchStates();
  await hands.type(dialog.getByRole("textbox", { name: "Video file" }), "recorded.mp4");
  await page.getByRole("link", { name: /^recorded\.mp4 \(13 frames(, \d+ of them kept)?\)$/ }).waitFor();
  const count = execFileSync("ffprobe", ["-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", join(server.folder, "recorded.mp4")]);
  assert.equal(Number(String(count)), kFrames + 1);
  assert.deepEqual(await states(), []);
  await page.locator(".time").filter({ hasText: `frame ${kFrames}/${kFrames}` }).waitFor();
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
