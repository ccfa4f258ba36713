// What is done with whole runs, by mouse and keyboard alone: two are compared, one goes back to a frame, several values are
// tried, and what is shown is shared.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { step } from "./steps.mjs";
import { openStudio, savedBy } from "./studio.mjs";

// Water that falls in a tank, 12 frames long.
const kFrames = 12;
const kScene = {
  weir: 1, title: "Falling", world: { duration: kFrames / 30, frame_rate: 30 },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0.05, 0.05, 0.05], max: [0.25, 0.35, 0.25] } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [0.5, 0.5, 0.3], inverted: true } },
    water: { type: "ParticleFluid", params: { spacing: 0.03, rest_steps: 0 } },
  },
  links: ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
};

const { server, browser, page, mistakes, hands, state, button, open } = await openStudio({ "falling.json": kScene });

const time = (text) => page.locator(".time").filter({ hasText: text }).waitFor();

/** Plays to the end, from where the run is or anew; however short it is. */
async function play() {
  await page.evaluate(() => {
    const told = document.querySelector(".state");
    window.statesSeen = [];
    window.watchesStates ??= new MutationObserver(() => window.statesSeen.push(told.textContent));
    window.watchesStates.observe(told, { characterData: true, subtree: true, childList: true });
  });
  await hands.pressInGraph("Space");
  await page.waitForFunction(() => window.statesSeen.at(-1) === "finished");
}

async function openFalling() {
  await open("falling");
  await hands.arrange();
}

step("a run is kept, and the next one is seen beside it: one time, one camera, and what differs", async () => {
  await openFalling();
  await play();
  await button("Compare").click();
  const kept = page.getByLabel("The run that was kept");
  await kept.waitFor();
  const differences = page.getByRole("group", { name: "In what the runs differ" });
  await differences.getByText("Nothing differs yet").waitFor();
  // One second from now on in each: half the gravity.
  await hands.pressInGraph("Escape");
  await hands.set(hands.aside(), "gravity", "vec3", [0, -1, 0]);
  await differences.getByRole("button", { name: /World: Gravity.*→ 0, -1, 0/ }).waitFor();
  await play();
  await page.locator(".plot polyline.other").first().waitFor({ state: "attached" });
  // Both are at the end; then both go back to the same frame.
  const end = (kFrames / 30).toFixed(3);
  await page.waitForFunction((t) => document.querySelector(".compared").dataset.time === t, end);
  await page.getByRole("slider", { name: "Frame" }).focus();
  await page.keyboard.press("Home");
  await time("frame 0, 0.000 s");
  await page.waitForFunction(() => document.querySelector(".compared").dataset.time === "0.000");
  // A drag in one of them turns both.
  const pictures = async () => (await Promise.all([page.locator(".compared canvas"), page.locator(".stage:not(.compared) > canvas")].map((c) => c.screenshot()))).map((p) => p.toString("base64"));
  const before = await pictures();
  const { x, y, width, height } = await kept.boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 80, y + height / 2, { steps: 4 });
  await page.mouse.up();
  const turned = await pictures();
  assert.ok(turned.every((p, i) => p !== before[i]), "not both have turned");
  await differences.getByRole("button", { name: /Gravity/ }).click();
  await page.waitForFunction(() => document.activeElement.getAttribute("aria-label") === "gravity x");
  await button("End comparison").click();
  await kept.waitFor({ state: "detached" });
});

