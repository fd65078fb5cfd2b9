// SPDX-License-Identifier: GPL-3.0-or-later
// The workbench: what the page knows, what it asks the server, and what follows.
import {Chart} from "./chart.js";
import {Form, Sliders, element} from "./form.js";

const $ = id => document.getElementById(id);
const COLOURS = ["#08519c", "#2e7d32", "#6a3d9a", "#8c510a", "#c51b7d", "#01665e"], LIVE = "#d94801", MEASURED = ["#1b2430", "#757575"];
const GRADES = {"valid": "good", "valid with remarks": "fair", "do not use": "bad"};
const state = {name: "", path: "", changed: 0, job: null, runs: [], drops: new Map(), beside: new Set(), current: null, live: null, measured: [], answered: true, isLive: true};
let viewer = null;

/* ---- the server ---- */

class Refused extends Error {}

async function ask(word, request = {}, body = JSON.stringify(request)) {
  const answer = await fetch(`api/${word}`, {method: "POST", body});
  const told = await answer.json();
  if (answer.status === 403) banner("This page belongs to a server that has ended. Open the address that softfall open has printed; your values are kept in this tab.", true);
  if (!answer.ok) throw new Refused(told.error);
  return told;
}

function banner(text, isBad = false) {
  $("banner").hidden = !text;
  $("banner").className = isBad ? "bad" : "";
  if ($("banner").textContent !== text) $("banner").textContent = text;
}

/* Does what may fail; a sentence of the server goes to the banner, a server that is gone is told by poll(). */
async function attempt(work) {
  try {
    return await work();
  } catch (error) {
    if (error instanceof Refused) banner(error.message, true);
    else if (!(error instanceof TypeError)) throw error;
    return null;
  }
}

async function poll() {
  let wait = 1500;
  try {
    const told = await ask("state");
    if (!state.answered) banner("");
    state.answered = true;
    if (told.changed !== state.changed) await loadCase(told.changed);
    await takeState(told);
    if (["running", "stopping"].includes(told.job?.state)) wait = 300;
  } catch (error) {
    if (!(error instanceof Refused)) {
      state.answered = false;
      banner("The server does not answer. Start softfall open again in the same folder: this page goes on by itself.", true);
    }
  }
  setTimeout(poll, document.hidden ? 3 * wait : wait);
}

/* ---- the case ---- */

async function loadCase(changed) {
  const told = await ask("case");
  if (state.changed) {
    banner("The case or a file of it has changed: its values are taken over, your own stay.");
    for (const drop of state.drops.values()) drop.values = undefined; // they are drops of the case as it was
    state.before = state.job?.number;
  }
  Object.assign(state, {changed, name: told.name, path: told.path});
  $("title").textContent = document.title = `${told.name} – softfall`;
  $("path").textContent = told.path;
  $("version").textContent = `softfall ${told.version}`;
  form.edits = JSON.parse(sessionStorage.getItem(`edits ${told.path}`) ?? "{}");
  form.show(told.fields);
  sliders.show(told.sliders);
  await check();
  wanted.isQuiet = true;
  moved(false);
  moved(true);
}

const form = new Form($("fields"), () => edited());
let checking = 0, waits = 0;

/* After an edit by hand: the values are judged when the typing pauses, and answered live if they are right. */
function edited() {
  keepEdits();
  clearTimeout(waits);
  waits = setTimeout(async () => { if (await check()) moved(true); }, 250);
}

/* Keeps the edits of this tab, and lets go of quiet requests. */
const keepEdits = () => { sessionStorage.setItem(`edits ${state.path}`, JSON.stringify(form.edits)); wanted.isQuiet = false; wanted.meshes = []; tellAnswer(); };

/* Returns whether all values are right. */
async function check() {
  const number = ++checking;
  const told = await attempt(() => ask("check", {values: form.edits}));
  if (number !== checking) return undefined; // a later one has taken its place
  if (!told) return false;
  form.markWrong(told.wrong);
  const isRight = Object.keys(told.wrong).length === 0;
  if (isRight) sliders.put(told.sliders);
  tellRun();
  tellAnswer();
  if (isRight && told.found && !["running", "stopping"].includes(state.job?.state)) await choose(told.found, {...form.edits});
  return isRight;
}

/* ---- live answers ---- */

const sliders = new Sliders($("sliders"), (key, text, rests) => {
  form.set(key, text);
  keepEdits();
  moved(rests);
  if (rests) check();
});
const wanted = {meshes: [], isBusy: false, isQuiet: false};

