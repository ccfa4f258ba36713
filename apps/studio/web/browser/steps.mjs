// What the tests of one page in many steps have in common.
import { test } from "node:test";
import { keepWhatIsSeen } from "./seen.mjs";

let failed = false;

/** A part of a test, which needs those before it. Where it fails, what is on the pages is kept. */
export const step = (name, f) =>
  test(name, async (t) => {
    if (failed) return t.skip("a step before it failed");
    failed = true;
    try {
      await f();
    } catch (e) {
      await keepWhatIsSeen(name);
      throw e;
    }
    failed = false;
  });
