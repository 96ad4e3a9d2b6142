// The map: cells, fields, paths, and what is under the pointer.
"use strict";

/** Return the value of a colour of the page. */
function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Return the parts of a colour "#rrggbb". */
function parts(hex) {
  return [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
}

/** Return how many dots a canvas has on the screen, across and up. */
function dotsOf(canvas) {
  const ratio = window.devicePixelRatio || 1;
  return [canvas.clientWidth, canvas.clientHeight].map((length) => Math.max(1, Math.round(length * ratio)));
}

/** Whether a canvas has as many dots as on the screen. */
function fits(canvas) {
  const [width, height] = dotsOf(canvas);
  return canvas.width === width && canvas.height === height;
}

/** Give a canvas as many dots as it has on the screen; return whether that changed. */
function fit(canvas) {
  if (fits(canvas)) return false;
  [canvas.width, canvas.height] = dotsOf(canvas);
  return true;
}

function newCanvas(width, height) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  return canvas;
}

/** All paths: `x` and `y` of their cells, those of path k from `offsets[k]` on. */
class Paths {
  constructor(page) {
    const counts = unpack(page.counts);
    const starts = unpack(page.starts);
    const steps = unpack(page.steps);
    const near = page.steps.kind === "u1";
    this.offsets = new Uint32Array(counts.length + 1);
    counts.forEach((count, k) => (this.offsets[k + 1] = this.offsets[k] + count));
    this.x = new Int32Array(this.offsets[counts.length]);
    this.y = new Int32Array(this.offsets[counts.length]);
    let step = 0;
    for (let k = 0; k < counts.length; k++) {
      let x = starts[2 * k];
      let y = starts[2 * k + 1];
      for (let at = this.offsets[k]; at < this.offsets[k + 1]; at++) {
        if (at > this.offsets[k]) {
          // Two signed numbers of four bits in a byte, or of sixteen in two words where a step is longer.
          x += near ? (steps[step] << 28) >> 28 : steps[2 * step];
          y += near ? (steps[step] << 24) >> 28 : steps[2 * step + 1];
          step++;
        }
        this.x[at] = x;
        this.y[at] = y;
      }
    }
  }

  /** Return the cells (x, y) of a path. */
  cells(k) {
    const found = [];
    for (let at = this.offsets[k]; at < this.offsets[k + 1]; at++) found.push([this.x[at], this.y[at]]);
    return found;
  }

  /** Whether a path comes within `reach` cells of a cell. */
  passes(k, x, y, reach) {
    for (let at = this.offsets[k]; at < this.offsets[k + 1]; at++) {
      if (Math.abs(this.x[at] - x) <= reach && Math.abs(this.y[at] - y) <= reach) return true;
    }
    return false;
  }
}

class MapView {
  constructor(canvas, page, paths) {
    this.canvas = canvas;
    this.page = page;
    this.paths = paths;
    [this.width, this.height] = page.map.size;
    this.occupied = unpack(page.occupied);
    this.field = page.field && unpack(page.field);
    this.grown = page.grown && unpack(page.grown);
    this.layers = { occupied: true, grown: true, field: true, others: true, named: false };
    this.backdrop = newCanvas(1, 1);
    this.fitView();
  }

  /** Show the whole map. */
  fitView() {
    this.view = { zoom: 1, x: this.width / 2, y: this.height / 2 };
  }

  /** Dots a cell, and where the corner of the map is. Below a map that is shown whole there is room for the scale. */
  get frame() {
    const width = this.canvas.width;
    const height = Math.max(this.canvas.height - 34 * (window.devicePixelRatio || 1), 1);
    const scale = 0.98 * Math.min(width / this.width, height / this.height) * this.view.zoom;
    return { scale, left: width / 2 - this.view.x * scale, bottom: height / 2 + this.view.y * scale };
  }

  /** Return the cell at a place of the canvas, in CSS pixels, as numbers that are not whole. */
  cellAt(px, py) {
    const ratio = this.canvas.width / this.canvas.clientWidth;
    const { scale, left, bottom } = this.frame;
    return [(px * ratio - left) / scale, (bottom - py * ratio) / scale];
  }

