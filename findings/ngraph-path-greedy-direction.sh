#!/usr/bin/env bash
# ngraph.path 1.6.1 (npm): aGreedy returns its path now from start to goal, now from goal to start.
#
# Good guess: like aStar and nba of the same package it lists the goal first (an odd order, but a fixed one).
# Behaviour: the order changes with the map. On a line of 2 or 3 nodes the goal is first, on a line
#   of 4 or more the start is. Code that reverses every path turns half of them the wrong way round.
# So: look at path[0].id before using the path.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
pinned="ngraph.path==1.6.1 ngraph.graph==20.1.2"
npm install ${pinned//==/@} --silent --no-audit --no-fund --prefix "$tmp"
[[ $(node -p "require('./node_modules/ngraph.path/package.json').version") == 1.6.1 ]]
node - <<'JS'
const assert = require("assert");
const createGraph = require("ngraph.graph");
const finders = require("ngraph.path");

const first = { aStar: [], nba: [], aGreedy: [] };
for (let n = 2; n < 7; n++) {
  const graph = createGraph();
  for (let i = 0; i < n; i++) graph.addNode(i, { x: i });
  for (let i = 1; i < n; i++) graph.addLink(i - 1, i);
  const heuristic = (a, b) => Math.abs(a.data.x - b.data.x);
  for (const name of Object.keys(first)) {
    const path = finders[name](graph, { heuristic }).find(0, n - 1);
    first[name].push(path[0].id === 0 ? "start" : "goal");
  }
}
console.log("first node of the path from 0 to n - 1, n = 2 .. 6:", first);
assert.deepStrictEqual(first.aStar, ["goal", "goal", "goal", "goal", "goal"]);
assert.deepStrictEqual(first.nba, ["goal", "goal", "goal", "goal", "goal"]);
assert.deepStrictEqual(first.aGreedy, ["goal", "goal", "start", "start", "start"]);
JS
