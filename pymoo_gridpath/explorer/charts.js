// Charts of the front: the plane of two columns, and parallel coordinates of all objectives.
"use strict";

/** Return a number as people read it. */
function format(value) {
  if (value === null) return "\u221e";
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  return size >= 1000 ? value.toFixed(0) : size >= 100 ? value.toFixed(1) : size >= 1 ? value.toFixed(2) : value.toPrecision(3);
}

/** Return the largest of 1, 2 and 5 times a power of ten that is no more than a number. */
function roundDown(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((factor) => factor * power <= most * (1 + 1e-9)) * power;
}

/** Return the least of 1, 2 and 5 times a power of ten that is no less than a number. */
function roundUp(least) {
  const down = roundDown(least);
  const factor = Math.round(down / 10 ** Math.floor(Math.log10(down) + 1e-9));
  return down >= least * (1 - 1e-9) ? down : down * (factor === 2 ? 2.5 : 2);
}

/** Where the values of a column lie on an axis from 0 to 1; infinite ones (null) lie at its end. */
class Scale {
  constructor(values, log) {
    const finite = values.filter((value) => value !== null);
    let low = finite.length ? finite.reduce((a, b) => Math.min(a, b)) : 0;
    let high = finite.length ? finite.reduce((a, b) => Math.max(a, b)) : 1;
    if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) [low, high] = [low - 0.5, high + 0.5];
    // Zero has a place on a logarithmic axis, too, before the least that is more than it.
    const positive = finite.filter((value) => value > 0);
    this.log = log && low >= 0 && positive.length > 0;
    this.shift = low > 0 || !this.log ? 0 : positive.reduce((a, b) => Math.min(a, b));
    [this.low, this.high] = [low, high];
    [this.from, this.to] = [this.value(low), this.value(high)];
    this.places = Float64Array.from(values, (value) => this.place(value));
  }

  value(x) {
    return this.log ? Math.log10(x + this.shift) : x;
  }

  place(x) {
    return x === null ? 1 : (this.value(x) - this.from) / (this.to - this.from);
  }

  /** Return round numbers on the axis, about so many or fewer, each with its text. */
  ticks(count) {
    const numbers = this.roundNumbers(count);
    const gaps = numbers.slice(1).map((value, k) => value - numbers[k]);
    const digits = this.log || !gaps.length ? null : Math.max(0, -Math.floor(Math.log10(Math.min(...gaps)) + 1e-9));
    return numbers.map((value) => ({ value, text: digits === null ? format(value) : value.toFixed(Math.min(digits, 8)) }));
  }

  roundNumbers(count) {
    if (this.log) {
      const found = [];
      for (let power = Math.floor(Math.log10(this.low || this.shift)); power <= Math.log10(this.high); power++) {
        found.push(...[1, 2, 5].map((factor) => factor * 10 ** power));
      }
      const inside = found.filter((value) => value >= this.low && value <= this.high);
      const each = Math.ceil(inside.length / count);
      if (inside.length > 1) return inside.filter((_, k) => k % each === 0);
    }
    const step = roundUp((this.high - this.low) / count);
    const first = Math.ceil(this.low / step - 1e-9);
    const n = Math.floor(this.high / step + 1e-9) - first + 1;
    // Multiples, not sums, and without the noise of their last digits.
    return Array.from({ length: n }, (_, k) => Number(((first + k) * step).toPrecision(12)));
  }
}

/** What both charts share: a backdrop that stays while another path is chosen, and the path nearest to the pointer. */
class Chart {
  constructor(canvas, columns) {
    this.canvas = canvas;
    this.columns = columns;
    this.backdrop = newCanvas(1, 1);
  }

  get dot() {
    return window.devicePixelRatio || 1;
  }

  /** Return the context of a clean backdrop of the size of the canvas. */
  clean() {
    const { width, height } = this.canvas;
    if (this.backdrop.width !== width || this.backdrop.height !== height) this.backdrop = newCanvas(width, height);
    const context = this.backdrop.getContext("2d");
    context.fillStyle = color("panel");
    context.fillRect(0, 0, width, height);
    context.font = `${11 * this.dot}px system-ui, sans-serif`;
    return context;
  }

  /** Return the shown path nearest to a place of the canvas, in CSS pixels, or null. */
  nearest(px, py, shown) {
    const [x, y] = [px * this.dot, py * this.dot];
    let best = null;
    let least = Infinity;
    for (let k = 0; k < shown.length; k++) {
      if (!shown[k]) continue;
      const far = this.distance(k, x, y);
      if (far < least) [best, least] = [k, far];
    }
    return least <= this.reach * this.dot ? best : null;
  }
}

class Front extends Chart {
  reach = 40;

  /** Choose the columns of the axes and whether they are logarithmic. */
  setAxes(x, y) {
    this.axes = [x, y];
    this.scales = this.axes.map((axis) => new Scale(this.columns[axis.column].values, axis.log));
  }

  get box() {
    const { dot } = this;
    return { left: 58 * dot, right: this.canvas.width - 14 * dot, top: 12 * dot, bottom: this.canvas.height - 38 * dot };
  }

  // With some room at the ends, so that no point lies on the edge.
  across(place) {
    const { left, right } = this.box;
    return left + (0.03 + 0.94 * place) * (right - left);
  }

  up(place) {
    const { top, bottom } = this.box;
    return bottom - (0.05 + 0.9 * place) * (bottom - top);
  }

  at(k) {
    const [x, y] = this.scales.map((scale) => scale.places[k]);
    return [this.across(x), this.up(y)];
  }