  /** Zoom by a factor about a place of the canvas, in CSS pixels; about the middle if none is given. */
  zoom(factor, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2) {
    const [x, y] = this.cellAt(px, py);
    const zoom = Math.min(Math.max(this.view.zoom * factor, 1), Math.max(1, Math.max(this.width, this.height) / 8));
    const share = this.view.zoom / zoom;
    this.view = { zoom, x: x + (this.view.x - x) * share, y: y + (this.view.y - y) * share };
    if (zoom === 1) this.fitView();
  }

  /** Move what is shown by so many CSS pixels. */
  pan(dx, dy) {
    const ratio = this.canvas.width / this.canvas.clientWidth;
    const { scale } = this.frame;
    this.view.x = Math.min(Math.max(this.view.x - (dx * ratio) / scale, 0), this.width);
    this.view.y = Math.min(Math.max(this.view.y + (dy * ratio) / scale, 0), this.height);
  }

  /** Paint the cells, a dot each. */
  paintCells() {
    const { width, height } = this;
    const cells = newCanvas(width, height);
    const context = cells.getContext("2d");
    const image = context.createImageData(width, height);
    const [free, occupied, grown, field] = ["free", "occupied", "grown", "field"].map((name) => parts(color(name)));
    const has = (bits, at) => bits && (bits[at >> 3] >> (7 - (at & 7))) & 1;
    for (let y = 0, at = 0; y < height; y++) {
      let dot = (height - 1 - y) * width * 4;
      for (let x = 0; x < width; x++, at++, dot += 4) {
        const near = has(this.grown, at);
        const blocked = has(this.occupied, at) && this.layers[near ? "grown" : "occupied"];
        const share = this.field && this.layers.field && !blocked ? (0.8 * this.field[at]) / 255 : 0;
        for (let k = 0; k < 3; k++) {
          image.data[dot + k] = blocked ? (near ? grown : occupied)[k] : free[k] + (field[k] - free[k]) * share;
        }
        image.data[dot + 3] = 255;
      }
    }
    context.putImageData(image, 0, 0);
    this.cells = cells;
  }

  /** Draw all that stays as it is when another path is chosen: cells, lines between them, the other paths and the named ones. */
  paintBackdrop(shown, named) {
    const { width, height } = this.canvas;
    if (this.backdrop.width !== width || this.backdrop.height !== height) this.backdrop = newCanvas(width, height);
    const context = this.backdrop.getContext("2d");
    const { scale, left, bottom } = this.frame;
    context.fillStyle = color("beyond");
    context.fillRect(0, 0, width, height);
    // Dots of a map that is shown smaller than it is are averaged, so that thin walls stay in sight.
    context.imageSmoothingEnabled = scale < 1;
    context.imageSmoothingQuality = "high";
    context.drawImage(this.cells, left, bottom - this.height * scale, this.width * scale, this.height * scale);
    if (scale >= 12) this.rule(context);
    if (this.layers.others) {
      context.strokeStyle = color("others");
      context.globalAlpha = 0.75;
      context.lineWidth = Math.max(1, 0.03 * scale);
      context.stroke(this.edges(shown));
      context.globalAlpha = 1;
    }
    if (this.layers.named) {
      named.forEach(({ path, tint }, k) => {
        // Those drawn first are wider, so that they show behind the next where paths share cells.
        this.trace(context, path, tint, (2.5 + 2 * (named.length - 1 - k)) * (window.devicePixelRatio || 1));
      });
    }
  }

  rule(context) {
    const { scale, left, bottom } = this.frame;
    context.strokeStyle = color("line");
    context.globalAlpha = 0.4;
    context.lineWidth = 1;
    context.beginPath();
    for (let x = 0; x <= this.width; x++) {
      context.moveTo(left + x * scale, bottom);
      context.lineTo(left + x * scale, bottom - this.height * scale);
    }
    for (let y = 0; y <= this.height; y++) {
      context.moveTo(left, bottom - y * scale);
      context.lineTo(left + this.width * scale, bottom - y * scale);
    }
    context.stroke();
    context.globalAlpha = 1;
  }

