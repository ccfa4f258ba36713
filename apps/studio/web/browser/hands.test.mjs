// What hands do to a run and in its view, by mouse and keyboard alone: a preview, a body that is pulled, a plane that cuts, and a
// mesh that is dropped.
import assert from "node:assert/strict";
import { strToU8, zipSync } from "three/examples/jsm/libs/fflate.module.js";
import { step } from "./steps.mjs";
import { openStudio } from "./studio.mjs";

// Both runs are so long that no machine comes to their ends meanwhile.
// A cube that floats freely beside a block of water at rest; nothing falls.
const kScene = {
  weir: 1, title: "Adrift", world: { duration: 3600, frame_rate: 30, gravity: [0, 0, 0] },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0.5, 0, 0], max: [0.74, 0.24, 0.24] } },
    water: { type: "ParticleFluid", params: { spacing: 0.03, rest_steps: 0 } },
    cube: { type: "BoxMesh", params: { min: [-0.1, -0.1, -0.1], max: [0.1, 0.1, 0.1] } },
    raft: { type: "RigidBody", params: { density: 500, position: [0, 0.1, 0.1] } },
  },
  links: ["block.particles -> water.initial", "cube.surface -> raft.mesh"],
};

// Its solver is allowed too few iterations.
const kHasty = {
  weir: 1, title: "Hasty", world: { duration: 3600, frame_rate: 30, dt: 0.004 },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0, 0, 0], max: [0.24, 0.24, 0.24] } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [0.48, 0.48, 0.24], inverted: true } },
    water: { type: "ParticleFluid", params: { spacing: 0.04, rest_steps: 0 }, modules: { solver: { params: { max_iterations: 1 } } } },
  },
  links: ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
};

const { server, page, mistakes, hands, state, button, open } = await openStudio({ "adrift.json": kScene, "hasty.json": kHasty });

const saved = (isRight) => server.written("adrift.json", isRight);
const particles = async () => Number(/([\d,]+) particle/.exec(await page.locator(".load").innerText())[1].replaceAll(",", ""));
const tidy = async () => {
  await hands.pointAtGraph();
  await hands.pressInGraph("Escape");
};

step("a light tells which steps have not converged, and one click allows more iterations", async () => {
  await open("hasty");
  const light = page.locator(".light", { hasText: "convergence" });
  await hands.pressInGraph("Space");
  await light.and(page.locator(".bad")).waitFor();
  // With all that there is to say, the bar stays one line where the page is small.
  await hands.pressInGraph("Space");
  await page.setViewportSize({ width: 1280, height: 800 });
  await hands.select("water");
  await hands.set(hands.aside(), "spacing", "float", 0.05);
  await page.locator(".transport .cost").waitFor();
  await page.locator(".transport .warnings").waitFor();
  await page.locator(".reset-hint").filter({ hasText: "water.spacing" }).waitFor();
  const bar = await page.locator(".transport").boundingBox(), device = await page.getByLabel("Device").boundingBox();
  assert.ok(bar.height < 2 * device.height, `${bar.height} pixels`);
  await hands.pressInGraph("Control+z");
  await page.setViewportSize({ width: 1600, height: 1000 });
  await page.getByRole("button", { name: /^Health: bad/ }).click();
  const why = page.getByRole("dialog", { name: "Health of the run" });
  await why.getByText("of water ended before the solver's tolerance was met").waitFor();
  await why.getByRole("button", { name: "Set max_iterations to 1000 and begin anew" }).click();
  await light.and(page.locator(".good")).waitFor();
  await page.keyboard.press("Control+s");
  await server.written("hasty.json", (s) => s.nodes.water.modules?.solver?.params?.max_iterations === undefined);
});

step("a preview is coarser, is marked, writes nothing, and leaves the scene as it is", async () => {
  await open("adrift");
  await hands.arrange();
  const all = await particles();
  await button("Preview").click();
  await page.locator(".preview-hint").filter({ hasText: "2 × the spacing" }).waitFor();
  await page.waitForFunction((n) => Number(/([\d,]+) particle/.exec(document.querySelector(".load").innerText)[1].replaceAll(",", "")) === n, all / 8);
  assert.ok(await button("Record").isDisabled());
  await page.locator('.bar .title').filter({ hasText: "Adrift" }).waitFor();
  assert.equal(await page.locator(".reset-hint").count(), 0);
  await button("Preview").click();
  await page.locator(".preview-hint").waitFor({ state: "detached" });
  await page.waitForFunction((n) => Number(/([\d,]+) particle/.exec(document.querySelector(".load").innerText)[1].replaceAll(",", "")) === n, all);
  await saved((s) => s.nodes.water.params.spacing === 0.03);
});

step("a light tells how far particles fly in a step", async () => {
  await hands.pressInGraph("Space");
  await page.locator(".light.good").filter({ hasText: /^CFL 0/ }).waitFor();
  await hands.pressInGraph("Space");
  await state("paused");
});

