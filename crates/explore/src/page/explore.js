// The page of `asperity explore`: its state, its controls, and the pictures that the server draws.
import { clamp, interactive, make, placeOf, valueAt } from "./figures.js";

const $ = id => document.getElementById(id);
const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};
const tab = crypto.getRandomValues(new Uint32Array(4)).join("-");

// ---- State -------------------------------------------------------------------------------------
// changes: pointers and values, in the order of the changes; settings: those that are not left to the server.
let state = { changes: [], settings: {}, views: ["law", "frf", "levels"], pinned: null };
const past = [], future = [];
let described = null;

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
// A page within a frame, as of a notebook, has another way to its answers, and leaves the history to the page around it.
const inFrame = "asperityPost" in globalThis;
const clone = value => JSON.parse(JSON.stringify(value));
const isInside = (inner, outer) => inner === outer || inner.startsWith(`${outer}/`);

// The changes with another value at a pointer; without a value the scenario's own.
const changed = (changes, pointer, value) => {
  // An object that is replaced takes the changes inside it along.
  const at = changes.findIndex(([known]) => known === pointer);
  const kept = changes.filter(([known]) => !isInside(known, pointer));
  if (value === null) return kept;
  if (at < 0 || kept.length < changes.length - 1) return [...kept, [pointer, value]];
  return changes.map(one => one[0] === pointer ? [pointer, value] : one);
};

// The state as the fragment of the address, and back.
const written = ({ changes, settings, views, pinned }) => {
  const parts = new URLSearchParams();
  parts.set("view", views.join(","));
  for (const [key, value] of Object.entries(settings)) parts.set(key, JSON.stringify(value));
  for (const [pointer, value] of changes) parts.append("set", `${pointer}=${JSON.stringify(value)}`);
  if (pinned) parts.set("pin", JSON.stringify(pinned));
  return `#${parts.toString().replaceAll("%2F", "/").replaceAll("%2C", ",")}`;
};
const read = fragment => {
  const found = { changes: [], settings: {}, views: state.views, pinned: null };
  for (const [key, text] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    try {
      if (key === "view") found.views = text.split(",").filter(Boolean);
      else if (key === "set") {
        const at = text.indexOf("=");
        found.changes.push([text.slice(0, at), plain(text.slice(at + 1))]);
      } else if (key === "pin") found.pinned = JSON.parse(text);
      else found.settings[key] = JSON.parse(text);
    } catch {
      say(`${key} in the address is not understood`);
    }
  }
  return found;
};
// A value as `--set` takes it: JSON, or else text.
const plain = text => {
  try { return JSON.parse(text); } catch { return text; }
};

const say = text => {
  const status = $("status");
  status.textContent = text;
  status.classList.add("shown");
  clearTimeout(say.timer);
  say.timer = setTimeout(() => status.classList.remove("shown"), 2500);
};

// A new state; one that is `passing`, while a slider moves, is no step of undo.
let settled = null;
const go = (next, { passing = false, step = true } = {}) => {
  if (passing && settled === null) settled = clone(state);
  const before = settled ?? state;
  state = next;
  if (!passing) {
    settled = null;
    if (step && !same(before, state)) {
      past.push(clone(before));
      future.length = 0;
    }
    if (location.hash !== written(state)) history[inFrame ? "replaceState" : "pushState"](null, "", written(state));
  }
  tools();
  describe();
  update();
};
const change = (pointer, value, passing) =>
  go({ ...state, changes: changed(state.changes, pointer, value) }, { passing });
const set = (key, value) => {
  const settings = { ...state.settings };
  if (value === null) delete settings[key]; else settings[key] = value;
  go({ ...state, settings });
};
const back = (from, to) => {
  if (!from.length) return;
  to.push(clone(state));
  go(from.pop(), { step: false });
};

// ---- Server ------------------------------------------------------------------------------------
const post = globalThis.asperityPost ?? ((place, body, signal) => fetch(place, {
  method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" }, signal,
}));

// The lines of an answer, as they come.
async function* lines(response) {
  const decoder = new TextDecoder();
  const reader = response.body.getReader();
  let rest = "";
  for (;;) {
    const { done, value } = await reader.read();
    rest += done ? "" : decoder.decode(value, { stream: true });
    const all = rest.split("\n");
    rest = all.pop();
    for (const line of all) if (line) yield JSON.parse(line);
    if (done) return;
  }
}

// Asks for the controls of the state: the newest question alone is answered.
let describing = null, describeAgain = false;
async function describe() {
  if (describing) { describeAgain = true; return; }
  describing = post("state", { changes: state.changes, settings: state.settings });
  try {
    const response = await describing;
    const answer = await response.json();
    if (!response.ok) throw new Error(answer.error);
    described = answer;
    show();
  } catch (error) {
    say(`no answer: ${error.message}`);
  }
  describing = null;
  if (describeAgain) { describeAgain = false; describe(); }
}

