// SPDX-License-Identifier: GPL-3.0-or-later
// Pad and missile of a drop in 3-D, from the frames that softfall-post wrote. Lengths are in m. A quantised array has
// value = low[c] + step[c] * code in component c.
import * as THREE from "./three.module.min.js";

const XYZ = [0, 1, 2];
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;

/* All values of a quantised array. */
function values(array) {
  const code = new Uint16Array(bytes(array.data)), n = array.low.length, out = new Float32Array(code.length);
  for (let k = 0; k < out.length; k++) out[k] = array.low[k % n] + array.step[k % n] * code[k];
  return out;
}

/* A drop, decoded: triangles and edges of the pad's skin, tetrahedra of its cells, the missile, and the frames. */
class Drop {
  constructor(data) {
    const index = text => data.wide ? new Uint32Array(bytes(text)) : new Uint16Array(bytes(text)), none = data.wide ? 0xffffffff : 0xffff;
    Object.assign(this, {fields: data.fields, decades: data.decades, planes: data.planes, axis: data.axis, peak: data.peak, colours: data.colours, triangles: [], tetrahedra: []});
    const faces = index(data.skin), edges = new Map();
    for (let k = 0; k < faces.length; k += 4) {
      const corner = [...faces.slice(k, k + 4)].filter(node => node !== none);
      for (let c = 2; c < corner.length; c++) this.triangles.push(corner[0], corner[c - 1], corner[c]);
      corner.forEach((node, c) => { const next = corner[(c + 1) % corner.length]; edges.set(node < next ? `${node} ${next}` : `${next} ${node}`, [node, next]); });
    }
    this.edges = [...edges.values()].flat();
    if (data.cells) {
      const type = new Uint8Array(bytes(data.cells.type)), node = index(data.cells.node);
      for (let c = 0, at = 0; c < type.length; c++) {
        const corner = data.tetrahedra[type[c]];
        for (const k of corner) this.tetrahedra.push(node[at + k]);
        at += Math.max(...corner) + 1;
      }
    }
    this.bodies = ["missile", "support"].map(name => data[name] && {position: values(data[name].position), triangle: index(data[name].triangle), sphere: data[name].sphere});
    this.frames = data.frames.map(f => ({time: f.time, motion: f.missile, packed: f}));
  }

  /* Decodes a frame when it is shown first. */
  frame(k) {
    const frame = this.frames[k];
    if (frame.packed) Object.assign(frame, {position: values(frame.packed.position), values: frame.packed.fields.map(values), packed: null});
    return frame;
  }

  /* The scale of a field, over all frames. */
  scale(f) {
    const field = this.fields[f];
    if (field.high === undefined) {
      const ends = this.frames.map((_, k) => this.frame(k).values[f]).map(v => [v.reduce((a, b) => Math.min(a, b), 0), v.reduce((a, b) => Math.max(a, b), 0)]);
      field.high = Math.max(...ends.map(e => e[1])) * field.factor;
      const low = Math.min(...ends.map(e => e[0])) * field.factor;
      field.logarithmic = field.logarithmic && field.high > 0;
      field.low = field.logarithmic ? field.high / 10 ** this.decades : low > -0.02 * field.high ? 0 : low;
      if (!(field.high > field.low)) field.high = field.low + 1;
    }
    return field;
  }

  /* Writes the colours of values into an array of three for each. */
  paint(f, value, out) {
    const field = this.scale(f), span = field.logarithmic ? Math.log(field.high / field.low) : field.high - field.low;
    for (let i = 0; i < value.length; i++) {
      const x = value[i] * field.factor, part = field.logarithmic ? Math.log(Math.max(x, field.low) / field.low) / span : (x - field.low) / span;
      const at = Math.min(6.999, Math.max(0, part * 7)), k = Math.floor(at);
      for (const c of XYZ) out[3 * i + c] = ((this.colours[3 * k + c] + (at - k) * (this.colours[3 * k + 3 + c] - this.colours[3 * k + c])) / 255) ** 2.2;
    }
  }
}

