// What is done to a scene that is there already, by mouse and keyboard alone: nodes that are left out, the table of particles,
// modules of plugins, frames that were recorded, a second window, and what is left after a crash.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFile, mkdir, writeFile } from "node:fs/promises";
import { basename, join } from "node:path";
import { after, before } from "node:test";
import { step } from "./steps.mjs";
import { Hands, openPage, openWindow, startServer } from "./studio.mjs";

const kScene = {
  weir: 1, title: "Blocks", world: { duration: 4, frame_rate: 30 },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0.05, 0.05, 0.05], max: [0.25, 0.35, 0.25] } },
    floor: { type: "StaticBoundary", params: { shape: "plane" } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [0.5, 0.5, 0.3], inverted: true } },
    water: { type: "ParticleFluid", params: { spacing: 0.025, rest_steps: 0 }, modules: { solver: { type: "SemiImplicitSolver" } } },
  },
  links: ["block.particles -> water.initial", "floor.boundary -> tank.boundaries", "tank.boundary -> water.boundaries"],
};

let server, browser, context, page, mistakes, hands;

before(async () => {
  server = await startServer();
  await writeFile(join(server.folder, "blocks.json"), JSON.stringify(kScene));
  const plugins = join(server.folder, "plugins");
  await mkdir(plugins);
  await copyFile(process.env.WEIR_TEST_PLUGIN, join(plugins, basename(process.env.WEIR_TEST_PLUGIN)));
  await restart();
});
after(async () => {
  await browser?.close();
  await server?.close();
});

/** The server ends as in a crash, and another one serves the same folder. */
async function restart(...options) {
  await browser?.close();
  await server.crash();
  server = await startServer(options, { folder: server.folder, env: { WEIR_PLUGIN_PATH: join(server.folder, "plugins") } });
  ({ browser, context, page, mistakes } = await openPage(server.address));
  hands = new Hands(page);
}

const time = (text) => page.locator(".time").filter({ hasText: text });
const frame = async () => Number(/frame (\d+)\//.exec(await page.locator(".time").innerText())[1]);

async function open(name) {
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.getByRole("dialog").getByRole("button", { name }).click();
  await hands.node("water").waitFor();
  await hands.arrange();
}

/** Saves, and waits until the file is as it should be. */
async function save(check) {
  await page.keyboard.press("Control+s");
  for (let tries = 100; ; --tries)
    try {
      return check(await server.read("blocks.json"));
    } catch (e) {
      if (tries === 0) throw e;
      await page.waitForTimeout(100);
    }
}

/** What the view shows. */
const seen = async () => (await page.locator(".viewport").screenshot()).toString("base64");

step("nodes stay where they are seen, whatever is brought into view", async () => {
  await open("blocks");
  const moved = await page.evaluate(() =>
    [...document.querySelectorAll(".scene-node")].flatMap((node) => {
      const before = node.getBoundingClientRect();
      node.scrollIntoView({ block: "center", inline: "center", behavior: "instant" });
      const after = node.getBoundingClientRect();
      return after.x === before.x && after.y === before.y ? [] : [`${node.dataset.node} by ${after.x - before.x}, ${after.y - before.y}`];
    }),
  );
  assert.deepEqual(moved, []);
});

step("a hand that trembles chooses a node, and does not move it", async () => {
  for (const by of [1, 2, 3]) {
    await hands.pressInGraph("Escape");
    const before = await hands.node("tank").boundingBox();
    const title = await hands.node("tank").locator("strong").boundingBox();
    const [x, y] = [title.x + title.width / 2, title.y + title.height / 2].map(Math.floor);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + by, y);
    await page.mouse.up();
    await page.locator('[data-node="tank"].selected').waitFor();
    assert.deepEqual(await hands.node("tank").boundingBox(), before);
  }
});

