// Names of files, menus, and numbers as they are told.
import { describe, expect, test } from "vitest";
import { menuOf } from "../src/Menu";
import { fileNameOf, pathProblem, withNumber } from "../src/model/names";
import { shortText } from "../src/model/numbers";

describe("names of files", () => {
  test("come from titles", () => {
    expect(fileNameOf("A jet fills a goblet!")).toBe("a_jet_fills_a_goblet");
    expect(fileNameOf(undefined)).toBe("scene");
    expect(fileNameOf("…")).toBe("scene");
  });
  test("are numbered where they are taken", () => {
    const taken = new Set(["a.mp4", "a_001.mp4", "meshes/b.tar.gz", "c"]);
    const free = (path: string) => withNumber(path, (p) => taken.has(p));
    expect(free("x.mp4")).toBe("x.mp4");
    expect(free("a.mp4")).toBe("a_002.mp4");
    expect(free("c")).toBe("c_001");
    expect(free("meshes/b.tar.gz")).toBe("meshes/b.tar_001.gz");
  });
});

test("a path that cannot be written has a sentence that says why", () => {
  for (const fine of ["a.json", "folder/a", "a..b.json"]) expect(pathProblem(fine)).toBeNull();
  expect(pathProblem("../a.json")).toContain("below the served folder");
  expect(pathProblem("/a.json")).toContain("below the served folder");
  expect(["", "folder/", "a\\b", ".a.json", "b/.git/c"].map((p) => pathProblem(p) !== null)).toEqual([true, true, true, true, true]);
});

test("a menu has no lines above, below, or twice", () => {
  const item = (name: string) => ({ name, take: () => {} });
  expect(menuOf(null, item("a"), false, null, null, item("b"), null).map((i) => i?.name)).toEqual(["a", undefined, "b"]);
});

test("tables show whole numbers whole, and four digits of others", () => {
  expect(shortText(2 ** 40 + 5)).toBe("1099511627781");
  expect([12345, 1234.56, [0.123456, -98765.4], null].map(shortText)).toEqual(["12345", "1235", "0.1235, -98770", "–"]);
});