// ---- Pictures ----------------------------------------------------------------------------------
// An answer older than this is not waited for when there is a newer state [ms].
const PATIENCE = 150;
const works = {};
const cards = new Map();

const update = () => { for (const part in works) works[part].update(); };

// The computation of one part: one at a time, the newest state last.
class Work {
  constructor(part) { Object.assign(this, { part, running: null, asked: null }); }
  get views() {
    return [...cards.values()].filter(card => card.part === this.part && !card.root.hidden)
      .map(card => ({ view: card.view, width: card.width }));
  }
  update() {
    const views = this.views;
    if (!views.length) { this.running?.stop.abort(); this.asked = null; return; }
    const request = { tab, part: this.part, views, changes: state.changes, pinned: state.pinned, settings: state.settings };
    if (same(request, this.asked)) return;
    this.asked = request;
    if (!this.running) this.start();
    else if (this.running.drawn || performance.now() - this.running.begun > PATIENCE) this.running.stop.abort();
  }
  async start() {
    const request = this.asked, stop = new AbortController();
    this.running = { stop, begun: performance.now() };
    const mine = [...cards.values()].filter(card => card.part === this.part);
    mine.forEach(card => card.wait());
    try {
      const response = await post("compute", request, stop.signal);
      if (!response.ok) throw new Error((await response.json()).error);
      for await (const line of lines(response)) {
        this.take(line, mine);
        // A newer state does not wait for what follows a draft.
        if (line.answer === "words" && this.running.drawn && !same(this.asked, request)) stop.abort();
      }
    } catch (error) {
      if (error.name !== "AbortError") mine.forEach(card => card.fail(`no answer: ${error.message}`));
    }
    this.running = null;
    if (this.asked && !same(this.asked, request)) this.start();
    else mine.forEach(card => card.ready());
  }
  take(line, mine) {
    switch (line.answer) {
      case "progress": mine.forEach(card => card.progress(line.done)); break;
      case "picture":
        cards.get(line.view)?.draw(line.svg, JSON.parse(line.data), line.draft);
        this.running.drawn = line.draft;
        break;
      case "absent": cards.get(line.view)?.fail(line.reason, false); break;
      case "words": words(this.part, line.text); break;
      case "faults": mine.forEach(card => card.ready()); break;
      case "error": mine.forEach(card => card.fail(line.text)); break;
      case "done": mine.forEach(card => card.took(line.seconds)); break;
    }
  }
}

class Card {
  constructor({ view, title, part }) {
    Object.assign(this, { view, part, panels: [], data: null });
    this.time = element("span", { className: "time" });
    this.settings = element("div", { className: "settings" });
    this.picture = element("div", { className: "picture" });
    this.frame = element("div", { className: "frame" }, this.picture);
    this.bar = element("progress", { max: 1, value: 0 });
    this.bar.setAttribute("aria-label", "Progress");
    this.reason = element("p", { className: "reason", hidden: true });
    const wide = element("button", { className: "small", type: "button", textContent: "⤢", title: "As wide as the page" });
    wide.setAttribute("aria-label", `${title}: as wide as the page`);
    wide.setAttribute("aria-pressed", "false");
    wide.addEventListener("click", () => {
      wide.setAttribute("aria-pressed", String(this.root.classList.toggle("wide")));
    });
    this.root = element("section", { className: "card", hidden: true },
      element("header", {}, element("h2", { textContent: title }), this.time, this.settings, wide), this.bar, this.frame, this.reason);
    this.root.setAttribute("aria-label", title);
    new ResizeObserver(() => { clearTimeout(Card.timer); Card.timer = setTimeout(update, 60); }).observe(this.frame);
    $("cards").append(this.root);
  }
  // In steps, so that a scroll bar that comes and goes asks for nothing.
  get width() { return 20 * Math.round(this.frame.clientWidth / 20); }
  wait() { this.root.classList.add("busy"); this.root.classList.remove("draft"); this.bar.value = 0; this.failed = false; }
  ready() { this.root.classList.remove("busy", "draft"); }
  progress(done) { this.bar.value = done; }
  took(seconds) { this.time.textContent = seconds < 1 ? `${Math.round(1e3 * seconds)} ms` : `${seconds.toFixed(1)} s`; }
  fail(text, isError = true) {
    this.reason.textContent = text;
    this.reason.classList.toggle("error", isError);
    this.reason.hidden = false;
    if (!isError) { this.picture.replaceChildren(); this.handles?.remove(); this.drawn = null; }
  }
  draw(svg, data, draft) {
    const drawn = document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
    const zoomed = this.panels.map(panel => panel.limits);
    this.picture.replaceChildren(drawn);
    this.panels = interactive(drawn, data, `figure-${this.view}`);
    zoomed.forEach((limits, index) => { if (this.panels[index]) this.panels[index].limits = limits; });
    this.reason.hidden = true;
    this.root.classList.toggle("busy", draft);
    this.root.classList.toggle("draft", draft);
    if (draft) this.time.textContent = "draft";
    this.drawn = [drawn, data];
    this.knots();
  }

