// What the tests of one page in many steps have in common.
import { test } from "node:test";

let failed = false;

/** A part of a test, which needs those before it. */
export const step = (name, f) =>
  test(name, async (t) => {
    if (failed) return t.skip("a step before it failed");
    failed = true;
    await f();
    failed = false;
  });
