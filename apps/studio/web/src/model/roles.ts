// What a node is for, told by what it gives: so types of plugins have a role, too.
import type { IconName } from "../Icon";
import type { NodeType } from "./types";

export interface Role {
  name: string;
  icon: IconName;
  /** The type of port that has its colour. */
  port: string;
}

const kRoles: Role[] = [
  { name: "Liquids", icon: "drop", port: "Particles" },
  { name: "Sources of particles", icon: "source", port: "ParticleBatch" },
  { name: "Solids and containers", icon: "solid", port: "Boundary" },
  { name: "Solids and containers", icon: "solid", port: "SolidForces" },
  { name: "Meshes", icon: "mesh", port: "TriangleMesh" },
  { name: "Sinks", icon: "sink", port: "SinkRegion" },
  { name: "Surfaces", icon: "surface", port: "DynamicMesh" },
];
export const kModuleRole: Role = { name: "Modules", icon: "modules", port: "Particles" };
export const kOther: Role = { name: "Others", icon: "world", port: "" };

export function roleOf(type: NodeType | undefined): Role {
  const gives = type?.outputs.map((o) => o.type) ?? [];
  return kRoles.find((r) => gives.includes(r.port)) ?? kOther;
}

/** The names of all roles, in the order in which lists have them. */
export const kRoleNames = [...new Set([...kRoles, kOther, kModuleRole].map((r) => r.name))];