  // Points of laws, to be dragged in the panel of the stiffness.
  knots() {
    if (this.view !== "law" || this.dragged || !this.drawn || this.frame.contains(document.activeElement)) return;
    const [drawn, data] = this.drawn;
    const [panel] = data.panels;
    this.handles?.remove();
    this.handles = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    this.handles.setAttribute("class", "handles");
    this.handles.setAttribute("role", "group");
    this.handles.setAttribute("aria-label", "Points of the laws");
    this.handles.setAttribute("viewBox", drawn.getAttribute("viewBox"));
    this.frame.append(this.handles);
    const [left, top, right, bottom] = panel.frame;
    const spans = [[panel.xAxis, left, right], [panel.yAxis, bottom, top]];
    const controls = (described?.groups ?? []).flatMap(group => group.controls);
    for (const { pointer, value, increasing } of controls.filter(one => one.control === "pairs" && one.pointer.startsWith("/laws/"))) {
      value.forEach((pair, index) => {
        const place = pair.map((number, k) => placeOf(spans[k][0], number * spans[k][0].factor, spans[k][1], spans[k][2]));
        if (!(place[0] >= left - 1 && place[0] <= right + 1 && place[1] >= top - 1 && place[1] <= bottom + 1)) return;
        this.knot(spans, { pointer, value, increasing, index }, place);
      });
    }
  }
  knot(spans, { pointer, value, increasing, index }, [x, y]) {
    const handle = make(this.handles, "circle", { cx: x, cy: y, r: 4.5, tabindex: 0, role: "slider" });
    const name = pointer.split("/")[2].replaceAll("~1", "/").replaceAll("~0", "~");
    handle.setAttribute("aria-label", `Point ${index + 1} of law ${name}`);
    handle.setAttribute("aria-valuenow", value[index][1]);
    handle.setAttribute("aria-valuetext", `${digits(value[index][0])} Pa, ${digits(value[index][1])} Pa/m`);
    // Between its neighbours, and at zero pressure where it is there.
    const between = (number, k, bounded) => {
      const low = bounded && index ? value[index - 1][k] * 1.001 : 1, high = (bounded && value[index + 1]?.[k] * 0.999) || Infinity;
      return Number(clamp(number, low, high).toPrecision(4));
    };
    const accepted = ([pressure, stiffness]) =>
      [value[index][0] === 0 ? 0 : between(pressure, 0, true), between(stiffness, 1, increasing)];
    const move = (pair, passing) => change(`${pointer}/${index}`, accepted(pair), passing);
    const at = event => {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.handles.getScreenCTM().inverse());
      return spans.map(([axis, start, end], k) => valueAt(axis, k ? point.y : point.x, start, end) / axis.factor);
    };
    handle.addEventListener("pointerdown", event => {
      handle.setPointerCapture(event.pointerId);
      this.dragged = true;
      event.preventDefault();
      handle.focus();
    });
    handle.addEventListener("pointermove", event => {
      if (!this.dragged || !handle.hasPointerCapture(event.pointerId)) return;
      const pair = accepted(at(event));
      pair.forEach((number, k) => {
        const [axis, start, end] = spans[k];
        handle.setAttribute(k ? "cy" : "cx", placeOf(axis, number * axis.factor, start, end));
      });
      move(pair, true);
    });
    const drop = event => {
      if (!this.dragged) return;
      this.dragged = false;
      move(at(event), false);
    };
    handle.addEventListener("pointerup", drop);
    handle.addEventListener("pointercancel", drop);
    handle.addEventListener("keydown", event => {
      const step = { ArrowLeft: [0.98, 1], ArrowRight: [1.02, 1], ArrowDown: [1, 0.98], ArrowUp: [1, 1.02] }[event.key];
      if (!step) return;
      event.preventDefault();
      move(value[index].map((number, k) => number * step[k]), false);
    });
  }
}

// Numbers of the parts, as the command prints them.
const texts = {};
const words = (part, text) => {
  texts[part] = text;
  $("words").textContent = shownParts()
    .map(one => texts[one]).filter(Boolean).join("\n");
};

