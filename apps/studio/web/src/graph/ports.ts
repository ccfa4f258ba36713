// Colours of port types: the same hue for the same name, evenly told apart.

const kKnown: { [type: string]: number } = { ParticleBatch: 200, Boundary: 30, Particles: 165, TriangleMesh: 285, SinkRegion: 350 };

export function hueOf(type: string): number {
  const known = kKnown[type];
  if (known !== undefined) return known;
  let hash = 0;
  for (const c of type) hash = (hash * 31 + c.charCodeAt(0)) % 360;
  return hash;
}

export const portColor = (type: string): string => `hsl(${hueOf(type)} 70% var(--port-light))`;

/** Of a role, as that of what it gives. */
export const roleColor = (role: { port: string }): string => (role.port ? portColor(role.port) : "var(--soft)");
