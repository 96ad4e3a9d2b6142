#!/usr/bin/env bash
# rot-js 2.2.1 (npm): A* walks into a blocked goal but will not leave a blocked start.
#
# Good guess: as in most grid libraries the start is not asked whether it is passable, the goal is.
# Behaviour: the other way round, for the search runs from the goal (named in the constructor) to the start (named in
#   compute()), and its own first cell, the goal, is never asked. A goal inside a wall gets an ordinary path.
# So: ask your own map about the goal first.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
pinned="rot-js==2.2.1"
npm install ${pinned//==/@} --silent --no-audit --no-fund --prefix "$tmp"
[[ $(node -p "require('./node_modules/rot-js/package.json').version") == 2.2.1 ]]
cat > check.mjs <<'JS'
import assert from "node:assert";
import { Path } from "rot-js";

const passable = (x, y) => x >= 0 && y >= 0 && x < 3 && y < 3 && !(x === 2 && y === 2);
function plan(start, goal) {
  const path = [];
  new Path.AStar(...goal, passable, { topology: 8 }).compute(...start, (x, y) => path.push([x, y]));
  return path;
}
console.log("goal (2, 2) blocked: ", JSON.stringify(plan([0, 0], [2, 2])));
console.log("start (2, 2) blocked:", JSON.stringify(plan([2, 2], [0, 0])));
assert.deepStrictEqual(plan([0, 0], [2, 2]), [[0, 0], [1, 1], [2, 2]]);
assert.deepStrictEqual(plan([2, 2], [0, 0]), []);
JS
node check.mjs
