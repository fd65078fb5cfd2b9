// SPDX-License-Identifier: GPL-3.0-or-later
// The fields of the case, by groups, and the sliders. Values are texts; the server judges them.

const FIRST = ["missile.velocity", "missile.mass", "geometry.parameters.thickness", "geometry.parameters.side", "geometry.parameters.fine_spacing", "geometry.missile_parameters.diameter",
  "geometry.model", "material.curve", "pad.stress_factor", "solver.end_time"];
const GROUPS = {"geometry.parameters": "geometry of the pad", "geometry.missile_parameters": "geometry of the missile", "support.parameters": "geometry of the support"};

export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

const spoken = name => name.replaceAll("_", " ");

export class Form {
  /* `onEdit` is called after a value was changed by hand. */
  constructor(place, onEdit) { Object.assign(this, {place, onEdit, fields: new Map(), edits: {}, wrong: {}}); }

  /* Shows the fields of the server's answer; edits that are there stay. */
  show(fields) {
    const open = new Set([...this.place.querySelectorAll("details[open]")].map(d => d.dataset.group));
    this.fields = new Map(fields.map(field => [field.key, field]));
    this.edits = Object.fromEntries(Object.entries(this.edits).filter(([key, text]) => this.fields.has(key) && this.fields.get(key).value !== text));
    const first = FIRST.filter(key => this.fields.has(key)), groups = Map.groupBy ? Map.groupBy(fields, f => f.group) : fields.reduce((m, f) => m.set(f.group, [...(m.get(f.group) ?? []), f]), new Map());
    this.place.replaceChildren(...first.map(key => this.row(this.fields.get(key), true)));
    for (const [group, list] of groups) {
      const rest = list.filter(field => !first.includes(field.key));
      if (!rest.length) continue;
      const summary = element("summary", {}, GROUPS[group] ?? group, element("span", {className: "note", textContent: `  ${rest.length} value${rest.length > 1 ? "s" : ""}`}));
      const details = element("details", {open: open.has(group)}, summary, ...rest.map(field => this.row(field)));
      details.dataset.group = group;
      this.place.append(details);
    }
    this.markWrong(this.wrong);
  }

  row(field, isFirst = false) {
    const id = `field-${field.key}`, text = this.edits[field.key] ?? field.value;
    const choices = field.choices.includes(text) || !text ? field.choices : [...field.choices, text];
    const input = field.choices.length ? element("select", {id}, ...(text ? [] : [new Option("–", "")]), ...choices.map(word => new Option(word, word, false, word === text)))
      : element("input", {id, value: text, type: "text", spellcheck: false, placeholder: field.fallback === "absent" || field.fallback === "required" ? field.fallback : ""});
    input.dataset.key = field.key;
    input.setAttribute("aria-describedby", `${id}-help`);
    input.addEventListener(field.choices.length ? "change" : "input", () => this.take(field.key, input.value));
    const label = element("label", {htmlFor: id, textContent: isFirst && !/[A-Z[]/.test(field.name) ? `${spoken(field.name)} (${field.group.split(".").at(-1)})` : spoken(field.name), title: field.key});
    const help = [field.kind, field.help].filter(Boolean).join("; ");
    const row = element("div", {className: "field"}, label, input, element("p", {id: `${id}-help`, className: "note", textContent: help}), element("p", {id: `${id}-wrong`, className: "wrong", hidden: true}));
    row.dataset.words = `${field.key} ${field.name} ${help}`.toLowerCase();
    row.classList.toggle("changed", field.key in this.edits);
    return row;
  }

  input(key) { return document.getElementById(`field-${key}`); }

  /* Takes a value by hand; that of the case itself is no edit. */
  take(key, text) {
    this.remember(key, text);
    this.onEdit(key);
  }

  remember(key, text) {
    if (text === this.fields.get(key)?.value) delete this.edits[key];
    else this.edits[key] = text;
    this.input(key)?.closest(".field").classList.toggle("changed", key in this.edits);
  }

  /* Gives a field a value that was not typed into it. */
  set(key, text) {
    this.remember(key, text);
    const input = this.input(key);
    if (input && document.activeElement !== input) input.value = text;
  }

  /* Marks all wrong values beside their fields; returns the first field that is marked. */
  markWrong(wrong) {
    let first = null;
    this.wrong = wrong;
    for (const input of this.place.querySelectorAll("[data-key]")) {
      const text = wrong[input.dataset.key], note = document.getElementById(`${input.id}-wrong`);
      note.hidden = !text;
      note.textContent = text ?? "";
      if (text) { input.setAttribute("aria-invalid", "true"); input.closest("details")?.setAttribute("open", ""); first ??= input; }
      else input.removeAttribute("aria-invalid");
      input.setAttribute("aria-describedby", text ? `${input.id}-wrong ${input.id}-help` : `${input.id}-help`);
    }
    return first;
  }

  /* Shows the fields whose key, name or help has the words. */
  filter(text) {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const row of this.place.querySelectorAll(".field")) row.hidden = !words.every(word => row.dataset.words.includes(word));
    for (const details of this.place.querySelectorAll("details")) {
      const some = [...details.querySelectorAll(".field")].some(row => !row.hidden);
      details.hidden = !some;
      if (words.length) details.open = some;
    }
  }
}

/* A number with about four digits, as it stands in a field. */
export const rounded = x => String(Number(x.toPrecision(4)));

export class Sliders {
  /* `onMove(key, text, rests)` is called while a slider moves, and when it rests. */
  constructor(place, onMove) { Object.assign(this, {place, onMove, list: []}); }

  show(list) {
    this.list = list;
    this.place.replaceChildren(...list.map(slider => {
      const id = `slider-${slider.key}`, step = (slider.high - slider.low) / 400;
      const input = element("input", {id, type: "range", min: slider.low, max: slider.high, step: "any", value: slider.value});
      input.dataset.key = slider.key;
      const told = element("output", {htmlFor: id});
      const tell = () => { told.textContent = `${rounded(Number(input.value))} ${slider.unit}`; input.setAttribute("aria-valuetext", told.textContent); };
      const text = () => rounded(Number(input.value)) + slider.suffix;
      input.addEventListener("input", () => { tell(); this.onMove(slider.key, text(), false); });
      input.addEventListener("change", () => { tell(); this.onMove(slider.key, text(), true); });
      input.addEventListener("keydown", e => {
        const steps = {ArrowRight: 4, ArrowUp: 4, ArrowLeft: -4, ArrowDown: -4, PageUp: 40, PageDown: -40}[e.key];
        if (!steps) return;
        e.preventDefault();
        input.value = Math.min(slider.high, Math.max(slider.low, Number(input.value) + steps * step));
        tell();
        this.onMove(slider.key, text(), true);
      });
      Object.assign(slider, {input, tell});
      tell();
      return element("div", {className: "slider"}, element("label", {htmlFor: id, textContent: slider.name}), told, input);
    }));
  }

  /* Puts sliders to the values of the form; one beyond its ends gets new ones. */
  put(values) {
    for (const slider of this.list) {
      const value = values[slider.key];
      if (value === undefined || document.activeElement === slider.input) continue;
      if (value < slider.low || value > slider.high) Object.assign(slider.input, {min: 0.7 * value, max: 1.4 * value});
      slider.input.value = value;
      slider.tell();
    }
  }
}