step("a bypassed node passes on what comes in, a muted one nothing, and both can be edited", async () => {
  await hands.select("tank");
  await hands.pressInGraph("b");
  await page.locator('[data-node="tank"].bypassed').waitFor();
  await page.locator(".passages path").waitFor({ state: "attached" });
  await hands.set(hands.aside(), "min", "vec3", [0, 0, -0.1]);
  await save((s) => {
    assert.deepEqual(Object.keys(s.nodes), ["block", "floor", "water"]);
    assert.deepEqual(s.links, ["block.particles -> water.initial", "floor.boundary -> water.boundaries"]);
  });
  await hands.select("floor");
  await hands.aside().getByRole("button", { name: "Mute", exact: true }).click();
  await page.locator('[data-node="floor"].muted').waitFor();
  await save((s) => assert.deepEqual(s.links, ["block.particles -> water.initial"]));
  await open("blocks");
  await page.locator('[data-node="tank"].bypassed').waitFor();
  await page.locator('[data-node="floor"].muted').waitFor();
  for (const name of ["tank", "floor"]) {
    await hands.select(name);
    await hands.aside().getByRole("button", { name: "On", exact: true }).click();
  }
  await page.locator(".bar .title").filter({ hasText: "changed" }).waitFor();
  await save((s) => {
    assert.deepEqual([...s.links].sort(), [...kScene.links].sort());
    assert.deepEqual(s.nodes.tank.params.min, [0, 0, -0.1]);
  });
  await page.locator(".bar .title").filter({ hasText: /blocks\.json$/ }).waitFor();
});

step("what is being typed is saved, too", async () => {
  await hands.select("tank");
  await hands.aside().getByLabel("max x", { exact: true }).click();
  await page.keyboard.press("Control+A");
  await page.keyboard.type("0.6");
  await save((s) => assert.equal(s.nodes.tank.params.max[0], 0.6));
});

step("what a field refused is gone after an undo", async () => {
  await hands.select("tank");
  // Not of the parameter that was changed last: that could be one step with it.
  await hands.type(hands.aside().getByLabel("min y", { exact: true }), "-0.1");
  const field = hands.aside().getByLabel("max x", { exact: true });
  await hands.type(field, "wide");
  await hands.aside().getByRole("alert").filter({ hasText: "a number" }).waitFor();
  assert.equal(await field.inputValue(), "wide");
  await page.getByRole("button", { name: "Undo" }).click();
  await hands.aside().getByRole("alert").waitFor({ state: "detached" });
  assert.equal(await field.inputValue(), "0.6");
  assert.equal(await hands.aside().getByLabel("min y", { exact: true }).inputValue(), "0");
});

step("a run has what was edited before it was asked for, however late the server is", async () => {
  await hands.pointAtGraph();
  const world = await hands.open(page.locator('[data-param="world"]'));
  const duration = world.getByLabel("duration", { exact: true });
  await server.meanwhile(async () => {
    for (const seconds of [3, 2]) await hands.type(duration, seconds);
    await hands.pressInGraph("r");
  });
  await time("/ 2.00 s").waitFor();
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
  await hands.type(duration, kScene.world.duration);
  await hands.pressInGraph("r");
  await time("/ 4.00 s").waitFor();
});

const chosen = () => page.locator(".scene-node.selected").evaluateAll((nodes) => nodes.map((n) => n.dataset.node));
/** The graph shows it a frame later than it is chosen elsewhere in the page. */
const becomesChosen = (name) =>
  page.waitForFunction((n) => [...document.querySelectorAll(".scene-node.selected")].map((e) => e.dataset.node).join() === n, name);

step("nodes are chosen, folded, grouped and renamed by the keyboard alone", async () => {
  await hands.pressInGraph("Escape");
  assert.deepEqual(await chosen(), []);
  const walked = [];
  for (let i = 0; i < 4; ++i) {
    await hands.pressInGraph("PageDown");
    walked.push(...(await chosen()));
  }
  assert.deepEqual([...walked].sort(), ["block", "floor", "tank", "water"]);
  assert.equal(walked[3], "water");  // what it takes stands before it
  await hands.pressInGraph("PageUp");
  assert.deepEqual(await chosen(), [walked[2]]);
  await hands.pressInGraph("PageDown");
  await hands.pressInGraph("F2");
  await page.keyboard.type("sea");
  await page.keyboard.press("Enter");
  await hands.node("sea").waitFor();
  await save((s) => assert.ok(s.links.includes("tank.boundary -> sea.boundaries")));
  await hands.pressInGraph("c");
  await page.locator('[data-node="sea"].collapsed').waitFor();
  await hands.pressInGraph("Control+a", "g");
  const frame = page.locator(".note.frame");
  const outer = await frame.boundingBox();
  for (const name of ["block", "floor", "tank", "sea"]) {
    const box = await hands.node(name).boundingBox();
    assert.ok(box.x > outer.x && box.y > outer.y && box.x + box.width < outer.x + outer.width && box.y + box.height < outer.y + outer.height, name);
  }
  await hands.pressInGraph("Control+z", "Control+z", "Control+z");
  await frame.waitFor({ state: "detached" });
  await hands.node("water").waitFor();
  // The keyboard can leave the graph again.
  await hands.pressInGraph("Shift+Tab");
  assert.ok(await page.evaluate(() => document.activeElement.getAttribute("aria-label") !== "Node editor" && !document.querySelector(".add-menu")));
});

