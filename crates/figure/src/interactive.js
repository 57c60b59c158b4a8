// Zoom and values of figures. Points are in the coordinates of the page; a view is the part of
// the frame that is shown: [left, top, right, bottom].
const NS = "http://www.w3.org/2000/svg";
const tip = document.createElement("div");
tip.className = "tip";
tip.hidden = true;
document.body.append(tip);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const make = (parent, name, attributes) => {
  const element = document.createElementNS(NS, name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  parent.append(element);
  return element;
};

// The value at a place of an axis that runs from start to end.
const valueAt = (axis, place, start, end) => {
  const part = (place - start) / (end - start);
  return axis.log ? axis.low * (axis.high / axis.low) ** part
    : axis.low + part * (axis.high - axis.low);
};
const placeOf = (axis, value, start, end) => start + (end - start) * (axis.log
  ? Math.log(value / axis.low) / Math.log(axis.high / axis.low)
  : (value - axis.low) / (axis.high - axis.low));

const minus = text => text.replace(/-/g, "\u2212");
const power = text => minus(text).replace(/^(.*)e\+?(.*)$/, "$1\u00d710<sup>$2</sup>");
const digits = value => {
  const size = Math.abs(value);
  const plain = size === 0 || (size >= 1e-3 && size < 1e6);
  return plain ? minus(String(Number(value.toPrecision(6)))) : power(value.toExponential(4));
};
const steps = (low, high, count) => {
  const rough = (high - low) / count;
  const ten = 10 ** Math.floor(Math.log10(rough));
  const step = ten * [1, 2, 5, 10].find(factor => factor * ten >= rough);
  const marks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) marks.push(k * step);
  return [marks, step];
};
// Values and labels of the marks of an axis between two values.
const ticks = (axis, low, high, count) => {
  if (axis.log && high / low > 8) {
    const marks = [];
    const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
    const every = Math.max(1, Math.ceil((last - first) / count));
    for (let k = first; k <= last; k += every) {
      const plain = first >= -2 && last <= 4;
      marks.push([10 ** k, plain ? String(Number((10 ** k).toPrecision(3)))
        : `10<sup>${minus(String(k))}</sup>`]);
    }
    return marks;
  }
  const [marks, step] = steps(low, high, count);
  const unit = 10 ** axis.exponent;
  const size = Math.max(Math.abs(low), Math.abs(high)) / unit;
  const places = clamp(-Math.floor(Math.log10(step / unit) + 1e-9), 0, 12);
  const label = value => size >= 1e-3 && size < 1e6 ? minus((value / unit).toFixed(places))
    : power((value / unit).toExponential(Math.max(0, Math.round(Math.log10(size * unit / step)))));
  return marks.map(value => [value, label(Math.abs(value) < 1e-9 * step ? 0 : value)]);
};
// A text with <sub> and <sup> as spans.
const write = (parent, html, attributes) => {
  const text = make(parent, "text", attributes);
  const size = Number(attributes["font-size"]);
  const box = document.createElement("template");
  box.innerHTML = html;
  let height = 0;
  for (const node of box.content.childNodes) {
    const rise = { SUP: 0.36, SUB: -0.18 }[node.nodeName] ?? 0;
    const span = make(text, "tspan", { dy: (height - rise) * size, "font-size": rise ? 0.7 * size : size });
    span.textContent = node.textContent;
    height = rise;
  }
  return text;
};

