// Pictures of the page's states, to be looked at: node browser/states.mjs FOLDER [SIZE…]. Three sizes, light and dark, as PNG:
// FOLDER/1280_dark_03_runs.png. A run of the goblet and a small one; some minutes a size.
import { mkdir, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { Hands, openPage, startServer } from "./studio.mjs";

const kSizes = [[1280, 800], [1920, 1080], [2560, 1440]];
const kFrame = 12;
const kPatience = 600_000;
// Until what glides stands still.
const kRestMs = 400;
const [folder, ...widths] = process.argv.slice(2);

const kFalling = {
  weir: 1, title: "Falling", world: { duration: 0.4, frame_rate: 30 },
  nodes: {
    block: { type: "BoxSampler", params: { min: [0.05, 0.05, 0.05], max: [0.25, 0.35, 0.25] } },
    tank: { type: "StaticBoundary", params: { shape: "box", min: [0, 0, 0], max: [0.5, 0.5, 0.3], inverted: true } },
    water: { type: "ParticleFluid", params: { spacing: 0.03, rest_steps: 0 } },
  },
  links: ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
};

/** Goes through the states of one page, and takes each in both colours. */
async function walk(page, hands, shoot) {
  const button = (name, within = page) => within.getByRole("button", { name, exact: true });
  const state = (name) => page.locator(`.state.${name}`).waitFor({ timeout: kPatience });
  const escape = () => page.keyboard.press("Escape");
  const frame = (n) => page.waitForFunction((f) => Number(/frame (\d+)\//.exec(document.querySelector(".time").textContent)[1]) >= f, n, { timeout: kPatience });

  await shoot("empty");
  await button("Water in a minute").click();
  await shoot("tour");
  await button("End the tour").click();
  await button("Templates").click();
  await shoot("templates");
  await page.getByRole("dialog").getByRole("button", { name: /goblet/i }).first().click();
  await state("paused");
  await hands.arrange();
  await shoot("goblet");
  await hands.select("water");
  await hands.pressInGraph("Space");
  await frame(4);
  await shoot("runs");
  await frame(kFrame);
  await hands.pressInGraph("Space");
  await state("paused");
  await page.getByRole("tab", { name: "Plots" }).click();
  await shoot("plots");
  await page.getByRole("tab", { name: "Particles" }).click();
  await shoot("table");
  await page.locator(".health > button").click();
  await shoot("health");
  await escape();
  await hands.select("water");
  await hands.pressInGraph("Enter");
  await hands.stillness();
  await shoot("modules");
  await hands.pressInGraph("Enter", "f");
  await hands.select("nozzle");
  await page.keyboard.press("F1");
  await page.locator(".reference").waitFor();
  await hands.stillness();
  await shoot("reference");
  await page.keyboard.press("F1");
  await hands.pointAtGraph();
  await hands.pressInGraph("a");
  await page.keyboard.type("water");
  await shoot("search");
  await escape();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("visc");
  await shoot("palette");
  await escape();
  await button("Rendered").click();
  await page.locator(".rendered[src]").waitFor();
  await page.waitForTimeout(3000);
  await shoot("rendered");
  await button("Rendered").click();

  await button("Open").click();
  await shoot("open");
  await page.getByRole("dialog").getByRole("button", { name: /^falling/ }).click();
  await page.locator(".bar .title").filter({ hasText: "falling.json" }).waitFor();
  await state("paused");
  await hands.arrange();
  await hands.pressInGraph("Space");
  await state("finished");
  await button("Compare").click();
  await page.getByLabel("The run that was kept").waitFor();
  await hands.select("water");
  await hands.set(hands.aside(), "spacing", "float", 0.025);
  await hands.pressInGraph("Space");
  await page.waitForTimeout(1000);
  await state("finished");
  await page.getByRole("tab", { name: "Plots" }).click();
  await shoot("compare");
  await button("End comparison").click();
  await hands.aside().locator('[data-param="spacing"]').first().click({ button: "right" });
  await page.getByRole("menu").getByRole("menuitem", { name: "Sweep this value…" }).click();
  await shoot("sweep");
  const box = page.getByRole("dialog", { name: /^Sweep/ });
  await box.getByRole("button", { name: "Start" }).click();
  await box.locator(".progress").waitFor();
  await box.locator(".progress").waitFor({ state: "detached", timeout: kPatience });
  await shoot("swept");
}

await mkdir(folder, { recursive: true });
for (const [width, height] of kSizes.filter(([w]) => widths.length === 0 || widths.includes(String(w)))) {
  const server = await startServer();
  try {
    await writeFile(join(server.folder, "falling.json"), JSON.stringify(kFalling));
    const { browser, page } = await openPage(server.address, { width, height, colorScheme: "light" });
    let taken = 0;
    const shoot = async (name) => {
      const number = String(++taken).padStart(2, "0");
      for (const colors of ["light", "dark"]) {
        // Not by the pointer, which a dialog may hinder.
        await page.evaluate((c) => document.documentElement.dataset.theme === c || document.querySelector('[aria-label="Dark colours"]').click(), colors);
        await page.waitForTimeout(kRestMs);
        await page.screenshot({ path: join(folder, `${width}_${colors}_${number}_${name}.png`) });
      }
    };
    await walk(page, new Hands(page), shoot);
    await browser.close();
  } finally {
    await server.close();
  }
}