const noteTexts = () => page.locator(".note textarea").evaluateAll((notes) => notes.map((n) => n.value).sort());
const placeOf = async (text) => {
  const i = (await page.locator(".note textarea").evaluateAll((notes) => notes.map((n) => n.value))).indexOf(text);
  return page.locator(".note").nth(i).boundingBox();
};

step("notes and groups are written, copied, moved and deleted with the nodes, and each is one step to undo", async () => {
  const count = () => page.locator(".scene-node").count();
  const add = async (kind, text) => {
    await hands.pointAtGraph();
    await hands.pressInGraph("Tab");
    await page.getByRole("combobox", { name: "Search" }).waitFor();
    await page.keyboard.type(kind);
    await page.keyboard.press("Enter");
    // It is there to be written on.
    await page.waitForFunction(() => document.activeElement.matches(".note textarea"));
    await page.keyboard.type(text);
    await page.keyboard.press("Escape");
  };
  const nodes = await count();
  await add("note", "Mind the gap");
  await hands.pressInGraph("Control+a");
  assert.equal(await page.locator(".react-flow__node.selected").count(), nodes + 1);
  await hands.pressInGraph("g", "F2");
  await page.waitForFunction(() => document.activeElement.matches(".note.frame textarea"));
  await page.keyboard.type("All");
  await page.keyboard.press("Escape");
  assert.deepEqual(await noteTexts(), ["All", "Mind the gap"]);

  await hands.pressInGraph("Control+a", "Control+c", "Control+v");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length === n, 2 * nodes);
  assert.deepEqual(await noteTexts(), ["All", "All", "Mind the gap", "Mind the gap"]);
  await hands.pressInGraph("Control+v");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length === n, 3 * nodes);
  // Side by side, not upon each other.
  await save((s) => assert.equal(new Set(s.layout.notes.map((n) => `${n.frame} ${n.x} ${n.y}`)).size, 6));
  await hands.pressInGraph("Control+z", "Control+z");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length === n, nodes);
  assert.deepEqual(await noteTexts(), ["All", "Mind the gap"]);

  await hands.pressInGraph("Control+a", "Control+d");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length === n, 2 * nodes);
  assert.equal(await page.locator(".react-flow__node.selected").count(), nodes + 2);
  await hands.pressInGraph("Delete");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length === n, nodes);
  assert.deepEqual(await noteTexts(), ["All", "Mind the gap"]);
  await hands.pressInGraph("Control+z", "Control+z");
  await page.waitForFunction((n) => document.querySelectorAll(".scene-node").length === n, nodes);

  // A group that is moved takes along what lies on it, as it is dragged and for good.
  await hands.pressInGraph("f", "Escape");
  await hands.stillness();
  const before = { water: await hands.node("water").boundingBox(), note: await placeOf("Mind the gap"), group: await placeOf("All") };
  await page.mouse.move(before.group.x + before.group.width / 2, before.group.y + before.group.height - 6);
  await page.mouse.down();
  await page.mouse.move(before.group.x + before.group.width / 2 - 30, before.group.y + before.group.height - 26, { steps: 4 });
  const shift = async () => {
    const now = { water: await hands.node("water").boundingBox(), note: await placeOf("Mind the gap"), group: await placeOf("All") };
    return Object.keys(now).map((k) => [Math.round(now[k].x - before[k].x), Math.round(now[k].y - before[k].y)]);
  };
  const [one, ...others] = await shift();
  assert.ok(one[0] < -20 && one[1] < -10, `${one}`);
  for (const other of others) for (const axis of [0, 1]) assert.ok(Math.abs(other[axis] - one[axis]) <= 1, `${others} beside ${one}`);
  await page.mouse.up();
  for (const now of await shift()) for (const axis of [0, 1]) assert.ok(Math.abs(now[axis] - one[axis]) <= 2, `${now} beside ${one}`);
  await hands.pressInGraph("Control+z");
  for (const now of await shift()) for (const axis of [0, 1]) assert.ok(Math.abs(now[axis]) <= 1, `${now}`);
  await hands.pressInGraph(...Array(4).fill("Control+z"));
  await page.locator(".note").first().waitFor({ state: "detached" });
});