// ---- Controls ----------------------------------------------------------------------------------
const digits = value => {
  if (value === null || value === undefined) return "";
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(6));
  return size !== 0 && (size < 1e-3 || size >= 1e6) ? rounded.toExponential().replace("e+", "e") : String(rounded);
};
// A number as it is typed; none for an empty text, NaN for another.
const typed = text => text.trim() === "" ? null : Number(text.trim().replace("−", "-").replace(",", "."));
// Ranges of sliders that have been edited, by pointer.
const ranges = {};
const STEPS = 1000;

const rows = new Map();
const isChanged = pointer => state.changes.some(([known]) => isInside(known, pointer) || isInside(pointer, known));

const isSet = pointer => state.changes.some(([known]) => known === pointer);

class Row {
  constructor(control) {
    this.control = control;
    const name = `c${rows.size}`;
    this.undo = element("button", { className: "small", type: "button", textContent: "×", title: "As in the file" });
    this.undo.setAttribute("aria-label", `${control.label}: as in the file`);
    this.undo.addEventListener("click", () => change(control.pointer, null));
    this.root = element("div", { className: "control", title: control.help });
    this[control.control](name, control);
  }
  label(name) { return element("label", { htmlFor: name, textContent: this.control.label }); }
  number(name, { unit }) {
    this.field = element("input", { type: "text", className: "value", id: name, inputMode: "decimal", autocomplete: "off" });
    this.slider = element("input", { type: "range", min: 0, max: STEPS, step: 1 });
    this.slider.setAttribute("aria-label", `${this.control.label}, slider`);
    const edit = element("button", { className: "small", type: "button", textContent: "↔", title: "Range of the slider" });
    edit.setAttribute("aria-label", `${this.control.label}: range of the slider`);
    edit.setAttribute("aria-expanded", "false");
    edit.addEventListener("click", () => this.edit(edit));
    this.root.append(element("div", { className: "line" }, this.label(name), this.undo, this.field,
      element("span", { className: "unit" }, ...superscripts(unit)), edit), this.slider);
    this.field.addEventListener("change", () => this.type());
    this.field.addEventListener("keydown", event => { if (event.key === "Enter") this.type(); });
    this.slider.addEventListener("input", () => this.slide(true));
    this.slider.addEventListener("change", () => this.slide(false));
  }
  get range() {
    const { low, high, log } = this.control;
    return ranges[this.control.pointer] ?? { low, high, log };
  }
  type() {
    const value = typed(this.field.value);
    this.field.setAttribute("aria-invalid", String(Number.isNaN(value)));
    if (Number.isNaN(value) || value === this.control.value) return;
    change(this.control.pointer, value);
  }
  slide(passing) {
    const { whole } = this.control;
    const value = valueAt(this.range, Number(this.slider.value), 0, STEPS);
    const kept = whole ? Math.round(value) : Number(value.toPrecision(4));
    this.field.value = digits(kept);
    change(this.control.pointer, kept, passing);
  }
  edit(button) {
    if (this.ends) { this.ends.remove(); this.ends = null; button.setAttribute("aria-expanded", "false"); return; }
    button.setAttribute("aria-expanded", "true");
    const field = key => {
      const input = element("input", { type: "text", value: digits(this.range[key]) });
      input.setAttribute("aria-label", `${key} end of the slider`);
      input.addEventListener("change", () => {
        const next = { ...this.range, [key]: typed(input.value) };
        if (!(next.low < next.high) || (next.log && next.low <= 0)) { input.setAttribute("aria-invalid", "true"); return; }
        input.setAttribute("aria-invalid", "false");
        ranges[this.control.pointer] = next;
        this.show(this.control);
      });
      return input;
    };
    const log = element("input", { type: "checkbox", checked: this.range.log });
    log.addEventListener("change", () => {
      const range = this.range;
      if (log.checked && range.low <= 0) { log.checked = false; say("a logarithmic slider begins above zero"); return; }
      ranges[this.control.pointer] = { ...range, log: log.checked };
      this.show(this.control);
    });
    this.ends = element("div", { className: "range" }, field("low"), "to", field("high"), element("label", {}, log, " logarithmic"));
    this.root.append(this.ends);
  }
  flag(name) {
    this.field = element("input", { type: "checkbox", id: name });
    this.field.addEventListener("change", () => change(this.control.pointer, this.field.checked));
    this.root.append(element("div", { className: "line" }, this.label(name), this.undo, this.field));
  }
  choice(name) {
    this.field = element("select", { id: name });
    this.field.addEventListener("change", () => {
      change(this.control.pointer, this.control.options[this.field.selectedIndex].value);
    });
    this.root.append(element("div", { className: "line" }, this.label(name), this.undo, this.field));
  }
  pairs(name, { columns, pulse }) {
    this.body = element("tbody");
    const head = text => element("th", { textContent: text, scope: "col" });
    this.root.append(element("div", { className: "line" }, element("span", { className: "label", textContent: this.control.label }), this.undo));
    if (pulse) {
      this.pad = new Pad((points, passing) => change(this.control.pointer, points, passing));
      this.root.append(this.pad.root);
    }
    const table = element("table", { className: "pairs" }, element("thead", {}, element("tr", {}, ...columns.map(head))), this.body);
    this.root.append(element("div", { className: "scrolled" }, table));
  }
  // Shows the value of a newer control of the same kind.
  show(control) {
    this.control = control;
    const active = document.activeElement;
    const own = control.control === "choice" ? isSet(control.pointer) : isChanged(control.pointer);
    this.root.classList.toggle("changed", own);
    this.undo.classList.toggle("idle", !own);
    this.undo.disabled = !state.changes.some(([known]) => isInside(known, control.pointer));
    if (control.control === "number") {
      if (active !== this.field) this.field.value = digits(control.value);
      if (active !== this.slider || settled === null) {
        const place = control.value === null ? 0 : placeOf(this.range, control.value, 0, STEPS);
        this.slider.value = clamp(Number.isFinite(place) ? place : 0, 0, STEPS);
      }
      this.slider.setAttribute("aria-valuetext", `${digits(control.value)} ${control.unit}`);
      this.slider.hidden = control.value === null;
      this.field.placeholder = control.value === null ? "left out" : "";
    } else if (control.control === "flag") {
      this.field.checked = control.value;
    } else if (control.control === "choice") {
      const name = ({ label, value }) => {
        if (label !== "samples" || !value?.points) return label.replaceAll("_", " ");
        return label === control.chosen && described.driven !== null ? "measured pulse" : "drawn pulse";
      };
      const options = control.options.map(one => element("option", { textContent: name(one) }));
      this.field.replaceChildren(...options);
      this.field.selectedIndex = control.options.findIndex(one => one.label === control.chosen);
    } else {
      this.pad?.show(control.value);
      if (!this.body.contains(active)) this.body.replaceChildren(...control.value.map((pair, row) => element("tr", {}, ...pair.map((number, column) => {
        const field = element("input", { type: "text", value: digits(number), inputMode: "decimal" });
        field.setAttribute("aria-label", `${control.columns[column]} of point ${row + 1}`);
        field.addEventListener("change", () => {
          const value = typed(field.value);
          if (value === null || Number.isNaN(value)) { field.setAttribute("aria-invalid", "true"); return; }
          field.blur();
          change(`${control.pointer}/${row}/${column}`, value);
        });
        return element("td", {}, field);
      }))));
    }
  }
}

