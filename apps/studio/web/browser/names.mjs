// What those meet who do not see the page: axe-core's rules of WCAG 2.1, levels A and AA, for names, roles, structure and contrast.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

const source = readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What breaks a rule, as "rule: element"; empty where nothing does. */
export async function namesThatAreMissing(page) {
  const text = await source;
  await page.evaluate(text);
  return page.evaluate(async () => {
    const { violations } = await globalThis.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"], resultTypes: ["violations"] });
    return violations.flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.target.join(" ")}`));
  });
}