step("a run goes back to a frame, and from there on with another value", async () => {
  await hands.set(hands.aside(), "gravity", "vec3", [0, -9.8, 0]);
  await hands.pressInGraph("r");
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
  await play();
  const energy = async () => Number((await page.locator('.plot[data-quantity="water.potential_energy"] figcaption b').last().innerText()).split(" ")[0]);
  const before = await energy();
  await page.getByRole("slider", { name: "Frame" }).focus();
  for (let i = 0; i < kFrames - 4; ++i) await page.keyboard.press("ArrowLeft");
  await time("frame 4, 0.133 s");
  await button("Go back to this frame").click();
  // Or to the last one before it that could be kept.
  await state("paused");
  await time(/^0\.(133|1|067|033|0)\d* \/ 0\.40 s · frame [0-4]\//);
  await hands.pressInGraph("Escape");
  await hands.set(hands.aside(), "gravity", "vec3", [0, 9.8, 0]);
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
  await play();
  assert.ok((await energy()) !== before);
  await hands.pressInGraph("Control+z", "Control+z");
  await hands.set(hands.aside(), "gravity", "vec3", [0, -9.8, 0]);
  // What asks for a reset cannot be of the same run.
  await hands.select("water");
  await hands.set(hands.aside(), "spacing", "float", 0.04);
  await page.locator(".reset-hint").filter({ hasText: "spacing" }).waitFor();
  await page.getByRole("slider", { name: "Frame" }).focus();
  await page.keyboard.press("Home");
  await time("frame 0, 0.000 s");
  assert.ok(await button("Go back to this frame").isDisabled());
  await hands.pressInGraph("Control+z");
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
});

step("several values of a parameter are tried, looked at side by side, and one is used", async () => {
  await hands.select("water");
  const spacing = hands.aside().locator('[data-param="spacing"] .name');
  await spacing.click({ button: "right" });
  await page.getByRole("menu", { name: "spacing" }).getByRole("menuitem", { name: "Sweep this value…" }).click();
  const box = page.getByRole("dialog", { name: /^Sweep water: Spacing/ });
  await hands.type(box.getByLabel("Values", { exact: true }), "0.04, -1", "Tab");
  await box.getByRole("alert").filter({ hasText: "-1 cannot be" }).waitFor();
  assert.ok(await box.getByRole("button", { name: "Start" }).isDisabled());
  await hands.type(box.getByLabel("Values", { exact: true }), "0.04, 0.05, 0.2", "Tab");
  // The command line would do the same.
  await box.getByText("On a cluster, or several at once").click();
  const command = (await box.getByLabel("The sweep as a command").innerText()).split(" ");
  assert.equal(command.shift(), "weir");
  const points = execFileSync(process.env.WEIR ?? "weir", [...command, "--list"], { cwd: server.folder, encoding: "utf8" });
  for (const value of ["0.04", "0.05", "0.2"]) assert.ok(points.includes(value), points);
  await box.getByRole("button", { name: "Start" }).click();
  await box.locator(".progress").waitFor();
  await box.locator(".progress").waitFor({ state: "detached" });
  assert.deepEqual(await box.locator(".multiples li").evaluateAll((all) => all.map((li) => li.dataset.value)), ["0.04", "0.05", "0.2"]);
  await box.getByLabel("Quantity").selectOption("particles");
  // As many particles as there are places on a grid in the block, whatever the fluid says.
  const told = await box.locator(".against .field").getAttribute("aria-label");
  const counts = [...told.matchAll(/(0\.\d+): (\d+)/g)].map(([, v, n]) => [Number(v), Number(n)]);
  assert.ok(counts.length >= 2 && counts[0][1] > counts[1][1], told);
  for (const [v, n] of counts.slice(0, 2)) {
    const places = Math.round(0.2 / v) ** 2 * Math.round(0.3 / v);
    assert.ok(Math.abs(n / places - 1) < 0.35, `${n} particles of ${v} m, ${places} places`);
  }
  // The pictures go through time together.
  const first = box.getByRole("img", { name: "With 0.04" });
  await first.locator("canvas").waitFor();
  const pixels = () => first.locator("canvas").evaluate((c) => c.toDataURL());
  const end = await pixels();
  await box.getByLabel("Time of the pictures").focus();
  await page.keyboard.press("Home");
  await page.waitForFunction((e) => document.querySelector(".multiples canvas").toDataURL() !== e, end);
  // Nothing of that has changed the scene.
  assert.equal(await hands.aside().getByLabel("spacing", { exact: true }).inputValue(), "0.03");
  await box.locator('[data-value="0.05"]').getByRole("button", { name: "Use it" }).click();
  await box.waitFor({ state: "detached" });
  assert.equal(await hands.aside().getByLabel("spacing", { exact: true }).inputValue(), "0.05");
  await hands.pressInGraph("Control+z");
  assert.equal(await hands.aside().getByLabel("spacing", { exact: true }).inputValue(), "0.03");
  await hands.pressInGraph("r");
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
});

const saved = (f) => savedBy(page, server.folder, f);

/** Drops a file of the disk on the view. */
async function drop(path) {
  const name = path.split("/").at(-1);
  const dropped = await page.evaluateHandle(([name, data]) => {
    const all = new DataTransfer();
    all.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], name));
    return all;
  }, [name, (await readFile(path)).toString("base64")]);
  await page.dispatchEvent(".viewport", "drop", { dataTransfer: dropped });
}

