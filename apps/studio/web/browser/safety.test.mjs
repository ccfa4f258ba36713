// No work is lost, and Play always does something: large numbers, files that are there already, drafts, a server that was
// started again, runs that failed or ended.
import assert from "node:assert/strict";
import { readFile, stat, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before } from "node:test";
import { step } from "./steps.mjs";
import { Hands, openPage, openWindow, startServer } from "./studio.mjs";

const kScene = {
  weir: 1, title: "Blocks", world: { duration: 0.04, frame_rate: 100 },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0, 0, 0], max: [0.2, 0.2, 0.2] } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [1, 1, 1], inverted: true } },
    water: { type: "ParticleFluid", params: { spacing: 0.04, rest_steps: 0 }, modules: { solver: { type: "SemiImplicitSolver" } } },
  },
  links: ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
};

let server, browser, context, page, hands;

before(async () => {
  server = await startServer();
  for (const name of ["blocks", "other"]) await writeFile(join(server.folder, `${name}.json`), JSON.stringify(kScene));
  const unshaped = { ...kScene, nodes: { ...kScene.nodes, tank: { type: "StaticBoundary" } } };
  await writeFile(join(server.folder, "unshaped.json"), JSON.stringify(unshaped));
  await show();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

async function show() {
  ({ browser, context, page } = await openPage(server.address));
  hands = new Hands(page);
}

const state = (name) => page.locator(".state").filter({ hasText: name }).waitFor();
const dialog = (name) => page.getByRole("dialog", { name });
const offer = () => dialog("Changes that were not saved");
const spacing = () => hands.aside().getByLabel("spacing", { exact: true });

async function open(name, reached = "paused") {
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.getByRole("dialog").getByRole("button", { name }).click();
  await hands.node("water").waitFor();
  await state(reached);
  await hands.arrange();
}

const written = (name, isRight) => server.written(name, isRight);

step("what is edited after a number of 1e20 still reaches the server", async () => {
  await open("blocks");
  await hands.pointAtGraph();
  await hands.set(hands.aside(), "gravity", "vec3", [0, -1e20, 0]);
  await hands.select("water");
  await hands.type(spacing(), 0.05);
  await page.keyboard.press("Control+s");
  await written("blocks.json", (s) => s.world.gravity?.[1] === -1e20 && s.nodes.water.params.spacing === 0.05);
  await hands.pointAtGraph();
  await hands.set(hands.aside(), "gravity", "vec3", [0, -9.8, 0]);
  await page.keyboard.press("Control+s");
  await written("blocks.json", (s) => s.world.gravity?.[1] !== -1e20);
});

step("saving under the name of another scene asks", async () => {
  const before = await readFile(join(server.folder, "other.json"), "utf8");
  await page.getByRole("button", { name: "Save as" }).click();
  const box = dialog("Save the scene");
  await hands.type(box.getByLabel("File name"), "other.json");
  await box.getByRole("alert").filter({ hasText: "There is a scene other.json already" }).waitFor();
  assert.equal(await readFile(join(server.folder, "other.json"), "utf8"), before);
  await hands.type(box.getByLabel("File name"), "third");
  await box.waitFor({ state: "hidden" });
  await written("third.json", (s) => s.nodes.water.params.spacing === 0.05);
  await page.getByRole("button", { name: "Save as" }).click();
  await hands.type(box.getByLabel("File name"), "other.json");
  await box.getByRole("button", { name: "Replace it" }).click();
  await box.waitFor({ state: "hidden" });
  await written("other.json", (s) => s.nodes.water.params.spacing === 0.05);
});

step("Play begins anew at the end, and by Space after a click on a button", async () => {
  await page.getByRole("button", { name: "Play" }).click();
  await state("finished");
  await page.getByRole("button", { name: "Reset", exact: true }).click();
  await state("paused");
  await page.keyboard.press(" ");
  await state("finished");
  await page.evaluate(() => {
    window.states = [];
    new MutationObserver(() => window.states.push(document.querySelector(".state").textContent)).observe(document.querySelector(".state"), { characterData: true, subtree: true, childList: true });
  });
  await page.keyboard.press(" ");
  await page.waitForFunction(() => window.states.includes("playing") && window.states.at(-1) === "finished");
});

step("Space plays after a scene was chosen", async () => {
  await open("blocks");
  await page.getByRole("dialog").waitFor({ state: "detached" });
  await page.keyboard.press(" ");
  await state("finished");
  assert.equal(await page.getByRole("dialog").count(), 0);
});

step("a failure is shown until the scene is another one, and Play tries again", async () => {
  await open("unshaped", "failed");
  await page.locator(".problem-line").waitFor();
  await hands.select("tank");
  await page.locator(".problem-line").getByRole("button", { name: "Shape: box" }).click();
  assert.equal(await hands.aside().getByLabel("shape", { exact: true }).inputValue(), "box");
  await page.locator(".problem-line").waitFor({ state: "detached" });
  await hands.set(hands.aside(), "inverted", "bool", true);
  await page.getByRole("button", { name: "Play" }).click();
  await state("finished");
  await page.locator(".problem-line").waitFor({ state: "detached" });
});

step("the health of a run says what is wrong, and why", async () => {
  await page.getByRole("button", { name: /^Health: (good|look at it)/ }).click();
  const why = dialog("Health of the run");
  await why.getByText(/^Lost: 0/).waitFor();
  await page.keyboard.press("Escape");
  await why.waitFor({ state: "detached" });
  await hands.select("water");
  await hands.pressInGraph("Escape");
  await hands.set(hands.aside(), "gravity", "vec3", [0, -1e8, 0]);
  await page.getByRole("button", { name: "Play" }).click();
  await page.locator(".light", { hasText: "compression" }).and(page.locator(".watch, .bad")).waitFor();
  await page.getByRole("button", { name: /^Health: (look at it|bad)/ }).click();
  await why.getByText("Above 1 % the liquid loses volume").waitFor();
  await why.getByRole("button", { name: "Show water" }).first().click();
  await page.locator('[data-node="water"].selected').waitFor();
  await page.keyboard.press("Escape");
});

step("New takes the old world away, and can be undone", async () => {
  assert.notEqual(await page.locator(".load").innerText(), "0 particles");
  await page.locator(".light.warnings").waitFor();
  await page.getByRole("button", { name: "New", exact: true }).click();
  await state("empty");
  await page.locator(".light.warnings").waitFor({ state: "detached" });
  await page.locator(".load").filter({ hasText: /^0 particles/ }).waitFor();
  await hands.pressInGraph("Control+z");
  await hands.node("water").waitFor();
});

step("a draft is offered, not now keeps it", async () => {
  await open("blocks");
  await hands.select("water");
  await hands.type(spacing(), 0.0625);
  await written(".blocks.json.draft", (s) => s?.nodes.water.params.spacing === 0.0625);
  await browser.close();
  await server.crash();
  server = await startServer([join(server.folder, "blocks.json")], { folder: server.folder });
  await show();
  await offer().getByText("3 nodes").waitFor();
  await page.keyboard.press("Escape");
  await offer().waitFor({ state: "detached" });
  assert.equal((await server.read(".blocks.json.draft")).nodes.water.params.spacing, 0.0625);
  await page.reload();
  await offer().getByRole("button", { name: "Restore" }).click();
  await hands.select("water");
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.0625");
});

step("what a window has edited outlives a server that was started again", async () => {
  const port = new URL(server.address).port;
  await server.crash();
  await page.getByRole("alert").filter({ hasText: "There is no connection to the studio" }).waitFor();
  await hands.type(spacing(), 0.017);
  server = await startServer(["--port", port, "--new-token"], { folder: server.folder });
  await page.getByRole("alert").filter({ hasText: "open the address that it printed" }).waitFor();
  const other = await openWindow(context, server.address);
  await offer().getByText("This window has changes that the server does not have").waitFor();
  await offer().getByRole("button", { name: "Restore" }).click();
  await hands.node("water").waitFor();
  await hands.select("water");
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.017");
  await other.locator('[data-node="water"]').waitFor();
  await written(".untitled.json.draft", (s) => s?.nodes.water.params.spacing === 0.017);
});

step("a draft of a scene without a file has a picture of its run", async () => {
  const port = new URL(server.address).port, picture = join(server.folder, ".untitled.json.jpg");
  await hands.type(spacing(), 0.0625);
  await page.getByRole("button", { name: "Play" }).click();
  await state("finished");
  while (!(await stat(picture).catch(() => null))) await page.waitForTimeout(100);
  await server.crash();
  server = await startServer(["--port", port], { folder: server.folder });
  await offer().getByText("3 nodes").waitFor();
  await page.waitForFunction(() => document.querySelector(".last-seen").naturalWidth > 0);
  await offer().getByRole("button", { name: "Restore" }).click();
  await hands.select("water");
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.0625");
});

step("a window goes on with a server that was started again at its port, without another address", async () => {
  const port = new URL(server.address).port, lost = page.getByRole("alert").filter({ hasText: "There is no connection to the studio" });
  await server.crash();
  await lost.waitFor();
  await hands.type(spacing(), 0.019);
  server = await startServer(["--port", port, join(server.folder, "blocks.json")], { folder: server.folder });
  await lost.waitFor({ state: "detached" });
  await offer().getByText("This window has changes that the server does not have").waitFor();
  await offer().getByRole("button", { name: "Restore" }).click();
  await hands.select("water");
  await page.waitForFunction(() => document.querySelector('[aria-label="spacing"]').value === "0.019");
  await written(".blocks.json.draft", (s) => s?.nodes.water.params.spacing === 0.019);
});
