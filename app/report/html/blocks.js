// The blocks of the program as columns of numbers, unpacked once.

/** Units: um, seconds, mm3. `lower` and `width` are -1 if unknown. */
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

/** Minimum clearance of the deciding pair of a block, um; 0 without a pair. */
function keepOf(blocks, i) {
  return blocks.pair[i] < 0 ? 0 : blocks.pairs[blocks.pair[i]][2];
}

function hasError(blocks, i) {
  const found = blocks.found.get(i);
  return found !== undefined && severities[found.severity] === "error";
}

/** "violation", "near" or "clear", the colour of a block in the window; "" if nothing is known. */
function stateOf(blocks, i) {
  if (blocks.verdict[i] > 0 || hasError(blocks, i)) return "violation";
  if (blocks.lower[i] < 0) return "";
  // Allowed contact (minimum clearance 0) is clear, not near.
  return blocks.width[i] >= 0 && blocks.lower[i] < 2 * keepOf(blocks, i) ? "near" : "clear";
}

/** Badness of a block: its verdict, at least 2 (violation) for an error, 0.5 if near, -1 if nothing is known. */
function badnessOf(blocks, i) {
  const state = stateOf(blocks, i);
  if (state === "violation") return Math.max(blocks.verdict[i], hasError(blocks, i) ? verdicts.indexOf("violation") : 0);
  return { near: 0.5, clear: 0 }[state] ?? -1;
}

/** Clearance minus allowance, um; infinite if no clearance is known. */
function marginOf(blocks, i) {
  return blocks.lower[i] < 0 ? Infinity : blocks.lower[i] - keepOf(blocks, i);
}

/** Whether block `a` is worse than `b`: by badness, then by margin. Index -1 (no block) is better than any. */
function isWorse(blocks, a, b) {
  if (b < 0) return a >= 0;
  if (a < 0) return false;
  const more = badnessOf(blocks, a) - badnessOf(blocks, b);
  return more !== 0 ? more > 0 : marginOf(blocks, a) < marginOf(blocks, b);
}

/** Whether the bodies of a block touch as intended: it is clear, without a gap and without a minimum. */
function isContact(blocks, i) {
  return stateOf(blocks, i) === "clear" && blocks.lower[i] === 0 && blocks.width[i] === 0
    && blocks.pair[i] >= 0 && keepOf(blocks, i) === 0;
}

function clearanceText(blocks, i) {
  if (blocks.motion[i] === 0) return "";
  if (blocks.lower[i] < 0) return "unknown";
  if (isContact(blocks, i)) return blocks.removed[i] > 0 ? "cutting" : "contact";
  if (blocks.width[i] < 0) return "\u2265 " + millimetres(blocks.lower[i]);
  if (blocks.width[i] <= 1) return millimetres(blocks.lower[i]); // rounded down, as a lower bound is
  return millimetres(blocks.lower[i]) + "\u2013" + millimetres(blocks.lower[i] + blocks.width[i]);
}

/** The clearance with its unit and the pair, for a sentence: "3.605 mm flutes / jaw", "contact flutes / stock". */
function clearanceWithPair(blocks, i) {
  const text = clearanceText(blocks, i), hasUnit = /[0-9]/.test(text);
  return [text + (hasUnit ? " mm" : ""), pairText(blocks, i)].filter(Boolean).join(" ");
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
