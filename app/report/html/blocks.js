// The blocks of the program as columns of numbers, unpacked once.

const motions = ["none", "rapid", "feed", "arc", "cycle"];
const verdicts = ["clear", "undecided", "violation", "collision"];

/** Units: um, seconds, mm3. `lower` and `width` are -1 where nothing is known. */
function unpackBlocks(data) {
  const count = data.count;
  const time = summed(Float64Array.from(data.time)).map((step) => step * 1e-4);
  return {
    count,
    time,
    end: data.end * 1e-4,
    limit: data.limit,
    line: summed(unpackRuns(data.line, count)),
    text: summed(unpackRuns(data.text, count)),
    texts: data.texts,
    file: unpackRuns(data.file, count),
    files: data.files,
    motion: unpackRuns(data.motion, count),
    tool: unpackRuns(data.tool, count),
    verdict: unpackRuns(data.verdict, count),
    pair: unpackRuns(data.pair, count),
    pairs: data.pairs,
    lower: Int32Array.from(data.lower),
    width: Int32Array.from(data.width),
    removed: Float64Array.from(data.removed, (step) => step * 0.01),
    rules: data.rules,
    found: new Map(data.found.map(([block, severity, ...rules]) => [block, { severity, rules }])),
  };
}

function durationOf(blocks, i) {
  return (i + 1 < blocks.count ? blocks.time[i + 1] : blocks.end) - blocks.time[i];
}

/** What the pair of a block has to keep, um; 0 where there is none. */
function keepOf(blocks, i) {
  return blocks.pair[i] < 0 ? 0 : blocks.pairs[blocks.pair[i]][2];
}

function hasError(blocks, i) {
  const found = blocks.found.get(i);
  return found !== undefined && found.severity === 3;
}

/** "violation", "near" or "clear"; "" where nothing is known. As the window colours a block. */
function stateOf(blocks, i) {
  if (blocks.verdict[i] > 0 || hasError(blocks, i)) return "violation";
  if (blocks.lower[i] < 0) return "";
  // Contact that is allowed, where 0 must be kept, is clear and not near.
  return blocks.width[i] >= 0 && blocks.lower[i] < 2 * keepOf(blocks, i) ? "near" : "clear";
}

/** How bad a block is: by its verdict, an error like a violation; near is 0.5, nothing known -1. */
function badnessOf(blocks, i) {
  const state = stateOf(blocks, i);
  if (state === "violation") return Math.max(blocks.verdict[i], hasError(blocks, i) ? 2 : 0);
  return { near: 0.5, clear: 0 }[state] ?? -1;
}

/** Clearance less allowance, um; infinite where no clearance is known. */
function marginOf(blocks, i) {
  return blocks.lower[i] < 0 ? Infinity : blocks.lower[i] - keepOf(blocks, i);
}

/** Whether block `a` is the one to see of the two: by badness, then by margin. Any but -1 is worse than -1. */
function isWorse(blocks, a, b) {
  if (b < 0) return a >= 0;
  if (a < 0) return false;
  const more = badnessOf(blocks, a) - badnessOf(blocks, b);
  return more !== 0 ? more > 0 : marginOf(blocks, a) < marginOf(blocks, b);
}

function clearanceText(blocks, i) {
  if (blocks.motion[i] === 0) return "";
  if (blocks.lower[i] < 0) return "not known";
  if (blocks.width[i] < 0) return (blocks.lower[i] >= blocks.limit ? "> " : "\u2265 ") + millimetres(blocks.lower[i]);
  if (blocks.width[i] <= 1) return millimetres(blocks.lower[i]); // rounded down, as a lower bound is
  return millimetres(blocks.lower[i]) + "\u2013" + millimetres(blocks.lower[i] + blocks.width[i]);
}

function pairText(blocks, i) {
  const pair = blocks.pairs[blocks.pair[i]];
  return pair ? pair[0] + " / " + pair[1] : "";
}

function rulesText(blocks, i) {
  const found = blocks.found.get(i);
  return found ? found.rules.map((rule) => blocks.rules[rule]).join(", ") : "";
}

function lineText(blocks, i) {
  const file = blocks.files[blocks.file[i]];
  return (file ? file + ":" : "") + blocks.line[i];
}