class Panel {
  constructor(svg, data, still, index, id) {
    Object.assign(this, data, { still });
    this.view = [...this.frame];
    this.clip = `${id}-${index}`;
    const [left, top, right, bottom] = this.frame;
    const clip = make(svg, "clipPath", { id: this.clip });
    make(clip, "rect", { x: left, y: top, width: right - left, height: bottom - top });
    this.moved = make(svg, "g", {});
    // Legends stay above the curves.
    this.still[this.still.length - 1]?.after(this.moved);
  }
  get zoomed() { return this.view.some((side, k) => Math.abs(side - this.frame[k]) > 1e-6); }
  x(place) {
    const [l, , r] = this.frame, [a, , b] = this.view;
    return l + (place - a) / (b - a) * (r - l);
  }
  y(place) {
    const [, t, , b] = this.frame, [, c, , d] = this.view;
    return t + (place - c) / (d - c) * (b - t);
  }
  // The place in the figure as drawn of a place on the screen.
  back(x, y) {
    const [l, t, r, b] = this.frame, [a, c, e, d] = this.view;
    return [a + (x - l) / (r - l) * (e - a), c + (y - t) / (b - t) * (d - c)];
  }
  // The values at the ends of the view; none of the whole.
  get limits() {
    if (!this.zoomed) return null;
    const [l, t, r, b] = this.frame, [a, c, e, d] = this.view;
    return [[a, e].map(x => valueAt(this.xAxis, x, l, r)), [d, c].map(y => valueAt(this.yAxis, y, b, t))];
  }
  set limits(limits) {
    if (!limits || (this.xAxis.log && limits[0][0] <= 0) || (this.yAxis.log && limits[1][0] <= 0)) return;
    const [l, t, r, b] = this.frame;
    const [a, e] = limits[0].map(value => placeOf(this.xAxis, value, l, r));
    const [d, c] = limits[1].map(value => placeOf(this.yAxis, value, b, t));
    this.view = [a, c, e, d];
    this.draw();
  }
  holds(x, y) {
    const [l, t, r, b] = this.frame;
    return x >= l && x <= r && y >= t && y <= b;
  }
  draw() {
    this.moved.replaceChildren();
    for (const part of this.still) part.style.display = this.zoomed ? "none" : "";
    if (!this.zoomed) return;
    const [left, top, right, bottom] = this.frame, [a, c, b, d] = this.view;
    const curves = make(this.moved, "g", { "clip-path": `url(#${this.clip})` });
    const path = (points, close) => {
      let text = "";
      for (let k = 0; k < points.length; k += 2) {
        text += `${k ? "L" : "M"}${this.x(points[k]).toFixed(2)} ${this.y(points[k + 1]).toFixed(2)}`;
      }
      return text + (close ? "Z" : points.length === 2 ? "h0.01" : "");
    };
    for (const [from, to] of this.shades) {
      const [start, end] = [this.x(from), this.x(to)].map(x => clamp(x, left, right));
      if (end > start) make(curves, "rect", { x: start, y: top, width: end - start, height: bottom - top, fill: "#f0f0f0" });
    }
    for (const one of this.series) {
      for (const area of one.areas) make(curves, "path", { d: path(area, true), fill: one.color, "fill-opacity": 0.22 });
    }
    for (const [vertical, at, text] of this.references) {
      const place = vertical ? this.x(at) : this.y(at);
      make(curves, "path", {
        d: vertical ? `M${place} ${bottom}V${top}` : `M${left} ${place}H${right}`,
        fill: "none", stroke: "#707070", "stroke-width": 0.8, "stroke-dasharray": "4.6 2.6",
      });
      const spot = vertical ? { x: place + 4, y: top + 14 } : { x: right - 7, y: place - 4, "text-anchor": "end" };
      write(curves, text, { ...spot, "font-size": 9.33, fill: "#444", stroke: "#fff", "stroke-width": 2.6, "paint-order": "stroke" });
    }
    for (const one of this.series) {
      const line = { fill: "none", stroke: one.color, "stroke-width": one.width, "stroke-linejoin": "round" };
      if (one.dash) line["stroke-dasharray"] = one.dash;
      for (const run of one.runs) make(curves, "path", { d: path(run, false), ...line });
      let bars = "";
      for (let k = 0; k < one.errors.length; k += 4) {
        bars += `M${this.x(one.errors[k])} ${this.y(one.errors[k + 1])}L${this.x(one.errors[k + 2])} ${this.y(one.errors[k + 3])}`;
      }
      if (bars) make(curves, "path", { d: bars, fill: "none", stroke: one.color, "stroke-width": 0.93 });
      if (one.marks.length) {
        const group = make(curves, "g", {});
        let marks = "";
        for (let k = 0; k < one.marks.length; k += 2) {
          const [x, y] = [this.x(one.marks[k]), this.y(one.marks[k + 1])];
          if (x >= left - 9 && x <= right + 9 && y >= top - 9 && y <= bottom + 9) {
            marks += `<path transform="translate(${x.toFixed(2)} ${y.toFixed(2)})" d="${one.symbol}" ${one.style}/>`;
          }
        }
        group.innerHTML = marks;
      }
    }
    for (const [x, y, text, color] of this.notes) {
      if (x === null || y === null) continue;
      write(curves, text, { x: this.x(x) + 6, y: this.y(y) - 4, "font-size": 9.33, fill: color, stroke: "#fff", "stroke-width": 2.6, "paint-order": "stroke" });
    }
    let marks = "";
    const label = { "font-size": 9.33 };
    const along = (axis, low, high, count, start, end, put) => {
      if (axis.ticks) axis.ticks.forEach(([place, text]) => put(place, text));
      else for (const [value, text] of ticks(axis, low, high, count)) put(placeOf(axis, value, start, end), text);
    };
    along(this.xAxis, valueAt(this.xAxis, a, left, right), valueAt(this.xAxis, b, left, right),
      clamp((right - left) / 60, 2, 8), left, right, (place, text) => {
        const x = this.x(place);
        if (x < left - 0.5 || x > right + 0.5) return;
        marks += `M${x} ${bottom}v-4M${x} ${top}v4`;
        write(this.moved, text, { ...label, x, y: bottom + 11.3, "text-anchor": "middle" });
      });
    along(this.yAxis, valueAt(this.yAxis, d, bottom, top), valueAt(this.yAxis, c, bottom, top),
      clamp((bottom - top) / 32, 2, 7), bottom, top, (place, text) => {
        const y = this.y(place);
        if (y < top - 0.5 || y > bottom + 0.5) return;
        marks += `M${left} ${y}h4M${right} ${y}h-4`;
        write(this.moved, text, { ...label, x: left - 4.5, y: y + 3.4, "text-anchor": "end" });
      });
    make(this.moved, "path", { d: marks, stroke: "#000", "stroke-width": 0.7, fill: "none" });
    make(this.moved, "rect", { x: left, y: top, width: right - left, height: bottom - top, fill: "none", stroke: "#000", "stroke-width": 0.7 });
  }
  // The point of a series nearest to a place on the screen, within reach.
  nearest(x, y, reach) {
    let best = null, least = reach * reach;
    for (const one of this.series) {
      for (const points of [...one.runs, one.marks]) {
        for (let k = 0; k < points.length; k += 2) {
          const [px, py] = [this.x(points[k]), this.y(points[k + 1])];
          const far = (px - x) ** 2 + (py - y) ** 2;
          if (far < least && this.holds(px, py)) [least, best] = [far, { one, x: points[k], y: points[k + 1] }];
        }
      }
    }
    return best;
  }
  values(x, y) {
    const [left, top, right, bottom] = this.frame;
    const say = (axis, value) => `${axis.label || "value"} ${digits(value)} ${axis.unit}`;
    return `${say(this.xAxis, valueAt(this.xAxis, x, left, right))}<br>` +
      say(this.yAxis, valueAt(this.yAxis, y, bottom, top));
  }
}

