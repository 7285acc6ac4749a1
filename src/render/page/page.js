"use strict";
// Positions are in samples, from the first one, as in the shader.

const byId = id => document.getElementById(id);
const page = JSON.parse(byId("page").textContent);
const [nx, ny, nz] = page.dims;

// Vectors.
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const sum = (...terms) => [0, 1, 2].map(i => terms.reduce((total, [share, v]) => total + share * v[i], 0));
const unit = a => sum([1 / Math.hypot(...a), a]);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
function turn(v, axis, angle) {  // Rodrigues
  return sum([Math.cos(angle), v], [Math.sin(angle), cross(axis, v)], [(1 - Math.cos(angle)) * dot(axis, v), axis]);
}

// Returns the samples of an array as whole multiples of its step. Each is stored as its difference from what its
// neighbours before it suggest, all low bytes before all high bytes.
async function readSamples(number) {
  const packed = Uint8Array.from(atob(byId("array" + number).textContent), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = nx * ny * nz, values = new Int16Array(count);
  if (bytes.length !== 2 * count) throw Error(`the page holds ${bytes.length} bytes of samples, not ${2 * count}`);
  const sheet = nx * ny;
  for (let z = 0, i = 0; z < nz; ++z)
    for (let y = 0; y < ny; ++y)
      for (let x = 0; x < nx; ++x, ++i) {
        const at = (dx, dy, dz) => (x < dx || y < dy || z < dz ? 0 : values[i - dx - dy * nx - dz * sheet]);
        values[i] = (bytes[i] | (bytes[count + i] << 8)) + at(1, 0, 0) + at(0, 1, 0) + at(0, 0, 1) - at(1, 1, 0) -
          at(1, 0, 1) - at(0, 1, 1) + at(1, 1, 1);
      }
  return values;
}

// Half floats, which every WebGL 2 filters. They have their finest steps at 0, where the surface is.
function halves({ values, step }) {
  const table = new Uint16Array(65536), float = new Float32Array(1), bits = new Uint32Array(float.buffer);
  for (let v = -32768; v < 32768; ++v) {
    float[0] = Math.abs(v) * step;
    const exponent = (bits[0] >>> 23) - 112, rounded = bits[0] + 0x1000;
    const half = exponent <= 0 ? Math.round(float[0] * 16777216) : Math.min((rounded - (112 << 23)) >>> 13, 0x7bff);
    table[v & 0xffff] = half | (v < 0 ? 0x8000 : 0);
  }
  return Uint16Array.from(values, v => table[v & 0xffff]);
}

// Returns the difference of two fields as an array to show in colour. At first, its colours reach to the largest
// difference within a sample of either surface.
function difference(a, b) {
  const near = 1 / a.step;
  let most = 0;
  const values = a.values.map((v, i) => {
    const gap = b.values[i] - v;
    if (Math.min(Math.abs(v), Math.abs(b.values[i])) < near) most = Math.max(most, Math.abs(gap));
    return gap >> 1;
  });
  return { name: "difference B − A", values, step: 2 * a.step, unit: a.unit, isOnSurface: true, range: Math.max(most, 1) * a.step };
}

function compile(gl) {
  const program = gl.createProgram();
  const corners = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }`;
  for (const [kind, text] of [[gl.VERTEX_SHADER, corners], [gl.FRAGMENT_SHADER, byId("shader").textContent.trim()]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(program) || "no shader");
  return program;
}

class Viewer {
  // Shows fields, and arrays in colour: distances first, of whichever field is shown.
  constructor(gl, fields, colours) {
    this.gl = gl;
    this.fields = fields;
    this.colours = colours;
    this.program = compile(gl);
    this.uniforms = new Map();
    this.target = gl.createFramebuffer();
    this.buffer = gl.createRenderbuffer();
    this.share = 0.5;  // Of the pixels along a side, while somebody turns the shape.
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
    for (const array of new Set([...fields, ...colours])) this.upload(array);
    this.frame();
  }

  upload(array) {
    const { gl } = this;
    array.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_3D, array.texture);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R])
      gl.texParameteri(gl.TEXTURE_3D, side, gl.CLAMP_TO_EDGE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_3D, filter, gl.LINEAR);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R16F, nx, ny, nz, 0, gl.RED, gl.HALF_FLOAT, halves(array));
  }

  frame() {  // The view of the picture.
    const { eye, forward } = page.scene;
    this.forward = forward;
    this.distance = dot(sum([1, page.fields[0].shape.centre], [-1, eye]), forward);
    this.centre = sum([1, eye], [this.distance, forward]);
    this.mark = undefined;
  }

  // Looks from outside at a ball, and marks it.
  goTo({ at, radius }) {
    const h = Math.max(radius, 1), field = this.fields[this.settings.field];
    const axes = [[h, 0, 0], [0, h, 0], [0, 0, h]];
    const outward = axes.map(axis => this.value(sum([1, at], [1, axis]), field) - this.value(sum([1, at], [-1, axis]), field));
    if (Math.hypot(...outward) > 0.1 * h) this.look(sum([-1, outward]));
    this.centre = at;
    this.distance = Math.max(15 * radius, 0.7 * page.fields[0].shape.radius);
    this.mark = { at, radius };
  }

  showMark() {
    const { mark } = this, style = byId("mark").style, canvas = this.gl.canvas;
    const { right, up, eye } = this.axes(), way = mark && sum([1, mark.at], [-1, eye]);
    byId("mark").hidden = !mark || dot(way, this.forward) <= 0;
    if (byId("mark").hidden) return;
    const scale = 1 / (dot(way, this.forward) * this.pixelAngle(canvas.clientHeight));
    style.left = `${canvas.clientWidth / 2 + scale * dot(way, right)}px`;
    style.top = `${canvas.clientHeight / 2 - scale * dot(way, up)}px`;
    style.width = style.height = `${Math.max(2.4 * scale * mark.radius, 26)}px`;
  }

  look(forward) {
    this.forward = unit(forward);
  }

  orbit(x, y) {  // angles
    const up = page.scene.floorNormal;
    const turned = turn(this.forward, up, -x);
    const tilted = turn(turned, unit(cross(turned, up)), -y);
    this.forward = unit(Math.abs(dot(tilted, up)) < 0.999 ? tilted : turned);
  }

  axes() {
    const up = page.scene.floorNormal;
    const side = cross(this.forward, Math.abs(dot(this.forward, up)) < 0.9999 ? up : [up[1], up[2], up[0]]);
    const right = unit(side);
    return { right, up: cross(right, this.forward), eye: sum([1, this.centre], [-this.distance, this.forward]) };
  }

  pixelAngle(height) {
    return page.scene.pixelAngle * page.height / height;
  }

  ray(x, y) {  // through a point of the canvas, in CSS pixels
    const { right, up, eye } = this.axes(), canvas = this.gl.canvas;
    const angle = this.pixelAngle(canvas.clientHeight);
    const [u, v] = [angle * (x - canvas.clientWidth / 2), angle * (y - canvas.clientHeight / 2)];
    return { eye, direction: unit(sum([1, this.forward], [u, right], [-v, up])) };
  }

  move(x, y) {  // CSS pixels
    const { right, up } = this.axes(), step = this.distance * this.pixelAngle(this.gl.canvas.clientHeight);
    this.centre = sum([1, this.centre], [-step * x, right], [step * y, up]);
  }

  // Comes closer to what is at this place, or goes away from it.
  zoom(factor, x, y) {
    const ray = this.ray(x, y), hit = this.pick(ray)?.p;
    const towards = hit ?? sum([1, ray.eye], [this.distance, ray.direction]);
    const { radius } = page.fields[0].shape, least = 1e-3 * radius;
    const share = clamp(factor * this.distance, least, 100 * radius) / this.distance;
    this.distance *= share;
    this.centre = sum([share, this.centre], [1 - share, towards]);
  }

  inGrid(q, { values, step }) {
    const low = q.map((v, a) => Math.min(Math.floor(v), Math.max(page.dims[a] - 2, 0))), t = q.map((v, a) => v - low[a]);
    let value = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const [x, y, z] = [0, 1, 2].map(a => Math.min(low[a] + (corner >> a & 1), page.dims[a] - 1));
      const weight = [0, 1, 2].reduce((w, a) => w * (corner >> a & 1 ? t[a] : 1 - t[a]), 1);
      value += weight * step * values[(z * ny + y) * nx + x];
    }
    return value;
  }

  value(p, field) {  // distance in samples
    const q = closest(p), inGrid = this.inGrid(q, field), outside = Math.hypot(...p.map((v, a) => v - q[a]));
    return outside === 0 ? inGrid : Math.hypot(outside, Math.max(inGrid, 0));
  }

  shapeDistance(p) {
    const { shape, field } = this.settings;
    const d = this.value(p, this.fields[field]) - shape.level;
    const solid = shape.wall > 0 ? Math.max(d, -(d + shape.wall)) : d;
    return Math.max(solid, dot(shape.cutNormal, p) - shape.cutOffset);
  }

  // Returns what is seen along a ray: {p, isSlice}, or nothing.
  pick({ eye, direction }) {
    const { shape, sliceNormal, sliceOffset } = this.settings;
    const slice = (sliceOffset - dot(eye, sliceNormal)) / dot(direction, sliceNormal);
    const p = sum([1, eye], [slice, direction]);
    const isInGrid = slice > 0 && p.every((v, a) => v >= -0.5 && v <= page.dims[a] - 0.5);
    const middle = dot(sum([1, shape.centre], [-1, eye]), direction), reach = shape.radius + 2;
    for (let t = Math.max(middle - reach, 0); t <= middle + reach;) {
      if (isInGrid && slice <= t) break;
      const at = sum([1, eye], [t, direction]), d = this.shapeDistance(at);
      if (d <= 0) return { p: at, isSlice: false };
      t += Math.max(0.9 * d, 0.05);
    }
    return isInGrid ? { p, isSlice: true } : undefined;
  }

  set(name, value) {
    const { gl } = this;
    if (!this.uniforms.has(name)) this.uniforms.set(name, gl.getUniformLocation(this.program, "push." + name));
    const at = this.uniforms.get(name);
    if (["width", "height", "rays", "colours", "stopCount", "shape.nx", "shape.ny", "shape.nz"].includes(name))
      gl.uniform1ui(at, value);
    else if (name === "stops") gl.uniform4fv(at, value.flat());
    else if (value.length) gl.uniform3fv(at, value.flat());
    else gl.uniform1f(at, value);
  }

  draw(width, height, rays, first, last) {  // rows from the bottom
    const { gl, settings } = this, { right, up, eye } = this.axes(), floorNormal = page.scene.floorNormal;
    const [a, b, c] = page.light;
    const camera = { eye, right, up, forward: this.forward, pixelAngle: this.pixelAngle(height),
      toLight: unit(sum([a, right], [b, this.forward], [c, floorNormal])),
      sliceNormal: settings.sliceNormal, sliceOffset: settings.sliceOffset };
    const field = this.fields[settings.field], colours = settings.colours > 0 ? this.colours[settings.colours] : field;
    gl.useProgram(this.program);
    for (const [unit, name, array] of [[0, "samples", field], [1, "values", colours]]) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_3D, array.texture);
      gl.uniform1i(gl.getUniformLocation(this.program, name), unit);
    }
    for (const [name, value] of Object.entries(settings.shape)) this.set("shape." + name, value);
    for (const [name, value] of Object.entries({ ...page.scene, ...(isDark.matches ? page.dark : {}), ...camera }))
      this.set("scene." + name, value);
    const { stops, lineStep } = settings, stopCount = stops.length;
    for (const [name, value] of Object.entries({ width, height, rays, stopCount, lineStep,
      stops: stops.map(([at, ...colour]) => [...colour, at]), colours: settings.colours === 0 ? 0 : colours.isOnSurface ? 2 : 1 }))
      this.set(name, value);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, width + 1, height + 1);  // One pixel more, which `show` reads where it enlarges the picture.
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(0, first, width + 1, last - first);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.disable(gl.SCISSOR_TEST);
  }

  show(width, height) {
    const { gl } = this, { width: w, height: h } = gl.canvas;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.target);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, w, h, gl.COLOR_BUFFER_BIT, width === w && height === h ? gl.NEAREST : gl.LINEAR);
  }

  fit() {
    const { gl } = this, { canvas } = gl, ratio = devicePixelRatio;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(side => Math.max(Math.round(side * ratio), 1));
    if (canvas.width === width && canvas.height === height && this.hasBuffer) return;
    this.hasBuffer = true;
    [canvas.width, canvas.height] = [width, height];
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.buffer);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width + 1, height + 1);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, this.buffer);
  }

  // Draws coarsely now, then all of it in strips, so that a slow GPU does not hang the browser.
  async update() {
    const turn = this.turn = (this.turn ?? 0) + 1, busy = byId("busy").style;
    busy.setProperty("--share", 0);
    document.body.dataset.drawn = "no";
    await new Promise(requestAnimationFrame);
    if (turn !== this.turn) return;
    this.fit();
    this.showMark();
    const { gl } = this, { width, height } = gl.canvas;
    const [w, h] = [width, height].map(side => Math.max(Math.round(side * this.share), 1));
    const start = performance.now();
    this.draw(w, h, 1, 0, h + 1);
    this.show(w, h);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));  // Waits.
    const time = performance.now() - start;
    if (time > 40) this.share = Math.max(this.share / 1.4, 0.05);
    if (time < 12) this.share = Math.min(this.share * 1.2, 1);
    await new Promise(done => setTimeout(done, 120));
    const rows = Math.max(Math.ceil(height / 32), 1);
    for (let row = 0; row < height; row += rows) {
      if (turn !== this.turn) return;
      this.draw(width, height, 4, row, Math.min(row + rows, height));
      gl.readPixels(0, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      busy.setProperty("--share", (row + rows) / height);
      await new Promise(done => setTimeout(done));
    }
    if (turn !== this.turn) return;
    this.show(width, height);
    document.body.dataset.drawn = "yes";
  }
}

const isDark = matchMedia("(prefers-color-scheme: dark)");
const shortened = value => Number(value.toPrecision(4)).toString();
const extent = page.spacing * Math.max(nx, ny, nz);
const placed = value => {  // A coordinate, in steps of a thousandth of the box's size, or finer.
  const step = 10 ** (Math.floor(Math.log10(extent)) - 3);
  return Number((Math.round(value / step) * step).toPrecision(12)).toString();
};
const closest = p => p.map((v, a) => clamp(v, 0, page.dims[a] - 1));  // Of the box of the samples.
const roundedUp = length => {  // To 1, 2 or 5 times a power of ten.
  const power = 10 ** Math.floor(Math.log10(length));
  return power * [1, 2, 5, 10].find(factor => length <= 1.000001 * factor * power);
};

// Returns the numbers at which an array has its surface, and what it says of a number.
function sidesOf({ name, range }) {
  if (name === "distance") return { levels: [0], side: value => ["inside", "", "outside"][Math.sign(value) + 1] };
  if (name === "winding number") return { levels: [-0.5, 0.5], side: value => (Math.abs(value) > 0.5 ? "inside" : "outside") };
  return { levels: range === undefined ? [] : [0], side: () => "" };
}

// Shows the colours from one value to another.
function showLegend(array, stops, least, most) {
  const { unit } = array, { levels, side } = sidesOf(array);
  const encode = c => Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
  const places = stops.map(([at, ...colour]) => `rgb(${colour.map(encode)}) ${100 * (at - least) / (most - least || 1)}%`);
  byId("ramp").style.background = `linear-gradient(to right, ${places})`;
  for (const [id, value] of [["least", least], ["most", most]]) {
    byId(id).textContent = shortened(value * unit);
    byId(id + "Side").textContent = side(value);
  }
  byId("levels").replaceChildren(...levels.filter(level => level > least && level < most).map(level => {
    const mark = document.createElement("span");
    mark.textContent = level;
    mark.style.left = `${100 * (level - least) / (most - least)}%`;
    return mark;
  }));
}

// Returns the colours that the controls choose: stops, and the step of the lines.
function readColours(viewer) {
  const colours = Number(byId("colours").value), array = viewer.colours[colours];
  byId("ranges").hidden = array.range === undefined;
  const isSeen = array.isOnSurface || byId("cut").value || byId("slice").value;
  byId("meaning").textContent = array.range !== undefined ? "Red: the surface of B lies farther in. Blue: farther out."
    : isSeen ? "" : "A cut or a slice shows these colours.";
  if (array.range === undefined) {
    const [first, last] = [array.stops[0][0], array.stops.at(-1)[0]];
    showLegend(array, array.stops, Math.max(first, array.least), Math.min(last, array.most));
    return { colours, stops: array.stops, lineStep: array.lineStep };
  }
  const range = array.range * byId("range").value, stops = page.difference.map(([at, ...colour]) => [at * range, ...colour]);
  showLegend(array, stops, -range, range);
  return { colours, stops, lineStep: roundedUp(range * array.unit / 5) / array.unit };
}

// Returns what the shader draws, as the controls say.
function readControls(viewer) {
  const axis = name => ["x", "y", "z"].indexOf(byId(name).value);
  const normal = a => [0, 1, 2].map(b => (a === b ? 1 : 0));
  const place = (name, a) => (a < 0 ? 0 : byId(name + "At").value * (page.dims[a] - 1));
  const cut = axis("cut"), slice = axis("slice"), side = byId("flip").checked ? -1 : 1;
  const step = page.scene.depth / 500;  // Of the sliders; their values are rounded.
  const [iso, shell] = ["iso", "shell"].map(name => step * Math.round(byId(name).value / step));
  byId("isoText").textContent = shortened(iso * page.spacing);
  byId("shellText").textContent = shell > 0 ? shortened(shell * page.spacing) : "none";
  for (const name of ["cutAt", "flip"]) byId(name).disabled = cut < 0;
  byId("sliceAt").disabled = slice < 0;
  const field = Number(byId("field").value), { shape } = page.fields[field];
  return {
    ...readColours(viewer), field,
    shape: { ...shape, radius: shape.radius + Math.max(iso, 0), level: shape.level + iso, wall: shell,
      cutNormal: sum([side, normal(cut)]), cutOffset: cut < 0 ? 3e38 : side * place("cut", cut) },
    sliceNormal: normal(slice), sliceOffset: place("slice", slice),
  };
}

function addOptions(name, labels, chosen) {
  byId(name).replaceChildren(...labels.map((label, i) => new Option(label, i, i === chosen, i === chosen)));
}

function setControls(viewer) {
  const initial = page.fields[0].shape, cut = initial.cutNormal.findIndex(v => v !== 0);
  const limit = name => {
    const input = byId(name);
    const most = page.scene.depth;
    [input.min, input.max, input.step] = [name === "iso" ? -most : 0, most, most / 500];
  };
  limit("iso");
  limit("shell");
  byId("iso").defaultValue = 0;
  byId("shell").defaultValue = initial.wall;
  for (const option of byId("cut").options) option.defaultSelected = option.value === (cut < 0 ? "" : "xyz"[cut]);
  byId("cutAt").defaultValue = cut < 0 ? 0.5 : initial.cutNormal[cut] * initial.cutOffset / Math.max(page.dims[cut] - 1, 1);
  byId("flip").defaultChecked = cut >= 0 && initial.cutNormal[cut] < 0;
  byId("sliceAt").defaultValue = 0.5;
  const names = viewer.colours.map(array => array.name);
  addOptions("colours", names, Math.max(names.indexOf(page.colours), 0));
  addOptions("field", page.fields.map(({ name }, i) => (page.fields.length > 1 ? `${"AB"[i]}: ${name}` : name)), 0);
  for (const id of ["fields", "switch", "switches"]) byId(id).hidden = page.fields.length < 2;
  [byId("range").min, byId("range").max, byId("range").step, byId("range").defaultValue] = [0.01, 1, 0.01, 1];
  byId("controls").reset();
}

// Lists the places of the mesh's defects. A click leads there.
function listDefects(viewer) {
  const create = (parent, kind, text = "") => {
    const element = parent.appendChild(document.createElement(kind));
    element.textContent = text;
    return element;
  };
  const section = byId("defects");
  section.hidden = page.defects.length === 0;
  for (const { name, unit, count, isComplete, places, listed } of page.defects) {
    const details = create(section, "details");
    create(details, "summary", `${name}: ${name === "Holes" ? places : (isComplete ? "" : "at least ") + count}`);
    if (places > listed.length) create(details, "p", `The ${listed.length} largest of ${places} places:`);
    const list = create(details, "ol");
    for (const place of listed) {
      const size = 2 * place.radius * page.spacing;
      const button = create(create(list, "li"), "button", `${place.count} ${unit}${place.count > 1 ? "s" : ""}, ${shortened(size)} across`);
      button.title = "Look at this place";
      button.onclick = () => {
        for (const shown of section.querySelectorAll(".shown")) shown.classList.remove("shown");
        button.classList.add("shown");
        viewer.goTo(place);
        viewer.update();
      };
    }
  }
}

function listen(viewer) {
  const { canvas } = viewer.gl, form = byId("controls");
  const read = () => { viewer.settings = readControls(viewer); viewer.update(); };
  form.oninput = read;
  form.onreset = () => { viewer.frame(); setTimeout(read); };
  isDark.onchange = () => viewer.update();
  new ResizeObserver(() => viewer.update()).observe(canvas);
  canvas.oncontextmenu = event => event.preventDefault();

  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  canvas.onpointerdown = event => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
  };
  canvas.onpointerup = canvas.onpointercancel = event => fingers.delete(event.pointerId);
  canvas.onpointermove = event => {
    const before = fingers.get(event.pointerId), now = { x: event.offsetX, y: event.offsetY };
    if (!before) return hover(viewer, now);
    const pinch = fingers.size === 2 ? spread() : undefined;
    fingers.set(event.pointerId, now);
    const [x, y] = [now.x - before.x, now.y - before.y];
    if (pinch) {
      const after = spread();
      viewer.move(after.x - pinch.x, after.y - pinch.y);
      viewer.zoom(pinch.size / Math.max(after.size, 1), after.x, after.y);
    } else if (event.buttons & 2 || event.shiftKey) viewer.move(x, y);
    else viewer.orbit(4 * x / canvas.clientHeight, 4 * y / canvas.clientHeight);
    viewer.update();
  };
  canvas.onwheel = event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 30 : 1;
    viewer.zoom(Math.exp(clamp(event.deltaY * lines, -200, 200) / 600), event.offsetX, event.offsetY);
    viewer.update();
  };
  canvas.ondblclick = event => {
    const hit = viewer.pick(viewer.ray(event.offsetX, event.offsetY));
    if (hit) viewer.centre = hit.p;
    viewer.update();
  };
  canvas.onpointerleave = () => { byId("place").textContent = ""; };
  document.onkeydown = event => {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT)$/.test(event.target.tagName)) return;
    const up = page.scene.floorNormal, side = unit(cross(up, [up[2], up[0], up[1]])), front = cross(side, up);
    const middle = [canvas.clientWidth / 2, canvas.clientHeight / 2];
    const actions = {
      ArrowLeft: () => viewer.orbit(-0.1, 0), ArrowRight: () => viewer.orbit(0.1, 0),
      ArrowUp: () => viewer.orbit(0, -0.1), ArrowDown: () => viewer.orbit(0, 0.1),
      "+": () => viewer.zoom(0.9, ...middle), "-": () => viewer.zoom(1 / 0.9, ...middle),
      1: () => viewer.look(front), 3: () => viewer.look(side), 7: () => viewer.look(sum([-1, up], [1e-3, front])),
      b: () => { byId("field").selectedIndex = 1 - byId("field").selectedIndex; read(); }, f: () => viewer.frame(), h: () => { byId("help").open = !byId("help").open; },
    };
    if (page.fields.length < 2) delete actions.b;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
    viewer.update();
  };
}

function hover(viewer, { x, y }) {
  const hit = viewer.pick(viewer.ray(x, y));
  if (!hit) return byId("place").textContent = "";
  const at = hit.p.map((v, a) => placed(page.origin[a] + v * page.spacing)).join(", ");
  const read = array => shortened(viewer.inGrid(closest(hit.p), array) * array.unit);
  const isTwo = viewer.fields.length > 1, fields = isTwo || hit.isSlice ? viewer.fields : [];
  const values = fields.map((field, i) => `${isTwo ? "AB"[i] : "distance"} ${read(field)}`);
  values.push(...viewer.colours.slice(1).map(array => `${isTwo ? "B − A" : array.name} ${read(array)}`));
  byId("place").textContent = [`(${at})`, ...values].join(", ");
}

async function start() {
  const canvas = byId("canvas"), gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });
  if (!gl) throw Error("this browser has no WebGL 2");
  const most = gl.getParameter(gl.MAX_3D_TEXTURE_SIZE);
  if (Math.max(nx, ny, nz) > most) throw Error(`this browser draws at most ${most} samples along a side`);
  const arrays = await Promise.all(page.arrays.map(async (array, i) => ({ ...array, values: await readSamples(i) })));
  const fields = arrays.slice(0, page.fields.length), [a, b] = fields;
  const viewer = new Viewer(gl, fields, b ? [a, difference(a, b)] : arrays);
  setControls(viewer);
  viewer.settings = readControls(viewer);
  listDefects(viewer);
  byId("still").hidden = true;
  for (const id of ["canvas", "controls", "help"]) byId(id).hidden = false;
  canvas.addEventListener("webglcontextlost", () => fail(Error("the browser has lost its GPU; load the page again")));
  listen(viewer);
}

function fail(error) {
  for (const id of ["canvas", "controls", "help", "defects", "mark"]) byId(id).hidden = true;
  byId("still").hidden = false;
  byId("trouble").hidden = false;
  byId("trouble").textContent = `Only a picture: ${error.message}.`;
}

start().catch(fail);