step("a body is pulled by the pointer while the scene runs, and drifts on when it is let go", async () => {
  // A click while the body is held would let it go.
  await page.getByRole("tab", { name: "Plots", exact: true }).click();
  await page.getByLabel("Filter plots").fill("raft.position");
  await tidy();
  await button("From +z").click();
  await button("Grab").click();
  await hands.pressInGraph("Space");
  await state("playing");
  const { x, y, width, height } = await page.locator(".stage").boundingBox();
  const status = page.locator(".told.over").filter({ hasText: "Pulling raft to" });
  // All that there is fills the view: the cube is at its left.
  const held = x + 0.2 * width;
  await page.mouse.move(held, y + 0.55 * height);
  await page.mouse.down();
  await status.waitFor();
  const height0 = Number((await status.innerText()).split(", ")[1]);
  await page.mouse.move(held, y + 0.2 * height, { steps: 8 });
  const height1 = Number((await status.innerText()).split(", ")[1]);
  assert.ok(height1 > height0 + 0.05, `${height0} to ${height1}`);
  // What the server measures of it comes up to the hand.
  const place = () => page.locator('.plot[data-quantity="raft.position"] figcaption b').last().innerText();
  await page.waitForFunction((far) => Number.parseFloat(document.querySelector('.plot[data-quantity="raft.position"] figcaption b:last-of-type')?.innerText) > far, Math.hypot(height1, 0.1) - 0.1);
  await page.mouse.up();
  await status.waitFor({ state: "detached" });
  assert.ok(Number.parseFloat(await place()) > 0);
  await button("Grab").click();
  await hands.pressInGraph("Space");
  await state("paused");
});

step("a plane that cuts the water open is moved and turned by its handles", async () => {
  await tidy();
  // The body has drifted as far as the machine let it: the handles stand by all that there is, and would lie behind the camera.
  await hands.pressInGraph("r");
  await page.locator(".time").filter({ hasText: "frame 0/" }).waitFor();
  await state("paused");
  await button("From +z").click();
  await page.locator(".stage > canvas").click({ button: "right", position: { x: 30, y: 200 } });
  await page.getByRole("menuitem", { name: "Cut the fluids open" }).click();
  await hands.pressInGraph("Control+s");
  const place = page.getByRole("slider", { name: "Place of cut 1" });
  await place.waitFor();
  await saved((s) => s.render?.clips?.length === 1 && s.render?.clips[0].normal.join() === "0,0,1");
  const before = await server.read("adrift.json");
  await place.focus();
  for (let i = 0; i < 5; ++i) await page.keyboard.press("ArrowRight");
  await hands.pressInGraph("Control+s");
  await saved((s) => s.render?.clips[0].point[2] > before.render.clips[0].point[2]);
  const normal = page.getByRole("slider", { name: "Normal of cut 1" });
  const { x, y } = await normal.boundingBox();
  await page.mouse.move(x + 5, y + 5);
  await page.mouse.down();
  await page.mouse.move(x + 90, y - 60, { steps: 5 });
  await page.mouse.up();
  await hands.pressInGraph("Control+s");
  await saved((s) => s.render?.clips[0].normal.join() !== "0,0,1" && Math.abs(Math.hypot(...s.render?.clips[0].normal) - 1) < 1e-3);
  // One drag is one step of undo.
  await hands.pressInGraph("Control+z", "Control+s");
  await saved((s) => s.render?.clips[0].normal.join() === "0,0,1");
});

step("a click in the view selects a node, the axes turn the view, and Ctrl moves in round steps", async () => {
  await tidy();
  await hands.pressInGraph("r");
  await page.locator(".time").filter({ hasText: "frame 0/" }).waitFor();
  await state("paused");
  await button("From +z").click();
  // What looks at the camera is in the middle of the axes.
  const end = (name) => button(name).evaluate((e) => new DOMMatrix(getComputedStyle(e).transform)).then(({ e, f }) => [e, f].map(Math.round));
  assert.deepEqual(await end("From +z"), [34, 34]);
  assert.deepEqual(await end("From +x"), [58, 34]);
  const { x, y, width, height } = await page.locator(".stage").boundingBox();
  const selected = page.locator('[data-node="cube"].selected, [data-node="raft"].selected');
  let found = false;
  for (let i = 0; i < 30 && !found; ++i) {
    await page.mouse.click(x + ((2 + (i % 10)) / 20) * width, y + (0.4 + 0.1 * Math.floor(i / 10)) * height);
    found = await selected.first().waitFor({ timeout: 1000 }).then(() => true, () => false);
  }
  assert.ok(found, "a click on the cube selects nothing");
  await hands.select("block");
  const face = page.getByRole("slider", { name: "max x of block" });
  const from = await face.boundingBox();
  await page.mouse.move(from.x + from.width / 2, from.y + from.height / 2);
  await page.mouse.down();
  await page.keyboard.down("Control");
  await page.mouse.move(from.x + 33, from.y + 7, { steps: 5 });
  await page.mouse.up();
  await page.keyboard.up("Control");
  await hands.pressInGraph("Control+s");
  const kStep = 0.02;
  await saved((s) => s.nodes.block.params.max[0] > 0.75 && Math.abs(s.nodes.block.params.max[0] / kStep - Math.round(s.nodes.block.params.max[0] / kStep)) < 1e-6);
});

