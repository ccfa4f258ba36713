// Pictures of the page for the documentation: node browser/shots.mjs SCENE FOLDER [FRAME=60]. Both sizes, light and dark, as JPEG.
import { copyFile } from "node:fs/promises";
import { basename, join } from "node:path";
import { Hands, openPage, startServer } from "./studio.mjs";

const kSizes = [[1280, 800], [1920, 1080]];
const kQuality = 72;
const [scene, folder, frame = "60"] = process.argv.slice(2);

const server = await startServer();
try {
  await copyFile(scene, join(server.folder, basename(scene)));
  for (const [width, height] of kSizes)
    for (const colorScheme of ["light", "dark"]) {
      const { browser, page } = await openPage(server.address, { width, height, colorScheme });
      const hands = new Hands(page);
      await page.getByRole("button", { name: "Open", exact: true }).click();
      await page.getByRole("dialog").getByRole("button", { name: basename(scene, ".json") }).click();
      await hands.node("water").waitFor();
      await hands.arrange();
      await page.locator(".time").filter({ hasText: "frame 0/" }).waitFor();
      await hands.pressInGraph("Space");
      await page.waitForFunction((n) => Number(/frame (\d+)/.exec(document.querySelector(".time").textContent)[1]) >= n, Number(frame), { timeout: 300_000 });
      await hands.pressInGraph("Space");
      await hands.select(colorScheme === "light" ? "nozzle" : "water");
      await page.locator(".state.paused").waitFor();
      await page.screenshot({ path: join(folder, `studio_${colorScheme}_${width}.jpg`), type: "jpeg", quality: kQuality });
      await browser.close();
    }
} finally {
  await server.close();
}