/* Asks for the drop of the values on the screen: one request at a time, the newest next. */
async function moved(rests) {
  if (wanted.isQuiet) wanted.meshes.push(rests ? "fine" : "coarse"); // both models are made before they are needed
  else wanted.meshes = [rests ? "fine" : "coarse"];
  if (wanted.isBusy || !state.isLive) return;
  wanted.isBusy = true;
  while (wanted.meshes.length) {
    const mesh = wanted.meshes.shift(), values = {...form.edits}, began = performance.now(), isQuiet = wanted.isQuiet;
    let live = null, note = "";
    try {
      live = {...await ask("live", {values, mesh}), values};
      note = `Answered in ${((performance.now() - began) / 1000).toFixed(2)} s${live.built ? ", its mesh included," : ""} by the axisymmetric section${live.spacing_mm ? ` with nodes ${live.spacing_mm} mm apart` : ""}; Run computes the case itself.`;
    } catch (error) {
      if (!(error instanceof Refused)) break;
      note = `No live answers: ${error.message}`;
    }
    $("live").hidden = false;
    $("live-note").textContent = note;
    $("sliders").hidden = !live && isQuiet;
    if (isQuiet && !live) state.isLive = Object.keys(form.edits).length > 0;
    if (!isQuiet || !state.current) state.live = isKnown(values) ? null : live;
    if (!wanted.meshes.length) wanted.isQuiet = false;
    tellAnswer();
    tellCurves();
  }
  wanted.isBusy = false;
}

/* True if the drop that is shown is that of the values: then it answers. */
const isKnown = values => JSON.stringify(state.drops.get(state.current)?.values) === JSON.stringify(values);

/* ---- drops ---- */

async function takeState({job, runs}) {
  const before = state.job, isNew = JSON.stringify(runs) !== JSON.stringify(state.runs);
  Object.assign(state, {job, runs});
  tellRun();
  if (before?.state !== job?.state || before?.number !== job?.number || before?.points.length !== job?.points.length) tellCurves();
  const hasEnded = job && !["running", "stopping"].includes(job.state) && (before?.state !== job.state || before?.number !== job.number);
  if (hasEnded && job.id) await choose(job.id);
  if (hasEnded && !job.error) banner(job.warnings.join(" "));
  if (hasEnded && job.error) { banner(job.error, true); markFromSentence(job.error); }
  if (isNew || hasEnded) tellTable();
}

/* Marks the field whose key a sentence of a program names. */
function markFromSentence(sentence) {
  const key = [...form.fields.keys()].filter(name => sentence.includes(name)).sort((a, b) => b.length - a.length)[0];
  if (key) form.markWrong({...form.wrong, [key]: sentence});
}

async function fetchDrop(id) {
  if (!state.drops.has(id)) {
    const told = await attempt(() => ask("drop", {id}));
    if (!told) return null;
    state.drops.set(id, told);
  }
  return state.drops.get(id);
}

/* Shows a drop: its figures at the top, its curve first, its frames in 3-D. */
async function choose(id, values) {
  const run = state.runs.find(r => r.id === id);
  if (run && state.drops.has(id) && state.drops.get(id).when !== run.when) state.drops.delete(id);
  const drop = await fetchDrop(id);
  if (!drop) return;
  Object.assign(drop, {when: run?.when, values: values ?? (state.job?.id === id && state.job.number !== state.before ? state.job.values : drop.values)});
  Object.assign(state, {current: id, live: null});
  state.beside.delete(id);
  tellAnswer();
  tellCurves();
  tellTable();
  if (drop.view) await attempt(() => showScene(id));
}

async function showScene(id) {
  const answer = await fetch(`scene/${id}`);
  if (!answer.ok || state.current !== id) return;
  const frames = await answer.json();
  const {Viewer} = await import("./scene.js");
  try {
    viewer ??= new Viewer($, time => chart.setTime(1e3 * time));
  } catch {
    $("empty").textContent = "This browser shows no WebGL 2, which the picture needs; the report has pictures.";
    return;
  }
  $("empty").hidden = true;
  viewer.load(frames);
  viewer.id = id;
  tellTable();
}

/* ---- what is shown ---- */

const chart = new Chart($("chart"), $("key"), time => viewer?.showTime(time / 1e3));
const shown = (x, digits = 4) => x === null || x === undefined ? "–" : String(Number(x.toPrecision(digits)));

