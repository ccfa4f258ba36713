// The script of a page that replays a run: one file, which needs no server and no network. It is put into that page as it is.
// `RUN` is what ./replay.ts writes; the numbers stand in the element #weir-data, as base64 of gzip.
(async () => {
  const at = (id) => document.getElementById(id);
  const bytes = Uint8Array.from(atob(at("weir-data").textContent), (c) => c.charCodeAt(0));
  const data = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  at("weir-data").remove();
  const canvas = at("view"), gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) return void Object.assign(at("why"), { hidden: false, textContent: "This browser has no WebGL 2, so there is nothing to see." });

  // Matrices are columns one after another.
  const times = (a, b) => Float32Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce((s, k) => s + a[4 * k + (i % 4)] * b[4 * (i >> 2) + k], 0));
  const minus = (a, b) => a.map((x, i) => x - b[i]), dot = (a, b) => a.reduce((s, x, i) => s + x * b[i], 0);
  const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
  const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));
  const camera = { eye: [...RUN.camera.eye], target: [...RUN.camera.target], fov: RUN.camera.fov };
  const axes = () => {
    const back = unit(minus(camera.eye, camera.target)), right = unit(cross([0, 1, 0], back));
    return { back, right, up: cross(back, right) };
  };
  const looking = () => {
    const { back, right, up } = axes(), e = camera.eye;
    return [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, e), -dot(up, e), -dot(back, e), 1];
  };
  const projection = () => {
    const far = 100 * (Math.hypot(...minus(camera.eye, camera.target)) + RUN.size), near = far / 50000, f = 1 / Math.tan((camera.fov * Math.PI) / 360);
    return [(f * canvas.height) / canvas.width, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
  };
  /** Of a place and a turn: x, y, z and the quaternion x, y, z, w. */
  const placing = ([x, y, z, a, b, c, w]) =>
    [1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b), 0, 2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a), 0,
      2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b), 0, x, y, z, 1];

  const program = (vertex, fragment) => {
    const p = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const s = gl.createShader(kind);
      gl.shaderSource(s, "#version 300 es\nprecision highp float;\n" + text);
      gl.compileShader(s);
      if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
      gl.attachShader(p, s);
    }
    gl.bindAttribLocation(p, 0, "position");
    gl.bindAttribLocation(p, 1, "value");
    gl.linkProgram(p);
    const found = {};
    return { p, set: (name, f) => f((found[name] ??= gl.getUniformLocation(p, name))) };
  };
  const balls = program(
    `in vec3 position; in float value; uniform mat4 model, projection; uniform vec3 low, extent; uniform float radius, pixels; uniform vec2 values, range;
     out float t; out vec3 center;
     void main() {
       vec4 eye = model * vec4(low + extent * position, 1.0);
       center = eye.xyz;
       t = clamp((mix(values.x, values.y, value) - range.x) / max(range.y - range.x, 1e-12), 0.0, 1.0);
       gl_Position = projection * eye;
       gl_PointSize = max(2.0, pixels * radius * projection[1][1] / max(-eye.z, 1e-4));
     }`,
    `in float t; in vec3 center; uniform sampler2D map; uniform mat4 projection; uniform float radius; out vec4 color;
     void main() {
       vec2 at = 2.0 * gl_PointCoord - 1.0;
       float rr = dot(at, at);
       if (rr > 1.0) discard;
       vec3 normal = vec3(at.x, -at.y, sqrt(1.0 - rr));
       vec4 clip = projection * vec4(center + radius * normal, 1.0);
       gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
       color = vec4(texture(map, vec2(t, 0.5)).rgb * (0.42 + 0.58 * max(0.0, dot(normal, normalize(vec3(0.35, 0.8, 0.5))))), 1.0);
     }`);
  const solids = program(
    `in vec3 position; uniform mat4 model, projection; out vec3 eye; void main() { vec4 e = model * vec4(position, 1.0); eye = e.xyz; gl_Position = projection * e; }`,
    `in vec3 eye; uniform vec3 tint; out vec4 color;
     void main() { vec3 n = normalize(cross(dFdx(eye), dFdy(eye))); color = vec4(tint * (0.5 + 0.5 * abs(n.z)), 0.3); }`);

  const edges = program(
    `in vec3 position; uniform mat4 model, projection; void main() { gl_Position = projection * (model * vec4(position, 1.0)); }`,
    `uniform vec3 tint; out vec4 color; void main() { color = vec4(tint, 1.0); }`);

  const buffer = (kind, values) => {
    const b = gl.createBuffer();
    gl.bindBuffer(kind, b);
    gl.bufferData(kind, values, gl.STATIC_DRAW);
    return b;
  };
  const meshes = RUN.meshes.map((m) => ({
    ...m, points: buffer(gl.ARRAY_BUFFER, new Float32Array(data, m.vertices, 3 * m.vertexCount)), corners: buffer(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(data, m.triangles, m.cornerCount)),
  }));
  const lines = buffer(gl.ARRAY_BUFFER, new Float32Array(data, RUN.lines.at, 3 * RUN.lines.count));
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, RUN.colors.length / 4, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(RUN.colors));
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  const places = gl.createBuffer(), values = gl.createBuffer();
  gl.enable(gl.DEPTH_TEST);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);

  let shown = 0;
  const draw = () => {
    const scale = devicePixelRatio || 1;
    [canvas.width, canvas.height] = [Math.max(1, Math.round(canvas.clientWidth * scale)), Math.max(1, Math.round(canvas.clientHeight * scale))];
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...RUN.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const frame = RUN.frames[shown], view = looking(), project = projection();
    gl.useProgram(balls.p);
    balls.set("model", (u) => gl.uniformMatrix4fv(u, false, view));
    balls.set("projection", (u) => gl.uniformMatrix4fv(u, false, project));
    balls.set("pixels", (u) => gl.uniform1f(u, canvas.height));
    balls.set("range", (u) => gl.uniform2f(u, ...RUN.range));
    for (const f of frame.fluids) {
      for (const [where, b, size, from, count] of [[0, places, 3, f.positions, 3 * f.count], [1, values, 1, f.values, f.count]]) {
        gl.bindBuffer(gl.ARRAY_BUFFER, b);
        gl.bufferData(gl.ARRAY_BUFFER, new Uint16Array(data, from, count), gl.STREAM_DRAW);
        gl.enableVertexAttribArray(where);
        gl.vertexAttribPointer(where, size, gl.UNSIGNED_SHORT, true, 0, 0);
      }
      balls.set("low", (u) => gl.uniform3f(u, ...f.low));
      balls.set("extent", (u) => gl.uniform3f(u, ...minus(f.high, f.low)));
      balls.set("radius", (u) => gl.uniform1f(u, f.radius));
      balls.set("values", (u) => gl.uniform2f(u, f.least, f.most));
      gl.drawArrays(gl.POINTS, 0, f.count);
    }
    gl.disableVertexAttribArray(1);
    gl.useProgram(edges.p);
    edges.set("model", (u) => gl.uniformMatrix4fv(u, false, view));
    edges.set("projection", (u) => gl.uniformMatrix4fv(u, false, project));
    edges.set("tint", (u) => gl.uniform3f(u, ...RUN.lines.color));
    gl.bindBuffer(gl.ARRAY_BUFFER, lines);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.LINES, 0, RUN.lines.count);
    gl.useProgram(solids.p);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    solids.set("projection", (u) => gl.uniformMatrix4fv(u, false, project));
    for (const m of meshes) {
      const pose = frame.poses[m.node];
      solids.set("model", (u) => gl.uniformMatrix4fv(u, false, pose ? times(view, placing(pose)) : view));
      solids.set("tint", (u) => gl.uniform3f(u, ...m.color));
      gl.bindBuffer(gl.ARRAY_BUFFER, m.points);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, m.corners);
      gl.drawElements(gl.TRIANGLES, m.cornerCount, gl.UNSIGNED_INT, 0);
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    at("time").textContent = `${frame.time.toFixed(3)} s`;
    at("frame").value = shown;
  };
  let asked = false;
  const soon = () => asked || ((asked = true), requestAnimationFrame(() => ((asked = false), draw())));
  const show = (i) => ((shown = Math.min(Math.max(i, 0), RUN.frames.length - 1)), soon());

  // Time goes by the clock.
  let playing = false, time = 0, before = 0;
  const tick = (now) => {
    if (!playing) return;
    const end = RUN.frames.at(-1).time;
    time += (Number(at("speed").value) * (now - before)) / 1000;
    before = now;
    if (time > end) time = end > 0 ? time % end : 0;
    let i = RUN.frames.findIndex((f) => f.time > time);
    show(i < 0 ? RUN.frames.length - 1 : Math.max(0, i - 1));
    requestAnimationFrame(tick);
  };
  const play = (on) => {
    playing = on;
    at("play").textContent = on ? "Pause" : "Play";
    if (!on) return;
    time = shown === RUN.frames.length - 1 ? 0 : RUN.frames[shown].time;
    requestAnimationFrame((now) => ((before = now), tick(now)));
  };
  at("play").onclick = () => play(!playing);
  at("frame").max = RUN.frames.length - 1;
  at("frame").oninput = (e) => (play(false), show(Number(e.target.value)));
  addEventListener("keydown", (e) => {
    if (e.key === " " && e.target.tagName !== "BUTTON") play(!playing);
    else if (e.key === "ArrowRight" && e.target.tagName !== "INPUT") (play(false), show(shown + 1));
    else if (e.key === "ArrowLeft" && e.target.tagName !== "INPUT") (play(false), show(shown - 1));
    else return;
    e.preventDefault();
  });

  // The camera: drag turns it, right drag or Shift moves it, the wheel goes nearer.
  const turn = (dx, dy) => {
    const { back } = axes(), distance = Math.hypot(...minus(camera.eye, camera.target));
    const around = Math.atan2(back[0], back[2]) - dx, above = Math.min(Math.max(Math.asin(back[1]) + dy, -1.5), 1.5);
    const to = [Math.cos(above) * Math.sin(around), Math.sin(above), Math.cos(above) * Math.cos(around)];
    camera.eye = camera.target.map((t, i) => t + distance * to[i]);
  };
  const shift = (dx, dy) => {
    const { right, up } = axes(), by = (2 * Math.hypot(...minus(camera.eye, camera.target)) * Math.tan((camera.fov * Math.PI) / 360)) / canvas.clientHeight;
    for (const p of [camera.eye, camera.target]) for (let i = 0; i < 3; ++i) p[i] += by * (dy * up[i] - dx * right[i]);
  };
  canvas.onpointerdown = (e) => canvas.setPointerCapture(e.pointerId);
  canvas.onpointermove = (e) => {
    if (!canvas.hasPointerCapture(e.pointerId)) return;
    if (e.buttons === 2 || e.shiftKey) shift(e.movementX, e.movementY);
    else turn((5 * e.movementX) / canvas.clientHeight, (5 * e.movementY) / canvas.clientHeight);
    soon();
  };
  canvas.oncontextmenu = (e) => e.preventDefault();
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    camera.eye = camera.target.map((t, i) => t + (camera.eye[i] - t) * Math.exp(0.001 * e.deltaY));
    soon();
  }, { passive: false });
  new ResizeObserver(soon).observe(canvas);
  at("save").onclick = () => {
    const a = document.createElement("a");
    a.href = URL.createObjectURL(new Blob([at("weir-scene").textContent], { type: "application/json" }));
    a.download = RUN.file;
    a.click();
  };
  show(0);
  play(true);
})();