// Makes a drawn figure interactive, and returns its panels; `id` is unique on the page.
const interactive = (svg, data, id) => {
  const panels = data.panels.map((panel, index) => new Panel(svg, panel,
    svg.querySelectorAll(`g[data-panel="${index}"]`), index, id));
  // Panels of one figure with one horizontal axis are zoomed along it together.
  const linked = panel => panels.filter(other => other.xAxis.label === panel.xAxis.label &&
    other.xAxis.low === panel.xAxis.low && other.xAxis.high === panel.xAxis.high);
  const show = (panel, view) => {
    const part = k => (view[k] - panel.frame[k % 2]) / (panel.frame[k % 2 + 2] - panel.frame[k % 2]);
    const [from, to] = [part(0), part(2)];
    for (const other of linked(panel)) {
      const [left, , right] = other.frame;
      other.view[0] = left + from * (right - left);
      other.view[2] = left + to * (right - left);
      if (other === panel) [other.view[1], other.view[3]] = [view[1], view[3]];
      other.draw();
    }
  };
  const place = event => {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    return [point.x, point.y];
  };
  const at = (x, y) => panels.find(panel => panel.holds(x, y));
  const box = make(svg, "rect", { fill: "#0b57b0", "fill-opacity": 0.12, stroke: "#0b57b0", "stroke-width": 0.7, visibility: "hidden" });
  const dot = make(svg, "circle", { r: 3, fill: "none", stroke: "#0b57b0", "stroke-width": 1.2, visibility: "hidden" });
  let drag = null;
  const hide = () => { tip.hidden = true; dot.setAttribute("visibility", "hidden"); };
  svg.addEventListener("pointerdown", event => {
    const [x, y] = place(event), panel = at(x, y);
    if (!panel || event.button !== 0) return;
    drag = { panel, x, y, view: [...panel.view], pan: event.shiftKey };
    svg.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  svg.addEventListener("pointermove", event => {
    const [x, y] = place(event);
    if (drag) {
      hide();
      const { panel } = drag, [l, t, r, b] = panel.frame;
      if (drag.pan) {
        const [w, h] = [(drag.view[2] - drag.view[0]) / (r - l), (drag.view[3] - drag.view[1]) / (b - t)];
        const [dx, dy] = [(drag.x - x) * w, (drag.y - y) * h];
        show(panel, [drag.view[0] + dx, drag.view[1] + dy, drag.view[2] + dx, drag.view[3] + dy]);
        return;
      }
      const [ex, ey] = [clamp(x, l, r), clamp(y, t, b)];
      const sizes = { x: Math.min(drag.x, ex), y: Math.min(drag.y, ey), width: Math.abs(ex - drag.x), height: Math.abs(ey - drag.y) };
      for (const key in sizes) box.setAttribute(key, sizes[key]);
      box.setAttribute("visibility", "visible");
      return;
    }
    const panel = at(x, y);
    svg.style.cursor = panel ? "crosshair" : "";
    if (!panel) return hide();
    const found = panel.nearest(x, y, 24);
    const [px, py] = found ? [found.x, found.y] : panel.back(x, y);
    tip.innerHTML = (found && found.one.name ? `<b>${found.one.name}</b><br>` : "") + panel.values(px, py);
    tip.classList.toggle("free", !found);
    tip.hidden = false;
    const room = document.documentElement.clientWidth - tip.offsetWidth - 8;
    tip.style.left = `${Math.min(event.clientX + 14, room) + window.scrollX}px`;
    tip.style.top = `${event.clientY + 14 + window.scrollY}px`;
    dot.setAttribute("visibility", found ? "visible" : "hidden");
    if (found) { dot.setAttribute("cx", panel.x(px)); dot.setAttribute("cy", panel.y(py)); }
  });
  svg.addEventListener("pointerup", event => {
    if (!drag) return;
    const { panel, pan } = drag, start = [drag.x, drag.y], [x, y] = place(event);
    drag = null;
    box.setAttribute("visibility", "hidden");
    if (pan) return;
    const [l, t, r, b] = panel.frame, end = [clamp(x, l, r), clamp(y, t, b)];
    const wide = Math.abs(end[0] - start[0]) > 6, high = Math.abs(end[1] - start[1]) > 6;
    if (!wide && !high) return;
    const low = panel.back(Math.min(start[0], end[0]), Math.min(start[1], end[1]));
    const top = panel.back(Math.max(start[0], end[0]), Math.max(start[1], end[1]));
    // A flat or narrow box zooms along one axis alone.
    show(panel, [wide ? low[0] : panel.view[0], high ? low[1] : panel.view[1],
      wide ? top[0] : panel.view[2], high ? top[1] : panel.view[3]]);
  });
  svg.addEventListener("dblclick", event => {
    const panel = at(...place(event));
    if (!panel) return;
    for (const other of linked(panel)) { other.view = [...other.frame]; other.draw(); }
  });
  svg.addEventListener("wheel", event => {
    const [x, y] = place(event), panel = at(x, y);
    if (!panel || !(event.ctrlKey || event.metaKey || event.shiftKey)) return;
    event.preventDefault();
    const factor = Math.exp(clamp(event.deltaY || event.deltaX, -200, 200) / 500), [px, py] = panel.back(x, y);
    const [a, c, b, d] = panel.view;
    show(panel, [px + (a - px) * factor, py + (c - py) * factor, px + (b - px) * factor, py + (d - py) * factor]);
  }, { passive: false });
  svg.addEventListener("pointerleave", hide);
  return panels;
};
