// The page: what is chosen, shown and told; keys, links and files.
"use strict";

const page = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const { columns, names } = page;
const nPaths = columns[0].values.length;
const objectives = columns.filter((column) => column.objective);
const paths = new Paths(page);
const map = new MapView(byId("map"), page, paths);
const front = new Front(byId("front").firstElementChild, columns);
const parallel = objectives.length > 2 ? new Parallel(byId("parallel").firstElementChild, objectives) : null;
const charts = parallel ? [front, parallel] : [front];

let chosen = 0;
let hovered = null;
let shown = new Uint8Array(nPaths).fill(1);
let order = [];
const ranges = columns.map(() => null); // of each column, the least and the greatest value that is kept

function element(kind, attributes = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

const namesOf = (path) => names.filter((one) => one.path === path).map((one) => one.name);
const tintOf = (name) => color(name) || color("named");
const tinted = () => names.map(({ name, path }) => ({ path, tint: tintOf(name) }));
const quantity = (column, value) => format(value) + (/^\w/.test(column.unit) ? " " : "") + column.unit;
const told = (path) => objectives.map((column) => `${column.label} ${quantity(column, column.values[path])}`).join(", ");

// -- drawing --------------------------------------------------------------------------------------------------------------

let wanted = null;

/** Draw at the next chance: "cells", "backdrop" or "paths", each with all that follows it. */
function redraw(what) {
  const depth = ["paths", "backdrop", "cells"];
  if (wanted === null) requestAnimationFrame(drawNow);
  if (wanted === null || depth.indexOf(what) > depth.indexOf(wanted)) wanted = what;
}

function drawNow() {
  if (wanted === null) return;
  const what = wanted;
  wanted = null;
  const changed = [map, ...charts].map((view) => fit(view.canvas)).some(Boolean);
  if (what === "cells") map.paintCells();
  if (what !== "paths" || changed) for (const view of [map, ...charts]) view.paintBackdrop(shown, tinted());
  for (const view of [map, ...charts]) view.draw(chosen, hovered);
}

// -- choosing -------------------------------------------------------------------------------------------------------------

function choose(path, link = true) {
  chosen = path;
  const own = namesOf(path);
  const title = `Path ${path}${own.length ? ` \u00b7 ${own.join(", ")}` : ""}${shown[path] ? "" : " (filtered out)"}`;
  byId("chosen").textContent = title;
  const slider = byId("front");
  slider.setAttribute("aria-valuenow", order.indexOf(path));
  slider.setAttribute("aria-valuetext", `${title}, ${told(path)}`);
  map.canvas.setAttribute("aria-label", `Map of ${page.map.name} with ${title}: ${told(path)}`);
  byId("measures").tBodies[0].replaceChildren(
    ...columns.map((column) => {
      const best = column.maximise ? Math.max(...column.finite) : Math.min(...column.finite);
      const value = column.values[path];
      const percent = (100 * Math.abs(value / best - 1)).toFixed(1);
      const over = column.objective && value !== null && best > 0 ? `${column.maximise ? "\u2212" : "+"}${percent} %` : "";
      const row = element("tr", {}, element("th", { scope: "row" }, column.label));
      row.append(element("td", {}, quantity(column, value)), element("td", {}, over));
      row.classList.toggle("objective", column.objective);
      return row;
    }),
  );
  for (const button of byId("names").children) button.setAttribute("aria-pressed", String(Number(button.value) === path));
  if (link) {
    try {
      history.replaceState(null, "", `#${path}`);
    } catch {
      // Within a notebook the page has no address of its own.
    }
  }
  byId("link").textContent = location.protocol.startsWith("about") ? "" : `link to it: #${path}`;
  redraw("paths");
}

/** Choose the shown path so many places further along the front; from one that is not shown, the next that is. */
function step(places) {
  const along = order.filter((path) => shown[path]);
  if (!along.length) return;
  const here = along.indexOf(chosen);
  if (here >= 0) return choose(along[Math.min(Math.max(here + places, 0), along.length - 1)]);
  const place = order.indexOf(chosen);
  const beyond = along.filter((path) => (places > 0 ? order.indexOf(path) > place : order.indexOf(path) < place));
  choose(beyond.length ? beyond.at(places > 0 ? 0 : -1) : along.at(places > 0 ? -1 : 0));
}

function hover(path) {
  if (path === hovered) return;
  hovered = path;
  byId("hovered").textContent = path === null ? "" : `${path}: ${told(path)}`;
  redraw("paths");
}

function chooseLinked() {
  const text = location.hash.slice(1); // names are letters, so that nothing has to be decoded
  const named = names.find((one) => one.name === text);
  const path = named ? named.path : Number(text || NaN);
  if (Number.isInteger(path) && path >= 0 && path < nPaths) choose(path);
}

// -- axes, layers and names -----------------------------------------------------------------------------------------------

const axes = [0, objectives.length > 1 ? 1 : columns.length - 1].map((column) => ({ column, log: false }));

function setAxes() {
  front.setAxes(...axes);
  const [x, y] = front.scales;
  const places = Array.from({ length: nPaths }, (_, k) => k);
  order = places.sort((a, b) => x.places[a] - x.places[b] || y.places[a] - y.places[b] || a - b);
  byId("front").setAttribute("aria-valuenow", order.indexOf(chosen));
  redraw("backdrop");
}

function buildAxes() {
  ["Across", "Up"].forEach((word, k) => {
    const select = element("select", {
      "aria-label": `${word} the front`,
      onchange: () => {
        axes[k].column = Number(select.value);
        setAxes();
      },
    });
    select.append(...columns.map((column, n) => element("option", { value: n }, column.label)));
    select.value = String(axes[k].column);
    const log = element("input", {
      type: "checkbox",
      onchange: () => {
        axes[k].log = log.checked;
        setAxes();
      },
    });
    byId("axes").append(element("div", { className: "group" }, select, element("label", {}, log, `log ${k ? "up" : "across"}`)));
  });
}

function buildLayers() {
  const labels = {
    occupied: "Obstacles",
    grown: page.grown_label,
    field: page.field_label,
    others: "Other paths",
    named: "Named paths",
  };
  for (const [layer, label] of Object.entries(labels)) {
    if ((layer in page && !page[layer]) || (layer === "named" && !names.length)) continue;
    const box = element("input", {
      type: "checkbox",
      checked: map.layers[layer],
      onchange: () => {
        map.layers[layer] = box.checked;
        redraw("cells");
      },
    });
    byId("layers").append(element("label", {}, box, label));
  }
}

function buildNames() {
  names.forEach(({ name, path }) => {
    const swatch = element("span", { className: "swatch" });
    swatch.style.color = `var(--${name}, var(--named))`;
    byId("names").append(element("button", { type: "button", value: path, onclick: () => choose(path) }, swatch, name));
  });
}

// -- pointers and keys ----------------------------------------------------------------------------------------------------

function listenToChart(chart) {
  const near = (event) => chart.nearest(event.offsetX, event.offsetY, shown);
  chart.canvas.addEventListener("pointermove", (event) => hover(near(event)));
  chart.canvas.addEventListener("pointerleave", () => hover(null));
  chart.canvas.addEventListener("click", (event) => {
    const path = near(event);
    if (path !== null) choose(path);
  });
}

function listenToMap() {
  let dragged = null;
  const { canvas } = map;
  const under = (event) => {
    const [x, y] = map.cellAt(event.offsetX, event.offsetY).map(Math.floor);
    const reach = Math.floor((4 * (window.devicePixelRatio || 1)) / map.frame.scale);
    return { x, y, here: order.filter((path) => shown[path] && paths.passes(path, x, y, reach)) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    dragged = { x: event.offsetX, y: event.offsetY, far: 0 };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (dragged) {
      const [dx, dy] = [event.offsetX - dragged.x, event.offsetY - dragged.y];
      dragged = { x: event.offsetX, y: event.offsetY, far: dragged.far + Math.hypot(dx, dy) };
      if (dragged.far > 4) {
        map.pan(dx, dy);
        redraw("backdrop");
      }
      return;
    }
    const { x, y, here } = under(event);
    const inside = x >= 0 && y >= 0 && x < map.width && y < map.height;
    byId("place").textContent = inside ? describe(x, y, here.length) : "\u00a0";
    hover(inside && here.length ? here[Math.max(here.indexOf(chosen), 0)] : null);
  });
  canvas.addEventListener("pointerup", (event) => {
    if (dragged && dragged.far <= 4) {
      const { here } = under(event);
      if (here.length) choose(here[(here.indexOf(chosen) + 1) % here.length]);
    }
    dragged = null;
  });
  canvas.addEventListener("pointercancel", () => (dragged = null));
  canvas.addEventListener("pointerleave", () => {
    hover(null);
    byId("place").textContent = "\u00a0";
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      // Where the page itself scrolls, the wheel alone is for that.
      if (getComputedStyle(document.body).overflowY !== "hidden" && !event.ctrlKey) return;
      event.preventDefault();
      map.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
      redraw("backdrop");
    },
    { passive: false },
  );
}

/** Return where the centre of a cell of the page is on the whole map, in metres where it has them. */
function centre([x, y]) {
  const { resolution, origin, corner } = page.map;
  const cell = [x + corner[0], y + corner[1]];
  if (!resolution) return cell;
  const [across, up] = cell.map((value) => (value + 0.5) * resolution);
  const [cos, sin] = [Math.cos(origin[2]), Math.sin(origin[2])];
  return [origin[0] + across * cos - up * sin, origin[1] + across * sin + up * cos];
}

function describe(x, y, n) {
  const { resolution, corner } = page.map;
  let text = `cell ${x + corner[0]}, ${y + corner[1]}`;
  if (resolution) text += `; ${centre([x, y]).map((value) => `${value.toFixed(2)} m`).join(", ")}`;
  return n ? `${text}; ${n === 1 ? "one path passes" : `${n} paths pass`}` : text;
}

const KEYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10, Home: -Infinity, End: Infinity };