export class Viewer {
  /* `$` finds elements of the page; `onTime` is called with the time of the frame that is shown, in s. */
  constructor($, onTime) {
    Object.assign(this, {$, onTime, place: $("scene"), k: 0, timer: 0, azimuth: -1.15, elevation: 0.3, zoom: 1, pan: [0, 0]});
    this.renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.localClippingEnabled = true;
    this.place.append(this.renderer.domElement);
    this.camera = new THREE.OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    this.scene = new THREE.Scene();
    this.sun = new THREE.DirectionalLight(0xffffff, 1.7);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0xb8c2cc, 2.0), this.sun);
    this.listen();
    new ResizeObserver(() => this.render()).observe(this.place);
  }

  load(data) {
    this.play(false);
    this.drop = new Drop(data);
    const {$, drop} = this, field = Math.min(Math.max(0, $("field").selectedIndex), drop.fields.length - 1);
    $("field").replaceChildren(...drop.fields.map((f, k) => new Option(`${f.name} (${f.unit})`, k, false, k === field)));
    $("time").max = drop.frames.length - 1;
    $("controls").hidden = $("legend").hidden = $("scale").hidden = false;
    this.build();
    this.show(Math.max(0, drop.peak ?? 0));
    this.fit();
  }

  /* Makes the meshes of the modelled part and its mirror images. */
  build() {
    const {drop, $} = this, first = drop.frame(0).position, isCut = $("cut").checked;
    this.group?.traverse(o => { o.geometry?.dispose(); o.material?.dispose(); });
    if (this.group) this.scene.remove(this.group);
    this.group = new THREE.Group();
    const mirrored = XYZ.slice(0, 2).filter(d => drop.planes[d] !== null && drop.planes[d] !== undefined), images = mirrored.filter(d => d !== 1 || !isCut);
    this.split(first, images);
    this.lines = new THREE.BufferGeometry();
    this.lines.setAttribute("position", new THREE.BufferAttribute(new Float32Array(first.length), 3));
    this.lines.setIndex(drop.edges.filter((_, k) => !images.some(d => [k - k % 2, k - k % 2 + 1].every(i => Math.abs(first[3 * drop.edges[i] + d] - drop.planes[d]) < 1e-7))));
    this.cutFace = new THREE.BufferGeometry();
    this.section = isCut && !mirrored.includes(1) && drop.tetrahedra.length > 0; // else the symmetry plane is the cut
    const clip = this.section ? [new THREE.Plane(new THREE.Vector3(0, 1, 0), -drop.axis[1])] : [];
    const skin = new THREE.MeshStandardMaterial({vertexColors: true, roughness: 0.85, side: THREE.DoubleSide, clippingPlanes: clip, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    const face = new THREE.MeshBasicMaterial({vertexColors: true, side: THREE.DoubleSide});
    const wire = new THREE.LineBasicMaterial({color: 0x1b2430, transparent: true, opacity: 0.35, clippingPlanes: clip});
    const part = new THREE.Group();
    this.wires = new THREE.LineSegments(this.lines, wire);
    part.add(new THREE.Mesh(this.pad, skin), new THREE.Mesh(this.cutFace, face), this.wires);
    this.box = new THREE.Box3();
    for (let i = 0; i < first.length; i += 3) this.box.expandByPoint(new THREE.Vector3(...first.slice(i, i + 3)));
    let parts = [part];
    for (const d of images) {
      parts.push(...parts.map(p => {
        const image = p.clone(), outer = new THREE.Group();
        outer.add(image);
        outer.scale.setComponent(d, -1);
        outer.position.setComponent(d, 2 * drop.planes[d]);
        return outer;
      }));
      this.box.expandByPoint(new THREE.Vector3(...XYZ.map(e => e === d ? 2 * drop.planes[d] - this.box.max.getComponent(e) : this.box.min.getComponent(e))));
    }
    this.group.add(...parts);
    const extent = this.box.getSize(new THREE.Vector3()), dash = 0.012 * extent.length();
    const outline = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(...extent.toArray())),
      new THREE.LineDashedMaterial({color: 0x5a6675, dashSize: dash, gapSize: 0.7 * dash, clippingPlanes: clip}));
    outline.position.copy(this.box.getCenter(new THREE.Vector3()));
    outline.computeLineDistances();
    this.group.add(outline);
    this.buildBodies(images);
    this.scene.add(this.group);
  }

  /* Makes the pad's skin without its faces in planes behind which a mirror image begins. Faces of different directions have points of their own, so
   * that edges stay sharp: `source` has the node of each point. */
  split(first, images) {
    const points = new Map(), index = [], {triangles, planes} = this.drop, at = i => first.slice(3 * i, 3 * i + 3);
    this.source = [];
    for (let t = 0; t < triangles.length; t += 3) {
      const corner = triangles.slice(t, t + 3), [a, b, c] = corner.map(i => new THREE.Vector3(...at(i))), normal = b.sub(a).cross(c.sub(a)).toArray();
      if (images.some(d => corner.every(i => Math.abs(first[3 * i + d] - planes[d]) < 1e-7))) continue;
      const size = normal.map(Math.abs), axis = size.indexOf(Math.max(...size)), side = 2 * axis + (normal[axis] > 0);
      for (const i of corner) {
        const key = 6 * i + side;
        if (!points.has(key)) { points.set(key, this.source.length); this.source.push(i); }
        index.push(points.get(key));
      }
    }
    this.pad = new THREE.BufferGeometry();
    for (const name of ["position", "color"]) this.pad.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * this.source.length), 3));
    this.pad.setIndex(index);
  }

  /* The rigid bodies: a missile that the pad can be seen through, and supports. Its mirror images are those of the pad. */
  buildBodies(images) {
    this.missiles = [];
    const missile = this.drop.bodies[0]?.position, [low, high] = missile ? [missile.reduce((z, x, k) => k % 3 === 2 ? Math.min(z, x) : z, Infinity), missile.reduce((z, x, k) => k % 3 === 2 ? Math.max(z, x) : z, -Infinity)] : [0, 0];
    this.top = this.box.max.z + 0.75 * (high - low); // a missile that has met the pad
    this.drop.bodies.forEach((body, which) => {
      if (!body) return;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(body.position, 3));
      geometry.setIndex([...body.triangle]);
      geometry.computeVertexNormals();
      if (body.sphere) { // the triangles approximate a sphere, whose normals are known
        const normal = geometry.getAttribute("normal"), [x, y, z] = body.sphere, p = body.position, reach = body.sphere[3];
        for (let i = 0; i < normal.count; i++) {
          const arm = [p[3 * i] - x, p[3 * i + 1] - y, p[3 * i + 2] - z], length = Math.hypot(...arm);
          if (Math.abs(length - reach) < 0.02 * reach) normal.setXYZ(i, ...arm.map(a => a / length));
        }
      }
      const glass = which === 0;
      const material = new THREE.MeshPhongMaterial({color: glass ? 0x7fa3c7 : 0x9aa4ae, specular: 0x445566, shininess: 60, transparent: glass, opacity: glass ? 0.42 : 1, side: THREE.DoubleSide, depthWrite: !glass});
      const ends = new THREE.EdgesGeometry(geometry, 35).getAttribute("position").array, kept = new THREE.BufferGeometry(), seams = k => images.some(d => Math.abs(ends[k + d] - this.drop.planes[d]) + Math.abs(ends[k + 3 + d] - this.drop.planes[d]) < 1e-6);
      kept.setAttribute("position", new THREE.Float32BufferAttribute([...ends].filter((_, k) => !seams(k - k % 6)), 3));
      const edge = new THREE.LineSegments(kept, new THREE.LineBasicMaterial({color: 0x33475c}));
      let copies = [new THREE.Matrix4()];
      for (const d of images) {
        const flip = new THREE.Matrix4().makeScale(...XYZ.map(e => e === d ? -1 : 1));
        flip.setPosition(...XYZ.map(e => e === d ? 2 * this.drop.planes[d] : 0));
        copies.push(...copies.map(m => flip.clone().multiply(m)));
      }
      for (const copy of copies) {
        const whole = new THREE.Group(), own = new THREE.Group();
        whole.matrixAutoUpdate = own.matrixAutoUpdate = false;
        whole.matrix.copy(copy);
        const mesh = new THREE.Mesh(geometry, material);
        mesh.renderOrder = 2;
        own.add(mesh, edge.clone());
        whole.add(own);
        this.group.add(whole);
        if (glass) this.missiles.push(own);
      }
    });
  }

  show(k) {
    const {drop, $} = this, frame = drop.frame(k), f = $("field").selectedIndex;
    this.k = k;
    $("time").value = k;
    $("now").textContent = `${(1e3 * frame.time).toFixed(2)} ms`;
    $("time").setAttribute("aria-valuetext", $("now").textContent);
    const [point, colour] = ["position", "color"].map(name => this.pad.getAttribute(name)), painted = new Float32Array(frame.position.length).fill(0.7);
    if (f >= 0) drop.paint(f, frame.values[f], painted);
    this.source.forEach((node, k) => { for (const c of XYZ) { point.array[3 * k + c] = frame.position[3 * node + c]; colour.array[3 * k + c] = painted[3 * node + c]; } });
    const line = this.lines.getAttribute("position");
    line.array.set(frame.position);
    point.needsUpdate = colour.needsUpdate = line.needsUpdate = true;
    this.pad.computeVertexNormals();
    this.group.traverse(o => { if (o.geometry === this.lines) o.visible = $("mesh").checked; });
    if (this.section) this.cutTetrahedra(frame, f);
    const place = [0, 1, 2, 3].map(i => frame.motion.slice(3 * i, 3 * i + 3)), axes = [1, 2, 3].map(i => XYZ.map(d => place[i][d] - place[0][d]));
    for (const own of this.missiles) {
      own.visible = $("missile").checked;
      own.matrix.set(axes[0][0], axes[1][0], axes[2][0], place[0][0], axes[0][1], axes[1][1], axes[2][1], place[0][1], axes[0][2], axes[1][2], axes[2][2], place[0][2], 0, 0, 0, 1);
      own.matrixWorldNeedsUpdate = true;
    }
    this.tellScale(f);
    this.onTime(frame.time);
    this.render();
  }

  /* The face of the cut through the cells at the missile's axis. */
  cutTetrahedra(frame, f) {
    const {position, values: fields} = frame, tetra = this.drop.tetrahedra, at = this.drop.axis[1], point = [], value = [];
    const put = (u, d) => {
      const w = (position[3 * u + 1] - at) / (position[3 * u + 1] - position[3 * d + 1]);
      for (const c of XYZ) point.push(position[3 * u + c] + w * (position[3 * d + c] - position[3 * u + c]));
      value.push(f < 0 ? 0 : fields[f][u] + w * (fields[f][d] - fields[f][u]));
    };
    for (let t = 0; t < tetra.length; t += 4) {
      const up = [], down = [];
      for (let k = t; k < t + 4; k++) (position[3 * tetra[k] + 1] > at ? up : down).push(tetra[k]);
      if (up.length === 1) down.forEach(d => put(up[0], d));
      else if (up.length === 3) up.forEach(u => put(u, down[0]));
      else if (up.length === 2) for (const [i, j] of [[0, 0], [0, 1], [1, 1], [0, 0], [1, 1], [1, 0]]) put(up[i], down[j]);
    }
    const colour = new Float32Array(point.length);
    if (f >= 0) this.drop.paint(f, value, colour);
    this.cutFace.setAttribute("position", new THREE.Float32BufferAttribute(point, 3));
    this.cutFace.setAttribute("color", new THREE.BufferAttribute(colour, 3));
    this.cutFace.computeBoundingSphere();
  }

  tellScale(f) {
    if (f < 0) { this.$("legend").hidden = true; return; }
    const field = this.drop.scale(f), short = x => String(Number(x.toPrecision(3))), c = this.drop.colours, stops = [];
    for (let k = 0; k < 8; k++) stops.push(`rgb(${c.slice(3 * k, 3 * k + 3).join(" ")})`);
    this.$("bar").style.background = `linear-gradient(90deg, ${stops.join(", ")})`;
    this.$("least").textContent = `${field.name}: ${short(field.low)}`;
    this.$("most").textContent = `${short(field.high)} ${field.unit}${field.logarithmic ? " (log)" : ""}`;
  }

  showTime(time) {
    if (!this.drop) return;
    this.play(false);
    const far = this.drop.frames.map(f => Math.abs(f.time - time));
    this.show(far.indexOf(Math.min(...far)));
  }

  /* ---- the camera ---- */

  directions() {
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    return [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]].map(v => new THREE.Vector3(...v));
  }

  /* Frames the pad and as much of the missile as is as high again. */
  fit() {
    Object.assign(this, {azimuth: -1.15, elevation: 0.3, zoom: 1, pan: [0, 0]});
    this.render();
  }

  render() {
    const {clientWidth: w, clientHeight: h} = this.place;
    if (!this.drop || !w || !h) return;
    const {min, max} = this.box, size = max.clone().sub(min), [right, up, back] = this.directions(), top = Math.min(this.top, max.z + 0.32 * Math.hypot(size.x, size.y)), points = [];
    for (const x of [min.x, max.x]) for (const y of [this.$("cut").checked ? Math.max(min.y, this.section ? this.drop.axis[1] : min.y) : min.y, max.y]) for (const z of [min.z, max.z]) points.push(new THREE.Vector3(x, y, z));
    points.push(new THREE.Vector3((min.x + max.x) / 2, this.drop.axis[1], top));
    const across = points.map(p => p.dot(right)), along = points.map(p => p.dot(up)), middle = list => (Math.min(...list) + Math.max(...list)) / 2, span = list => Math.max(...list) - Math.min(...list);
    this.unit = Math.max(span(across) / w, span(along) / (h - 40)) * 1.06 / this.zoom; // m per pixel
    const target = right.clone().multiplyScalar(middle(across) - this.pan[0]).add(up.clone().multiplyScalar(middle(along) + 18 * this.unit - this.pan[1])), reach = 4 * size.length();
    target.add(back.clone().multiplyScalar(min.clone().add(max).multiplyScalar(0.5).dot(back)));
    Object.assign(this.camera, {left: -w / 2 * this.unit, right: w / 2 * this.unit, top: h / 2 * this.unit, bottom: -h / 2 * this.unit, near: 0, far: 2 * reach});
    this.camera.position.copy(target).add(back.clone().multiplyScalar(reach));
    this.camera.lookAt(target);
    this.camera.updateProjectionMatrix();
    this.sun.position.copy(back).add(up.clone().multiplyScalar(1.2)).add(right.clone().multiplyScalar(-0.7));
    this.renderer.setSize(w, h);
    this.renderer.render(this.scene, this.camera);
    const length = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000].find(mm => mm * 1e-3 / this.unit > 60) ?? 5000, bar = this.$("scale");
    bar.firstElementChild.style.width = `${length * 1e-3 / this.unit}px`;
    bar.lastElementChild.textContent = `${length} mm`;
  }

  /* ---- what the user does ---- */

  play(on) {
    clearInterval(this.timer);
    this.timer = on ? setInterval(() => this.show((this.k + 1) % this.drop.frames.length), 130 / Number(this.$("pace").value)) : 0;
    this.$("play").textContent = on ? "Pause" : "Play";
  }

  /* Takes a key; returns whether it has a meaning. */
  key(key) {
    if (!this.drop) return false;
    const last = this.drop.frames.length - 1, go = {ArrowRight: Math.min(last, this.k + 1), ArrowLeft: Math.max(0, this.k - 1), Home: 0, End: last}[key];
    if (key === " ") this.play(!this.timer);
    else if (go !== undefined) { this.play(false); this.show(go); }
    else if (key === "+" || key === "-") { this.zoom *= key === "+" ? 1.2 : 1 / 1.2; this.render(); }
    else return false;
    return true;
  }

  listen() {
    const {$} = this, down = new Map(), canvas = this.renderer.domElement;
    $("time").addEventListener("input", () => { this.play(false); this.show(Number($("time").value)); });
    $("play").addEventListener("click", () => this.play(!this.timer));
    $("pace").addEventListener("change", () => this.timer && this.play(true));
    for (const id of ["field", "mesh", "missile"]) $(id).addEventListener("change", () => this.show(this.k));
    $("cut").addEventListener("change", () => { this.build(); this.show(this.k); });
    $("reset").addEventListener("click", () => this.fit());
    const turn = (dx, dy) => { this.azimuth -= 0.008 * dx; this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + 0.008 * dy)); };
    const move = (dx, dy) => { this.pan[0] += dx * this.unit; this.pan[1] -= dy * this.unit; };
    canvas.addEventListener("pointerdown", e => { canvas.setPointerCapture(e.pointerId); down.set(e.pointerId, [e.offsetX, e.offsetY]); });
    canvas.addEventListener("pointermove", e => {
      const old = down.get(e.pointerId), now = [e.offsetX, e.offsetY], other = [...down].find(([id]) => id !== e.pointerId)?.[1];
      if (!old) return;
      const [dx, dy] = [now[0] - old[0], now[1] - old[1]], far = p => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      if (other) { this.zoom *= far(now) / far(old); move(dx / 2, dy / 2); }
      else (e.buttons !== 1 || e.shiftKey ? move : turn)(dx, dy);
      down.set(e.pointerId, now);
      this.render();
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, e => down.delete(e.pointerId));
    canvas.addEventListener("contextmenu", e => e.preventDefault());
    canvas.addEventListener("wheel", e => { e.preventDefault(); this.zoom = Math.max(0.2, Math.min(40, this.zoom * Math.exp(-0.001 * e.deltaY))); this.render(); }, {passive: false});
  }
}
