// What tests of the page have in common: types, a scene of two nodes, frames and runs.
import { addLink, addNode, emptyScene, type Scene } from "../src/model/scene";
import type { Run } from "../src/model/runs";
import type { NodeType, Types } from "../src/model/types";
import type { FramePacket } from "../src/protocol/packets";

export const fluid: NodeType = {
  doc: "", source: "weir", parameters: [], family: "FluidModule",
  inputs: [{ name: "initial", type: "ParticleBatch", doc: "", required: false, many: true }],
  outputs: [{ name: "fluid", type: "Particles", doc: "" }],
  modules: [{ name: "predict", type: "Predict", enabled: true }, { name: "solver", type: "Pbf", enabled: true }],
};
export const sampler: NodeType = {
  doc: "", source: "weir", parameters: [], inputs: [], outputs: [{ name: "particles", type: "ParticleBatch", doc: "" }],
};
export const types: Types = { nodes: { ParticleFluid: fluid, BoxSampler: sampler }, modules: {}, world: [], sections: {} };

export const link = { from: "box_sampler", output: "particles", to: "particle_fluid", input: "initial" };

export function linked(): Scene {
  const [one] = addNode(emptyScene(), "BoxSampler", { x: 0, y: 0 });
  const [two] = addNode(one, "ParticleFluid", { x: 300, y: 0 });
  return addLink(two, link);
}

/** A frame of two particles of one fluid. */
export const frameOf = (frame: number, time: number): FramePacket => ({
  kind: "frame", frame, time, poses: {},
  fluids: [{
    node: "water", total: 16, count: 2, spacing: 0.1, low: [0, 0, 0], high: [1, 2, 3], positions: Uint16Array.of(0, 0, 0, 65535, 65535, 65535), ids: Float64Array.of(1, 2), attributes: ["speed"],
    attribute: { name: "speed", unit: "m/s", low: 0, high: 4, values: Uint16Array.of(0, 65535) },
  }],
});
export const runOf = (values: number[]): Run => ({
  label: "A", scene: emptyScene(), frames: [], geometry: null, samples: values.map((v, i) => ({ time: i / 10, values: { "water.kinetic_energy": v, "water.compression.mean": v / 100 } })),
});