step("a number is typed with a unit", async () => {
  await hands.select("water");
  const field = hands.aside().getByLabel("spacing", { exact: true });
  await hands.type(field, "2*20 mm");
  assert.equal(await field.inputValue(), "0.04");
  await hands.type(field, "3 s");
  await hands.aside().getByText("also in a unit that can be turned into m").waitFor();
  await hands.type(field, "3 cm");
  await hands.pressInGraph("Control+s");
  await saved((s) => s.nodes.water.params.spacing === 0.03);
});

/** A box of an STL file, from 0 to a corner in the file's unit; without its last triangle where it is open. */
function stlBox(size, open) {
  const p = (i, j, k) => `vertex ${i * size} ${j * size} ${k * size}`;
  const quads = [
    [p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0)], [p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)], [p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0)],
    [p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1)], [p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)], [p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), p(1, 1, 0)],
  ];
  const triangles = quads.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]).slice(0, open ? -1 : undefined);
  return `solid box\n${triangles.map((t) => `facet normal 0 0 0\nouter loop\n${t.join("\n")}\nendloop\nendfacet`).join("\n")}\nendsolid box\n`;
}

async function drop(name, content) {
  const data = await page.evaluateHandle(([name, base64]) => {
    const dropped = new DataTransfer();
    dropped.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name));
    return dropped;
  }, [name, Buffer.from(content).toString("base64")]);
  await page.dispatchEvent(".app", "drop", { dataTransfer: data });
}

step("a mesh that is dropped is measured: its unit is guessed, and what is open is told", async () => {
  const dialog = page.getByRole("dialog", { name: "What shall it be?" });
  await drop("torn.stl", stlBox(0.2, true));
  await dialog.getByText("11 triangles, open: 3 edges without a triangle on each side").waitFor();
  await dialog.getByText("0.2 × 0.2 × 0.2 m").waitFor();
  await dialog.getByRole("button", { name: "Cancel" }).click();
  await drop("part.stl", stlBox(200, false));
  await dialog.getByText("12 triangles, closed").waitFor();
  await dialog.getByText("It looks like mm").waitFor();
  await dialog.getByText("0.2 × 0.2 × 0.2 m").waitFor();
  await dialog.getByRole("button", { name: /^Only the mesh/ }).click();
  await hands.node("part").waitFor();
  await hands.pressInGraph("Control+s");
  await saved((s) => s.nodes.part?.params.unit === 0.001);
});

// A tetrahedron, in metres.
const kPlaces = [[0, 0, 0], [0.2, 0, 0], [0, 0.3, 0], [0, 0, 0.4]], kFaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

const offFile = (faces) => ["OFF", `4 ${faces.length} 0`, ...kPlaces.map((p) => p.join(" ")), ...faces.map((f) => `3 ${f.join(" ")}`)].join("\n");

function gltfFile() {
  const bytes = Buffer.concat([Buffer.from(Float32Array.from(kPlaces.flat()).buffer), Buffer.from(Uint16Array.from(kFaces.flat()).buffer)]);
  return JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [0, 0, 0], max: [0.2, 0.3, 0.4] }, { bufferView: 1, componentType: 5123, count: 12, type: "SCALAR" }],
    bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 24 }],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  });
}

const threeMfFile = () => zipSync({
  "_rels/.rels": strToU8('<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'),
  "3D/3dmodel.model": strToU8(`<?xml version="1.0"?><model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1" type="model"><mesh><vertices>${
    kPlaces.map(([x, y, z]) => `<vertex x="${1000 * x}" y="${1000 * y}" z="${1000 * z}"/>`).join("")}</vertices><triangles>${
    kFaces.map(([a, b, c]) => `<triangle v1="${a}" v2="${b}" v3="${c}"/>`).join("")}</triangles></mesh></object></resources><build><item objectid="1"/></build></model>`),
});

step("so are meshes in all formats that are read unasked; of others it says so, and of damaged ones why", async () => {
  const dialog = page.getByRole("dialog", { name: "What shall it be?" });
  const told = async (name, content, ...texts) => {
    await drop(name, content);
    for (const text of texts) await dialog.getByText(text).waitFor();
    await dialog.getByRole("button", { name: "Cancel" }).click();
    await dialog.waitFor({ state: "detached" });
  };
  await told("a.off", offFile(kFaces), "4 triangles, closed", "0.2 × 0.3 × 0.4 m");
  await told("torn.off", offFile(kFaces.slice(1)), "3 triangles, open: 3 edges");
  await told("a.gltf", gltfFile(), "4 triangles, closed", "0.2 × 0.3 × 0.4 m");
  await told("a.3mf", threeMfFile(), "4 triangles, closed", "It looks like mm", "0.2 × 0.3 × 0.4 m");
  await told("a.glb", "no such thing", "It cannot be read here");
  await told("a.fbx", "x", "This page does not check such a file");
});

step("nothing went wrong on the way", () => assert.deepEqual(mistakes, []));