async function opensFrom(path) {
  await button("New").click();
  await hands.node("water").waitFor({ state: "detached" });
  await drop(path);
  await hands.node("water").waitFor();
  await page.locator(".bar .title").filter({ hasText: "Falling" }).waitFor();
  await hands.select("tank");
  assert.equal(await hands.aside().getByLabel("max x", { exact: true }).inputValue(), "0.5");
}

let replay;

step("a run is shared as one file, which replays it in any browser", async () => {
  await state("paused");
  await play();
  await button("Share").click();
  replay = await saved(() => button("Save the file").click());
  assert.match(replay, /falling\.html$/);
  const other = await browser.newPage({ viewport: { width: 900, height: 600 } });
  const complaints = [];
  other.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  other.on("pageerror", (e) => complaints.push(e.message));
  await other.goto(pathToFileURL(replay).href);
  assert.equal(await other.title(), "Falling");
  await other.waitForFunction((last) => document.getElementById("frame").max === String(last) && Number(document.getElementById("frame").value) > 0, kFrames);
  await other.getByRole("button", { name: "Pause" }).click();
  const at = (value) => other.getByLabel("Frame").evaluate((e, v) => ((e.value = v), e.dispatchEvent(new Event("input"))), value);
  const seen = async (text) => (await other.locator("#time").filter({ hasText: text }).waitFor(), (await other.locator("#view").screenshot()).toString("base64"));
  await at(kFrames);
  const end = await seen((kFrames / 30).toFixed(3));
  await at(0);
  const start = await seen("0.000");
  assert.notEqual(start, end);
  await other.mouse.move(400, 300);
  await other.mouse.down();
  await other.mouse.move(500, 320, { steps: 4 });
  await other.mouse.up();
  assert.notEqual(await seen("0.000"), start);
  assert.deepEqual(complaints, []);
  await other.close();
});

step("what was shared opens again where it is dropped: the page, a picture, a video", async () => {
  await opensFrom(replay);
  const picture = await saved(() => button("Save a picture").click());
  // Another program reads it, too.
  assert.match(String(execFileSync("ffprobe", ["-v", "error", "-show_entries", "stream=codec_name", "-of", "csv=p=0", picture])), /^png/);
  await opensFrom(picture);
  if (!(await page.evaluate(() => fetch("/api/types").then((r) => r.json()))).sections.render) return;
  await state("paused");
  for (const name of ["falling.mp4", "falling.webm", "falling.gif"]) {
    await button("Record").click();
    await hands.type(page.getByRole("textbox", { name: "Video file" }), name);
    await page.locator(".recording").waitFor();
    await hands.pressInGraph(".");
    await time("frame 1/");
    await page.locator(".recording").click();
    await page.getByRole("link", { name: new RegExp(name) }).waitFor();
    const video = join(server.folder, name);
    assert.equal(String(execFileSync("ffprobe", ["-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", video])).trim(), "2");
    await opensFrom(video);
    await state("paused");
  }
  await writeFile(join(server.folder, "other.html"), "<p>Nothing of a scene</p>");
  await drop(join(server.folder, "other.html"));
  await page.getByRole("alert").filter({ hasText: "other.html carries no scene" }).waitFor();
});

step("the page had nothing to complain of", () => assert.deepEqual(mistakes, []));