step("the list of nodes follows the keys", async () => {
  await hands.pointAtGraph();
  await hands.pressInGraph("Tab");
  await page.getByRole("combobox", { name: "Search" }).waitFor();
  for (let i = 0; i < 12; ++i) await page.keyboard.press("ArrowDown");
  const [list, item] = await Promise.all([page.locator(".add-menu ul"), page.locator('.add-menu [aria-selected="true"]')].map((l) => l.boundingBox()));
  assert.ok(item.y >= list.y - 1 && item.y + item.height <= list.y + list.height + 1);
  await page.keyboard.press("Escape");
});

step("a node is found by what people call it, in spite of a typo, and lies at the pointer", async () => {
  await hands.pressInGraph("f");
  await hands.stillness();
  const graph = await page.locator(".graph").boundingBox();
  // At the lower edge, where the list has no room below the pointer.
  const spot = await page.evaluate(([left, bottom]) => {
    for (let y = bottom - 60; y > bottom - 200; y -= 10)
      for (let x = left + 260; x < left + 800; x += 20)
        if (document.elementFromPoint(x, y)?.classList.contains("react-flow__pane")) return { x, y };
  }, [graph.x, graph.y + graph.height]);
  await hands.doubleClick(spot);
  await page.getByRole("combobox", { name: "Search nodes" }).waitFor();
  assert.deepEqual((await page.locator(".add-menu .heading").allInnerTexts()).slice(0, 2), ["Liquids", "Sources of particles"]);
  await page.keyboard.type("droplte");
  await page.locator('.add-menu [aria-selected="true"]').filter({ hasText: "SphereSampler" }).waitFor();
  await page.keyboard.press("Enter");
  const box = await hands.node("sphere_sampler").boundingBox();
  assert.ok(box.x <= spot.x && spot.x <= box.x + box.width && box.y <= spot.y && spot.y <= box.y + box.height, JSON.stringify([spot, box]));
  await hands.pressInGraph("a");
  await page.locator(".add-menu .heading").filter({ hasText: "Recently used" }).waitFor();
  await page.keyboard.press("Escape");
  await hands.pressInGraph("Control+z");
  await hands.node("sphere_sampler").waitFor({ state: "detached" });
});

step("Ctrl+K finds parameters, modules, nodes and templates", async () => {
  const find = async (text, first) => {
    await page.keyboard.press("Control+k");
    await page.getByRole("combobox", { name: "Find anything" }).waitFor();
    await page.keyboard.type(text);
    await page.locator('.palette [aria-selected="true"]').filter({ hasText: first }).waitFor();
    await page.keyboard.press("Enter");
    await page.locator(".palette").waitFor({ state: "detached" });
  };
  const focused = (label) => page.waitForFunction((l) => document.activeElement.getAttribute("aria-label") === l, label);
  await find("gravity", "gravity");
  await focused("gravity x");
  await find("rest dens", "rest_density");
  await focused("rest_density");
  await becomesChosen("water");
  await find("surface tension", "SurfaceTension");
  await page.locator('aside [data-module="surface_tension"] button.title[aria-expanded="true"]').waitFor();
  await hands.pressInGraph("Control+z");
  await page.locator('aside [data-module="surface_tension"]').waitFor({ state: "detached" });
  await find("tank", "tank");
  await becomesChosen("tank");
  await page.keyboard.press("Control+k");
  await page.keyboard.type("goblet");
  await page.locator(".palette [role=option]").filter({ hasText: "template" }).first().waitFor();
  await page.keyboard.press("Escape");
});

