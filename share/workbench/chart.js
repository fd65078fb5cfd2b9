// SPDX-License-Identifier: GPL-3.0-or-later
// Deceleration over time as an SVG picture: curves with time in ms and deceleration in g.

const EDGE = {left: 48, right: 12, top: 10, bottom: 34};
const SVG = "http://www.w3.org/2000/svg";

function put(parent, name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return parent.appendChild(made);
}

/* Returns round numbers within a range. */
function ticks(low, high, most) {
  const raw = (high - low) / most || 1, power = 10 ** Math.floor(Math.log10(raw)), step = power * [1, 2, 5, 10].find(k => k * power >= 0.999 * raw), out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) out.push(Number((k * step).toPrecision(6)));
  return out;
}

/* Height of a curve at a time; undefined beyond its ends. */
export function heightAt(curve, time) {
  const k = curve.t.findIndex(t => t >= time);
  if (k < 0 || (k === 0 && curve.t[0] > time)) return undefined;
  if (k === 0) return curve.g[0];
  const part = (time - curve.t[k - 1]) / (curve.t[k] - curve.t[k - 1] || 1);
  return curve.g[k - 1] + part * (curve.g[k] - curve.g[k - 1]);
}

export class Chart {
  /* `onTime` is called with the time of a click. */
  constructor(svg, key, onTime) {
    Object.assign(this, {svg, key, curves: [], now: undefined, at: undefined});
    svg.addEventListener("pointermove", e => { this.at = this.timeOf(e); if (e.buttons) onTime(this.at); this.mark(); });
    svg.addEventListener("pointerleave", () => { this.at = undefined; this.mark(); });
    svg.addEventListener("pointerdown", e => onTime(this.timeOf(e)));
    new ResizeObserver(() => this.draw()).observe(svg);
  }

  timeOf(event) {
    const box = this.svg.getBoundingClientRect();
    return this.range[0] + (event.clientX - box.x - EDGE.left) / (box.width - EDGE.left - EDGE.right) * (this.range[1] - this.range[0]);
  }

  /* Curves of {label, colour, t, g, dashed, window}; `window`: [t1, t2] of HIC, of one of them. */
  show(curves) {
    this.curves = curves.filter(curve => curve.t.length > 1);
    this.draw();
    this.key.replaceChildren(...this.curves.map(curve => {
      const line = document.createElement("i"), item = document.createElement("li");
      line.style.borderColor = curve.colour;
      line.className = curve.dashed ? "dashed" : "";
      item.append(line, curve.label);
      return item;
    }));
  }

  /* Marks the time of the frame that is shown. */
  setTime(time) { this.now = time; this.mark(); }

  draw() {
    const [w, h] = [this.svg.clientWidth, this.svg.clientHeight], all = this.curves;
    this.svg.replaceChildren();
    if (!w || !h) return;
    this.svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
    const high = Math.max(10, ...all.map(c => Math.max(...c.g))), low = Math.min(0, ...all.map(c => Math.min(...c.g)));
    this.range = [Math.min(0, ...all.map(c => c.t[0])), Math.max(10, ...all.map(c => c.t.at(-1))), low < -0.03 * high ? low : 0, 1.06 * high];
    const [t0, t1, y0, y1] = this.range, x = t => EDGE.left + (t - t0) / (t1 - t0) * (w - EDGE.left - EDGE.right), y = g => h - EDGE.bottom - (g - y0) / (y1 - y0) * (h - EDGE.top - EDGE.bottom);
    Object.assign(this, {x, y});
    for (const g of ticks(y0, y1, 6)) {
      put(this.svg, "line", {x1: EDGE.left, x2: w - EDGE.right, y1: y(g), y2: y(g), stroke: "#e3e8ee"});
      put(this.svg, "text", {x: EDGE.left - 6, y: y(g) + 4, "text-anchor": "end"}, g);
    }
    for (const t of ticks(t0, t1, w < 500 ? 5 : 9)) put(this.svg, "text", {x: x(t), y: h - EDGE.bottom + 16, "text-anchor": "middle"}, t);
    put(this.svg, "text", {x: (EDGE.left + w - EDGE.right) / 2, y: h - 3, "text-anchor": "middle"}, "time (ms)");
    put(this.svg, "text", {x: 12, y: h / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${h / 2})`}, "deceleration (g)");
    const windowed = all.find(c => c.window?.every(Number.isFinite));
    if (windowed) put(this.svg, "rect", {x: x(windowed.window[0]), y: EDGE.top, width: Math.max(0, x(windowed.window[1]) - x(windowed.window[0])), height: h - EDGE.top - EDGE.bottom, fill: windowed.colour, opacity: 0.08});
    for (const c of [...all].reverse())
      put(this.svg, "polyline", {points: c.t.map((t, k) => `${x(t).toFixed(1)},${y(c.g[k]).toFixed(1)}`).join(" "), fill: "none", stroke: c.colour, "stroke-width": c.thin ? 1.5 : 2.5,
        "stroke-linejoin": "round", ...(c.dashed ? {"stroke-dasharray": "7 4"} : {})});
    put(this.svg, "path", {d: `M${EDGE.left} ${EDGE.top}V${h - EDGE.bottom}H${w - EDGE.right}`, fill: "none", stroke: "#8797a8"});
    this.marks = put(this.svg, "g", {});
    this.mark();
  }

  /* The time of the frame, and the values under the pointer. */
  mark() {
    if (!this.marks?.isConnected) return;
    const h = this.svg.clientHeight, inside = t => t !== undefined && t >= this.range[0] && t <= this.range[1];
    this.marks.replaceChildren();
    if (inside(this.now)) put(this.marks, "line", {x1: this.x(this.now), x2: this.x(this.now), y1: EDGE.top, y2: h - EDGE.bottom, stroke: "#cb181d"});
    if (!inside(this.at)) return;
    const told = this.curves.slice(0, 5).map(c => [c, heightAt(c, this.at)]).filter(([, g]) => g !== undefined), right = this.at > (this.range[0] + this.range[1]) / 2;
    put(this.marks, "line", {x1: this.x(this.at), x2: this.x(this.at), y1: EDGE.top, y2: h - EDGE.bottom, stroke: "#8797a8", "stroke-dasharray": "3 3"});
    told.forEach(([c, g], k) => {
      put(this.marks, "circle", {cx: this.x(this.at), cy: this.y(g), r: 4, fill: c.colour});
      put(this.marks, "text", {x: this.x(this.at) + (right ? -8 : 8), y: EDGE.top + 28 + 15 * k, "text-anchor": right ? "end" : "start"}, `${g.toFixed(1)} g`).style.fill = c.colour;
    });
    put(this.marks, "text", {x: this.x(this.at) + (right ? -8 : 8), y: EDGE.top + 13, "text-anchor": right ? "end" : "start"}, `${this.at.toFixed(1)} ms`);
  }
}
