// What a file becomes in a scene: nodes that read it and make something of it, linked to the fluid.
import { addLink, addNode, linkProblem, setParam, type LinkEnds, type Scene } from "./scene";
import type { JsonObject, Types } from "./types";

export interface Use {
  name: string;
  doc: string;
  /** The node that takes the mesh, the port it comes in by, and what it gives to which port of the fluid. */
  by?: { type: string; takes: string; gives: string; to: string; params?: JsonObject };
}

const kSolid = { type: "StaticBoundary", takes: "meshes", gives: "boundary", to: "boundaries" };

export const kUses: Use[] = [
  { name: "Obstacle", doc: "A solid that does not move: the fluid flows around it.", by: kSolid },
  { name: "Container", doc: "The fluid stays inside of it.", by: { ...kSolid, params: { inverted: true } } },
  { name: "Fill it", doc: "Its inside is full of the fluid at the beginning.", by: { type: "MeshSampler", takes: "surface", gives: "particles", to: "initial" } },
  { name: "Emit from it", doc: "The fluid comes out of its surface.", by: { type: "MeshEmitter", takes: "surface", gives: "particles", to: "emitters" } },
  { name: "Only the mesh", doc: "A node that reads it, to be linked by hand." },
];

const kBeside = 260;

/** The link where it can be made, or else the scene as it is. */
const linkIfFits = (scene: Scene, types: Types, link: LinkEnds): Scene => (linkProblem(scene, types, link) === null ? addLink(scene, link) : scene);

/** The first node that takes what is given to this port. */
const fluidWith = (scene: Scene, types: Types, port: string): string | undefined =>
  Object.entries(scene.nodes).find(([, n]) => types.nodes[n.type]?.inputs.some((i) => i.name === port) && types.nodes[n.type]?.outputs.some((o) => o.type === "Particles"))?.[0];

/** The scene with a mesh of a file and its use, and the name of the node of that. */
export function withMesh(scene: Scene, types: Types, path: string, name: string, use: Use, at: { x: number; y: number }): [Scene, string] {
  const [read, mesh] = addNode(scene, "MeshFile", at, name);
  const withFile = setParam(read, { node: mesh }, ["file"], path);
  if (!use.by) return [withFile, mesh];
  const { type, takes, gives, to, params = {} } = use.by;
  const [both, made] = addNode(withFile, type, { x: at.x + kBeside, y: at.y }, `${mesh}_${use.name.toLowerCase().split(" ")[0]}`);
  const set = Object.entries(params).reduce((s, [k, v]) => setParam(s, { node: made }, [k], v), both);
  const linked = linkIfFits(set, types, { from: mesh, output: "surface", to: made, input: takes });
  const fluid = fluidWith(linked, types, to);
  return [fluid ? linkIfFits(linked, types, { from: made, output: gives, to: fluid, input: to }) : linked, made];
}

/** The scene with the particles of a file, which the fluid begins with. */
export function withParticles(scene: Scene, types: Types, path: string, name: string, at: { x: number; y: number }): [Scene, string] {
  const [read, node] = addNode(scene, "ParticleFile", at, name);
  const set = setParam(read, { node }, ["file"], path);
  const fluid = fluidWith(set, types, "initial");
  return [fluid ? linkIfFits(set, types, { from: node, output: "particles", to: fluid, input: "initial" }) : set, node];
}