step("a number changes the run while it is dragged, and the drag is one step to undo", async () => {
  await hands.pointAtGraph();
  const gravity = page.locator('[data-param="world"]');
  await hands.open(gravity);
  const duration = gravity.locator('[data-param="duration"]');
  const value = () => duration.getByLabel("duration", { exact: true }).inputValue();
  const before = await value();
  await duration.locator(".grip").hover();
  const grip = await duration.locator(".grip").boundingBox();
  await page.mouse.down();
  await page.mouse.move(grip.x - 40, grip.y, { steps: 3 });
  const during = await value();
  assert.ok(Number(during) < Number(before));
  await save((s) => assert.equal(s.world.duration, Number(during)));  // the hand still holds it
  await page.waitForTimeout(700);
  await page.mouse.move(grip.x - 60, grip.y, { steps: 3 });
  await page.mouse.up();
  assert.ok(Number(await value()) < Number(during));
  await hands.pressInGraph("Control+z");
  assert.equal(await value(), before);
});

step("a number is dragged anywhere on it, finely with Shift, and typed after a click", async () => {
  await hands.select("tank");
  const field = hands.aside().getByLabel("max y", { exact: true });
  const before = Number(await field.inputValue());
  const { x, y, width, height } = await field.boundingBox();
  const by = async (pixels, key) => {
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    if (key) await page.keyboard.down(key);
    await page.mouse.move(x + width / 2 + pixels, y + height / 2, { steps: 4 });
    await page.mouse.up();
    if (key) await page.keyboard.up(key);
    const now = Number(await field.inputValue());
    await hands.pressInGraph("Control+z");
    assert.equal(Number(await field.inputValue()), before);
    return now - before;
  };
  const whole = await by(40), fine = await by(40, "Shift"), coarse = await by(40, "Control");
  assert.ok(fine > 0 && Math.abs(whole / fine - 10) < 1 && Math.abs(coarse / whole - 10) < 1, `${[fine, whole, coarse]}`);
  await hands.type(field, before);
  assert.equal(Number(await field.inputValue()), before);
  // The wheel turns a number that has the keyboard, and no other.
  await field.click();
  await page.mouse.wheel(0, -100);
  await page.waitForFunction((b) => Number(document.querySelector('aside .properties [aria-label="max y"]').value) > b, before);
  await hands.pressInGraph("Control+z");
  assert.equal(Number(await field.inputValue()), before);
});

step("ports that fit light up while a link is dragged", async () => {
  await hands.node("block").locator(".source").hover();
  await page.mouse.down();
  const { x, y } = await hands.node("block").boundingBox();
  await page.mouse.move(x + 60, y - 30, { steps: 3 });
  const marks = (type) => page.locator(`.scene-node .${type}[data-fits]`).evaluateAll((ports) => ports.map((p) => `${p.dataset.nodeid}.${p.dataset.handleid} ${p.dataset.fits}`).sort());
  const targets = await marks("target");
  assert.ok(targets.includes("water.emitters yes") && targets.includes("water.initial no") && targets.includes("water.boundaries no"), `${targets}`);
  assert.ok((await marks("source")).every((p) => p.endsWith(" no")));
  await page.mouse.up();
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("[data-fits]").count(), 0);
});

step("the table has all particles, sorted by any attribute, and goes on while the scene runs", async () => {
  await page.getByRole("button", { name: "Reset", exact: true }).click();
  await time("frame 0/").waitFor();
  for (let i = 1; i <= 3; ++i) {
    await hands.pressInGraph(".");
    await time(`frame ${i}/`).waitFor();
  }
  await page.getByRole("tab", { name: "Particles" }).click();
  const table = page.locator(".particle-table table");
  const column = async (name) => {
    const at = await table.locator("thead th").evaluateAll((heads, n) => heads.findIndex((h) => h.innerText.startsWith(n)), name);
    return (await table.locator(`tbody td:nth-child(${at + 1})`).allInnerTexts()).map(Number);
  };
  await table.getByRole("button", { name: /^speed/ }).click();
  await table.locator('th[aria-sort="descending"]').filter({ hasText: "speed" }).waitFor();
  const speeds = await column("speed");
  assert.equal(speeds.length, 50);
  assert.deepEqual(speeds, [...speeds].sort((a, b) => b - a));
  assert.ok(speeds[0] > 0.5, `${speeds[0]} m/s`);
  await page.getByRole("button", { name: "Next page" }).click();
  await page.locator(".pager").filter({ hasText: "51–100 of" }).waitFor();
  assert.ok((await column("speed"))[0] <= speeds.at(-1));
  const [first] = await column("id");
  await table.locator("tbody tr").first().click();
  await page.locator(".picked").filter({ hasText: `Particle ${first} of water` }).waitFor();
  await page.locator(".picked td").first().waitFor();
  const text = () => table.locator("tbody").innerText();
  const then = await text();
  await hands.pressInGraph("Space");
  await page.waitForFunction((t) => document.querySelector(".particle-table tbody").innerText !== t, then);
  await hands.pressInGraph("Space");
  await page.locator(".picked").getByRole("button", { name: "Close" }).click();
});

