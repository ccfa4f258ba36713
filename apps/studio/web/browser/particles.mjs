// Particles as a page sees them, and as `weir run --ply-particles` writes them: by id, every attribute to the last bit.

const kTypes = {
  float: { bytes: 4, read: (view, at) => view.getFloat32(at, true) },
  double: { bytes: 8, read: (view, at) => view.getFloat64(at, true) }, // ids
  int: { bytes: 4, read: (view, at) => view.getInt32(at, true) },
};

/** Of a binary PLY file of particles: attributes by id. */
export function particlesOfPly(bytes) {
  const end = bytes.indexOf("end_header\n") + "end_header\n".length;
  const header = bytes.subarray(0, end).toString("latin1");
  const count = Number(/element vertex (\d+)/.exec(header)[1]);
  const columns = [...header.matchAll(/property (\w+) (\w+)/g)].map((m) => ({ ...kTypes[m[1]], name: m[2] }));
  const view = new DataView(bytes.buffer, bytes.byteOffset + end);
  const particles = new Map();
  let at = 0;
  const next = (column) => {
    const value = column.read(view, at);
    at += column.bytes;
    return value;
  };
  for (let i = 0; i < count; ++i) {
    const row = Object.fromEntries(columns.map((c) => [c.name, next(c)]));
    const { x, y, z, vx, vy, vz, id, ...rest } = row;
    particles.set(id, { position: [x, y, z], velocity: [vx, vy, vz], ...rest });
  }
  return particles;
}

// A server refuses a client that has more than 32 questions open.
const kQuestionsAtOnce = 16;

/** Of the simulation that runs behind a page. It is asked as the page asks when a particle is clicked. */
export async function particlesOfPage(page, node, ids) {
  const answers = await page.evaluate(
    ([node, ids, atOnce]) =>
      new Promise((resolve, reject) => {
        const socket = new WebSocket(`ws://${location.host}/api/live`);
        const found = [];
        let asked = 0;
        const ask = () => asked < ids.length && socket.send(JSON.stringify({ id: asked, do: "particle", node, particle: ids[asked++] }));
        socket.onopen = () => Array.from({ length: atOnce }).forEach(ask);
        socket.onerror = () => reject(new Error("no connection"));
        socket.onmessage = (m) => {
          const answer = typeof m.data === "string" ? JSON.parse(m.data) : {};
          if (answer.id === undefined) return;
          if (!answer.result) return reject(new Error(m.data));
          found.push(answer.result);
          ask();
          if (found.length === ids.length) (socket.close(), resolve(found));
        };
      }),
    [node, ids, kQuestionsAtOnce],
  );
  // Floats come with as many digits as they need.
  const floats = (v) => (Array.isArray(v) ? v.map(Math.fround) : Math.fround(v));
  const read = (attributes) => Object.fromEntries(Object.entries(attributes).map(([name, v]) => [name, floats(v)]));
  return new Map(answers.map((a) => [a.id, read(a.attributes)]));
}