// A force over time that is drawn: a stroke replaces it, its points are dragged, moved with the arrow keys, added and
// removed. `change` takes the points, as a passing state while the pointer is down.
const PAD = { width: 288, height: 132, left: 4, right: 284, top: 16, bottom: 116 };
// Points of a stroke, and room beyond the longest time and the largest force.
const STROKE = 60, ROOM = 1.25, MOST_POINTS = 200;
class Pad {
  constructor(change) {
    Object.assign(this, { change, points: [], held: null });
    this.svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    this.svg.setAttribute("viewBox", `0 0 ${PAD.width} ${PAD.height}`);
    this.svg.setAttribute("role", "group");
    this.svg.setAttribute("aria-label", "Force over time: draw it with the pointer, or move its points with the arrow keys; Delete removes a point");
    const button = (text, act) => {
      const made = element("button", { type: "button", className: "small", textContent: text });
      made.addEventListener("click", act);
      return made;
    };
    this.root = element("div", { className: "pad" }, this.svg,
      element("div", { className: "line" }, element("span", { className: "hint", textContent: "draw with the pointer, or" }), button("add point", () => this.add())));
    this.svg.addEventListener("pointerdown", event => {
      if (event.target.tagName === "circle") return;
      this.svg.setPointerCapture(event.pointerId);
      event.preventDefault();
      this.held = { stroke: [this.at(event)] };
    });
    this.svg.addEventListener("pointermove", event => {
      if (!this.held) return;
      if (this.held.stroke) this.extend(this.at(event)); else this.move(this.held.index, this.at(event), true);
    });
    const drop = () => {
      const held = this.held;
      this.held = null;
      if (held?.changed) this.change(this.points, false);
    };
    this.svg.addEventListener("pointerup", drop);
    this.svg.addEventListener("pointercancel", drop);
  }
  // The axes stay while the pointer is down.
  show(points) {
    if (this.held) return;
    this.points = points;
    const times = points.map(([time]) => time), forces = points.map(([, force]) => force);
    const largest = Math.max(...forces.map(Math.abs)) || 1;
    const least = Math.min(0, ...forces);
    this.time = { low: Math.min(0, times[0]), high: ROOM * times.at(-1) || 1, log: false };
    this.force = { low: least && ROOM * least, high: Math.max(ROOM * Math.max(...forces), 0.2 * largest), log: false };
    this.draw();
  }
  place([time, force]) {
    return [placeOf(this.time, time, PAD.left, PAD.right), placeOf(this.force, force, PAD.bottom, PAD.top)];
  }
  at(event) {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    const [x, y] = [clamp(point.x, PAD.left, PAD.right), clamp(point.y, PAD.top, PAD.bottom)];
    return [valueAt(this.time, x, PAD.left, PAD.right), valueAt(this.force, y, PAD.bottom, PAD.top)];
  }
  // A stroke goes forwards; where it goes back it takes its points along. It begins and ends without a force.
  extend([time, force]) {
    const least = (this.time.high - this.time.low) / STROKE;
    const stroke = this.held.stroke.filter(([earlier]) => earlier <= time - least);
    this.held.stroke = stroke.length ? [...stroke, [time, force]] : [[time, force]];
    const last = this.held.stroke.length - 1;
    if (last < 2) return;
    this.points = this.held.stroke.map(([t, f], k) => [rounded(t), k && k < last ? rounded(f) : 0]);
    this.held.changed = true;
    this.draw();
    this.change(this.points, true);
  }
  move(index, [time, force], passing) {
    const [before, after] = [this.points[index - 1]?.[0], this.points[index + 1]?.[0]];
    const gap = (this.time.high - this.time.low) * 1e-3;
    const moved = clamp(time, before === undefined ? Math.min(0, time) : before + gap, after === undefined ? Infinity : after - gap);
    this.points = this.points.map((point, k) => k === index ? [rounded(moved), rounded(force)] : point);
    if (this.held) this.held.changed = true;
    this.draw();
    this.change(this.points, passing);
  }
  // Another point in the middle of the longest interval.
  add() {
    if (this.points.length >= MOST_POINTS) { say(`at most ${MOST_POINTS} points`); return; }
    const lengths = this.points.slice(1).map(([time], k) => time - this.points[k][0]);
    const at = lengths.indexOf(Math.max(...lengths));
    const middle = [0, 1].map(k => rounded((this.points[at][k] + this.points[at + 1][k]) / 2));
    this.change(this.points.toSpliced(at + 1, 0, middle), false);
  }
  draw() {
    const focused = [...this.svg.querySelectorAll("circle")].indexOf(document.activeElement);
    if (focused < 0 || this.handles?.length !== this.points.length) {
      this.svg.replaceChildren();
      make(this.svg, "rect", { x: PAD.left, y: PAD.top, width: PAD.right - PAD.left, height: PAD.bottom - PAD.top, class: "ground" });
      this.zero = make(this.svg, "line", { class: "zero" });
      this.line = make(this.svg, "polyline", { class: "force" });
      // Handles of a measured force would hide it.
      this.handles = this.points.length > STROKE ? [] : this.points.map((_, index) => this.handle(index));
      this.texts = [["start", PAD.left, 10], ["end", PAD.right, PAD.height - 4]].map(([anchor, x, y]) =>
        make(this.svg, "text", { x, y, "text-anchor": anchor }));
    }
    if (this.next !== undefined) { this.handles[this.next]?.focus(); this.next = undefined; }
    const places = this.points.map(point => this.place(point));
    const zero = this.place([0, 0])[1];
    for (const [key, value] of Object.entries({ x1: PAD.left, x2: PAD.right, y1: zero, y2: zero })) this.zero.setAttribute(key, value);
    this.line.setAttribute("points", places.map(place => place.map(value => value.toFixed(1)).join(" ")).join(" "));
    this.handles.forEach((handle, k) => {
      handle.setAttribute("cx", places[k][0]);
      handle.setAttribute("cy", places[k][1]);
      handle.setAttribute("aria-valuenow", this.points[k][1]);
      handle.setAttribute("aria-valuetext", `${digits(this.points[k][0])} s, ${digits(this.points[k][1])} N`);
    });
    this.texts[0].textContent = `${digits(Number(this.force.high.toPrecision(3)))} N`;
    this.texts[1].textContent = `${digits(Number((1e3 * this.time.high).toPrecision(3)))} ms`;
  }
  handle(index) {
    const handle = make(this.svg, "circle", { r: this.points.length > STROKE / 2 ? 3 : 4, tabindex: 0, role: "slider" });
    handle.setAttribute("aria-label", `Point ${index + 1} of the force`);
    handle.addEventListener("pointerdown", event => {
      event.preventDefault();
      handle.focus();
      this.svg.setPointerCapture(event.pointerId);
      this.held = { index };
    });
    handle.addEventListener("keydown", event => {
      const [time, force] = this.points[index];
      const [across, up] = [(this.time.high - this.time.low) / 100, (this.force.high - this.force.low) / 100];
      const step = { ArrowLeft: [-across, 0], ArrowRight: [across, 0], ArrowDown: [0, -up], ArrowUp: [0, up] }[event.key];
      if (step) {
        event.preventDefault();
        this.move(index, [time + step[0], force + step[1]], false);
      } else if ((event.key === "Delete" || event.key === "Backspace") && this.points.length > 2) {
        event.preventDefault();
        this.next = Math.min(index, this.points.length - 2);
        this.change(this.points.toSpliced(index, 1), false);
      }
    });
    return handle;
  }
}
const rounded = number => Number(number.toPrecision(4));