step("nodes tell the time that they take, where that is worth a word, and are no wider for it", async () => {
  const timed = hands.node("water").locator(".took"), width = async (name) => (await hands.node(name).boundingBox()).width;
  await timed.filter({ hasText: /\d ms$/ }).waitFor();
  for (const name of ["block", "floor", "tank"]) assert.equal(await hands.node(name).locator(".took, .share").count(), 0);
  const before = await width("water");
  await page.getByRole("button", { name: "Reset", exact: true }).click();
  await timed.waitFor({ state: "detached" });
  assert.equal(await width("water"), before);
  for (let i = 1; i <= 3; ++i) {
    await hands.pressInGraph(".");
    await time(`frame ${i}/`).waitFor();
  }
});

step("recorded frames are seen again", async () => {
  await page.locator(".state.paused").waitFor();
  const last = await seen();
  const slider = page.getByRole("slider", { name: "Frame" });
  await slider.focus();
  await page.keyboard.press("Home");
  await time("frame 0, ").waitFor();
  // The view draws it with the browser's next frame.
  for (let tries = 100; (await seen()) === last; --tries) assert.ok(tries > 0, "the view still shows the last frame");
  await page.keyboard.press("End");
  await page.waitForFunction(() => !document.querySelector(".time").textContent.includes("frame 0, "));
  // A step goes on from where the simulation is, and is seen.
  await page.keyboard.press("Home");
  await time("frame 0, ").waitFor();
  const before = await frame();
  await hands.pressInGraph(".");
  await page.waitForFunction((n) => document.querySelector(".time").textContent.includes(`frame ${n}/`), before + 1);
  assert.equal(await slider.inputValue(), String(before + 1));
});