function onKey(event) {
  if (event.altKey || event.ctrlKey || event.metaKey || !(event.key in KEYS)) return;
  const onFront = document.activeElement === byId("front");
  // Elsewhere the keys that scroll keep doing so, and fields have their own.
  if (!onFront && (document.activeElement?.matches("input, select") || !/Arrow(Left|Right)/.test(event.key))) return;
  event.preventDefault();
  step(KEYS[event.key]);
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  byId("theme").textContent = theme === "dark" ? "Light" : "Dark";
  redraw("cells");
}

// -- to begin with --------------------------------------------------------------------------------------------------------

for (const column of columns) {
  column.finite = column.values.filter((value) => value !== null);
  column.title = column.label + (column.unit && ` [${column.unit}]`);
}
byId("summary").textContent = page.summary;
byId("caution").textContent = page.caution;
byId("caution").hidden = !page.caution;
byId("parallel-section").hidden = !parallel;
byId("stage").style.setProperty("--ratio", map.width / map.height);
byId("front").setAttribute("aria-valuemin", 0);
byId("front").setAttribute("aria-valuemax", nPaths - 1);
buildLayers();
buildNames();
buildAxes();
columns.forEach((column, k) => {
  const filter = buildFilter(column, k);
  if (filter) byId(column.objective ? "filters" : "more").append(filter);
});
byId("more").hidden = byId("more").children.length < 2;
byId("reset").addEventListener("click", applyFilters);
for (const chart of charts) listenToChart(chart);
listenToMap();
byId("previous").addEventListener("click", () => step(-1));
byId("next").addEventListener("click", () => step(1));
byId("download").addEventListener("click", download);
byId("download").hidden = !page.waypoints;
const zooms = { "zoom-in": () => map.zoom(1.5), "zoom-out": () => map.zoom(1 / 1.5), "zoom-fit": () => map.fitView() };
for (const [id, zoom] of Object.entries(zooms)) {
  byId(id).addEventListener("click", () => {
    zoom();
    redraw("backdrop");
  });
}
document.addEventListener("keydown", onKey);
window.addEventListener("hashchange", chooseLinked);
// It also tells the sizes to begin with, for which all is drawn already.
const sizes = new ResizeObserver(() => {
  if (![map, ...charts].every((view) => fits(view.canvas))) redraw("backdrop");
});
for (const view of [map, ...charts]) sizes.observe(view.canvas);
const dark = matchMedia("(prefers-color-scheme: dark)");
dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));
byId("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
setAxes();
setTheme(dark.matches ? "dark" : "light");
applyFilters();
const knee = names.find((one) => one.name === "knee");
choose(knee ? knee.path : 0, false);
chooseLinked();
drawNow(); // not at the next frame: the page is ready when it has loaded
