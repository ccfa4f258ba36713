// From an empty page to the goblet scene, by mouse and keyboard alone; what it computes is what `weir run` computes.
import assert from "node:assert/strict";
import { readFile, readdir } from "node:fs/promises";
import { join } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { particlesOfPage, particlesOfPly } from "./particles.mjs";
import { step } from "./steps.mjs";
import { Hands, openPage, startServer, weir } from "./studio.mjs";

const kLastFrame = 9;
/** m. Coarser than the scene that comes with Weir, which takes seconds to build and to draw where there is no graphics card. */
const kSpacing = 0.011;
const kBroken = "nozzle.particles -> water.emitters";

let server, browser, page, mistakes, hands, types, goblet;

before(async () => {
  server = await startServer();
  ({ browser, page, mistakes } = await openPage(server.address));
  hands = new Hands(page);
  types = await page.evaluate(() => fetch("/api/types").then((r) => r.json()));
  goblet = JSON.parse(await readFile(process.env.WEIR_GOBLET, "utf8"));
  delete goblet.nodes.water.modules.solver; // a module is of the type that a node has by default
  goblet.nodes.water.params.spacing = kSpacing;
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const state = () => page.locator(".state");
const undoButton = () => page.getByRole("button", { name: "Undo" });
const redoButton = () => page.getByRole("button", { name: "Redo" });

/** What is the default need not be written. */
function withoutDefaults(values, parameters) {
  const kept = Object.entries(values ?? {}).flatMap(([name, value]) => {
    const p = parameters.find((q) => q.name === name);
    if (p.kind === "group list") return [[name, value.map((v) => withoutDefaults(v, p.parameters))]];
    const own = p.parameters ? withoutDefaults(value, p.parameters) : value;
    const usual = p.parameters ? Object.keys(own).length === 0 : JSON.stringify(own) === JSON.stringify(p.default);
    return usual ? [] : [[name, own]];
  });
  return Object.fromEntries(kept);
}

/** All that a scene says, in one form. */
function meaningOf(scene) {
  const nodes = Object.entries(scene.nodes).map(([name, n]) => {
    const modules = Object.entries(n.modules ?? {})
      .map(([m, spec]) => [m, withoutDefaults(spec.params, moduleType(n.type, m).parameters)])
      .filter(([, params]) => Object.keys(params).length > 0);
    return [name, { type: n.type, params: withoutDefaults(n.params, types.nodes[n.type].parameters), modules: Object.fromEntries(modules) }];
  });
  return {
    title: scene.title, nodes: Object.fromEntries(nodes), links: [...scene.links].sort(),
    world: withoutDefaults(scene.world, types.world),
    sections: Object.entries(types.sections).map(([name, parameters]) => withoutDefaults(scene[name], parameters)),
  };
}

const moduleType = (nodeType, module) => types.modules[types.nodes[nodeType].modules.find((m) => m.name === module).type];

/** A section of the scene, such as its world, which is shown where no node is selected. */
async function setSection(name, parameters, values) {
  await hands.setAll(await hands.open(hands.aside().locator(`details[data-param="${name}"]`).first()), parameters, values);
}

async function pressUntilDisabled(keys, button) {
  const several = Array(10).fill(keys);
  for (let i = 0; i < 30 && (await button.isEnabled()); ++i) await hands.pressInGraph(...several);
  assert.ok(await button.isDisabled());
}

step("the page knows no type by its name: what it shows comes from what the server tells", async () => {
  const folder = fileURLToPath(new URL("../src/", import.meta.url));
  const names = [...Object.keys(types.nodes), ...Object.keys(types.modules)].join("|"), named = new RegExp(`["'\`](?:${names})["'\`]`);
  const found = [];
  for (const file of (await readdir(folder, { recursive: true })).filter((f) => /\.tsx?$/.test(f))) {
    const code = (await readFile(join(folder, file), "utf8")).replace(/\/\*[\s\S]*?\*\/|\/\/ .*/g, "");
    if (named.test(code)) found.push(file);
  }
  // The tour builds a scene of three nodes.
  assert.deepEqual(found, ["Tour.tsx"]);
});

step("an empty page has no nodes", async () => {
  assert.equal(await page.locator(".scene-node").count(), 0);
  assert.ok(await undoButton().isDisabled());
  // The graph has the keyboard before anything was clicked.
  await page.keyboard.press("a");
  await page.getByRole("combobox", { name: "Search nodes" }).waitFor();
  await page.keyboard.press("Escape");
});

step("nodes, their parameters and modules are made by hand", async () => {
  for (const [name, node] of Object.entries(goblet.nodes)) {
    await hands.addNode(node.type, name);
    await hands.setAll(hands.aside(), types.nodes[node.type].parameters, node.params ?? {});
    for (const [module, spec] of Object.entries(node.modules ?? {})) {
      const item = hands.aside().locator(`[data-module="${module}"]`);
      await item.locator("button.title").click();
      await hands.setAll(item, moduleType(node.type, module).parameters, spec.params);
    }
  }
  await hands.arrange();
  for (const name of Object.keys(goblet.nodes)) await hands.node(name).waitFor();
});

step("a link that does not fit is refused, and told why", async () => {
  await hands.drag(hands.node("tank").locator(".source"), hands.node("water").locator('.target[data-handleid="emitters"]'));
  await page.getByRole("alert").filter({ hasText: "takes a ParticleBatch" }).waitFor();
  assert.equal(await page.locator(".react-flow__edge").count(), 0);
});

step("links are drawn, and the scene has its settings", async () => {
  for (const text of goblet.links) await hands.link(text);
  await hands.pointAtGraph();
  await hands.type(hands.aside().getByLabel("title", { exact: true }), goblet.title, "Tab");
  // Without the plugin that renders there is no such section.
  for (const [section, parameters] of [["world", types.world], ...Object.entries(types.sections)].filter(([name]) => goblet[name]))
    await setSection(section, parameters, goblet[section]);
});

step("the viscosity changes while the scene runs", async () => {
  // However slow the page is, and however fast the simulation.
  await hands.pointAtGraph();
  await setSection("world", types.world, { duration: 1000 });
  await hands.pressInGraph("Space");
  await page.locator(".state.playing").waitFor();
  await hands.select("water");
  const viscosity = hands.aside().locator('[data-module="viscosity"]');
  await viscosity.locator("button.title").click();
  await hands.set(viscosity, "rate", "float", 250);
  await page.waitForFunction(() => document.querySelectorAll(".plot").length > 2);
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
  assert.equal(await state().innerText(), "playing");
  await hands.set(hands.aside(), "spacing", "float", 0.012);
  await page.locator(".reset-hint").filter({ hasText: "spacing" }).waitFor();
  await hands.pressInGraph("Control+z", "Control+z");
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
  await hands.pressInGraph("Space");
  await page.locator(".state.paused").waitFor();
  await hands.pointAtGraph();
  await setSection("world", types.world, { duration: goblet.world.duration });
  await page.locator(".reset-hint").filter({ hasText: "duration" }).waitFor();
  await hands.pressInGraph("r");
  await page.locator(".reset-hint").waitFor({ state: "hidden" });
});

step("a broken link shows as an error at the node and its port", async () => {
  await hands.clickLink(kBroken);
  await page.locator(".react-flow__edge.selected").waitFor();
  await hands.pressInGraph("Delete");
  await hands.edge(kBroken).waitFor({ state: "detached" });
  await page.locator(".reset-hint").filter({ hasText: "the links" }).waitFor();
  await hands.pressInGraph("r");
  await page.locator('[data-node="nozzle"].wrong').waitFor();
  await hands.node("nozzle").locator('.port.wrong[data-port="particles"]').waitFor();
  assert.match(await page.locator(".problem-line").innerText(), /nozzle.*not linked to a fluid/);
});

step("everything is undone, and done again", async () => {
  await pressUntilDisabled("Control+z", undoButton());
  assert.equal(await page.locator(".scene-node").count(), 0);
  await pressUntilDisabled("Control+Shift+z", redoButton());
  await hands.pressInGraph("Control+z");
  await hands.edge(kBroken).waitFor({ state: "attached" });
  await hands.pressInGraph("r");
  await page.locator(".problem-line").waitFor({ state: "hidden" });
});

step("the scene is saved, and is what it was built after", async () => {
  await page.keyboard.press("Control+s");
  await hands.type(page.getByRole("textbox", { name: "File name" }), "goblet");
  await page.locator(".bar .title").filter({ hasText: "goblet.json" }).waitFor();
  assert.deepEqual(meaningOf(await server.read("goblet.json")), meaningOf(goblet));
});

step("what was saved is opened again, and runs as weir run does", async () => {
  await page.getByRole("button", { name: "New", exact: true }).click();
  await page.waitForFunction(() => document.querySelectorAll(".scene-node").length === 0);
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.getByRole("dialog").getByRole("button", { name: "goblet" }).click();
  await hands.node("water").waitFor();
  await page.getByRole("button", { name: "Reset", exact: true }).click();
  for (let frame = 1; frame <= kLastFrame; ++frame) {
    await hands.pressInGraph(".");
    await page.locator(".time").filter({ hasText: `frame ${frame}/` }).waitFor();
  }
  const folder = join(server.folder, "run");
  await weir("run", join(server.folder, "goblet.json"), "--frames", String(kLastFrame), "--ply-particles", folder, "--device", "cpu", "--threads", "2", "--quiet");
  const files = (await readdir(folder)).filter((f) => f.endsWith(".ply")).sort();
  const expected = particlesOfPly(await readFile(join(folder, files.at(-1))));
  const found = await particlesOfPage(page, "water", [...expected.keys()]);
  assert.ok(expected.size > 1000, `${expected.size} particles`);
  const shown = Number((await page.locator(".load").innerText()).replace(/,/g, "").match(/^\d+/)[0]);
  assert.equal(shown, expected.size);
  for (const [id, attributes] of expected)
    for (const [name, value] of Object.entries(attributes)) assert.deepEqual(found.get(id)?.[name], value, `${name} of particle ${id}`);
});

step("the server draws pictures, and records a video from the view's camera", async () => {
  // The plugin that renders is needed.
  if (!types.sections.render) return;
  await page.getByRole("button", { name: "Rendered" }).click();
  await page.waitForFunction(() => document.querySelector("img.rendered")?.naturalWidth > 100);
  const [tools, picture] = await Promise.all([".view-tools", "img.rendered"].map((part) => page.locator(part).boundingBox()));
  assert.ok(tools.y + tools.height <= picture.y, "the tools cover the picture's title");
  await page.getByRole("button", { name: "Rendered" }).click();
  await page.getByRole("button", { name: "Record", exact: true }).click();
  await page.getByLabel("Video size").focus();
  await page.keyboard.type("720");
  await hands.type(page.getByRole("textbox", { name: "Video file" }), "seen.mp4");
  await page.getByRole("dialog").waitFor({ state: "hidden" });
  await page.locator(".recording").waitFor();
  await hands.pressInGraph("Space");
  await page.waitForFunction(() => parseInt(document.querySelector(".recording").textContent.slice(1)) >= 2);
  await page.locator(".recording").click();
  await page.getByRole("link", { name: /seen\.mp4/ }).waitFor();
  const video = await readFile(join(server.folder, "seen.mp4"));
  assert.equal(video.toString("latin1", 4, 8), "ftyp");
  // It would take the machine from the steps to come.
  await hands.pressInGraph("Space");
  await page.locator(".state.paused").waitFor();
});

const kCorner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/** Drops a file on a part of the page. */
async function drop(part, name, text) {
  const files = await page.evaluateHandle(([name, text]) => {
    const dropped = new DataTransfer();
    dropped.items.add(new File([text], name));
    return dropped;
  }, [name, text]);
  await page.dispatchEvent(part, "drop", { dataTransfer: files });
}

step("a mesh that is dropped becomes a node", async () => {
  await drop(".graph", "corner.obj", kCorner);
  await page.getByRole("dialog", { name: "What shall it be?" }).getByRole("button", { name: "Only the mesh" }).click();
  await page.getByLabel("Name", { exact: true }).and(page.locator('[value="corner"]')).waitFor();
  assert.match(await readFile(join(server.folder, "meshes/corner.obj"), "latin1"), /^v 0 0 0/);
});

step("a mesh that is dropped is asked about, and is linked as an obstacle", async () => {
  await drop(".viewport", "rock.obj", kCorner);
  await page.getByRole("dialog", { name: "What shall it be?" }).getByRole("button", { name: "Obstacle" }).click();
  await page.getByLabel("Name", { exact: true }).and(page.locator('[value="rock_obstacle"]')).waitFor();
  // In the draft on the disk, as links are drawn only where they can be seen.
  const links = ["rock.surface -> rock_obstacle.meshes", "rock_obstacle.boundary -> water.boundaries"];
  await server.written(".goblet.json.draft", (scene) => links.every((link) => scene?.links.includes(link)));
  await hands.pressInGraph("Control+z");
  await hands.node("rock_obstacle").waitFor({ state: "detached" });
});

step("a scene that is dropped is opened, and what is neither is refused in words", async () => {
  const before = await page.locator(".scene-node").count();
  for (const [name, text, why] of [["notes.txt", "water", "notes.txt is neither a scene"], ["package.json", "{}", "package.json is not a scene of Weir"]]) {
    await drop(".graph", name, text);
    await page.getByRole("alert").filter({ hasText: why }).waitFor();
  }
  assert.equal(await page.locator(".scene-node").count(), before);
  await drop(".viewport", "goblet.json", JSON.stringify({ weir: 1, title: "Dropped", nodes: { ball: { type: "SphereSampler" } } }));
  await hands.node("ball").waitFor();
  // Beside the scene of that name, which stays as it is.
  await page.locator(".bar .title").filter({ hasText: "goblet_001.json" }).waitFor();
  assert.deepEqual(meaningOf(await server.read("goblet.json")), meaningOf(goblet));
});

step("the page had nothing to complain of", () => assert.deepEqual(mistakes, []));