// A unit with its superscripts.
const superscripts = unit => unit.split(/(\^\{[^}]*\})/).map(part =>
  part.startsWith("^{") ? element("sup", { textContent: part.slice(2, -1) }) : part);

const shape = groups => groups.map(({ title, controls }) => [title, controls.map(one => [one.pointer, one.control, one.label])]);
let built = null;
const showControls = groups => {
  if (!same(built, shape(groups))) {
    const open = new Map([...$("controls").querySelectorAll("details")].map(one => [one.dataset.title, one.open]));
    built = shape(groups);
    rows.clear();
    $("controls").replaceChildren(...groups.map(({ title, open: usual, controls }) => {
      const group = element("div", { className: "group" });
      for (const control of controls) {
        const row = new Row(control);
        rows.set(control.pointer + control.control, row);
        group.append(row.root);
      }
      const details = element("details", { open: open.get(title) ?? usual }, element("summary", { textContent: title }), group);
      details.dataset.title = title;
      return details;
    }));
  }
  for (const { controls } of groups) for (const control of controls) rows.get(control.pointer + control.control).show(control);
  showHits();
};

// The measured forces of the hits, one of which may excite the scenario.
const showHits = () => {
  const { hits, driven } = described;
  const group = [...$("controls").querySelectorAll("details")].find(one => one.dataset.title === "Excitation")?.querySelector(".group");
  if (!group || !hits?.some(hit => hit.pulse)) return;
  let field = $("hit");
  if (!field) {
    const option = (value, text) => element("option", { value, textContent: text });
    const known = hits.map((hit, k) => [hit, k]).filter(([hit]) => hit.pulse);
    field = element("select", { id: "hit" }, option("", "none"), ...known.map(([hit, k]) => option(k, `hit ${k + 1}, ${hit.force_n} N`)));
    field.addEventListener("change", () => drive(field.value));
    group.prepend(element("div", { className: "control", title: "The force that was measured in a hit, as the excitation" },
      element("div", { className: "line" }, element("label", { htmlFor: "hit", textContent: "Measured force" }), field)));
  }
  if (document.activeElement !== field) field.value = driven ?? "";
};
const drive = async hit => {
  if (hit === "") { change("/excitation", null); return; }
  try {
    const response = await post("pulse", { changes: state.changes, hit: Number(hit) });
    const answer = await response.json();
    if (answer.error) say(answer.error); else change("/excitation", answer.excitation);
  } catch (error) {
    say(`no answer: ${error.message}`);
  }
};