function tellAnswer() {
  const drop = state.drops.get(state.current), live = state.live, verdict = $("verdict");
  const figures = live?.figures ?? drop?.figures ?? {};
  verdict.textContent = live ? "live answer" : drop?.grade ?? "no drop yet";
  verdict.className = live ? "live" : GRADES[drop?.grade] ?? "";
  verdict.title = live ? "not judged: Run gives a verdict" : drop?.remarks.join("\n") ?? "";
  for (const [id, key] of [["a_max", "a_max_g"], ["hic", "hic"]]) {
    const limit = live ? null : drop?.limits.find(l => l.key === key);
    $(id).textContent = shown(figures[key]);
    $(id).parentElement.classList.toggle("above", limit?.passed === false);
    $(id).parentElement.title = limit ? `${limit.passed ? "below" : "above"} the limit of ${limit.bound}` : "";
  }
  const stress = drop?.figures.peak_stress_kPa;
  const other = !live && drop && !isKnown(form.edits) ? "; the form has other values" : "";
  const wrong = Object.keys(form.wrong).length;
  $("origin").textContent = wrong ? `${wrong} value${wrong > 1 ? "s are" : " is"} wrong: see the red field${wrong > 1 ? "s" : ""}` : live ? `${live.spacing_mm ? `${live.spacing_mm} mm section` : "section"}, not judged` : drop ? `${drop.id}${stress ? `, peak stress ${shown(stress)} kPa` : ""}${other}` : "";
  $("remarks").hidden = !!live || !drop?.remarks.length;
  $("remarks").textContent = $("remarks").hidden ? "" : drop.remarks.slice(0, 3).join("; ") + (drop.remarks.length > 3 ? `; and ${drop.remarks.length - 3} more in the report` : "");
  $("report").hidden = !drop || !!live;
  if (drop) $("report").href = `runs/${drop.id}/report.html`;
}

function tellRun() {
  const job = state.job, isBusy = ["running", "stopping"].includes(job?.state);
  $("work").hidden = !isBusy;
  $("stop").hidden = !isBusy;
  $("stop").disabled = job?.state === "stopping";
  $("run").disabled = isBusy || Object.keys(form.wrong).length > 0;
  $("run").textContent = job?.state === "stopped" ? "Go on" : "Run";
  if (!isBusy) return;
  $("progress").value = job.share;
  const left = job.left === null ? "" : `, about ${job.left < 90 ? `${Math.ceil(job.left)} s` : `${Math.ceil(job.left / 60)} min`} left`;
  const text = job.state === "stopping" ? "stopping after this step" : `${job.what} (${Math.round(100 * job.share)} %${left})`;
  if ($("what").textContent !== text) $("what").textContent = text;
}

const windowOf = figures => [figures.hic_t1_ms, figures.hic_t2_ms];
const describe = run => run.prescribed_motion ? `prescribed motion, ${shown(run.thickness_mm, 4)} mm, peak stress ${shown(run.peak_stress_kPa)} kPa` : `${shown(run.v0_m_s, 3)} m/s, ${shown(run.missile_mass_kg, 3)} kg, ${shown(run.thickness_mm, 4)} mm`;

function curvesShown() {
  const out = [], {live, job, current, drops} = state;
  if (["running", "stopping"].includes(job?.state)) out.push({label: "at work (not filtered)", colour: COLOURS[0], t: job.points.map(p => p[0]), g: job.points.map(p => p[1])});
  if (live) out.push({label: "live answer", colour: LIVE, ...live.curve, window: windowOf(live.figures)});
  const list = [current, ...state.beside].filter(id => id && drops.has(id));
  list.forEach((id, k) => {
    const drop = drops.get(id), run = state.runs.find(r => r.id === id);
    out.push({id, label: run ? describe(run) : id, colour: COLOURS[k % COLOURS.length], ...drop.curve, thin: k > 0 || !!live, window: k === 0 ? windowOf(drop.figures) : undefined});
  });
  state.measured.forEach((m, k) => alignMeasured(m) ?? out.push({label: `measured: ${m.name}`, colour: MEASURED[k % 2], dashed: true, ...m.shifted}));
  return out;
}

function tellCurves() {
  const curves = curvesShown(), drop = state.drops.get(state.current), figures = state.live?.figures ?? drop?.figures;
  chart.show(curves);
  $("chart-title").textContent = figures?.a_max_g ? `Deceleration over time: a_max ${shown(figures.a_max_g)} g, HIC ${shown(figures.hic)}; ${curves.length} curve${curves.length > 1 ? "s" : ""}` : drop?.figures.prescribed_motion ? "A prescribed motion has no deceleration: its curve of stress over strain stands in the report" : "Deceleration over time";
}

