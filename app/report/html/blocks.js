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

/** "violation", "near" or "clear"; "" where nothing is known. As the window colours a block. */
function stateOf(blocks, i) {
  const found = blocks.found.get(i);
  if (blocks.verdict[i] > 0 || (found && found.severity === 3)) return "violation";
  if (blocks.lower[i] < 0) return "";
  const keep = blocks.pair[i] < 0 ? 0 : blocks.pairs[blocks.pair[i]][2];
  return blocks.width[i] >= 0 && blocks.lower[i] <= 2 * keep ? "near" : "clear";
}

function clearanceText(blocks, i) {
  if (blocks.motion[i] === 0) return "";
  if (blocks.lower[i] < 0) return "not known";
  if (blocks.width[i] < 0) return (blocks.lower[i] >= blocks.limit ? "> " : "\u2265 ") + millimetres(blocks.lower[i]);
  if (blocks.width[i] <= 1) return millimetres(blocks.lower[i] + blocks.width[i]);
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