// ---- Settings of views -------------------------------------------------------------------------
const fields = {
  frf: [["magnitude", "Magnitude", ["log", "linear", "db"]]],
  levels: [["level_from", "from"], ["level_to", "to"], ["levels", "levels"]],
  steady: [["amplitudes", "Amplitudes", "list"], ["from_hz", "from"], ["to_hz", "to"], ["backbone", "backbones", "flag"]],
};
const showSettings = settings => {
  for (const [view, list] of Object.entries(fields)) {
    const place = cards.get(view)?.settings;
    if (!place || place.contains(document.activeElement)) continue;
    place.replaceChildren(...list.map(([key, name, kind]) => {
      const label = element("label", {}, `${name} `);
      let field;
      if (Array.isArray(kind)) {
        field = element("select", {}, ...kind.map(text => element("option", { textContent: text, selected: settings[key] === text })));
        field.addEventListener("change", () => set(key, field.value));
      } else if (kind === "flag") {
        field = element("input", { type: "checkbox", checked: settings[key] });
        field.addEventListener("change", () => set(key, field.checked || null));
      } else {
        const text = kind === "list" ? (settings[key] ?? []).map(digits).join(", ") : digits(settings[key]);
        field = element("input", { type: "text", value: text, className: kind ?? "" });
        field.addEventListener("change", () => {
          const value = kind === "list" ? field.value.split(/[,;\s]+/).filter(Boolean).map(typed) : typed(field.value);
          const wrong = [value].flat().some(Number.isNaN);
          field.setAttribute("aria-invalid", String(wrong));
          field.blur();
          if (!wrong) set(key, kind === "list" && !value.length ? null : value);
        });
      }
      label.append(field);
      return label;
    }));
  }
};