function tellTable() {
  const inView = state.runs.find(run => run.id === viewer?.id);
  $("which").textContent = inView ? describe(inView) : viewer?.id ?? "";
  const rows = state.runs.map(run => {
    const isCurrent = run.id === state.current, box = element("input", {type: "checkbox", checked: isCurrent || state.beside.has(run.id), disabled: isCurrent, ariaLabel: `curve of ${describe(run)}`});
    box.addEventListener("change", async () => {
      state.beside[box.checked ? "add" : "delete"](run.id);
      await fetchDrop(run.id);
      tellCurves();
    });
    const open = element("button", {type: "button", textContent: isCurrent ? "shown" : "Show", disabled: isCurrent, ariaLabel: `show ${describe(run)}`});
    open.addEventListener("click", () => choose(run.id));
    const cell = (...what) => element("td", {}, ...what);
    return element("tr", {className: isCurrent ? "current" : "", title: run.id}, cell(box), cell(describe(run)), cell(element("span", {className: GRADES[run.grade], textContent: run.grade})), cell(shown(run.a_max_g)), cell(shown(run.hic)), cell(open));
  });
  const measured = state.measured.map((m, k) => {
    const gone = element("button", {type: "button", textContent: "Remove", ariaLabel: `remove ${m.name}`}), cell = (...what) => element("td", {}, ...what);
    gone.addEventListener("click", () => { state.measured.splice(k, 1); tellCurves(); tellTable(); });
    return element("tr", {title: m.interpretation}, cell("measured"), cell(m.name), cell(element("span", {className: GRADES[m.verdict], textContent: m.verdict})), cell(shown(m.figures.a_max_g)), cell(shown(m.figures.hic)), cell(gone));
  });
  $("runs").tBodies[0].replaceChildren(...measured, ...rows);
}

/* ---- measured files ---- */

/* Puts the peak of a measured curve at the time of the peak that is shown: the clock of a file begins anywhere. */
function alignMeasured(m) {
  const shownCurve = state.live?.curve ?? state.drops.get(state.current)?.curve;
  const peak = c => c.t[c.g.indexOf(Math.max(...c.g))], shift = shownCurve?.t.length ? peak(shownCurve) - peak(m.curve) : -m.curve.t[0];
  m.shifted = {t: m.curve.t.map(t => t + shift), g: m.curve.g};
}

async function measure(files) {
  for (const file of files) {
    $("measured-note").textContent = `reading ${file.name} …`;
    try {
      const told = await ask(`measured?name=${encodeURIComponent(file.name)}`, {}, file);
      state.measured.unshift(told);
      $("measured-note").textContent = `${file.name}: ${told.verdict}${told.remarks.length ? ` (${told.remarks.join("; ")})` : ""}. ${told.interpretation}. The peaks are put at one time.`;
    } catch (error) {
      if (!(error instanceof Refused)) return;
      $("measured-note").textContent = error.message;
    }
    tellCurves();
    tellTable();
  }
}

/* ---- what the user does ---- */

async function run() {
  clearTimeout(waits);
  if (await check() === false) { form.markWrong(form.wrong)?.focus(); return; }
  banner("");
  if (await attempt(() => ask("run", {values: form.edits}))) { state.live = null; tellAnswer(); await attempt(async () => takeState(await ask("state"))); }
}

$("run").addEventListener("click", run);
$("stop").addEventListener("click", () => attempt(async () => { await ask("stop"); await takeState(await ask("state")); }));
$("find").addEventListener("input", () => form.filter($("find").value));
$("form").addEventListener("submit", e => { e.preventDefault(); run(); });
$("saving").addEventListener("submit", async e => {
  e.preventDefault();
  $("saved").textContent = "saving …";
  try {
    $("saved").textContent = `Saved: ${(await ask("save", {folder: $("folder").value, values: form.edits})).folder}`;
  } catch (error) {
    $("saved").textContent = error instanceof Refused ? error.message : "The server does not answer.";
  }
});
$("measure").addEventListener("click", () => $("file").click());
$("file").addEventListener("change", async () => { await measure([...$("file").files]); $("file").value = ""; });
for (const name of ["dragenter", "dragover"]) addEventListener(name, e => { if (e.dataTransfer?.types.includes("Files")) { e.preventDefault(); document.body.classList.add("over"); } });
for (const name of ["dragleave", "drop"]) addEventListener(name, e => { if (name === "drop" || !e.relatedTarget) document.body.classList.remove("over"); });
addEventListener("drop", e => { if (e.dataTransfer?.files.length) { e.preventDefault(); measure([...e.dataTransfer.files]); } });
addEventListener("keydown", e => {
  if (e.ctrlKey && e.key === "Enter") { e.preventDefault(); if (!$("run").disabled) run(); }
  const isFree = !e.target.closest("input, select, button, a, summary, textarea") && !e.ctrlKey && !e.altKey && !e.metaKey;
  if (isFree && viewer?.key(e.key)) e.preventDefault();
});
poll();