  /** Return the steps of the shown paths, each once however many paths take it. */
  edges(shown) {
    const { x, y, offsets } = this.paths;
    const { scale, left, bottom } = this.frame;
    const seen = new Uint8Array(this.width * this.height);
    const line = new Path2D();
    const px = (at) => left + (x[at] + 0.5) * scale;
    const py = (at) => bottom - (y[at] + 0.5) * scale;
    for (let k = 0; k < shown.length; k++) {
      if (!shown[k]) continue;
      for (let at = offsets[k] + 1; at < offsets[k + 1]; at++) {
        // A step and its way back are one, seen from the lower cell, or the left one of two beside each other.
        const rising = y[at] > y[at - 1] || (y[at] === y[at - 1] && x[at] > x[at - 1]);
        const [from, to] = rising ? [at - 1, at] : [at, at - 1];
        const dx = x[to] - x[from];
        const dy = y[to] - y[from];
        const bit = dx > 1 || dx < -1 || dy > 1 ? 0 : 1 << (dy ? dx + 1 : 3);
        const cell = y[from] * this.width + x[from];
        if (bit && seen[cell] & bit) continue;
        seen[cell] |= bit;
        line.moveTo(px(from), py(from));
        line.lineTo(px(to), py(to));
      }
    }
    return line;
  }

  trace(context, path, tint, width, dashes = []) {
    const { x, y, offsets } = this.paths;
    const { scale, left, bottom } = this.frame;
    context.beginPath();
    for (let at = offsets[path]; at < offsets[path + 1]; at++) {
      context.lineTo(left + (x[at] + 0.5) * scale, bottom - (y[at] + 0.5) * scale);
    }
    context.strokeStyle = tint;
    context.lineWidth = width;
    context.lineJoin = context.lineCap = "round";
    context.setLineDash(dashes);
    context.stroke();
    context.setLineDash([]);
  }

  /** Draw the backdrop, and over it the chosen path and the one under the pointer. */
  draw(chosen, hovered) {
    const context = this.canvas.getContext("2d");
    const dot = window.devicePixelRatio || 1;
    context.drawImage(this.backdrop, 0, 0);
    this.trace(context, chosen, color("halo"), 7 * dot);
    this.trace(context, chosen, color("accent"), 3.5 * dot);
    if (hovered !== null && hovered !== chosen) {
      this.trace(context, hovered, color("halo"), 5 * dot);
      this.trace(context, hovered, color("ink"), 2 * dot, [6 * dot, 4 * dot]);
    }
    this.mark(context, this.page.start, false, dot);
    this.mark(context, this.page.goal, true, dot);
    this.drawScale(context, dot);
  }

  /** Draw the disc of the start or the star of the goal. */
  mark(context, [x, y], star, dot) {
    const { scale, left, bottom } = this.frame;
    const radius = Math.min(Math.max(0.45 * scale, 6 * dot), 12 * dot) * (star ? 1.35 : 1);
    context.beginPath();
    for (let k = 0; k < 10 && star; k++) {
      const far = k % 2 ? 0.45 * radius : radius;
      const angle = (k * Math.PI) / 5;
      context.lineTo(left + (x + 0.5) * scale + far * Math.sin(angle), bottom - (y + 0.5) * scale - far * Math.cos(angle));
    }
    if (!star) context.arc(left + (x + 0.5) * scale, bottom - (y + 0.5) * scale, radius, 0, 2 * Math.PI);
    context.closePath();
    context.fillStyle = color("ground");
    context.strokeStyle = color("ink");
    context.lineWidth = 2 * dot;
    context.fill();
    context.stroke();
  }

  /** Draw how long a round number of metres or cells is. */
  drawScale(context, dot) {
    const { scale } = this.frame;
    const unit = this.page.map.resolution || 1;
    const most = (0.25 * this.canvas.width * unit) / scale;
    const length = roundDown(most);
    const width = (length / unit) * scale;
    const [x, y] = [10 * dot, this.canvas.height - 12 * dot];
    const text = `${format(length)} ${this.page.map.unit}`;
    context.font = `${12 * dot}px system-ui, sans-serif`;
    context.fillStyle = color("ground");
    context.globalAlpha = 0.85;
    context.fillRect(x - 6 * dot, y - 20 * dot, Math.max(width, context.measureText(text).width) + 12 * dot, 28 * dot);
    context.globalAlpha = 1;
    context.fillStyle = color("ink");
    context.fillText(text, x, y - 6 * dot);
    context.fillRect(x, y, width, 2 * dot);
  }
}
