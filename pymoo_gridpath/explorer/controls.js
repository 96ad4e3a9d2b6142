// Ranges to filter by, and the file of waypoints.
"use strict";

/** Return the slider of the one end or the other of the range of a column, over its different values in order. */
function buildFilter(column, index) {
  const values = [...new Set(column.finite)].sort((a, b) => a - b);
  if (column.values.includes(null)) values.push(null);
  if (values.length < 2) return null;
  const last = values.length - 1;
  const output = element("output", {});
  const kept = element("span", { className: "kept" });
  const ends = [0, last].map((value, k) =>
    element("input", { type: "range", min: 0, max: last, value, "aria-label": `${column.label}, ${k ? "greatest" : "least"}` }),
  );
  const update = (moved) => {
    const at = ends.map((end) => Number(end.value));
    // The end that moves stops at the other one.
    if (at[0] > at[1]) ends[moved].value = at[moved] = at[1 - moved];
    ends.forEach((end, k) => end.setAttribute("aria-valuetext", quantity(column, values[at[k]])));
    output.textContent = `${format(values[at[0]])} to ${quantity(column, values[at[1]])}`;
    kept.style.left = `${(100 * at[0]) / last}%`;
    kept.style.right = `${100 - (100 * at[1]) / last}%`;
    ranges[index] = at[0] === 0 && at[1] === last ? null : [values[at[0]], values[at[1]]];
  };
  ends.forEach((end, k) =>
    end.addEventListener("input", () => {
      update(k);
      applyFilters();
    }),
  );
  update(0);
  const reset = () => {
    [ends[0].value, ends[1].value] = [0, last];
    update(0);
  };
  byId("reset").addEventListener("click", reset);
  const range = element("div", { className: "range" }, kept, ...ends);
  return element("div", { className: "filter" }, element("span", {}, column.label), output, range);
}

function applyFilters() {
  const number = (value) => (value === null ? Infinity : value);
  const active = ranges.flatMap((range, k) => (range ? [[columns[k].values, ...range.map(number)]] : []));
  shown = Uint8Array.from({ length: nPaths }, (_, path) =>
    active.every(([values, low, high]) => number(values[path]) >= low && number(values[path]) <= high),
  );
  const n = shown.reduce((a, b) => a + b, 0);
  byId("shown").textContent = n === nPaths ? `All ${nPaths} paths are shown.` : `${n} of ${nPaths} paths are shown.`;
  byId("reset").disabled = active.length === 0;
  choose(chosen, false);
  redraw("backdrop");
}

// -- files ----------------------------------------------------------------------------------------------------------------

/** Return the cells of a path that are its waypoints. */
function corners(path) {
  const [counts, gaps] = [unpack(page.waypoints.counts), unpack(page.waypoints.gaps)];
  const first = counts.subarray(0, path).reduce((a, b) => a + b, 0);
  const cells = paths.cells(path);
  let place = 0;
  return Array.from(gaps.subarray(first, first + counts[path]), (gap) => cells[(place += gap)]);
}

/** Return the waypoints of a path, a line of x, y and heading each, in metres where the map has them. */
function waypoints(path) {
  const points = corners(path).map(centre);
  const headings = points.map(([x, y], k) => {
    const [toX, toY] = points[k + 1] ?? [x, y];
    return toX === x && toY === y ? null : Math.atan2(toY - y, toX - x);
  });
  // A path that waits keeps its heading, and so does its end.
  let heading = headings.find((angle) => angle !== null) ?? 0;
  const lines = points.map(([x, y], k) => [x, y, (heading = headings[k] ?? heading)].join(","));
  return `${["x,y,yaw", ...lines].join("\n")}\n`;
}

function download() {
  const address = URL.createObjectURL(new Blob([waypoints(chosen)], { type: "text/csv" }));
  element("a", { href: address, download: `${page.file_name}-path-${chosen}.csv` }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
