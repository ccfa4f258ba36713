// What a file becomes in a scene: nodes that read it and make something of it, linked to the fluid.
import { addLink, addNode, linkProblem, setParam, type LinkEnds, type Scene } from "./scene";
import type { JsonObject, NodeType, Types } from "./types";

type Place = { x: number; y: number };

export interface Use {
  name: string;
  doc: string;
  /** What kind of node takes the mesh, and to which port of the fluid what it gives goes. */
  by?: { gives: string; word?: string; to: string; params?: (type: NodeType) => JsonObject };
}

/** A switch is known by a word that people use for it. */
const switched = (type: NodeType, word: string): JsonObject =>
  Object.fromEntries(type.parameters.filter((p) => p.kind === "bool" && p.also?.includes(word)).map((p) => [p.name, true]));

const kSolid = { gives: "Boundary", to: "boundaries" };

export const kUses: Use[] = [
  { name: "Obstacle", doc: "A solid that does not move: the fluid flows around it.", by: kSolid },
  { name: "Container", doc: "The fluid stays inside of it.", by: { ...kSolid, params: (type) => switched(type, "container") } },
  { name: "Fill it", doc: "Its inside is full of the fluid at the beginning.", by: { gives: "ParticleBatch", word: "fill", to: "initial" } },
  { name: "Emit from it", doc: "The fluid comes out of its surface.", by: { gives: "ParticleBatch", word: "inflow", to: "emitters" } },
  { name: "Only the mesh", doc: "A node that reads it, to be linked by hand." },
];

const kMesh = "TriangleMesh";

/** The first type of node that takes and gives such things, and is called by this word, too. */
const typeWith = (types: Types, takes: string | null, gives: string, word?: string): [string, NodeType] | undefined =>
  Object.entries(types.nodes).find(([, t]) =>
    (takes === null ? t.inputs.length === 0 && t.parameters.some((p) => p.kind === "path") : t.inputs.some((i) => i.type === takes)) &&
    t.outputs.some((o) => o.type === gives) && (word === undefined || t.also?.includes(word)));

/** A node that reads a file that gives such things. */
function withReader(scene: Scene, types: Types, gives: string, path: string, at: Place, name: string): [Scene, string, string] {
  const found = typeWith(types, null, gives);
  if (!found) throw new Error(`no node here reads a file that gives a ${gives}`);
  const [type, { parameters, outputs }] = found;
  const [next, node] = addNode(scene, type, at, name);
  return [setParam(next, { node }, [parameters.find((p) => p.kind === "path")!.name], path), node, outputs.find((o) => o.type === gives)!.name];
}

const kBeside = 260;

/** The link where it can be made, or else the scene as it is. */
const linkIfFits = (scene: Scene, types: Types, link: LinkEnds): Scene => (linkProblem(scene, types, link) === null ? addLink(scene, link) : scene);

/** The first node that takes what is given to this port. */
const fluidWith = (scene: Scene, types: Types, port: string): string | undefined =>
  Object.entries(scene.nodes).find(([, n]) => types.nodes[n.type]?.inputs.some((i) => i.name === port) && types.nodes[n.type]?.outputs.some((o) => o.type === "Particles"))?.[0];

/** How a mesh is read: the length of the file's unit, m, and whether it is turned inside out. */
export interface Reading {
  unit?: number;
  flip?: boolean;
}

/** What is not the default of the reader, which has such parameters. */
const reading = (scene: Scene, types: Types, node: string, how: Reading): Scene =>
  types.nodes[scene.nodes[node]!.type]!.parameters.reduce((s, { name, default: usual }) => {
    const wanted = name === "unit" || name === "flip" ? how[name] : undefined;
    return wanted === undefined || wanted === usual ? s : setParam(s, { node }, [name], wanted);
  }, scene);

/** The scene with a mesh of a file and its use, and the name of the node of that. */
export function withMesh(scene: Scene, types: Types, path: string, name: string, use: Use, at: Place, how: Reading = {}): [Scene, string] {
  const [plain, mesh, surface] = withReader(scene, types, kMesh, path, at, name);
  const read = reading(plain, types, mesh, how);
  if (!use.by) return [read, mesh];
  const { gives, word, to, params } = use.by;
  const found = typeWith(types, kMesh, gives, word);
  if (!found) throw new Error(`no node here makes a ${gives} of a mesh`);
  const [typeName, type] = found;
  const [both, made] = addNode(read, typeName, { x: at.x + kBeside, y: at.y }, `${mesh}_${use.name.toLowerCase().split(" ")[0]}`);
  const set = Object.entries(params?.(type) ?? {}).reduce((s, [k, v]) => setParam(s, { node: made }, [k], v), both);
  const linked = linkIfFits(set, types, { from: mesh, output: surface, to: made, input: type.inputs.find((i) => i.type === kMesh)!.name });
  const fluid = fluidWith(linked, types, to);
  return [fluid ? linkIfFits(linked, types, { from: made, output: type.outputs.find((o) => o.type === gives)!.name, to: fluid, input: to }) : linked, made];
}

/** The scene with the particles of a file, which the fluid begins with. */
export function withParticles(scene: Scene, types: Types, path: string, name: string, at: Place): [Scene, string] {
  const [read, node, output] = withReader(scene, types, "ParticleBatch", path, at, name);
  const fluid = fluidWith(read, types, "initial");
  return [fluid ? linkIfFits(read, types, { from: node, output, to: fluid, input: "initial" }) : read, node];
}
