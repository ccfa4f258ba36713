// How nodes and modules are found by what people type.
import { describe, expect, test } from "vitest";
import { distance, search } from "../src/model/search";

test("search finds letters in order, and word beginnings first", () => {
  const names = ["StaticBoundary", "SquareEmitter", "Sink", "SphereSampler"];
  expect(search("sqem", names, (n) => n)).toEqual(["SquareEmitter"]);
  expect(search("ss", names, (n) => n)[0]).toBe("SphereSampler");
});

describe("search", () => {
  // As the server tells them.
  const docs: { [name: string]: string } = {
    BoxSampler: "Fills a box with particles.", CircleEmitter: "A round nozzle that emits a jet of particles along its -y axis.",
    MeshEmitter: "Emits particles from the surface of a mesh, along the normals of its triangles.",
    ParticleFluid: "An incompressible liquid, simulated with particles (semi-implicit incompressible SPH).",
    SemiAnalyticalSFI: "Couples fluids with rigid triangle meshes, at rest or in motion.", SphereSampler: "Fills a sphere with particles.",
    StaticBoundary: "Solids or containers that do not move: shapes and meshes by signed distance.", Sink: "Removes the particles of fluids.",
    SurfaceTension: "Draws the fluid's surface together.", Xsph: "Smooths velocities between neighbours (artificial viscosity).",
  };
  const also: { [name: string]: string[] } = {
    BoxSampler: ["block", "cube", "dam", "fill", "water"], CircleEmitter: ["jet", "nozzle", "tap"], MeshEmitter: ["jet", "inflow", "rain"],
    ParticleFluid: ["water", "liquid", "viscosity"], SemiAnalyticalSFI: ["moving", "stirrer", "collider", "wall"], SphereSampler: ["ball", "drop", "droplet", "fill", "water"],
    StaticBoundary: ["tank", "wall", "collider", "container"], Sink: ["drain", "outflow"], SurfaceTension: ["drops", "cohesion"], Xsph: ["viscosity", "viscous", "honey"],
  };
  const find = (query: string) => search(query, Object.keys(docs), (name) => ({ name, doc: docs[name]!, synonyms: also[name]! }));
  test("knows the words of those who look for water, tanks, walls, jets and viscosity", () => {
    expect(find("water")[0]).toBe("ParticleFluid");
    expect(search("water", [{ name: "WhiteWater", synonyms: ["spray"] }, { name: "ParticleFluid", synonyms: ["water"] }], (i) => i)[0]!.name).toBe("ParticleFluid");
    expect(find("tank")[0]).toBe("StaticBoundary");
    expect(find("wall")).toContain("SemiAnalyticalSFI");
    expect(find("collider")[0]).toBe("StaticBoundary");
    expect(find("jet")[0]).toBe("MeshEmitter");
    expect(find("jet")).toContain("CircleEmitter");
    expect(find("visc")).toEqual(expect.arrayContaining(["Xsph", "ParticleFluid"]));
  });
  test("forgives typos, and not everything", () => {
    expect(find("smaplr")).toEqual(expect.arrayContaining(["BoxSampler", "SphereSampler"]));
    expect(find("emiter")[0]).toBe("MeshEmitter");
    expect(find("boundry")[0]).toBe("StaticBoundary");
    expect(find("surfcae tension")[0]).toBe("SurfaceTension");
    for (const nonsense of ["qqq", "xylophone", "zzzzzz"]) expect(find(nonsense)).toEqual([]);
  });
  test("ranks what is written so above letters that are scattered", () => {
    expect(find("emit").slice(0, 2)).toEqual(["MeshEmitter", "CircleEmitter"]);
    expect(find("emit")).not.toContain("SemiAnalyticalSFI");
    expect(find("box")[0]).toBe("BoxSampler");
    expect(find("sink")[0]).toBe("Sink");
  });
  test("measures slips", () => {
    expect([distance("abc", "abc"), distance("abc", "acb"), distance("abc", "ab"), distance("kitten", "sitting")]).toEqual([0, 1, 1, 3]);
  });
  test("has all words of a query", () => {
    expect(find("box sampler")).toEqual(["BoxSampler"]);
    expect(find("sphere particles")).toEqual(["SphereSampler"]);
  });
});
