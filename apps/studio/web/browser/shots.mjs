// Pictures of the page for the documentation: node browser/shots.mjs SCENE FOLDER [FRAME=60]. Three sizes, light and dark, as
// JPEG. The small one in light colours has the table of particles.
import { copyFile } from "node:fs/promises";
import { basename, join } from "node:path";
import { Hands, openPage, startServer } from "./studio.mjs";

const kSizes = [[1280, 800], [1920, 1080], [2560, 1440]];
const kQuality = 72;
const kPatience = 600_000;
const [scene, folder, frame = "60"] = process.argv.slice(2);

const server = await startServer();
try {
  await copyFile(scene, join(server.folder, basename(scene)));
  const { browser, page } = await openPage(server.address, { width: 1920, height: 1080, colorScheme: "light" });
  const hands = new Hands(page);
  const shoot = async (name, node) => {
    await page.getByRole("button", { name: "Fit", exact: true }).click();
    await hands.arrange();
    await hands.select(node);
    await page.keyboard.press("Control+s");
    await page.locator(".bar .title").filter({ hasNotText: "changed" }).waitFor();
    await page.screenshot({ path: join(folder, `${name}.jpg`), type: "jpeg", quality: kQuality });
  };
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.getByRole("dialog").getByRole("button", { name: basename(scene, ".json") }).click();
  await hands.node("water").waitFor();
  await hands.arrange();
  await page.locator(".state.paused").waitFor();
  await hands.pressInGraph("Space");
  await page.waitForFunction((n) => Number(/frame (\d+)/.exec(document.querySelector(".time").textContent)[1]) >= n, Number(frame), { timeout: kPatience });
  await hands.pressInGraph("Space");
  await page.locator(".state.paused").waitFor();
  // To a frame, for which the plots have numbers.
  await hands.pressInGraph(".");
  await page.waitForFunction((n) => Number(/frame (\d+)/.exec(document.querySelector(".time").textContent)[1]) > n, Number(frame));
  await page.locator(".state.paused").waitFor();
  for (const colorScheme of ["light", "dark"]) {
    if (colorScheme === "dark") await page.getByRole("button", { name: "Dark colours" }).click();
    for (const [width, height] of kSizes) {
      await page.setViewportSize({ width, height });
      await page.getByRole("tab", { name: colorScheme === "light" && width < 1500 ? "Particles" : "Plots" }).click();
      await shoot(`studio_${colorScheme}_${width}`, colorScheme === "light" ? "nozzle" : "water");
    }
  }
  await browser.close();
} finally {
  await server.close();
}