// ---- Page --------------------------------------------------------------------------------------
const tools = () => {
  $("undo").disabled = !past.length;
  $("redo").disabled = !future.length;
  $("reset").disabled = !state.changes.length;
  $("pin").setAttribute("aria-pressed", String(state.pinned !== null));
  $("pin").textContent = state.pinned === null ? "Pin" : "Unpin";
};

const show = () => {
  const { title, file, views, groups, faults, settings, out, hits } = described;
  $("title").textContent = title ?? file;
  $("file").textContent = title ? file : "";
  $("save").title = `Write scenario, figures and tables to ${out}`;
  $("problem").hidden = hits === null;
  if (hits !== null) $("file").textContent += ` · ${hits.length} measured hits`;
  document.title = `${title ?? file} · asperity explore`;
  if (!cards.size) build(views);
  showControls(groups);
  showSettings(settings);
  $("faults").hidden = !faults.length;
  cards.get("law").knots();
  $("faults").textContent = faults.map(fault => fault.text).join("\n");
};

const build = views => {
  for (const view of views) {
    works[view.part] ??= new Work(view.part);
    const card = new Card(view);
    cards.set(view.view, card);
    const chip = element("button", { type: "button", textContent: view.title });
    chip.addEventListener("click", () => {
      const shown = state.views.includes(view.view);
      const next = views.map(one => one.view).filter(one => one === view.view ? !shown : state.views.includes(one));
      go({ ...state, views: next }, { step: false });
      showViews();
    });
    card.chip = chip;
    $("views").append(chip);
  }
  $("cards").append(element("section", { className: "card" }, element("header", {}, element("h2", { textContent: "Numbers" })),
    element("pre", { id: "words" })));
  showViews();
};
const showViews = () => {
  for (const card of cards.values()) {
    const shown = state.views.includes(card.view);
    card.root.hidden = !shown;
    card.chip.setAttribute("aria-pressed", String(shown));
  }
  update();
};

$("undo").addEventListener("click", () => back(past, future));
$("redo").addEventListener("click", () => back(future, past));
$("reset").addEventListener("click", () => go({ ...state, changes: [] }));
$("pin").addEventListener("click", () => go({ ...state, pinned: state.pinned === null ? clone(state.changes) : null }));
document.addEventListener("keydown", event => {
  const isText = event.target.matches?.("input[type=text]");
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !isText) {
    event.preventDefault();
    if (event.shiftKey) back(future, past); else back(past, future);
  } else if (event.key === "p" && !isText && !event.ctrlKey && !event.metaKey && !event.altKey && !event.target.matches?.("select")) {
    $("pin").click();
  }
});
const shownParts = () => Object.keys(works).filter(part => works[part].views.length);
$("copy").addEventListener("click", async () => {
  const text = described.commands.filter(one => shownParts().includes(one.part)).map(one => one.text).join("\n");
  try {
    await navigator.clipboard.writeText(text);
    say("copied");
  } catch {
    prompt("The command of this state:", text);
  }
});
// Writes files to the folder of the page; existing ones once the user agrees.
const keep = async (problem, overwrite = false) => {
  const views = [...cards.values()].filter(card => !card.root.hidden).map(card => card.view);
  try {
    const response = await post("keep", { changes: state.changes, settings: state.settings, views: problem ? [] : views, problem, overwrite });
    const answer = await response.json();
    if (answer.error) say(answer.error);
    else if (!answer.existing) say(`${answer.written.length} files written to ${answer.folder}`);
    else if (confirm(`Replace in ${answer.folder}:\n${answer.existing.join(", ")}`)) await keep(problem, true);
  } catch (error) {
    say(`nothing was written: ${error.message}`);
  }
};
$("save").addEventListener("click", () => keep(false));
$("problem").addEventListener("click", () => keep(true));
addEventListener("popstate", () => {
  state = read(location.hash);
  settled = null;
  tools();
  describe();
  if (cards.size) showViews();
});

state = read(location.hash);
tools();
await describe();