step("recorded frames are played backwards and forwards, plots mark the one that is shown, and a reset ends it", async () => {
  const last = await frame();
  const press = (name) => page.getByRole("button", { name, exact: true }).click();
  assert.equal(await page.locator(".ruler .tick").last().innerText(), String(kScene.world.duration * kScene.world.frame_rate));
  assert.equal(await page.getByRole("slider", { name: "Frame" }).getAttribute("max"), "120");
  await press("Loop");
  await press("Recorded backwards");
  await time("frame 0, 0.000 s").waitFor();
  await page.getByRole("button", { name: "Recorded backwards", pressed: false }).waitFor();
  await page.getByRole("tab", { name: "Plots" }).click();
  await page.locator(".plot .cursor").first().waitFor({ state: "attached" });
  // Slowly: a machine that is busy leaves frames out.
  await page.getByLabel("Speed of playback").selectOption("0.1");
  await page.evaluate(() => {
    window.framesSeen = [];
    const told = document.querySelector(".time");
    new MutationObserver(() => window.framesSeen.push(/frame (\d+), /.exec(told.textContent)?.[1] ?? null)).observe(told, { characterData: true, subtree: true, childList: true });
  });
  await press("Recorded forwards");
  await time(/^\d+\.\d+ \/ 4\.00 s/).waitFor();
  const seenFrames = (await page.evaluate(() => window.framesSeen)).filter((f) => f !== null).map(Number);
  assert.deepEqual(seenFrames, [...seenFrames].sort((a, b) => a - b));
  assert.ok(new Set(seenFrames).size > 1 && seenFrames.at(-1) < last, `${seenFrames} of ${last}`);
  await page.locator(".plot .cursor").first().waitFor({ state: "detached" });
  await page.getByRole("button", { name: "First frame" }).click();
  await time("frame 0, 0.000 s").waitFor();
  await press("Reset");
  await time(/^0\.000 \/ 4\.00 s · frame 0\//).waitFor();
  for (let i = 1; i <= 2; ++i) {
    await hands.pressInGraph(".");
    await time(`frame ${i}/`).waitFor();
  }
});

step("every press of a step is one frame, also in a video", async () => {
  const presses = 5;
  if (!(await page.evaluate(() => fetch("/api/types").then((r) => r.json()))).sections.render) return;
  await page.getByRole("button", { name: "Record", exact: true }).click();
  await hands.type(page.getByRole("textbox", { name: "Video file" }), "steps.mp4");
  await page.locator(".recording").waitFor();
  const first = await frame();
  // As quickly as a key repeats, and quicker than frames are drawn.
  await hands.pressInGraph(...Array(presses).fill("."));
  await time(`frame ${first + presses}/`).waitFor();
  await page.locator(".state.paused").waitFor();
  assert.equal(await frame(), first + presses);
  await page.locator(".recording").click();
  await page.getByRole("link", { name: /steps\.mp4/ }).waitFor();
  const count = execFileSync("ffprobe", ["-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", join(server.folder, "steps.mp4")]);
  assert.equal(Number(String(count)), presses + 1);
});

step("a plugin's module is inserted into a node, and runs", async () => {
  await hands.select("water");
  // It is unfolded since Ctrl+K has put a module into it.
  await hands.pressInGraph("f");
  await hands.stillness();
  await hands.node("water").getByRole("button", { name: "Insert a module…" }).click();
  await page.getByRole("combobox", { name: "Search modules" }).waitFor();
  await page.keyboard.type("Lift");
  await page.keyboard.press("Enter");
  await hands.node("water").locator('[data-module="lift"]').waitFor();
  const lift = hands.aside().locator('[data-module="lift"]');
  await lift.locator('button.title[aria-expanded="true"]').waitFor();
  await hands.set(lift, "speed", "float", 2);
  await hands.pressInGraph("r");
  await time("frame 0/").waitFor();
  await hands.pressInGraph(".");
  await time("frame 1/").waitFor();
  await page.getByRole("tab", { name: "Time" }).click();
  await page.locator(".times th").filter({ hasText: "water/lift" }).waitFor();
  await page.getByRole("tab", { name: "Particles" }).click();
  await page.locator(".particle-table tbody tr").first().waitFor();
});

step("a second window watches, and can take the pen", async () => {
  const other = await openWindow(context, new URL("/", server.address).href, mistakes);
  const pen = (p) => p.getByRole("button", { name: "Take the pen" });
  await pen(other).waitFor();
  assert.ok(await other.getByRole("button", { name: "Play" }).isDisabled());
  await pen(other).click();
  await pen(page).waitFor();
  assert.ok(await page.getByRole("button", { name: "Play" }).isDisabled());
  const theirs = new Hands(other);
  await theirs.select("tank");
  await theirs.set(other.locator("aside .properties"), "max", "vec3", [0.7, 0.5, 0.3]);
  await hands.select("tank");
  await page.waitForFunction(() => document.querySelector('[aria-label="max x"]').value === "0.7");
  await hands.pressInGraph("Delete");
  await page.getByRole("alert").filter({ hasText: "another window has the pen" }).waitFor();
  await hands.node("tank").waitFor();
  await other.close();
  await pen(page).waitFor({ state: "hidden" });
});

step("what was not saved is offered after a crash", async () => {
  assert.deepEqual(mistakes, []);
  const before = await server.read("blocks.json");
  assert.equal(before.nodes.tank.params.max[0], 0.6);
  await restart(join(server.folder, "blocks.json"));
  const offer = page.getByRole("dialog", { name: "Changes that were not saved" });
  await offer.getByText(/node/).waitFor();
  await offer.getByRole("button", { name: "Restore" }).click();
  await hands.select("tank");
  assert.equal(await hands.aside().getByLabel("max x", { exact: true }).inputValue(), "0.7");
  assert.equal((await server.read("blocks.json")).nodes.tank.params.max[0], 0.6);
  await hands.pressInGraph("Control+z");
  await page.waitForFunction(() => document.querySelector('[aria-label="max x"]').value === "0.6");
});

step("the page had nothing to complain of", () => assert.deepEqual(mistakes, []));