  distance(k, x, y) {
    const [px, py] = this.at(k);
    return Math.hypot(px - x, py - y);
  }

  paintBackdrop(shown, named) {
    const context = this.clean();
    const { dot, box } = this;
    const [x, y] = this.scales;
    context.lineWidth = dot;
    context.strokeStyle = color("line");
    context.fillStyle = color("muted");
    context.textAlign = "center";
    for (const { value, text } of x.ticks((box.right - box.left) / (40 * dot))) {
      const px = this.across(x.place(value));
      line(context, px, box.top, px, box.bottom);
      context.fillText(text, px, box.bottom + 14 * dot);
    }
    context.textAlign = "right";
    for (const { value, text } of y.ticks(7)) {
      const py = this.up(y.place(value));
      line(context, box.left, py, box.right, py);
      context.fillText(text, box.left - 6 * dot, py + 4 * dot);
    }
    const [across, up] = this.axes.map((axis) => this.columns[axis.column].title);
    context.fillStyle = color("ink");
    context.fillText(across, box.right, box.bottom + 31 * dot);
    context.save();
    context.rotate(-Math.PI / 2);
    context.fillText(up, -box.top, 12 * dot);
    context.restore();
    for (const kept of [0, 1]) {
      context.fillStyle = color(kept ? "others" : "line");
      for (let k = 0; k < shown.length; k++) {
        if (Boolean(shown[k]) === Boolean(kept)) disc(context, ...this.at(k), (kept ? 2.6 : 1.8) * dot);
      }
    }
    for (const { path, tint } of named) {
      context.fillStyle = tint;
      disc(context, ...this.at(path), 5 * dot);
    }
  }

  draw(chosen, hovered) {
    const context = this.canvas.getContext("2d");
    const { dot } = this;
    context.drawImage(this.backdrop, 0, 0);
    if (hovered !== null) ring(context, ...this.at(hovered), 6 * dot, color("ink"), 1.5 * dot);
    context.fillStyle = color("accent");
    disc(context, ...this.at(chosen), 5 * dot);
    ring(context, ...this.at(chosen), 8 * dot, color("accent"), 2 * dot);
  }
}

class Parallel extends Chart {
  reach = 12;

  constructor(canvas, columns) {
    super(canvas, columns);
    this.scales = columns.map((column) => new Scale(column.values, false));
  }

  get box() {
    const { dot, columns } = this;
    const left = 40 * dot;
    const step = (this.canvas.width - 80 * dot) / Math.max(columns.length - 1, 1);
    return { left, step, top: 34 * dot, bottom: this.canvas.height - 22 * dot };
  }

  height(axis, k) {
    const { top, bottom } = this.box;
    return bottom - this.scales[axis].places[k] * (bottom - top);
  }

  distance(k, x, y) {
    const { left, step } = this.box;
    const axis = Math.min(Math.max(Math.floor((x - left) / step), 0), this.columns.length - 2);
    const share = Math.min(Math.max((x - left) / step - axis, 0), 1);
    return Math.abs(this.height(axis, k) * (1 - share) + this.height(axis + 1, k) * share - y);
  }

  trace(context, k) {
    const { left, step } = this.box;
    this.columns.forEach((_, axis) => context[axis ? "lineTo" : "moveTo"](left + axis * step, this.height(axis, k)));
  }

  paintBackdrop(shown, named) {
    const context = this.clean();
    const { dot } = this;
    const { left, step, top, bottom } = this.box;
    for (const kept of [0, 1]) {
      context.strokeStyle = color(kept ? "others" : "line");
      context.globalAlpha = kept ? Math.max(0.12, Math.min(0.8, 60 / shown.length)) : 0.3;
      context.lineWidth = dot;
      context.beginPath();
      for (let k = 0; k < shown.length; k++) if (Boolean(shown[k]) === Boolean(kept)) this.trace(context, k);
      context.stroke();
    }
    context.globalAlpha = 1;
    for (const { path, tint } of named) this.stroke(context, path, tint, 2 * dot);
    this.columns.forEach((column, axis) => {
      const x = left + axis * step;
      context.strokeStyle = color("muted");
      context.lineWidth = dot;
      line(context, x, top, x, bottom);
      context.textAlign = axis === 0 ? "left" : axis === this.columns.length - 1 ? "right" : "center";
      const edge = x + (axis === 0 ? -left + 4 * dot : axis === this.columns.length - 1 ? left - 4 * dot : 0);
      context.fillStyle = color("ink");
      context.fillText(column.title, edge, 12 * dot, Math.max(step, 80 * dot));
      context.fillStyle = color("muted");
      const scale = this.scales[axis];
      context.fillText(column.values.includes(null) ? "\u221e" : format(scale.high), edge, top - 8 * dot);
      context.fillText(format(scale.low), edge, bottom + 15 * dot);
    });
  }

  stroke(context, k, tint, width, dashes = []) {
    context.strokeStyle = tint;
    context.lineWidth = width;
    context.setLineDash(dashes);
    context.beginPath();
    this.trace(context, k);
    context.stroke();
    context.setLineDash([]);
  }

  draw(chosen, hovered) {
    const context = this.canvas.getContext("2d");
    const { dot } = this;
    context.drawImage(this.backdrop, 0, 0);
    this.stroke(context, chosen, color("accent"), 3.5 * dot);
    if (hovered !== null && hovered !== chosen) this.stroke(context, hovered, color("ink"), 2 * dot, [6 * dot, 4 * dot]);
  }
}

function line(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

function ring(context, x, y, radius, tint, width) {
  context.strokeStyle = tint;
  context.lineWidth = width;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.stroke();
}
