// The programs of a batch and their findings, unpacked once.

const firstLost = outcomes.indexOf("stopped"); // outcomes from here on: not checked to the end

/** Start indices of consecutive groups with these counts, and the end of the last one. */
function startsOf(counts) {
  const starts = new Int32Array(counts.length + 1);
  for (let i = 0; i < counts.length; ++i) starts[i + 1] = starts[i] + counts[i];
  return starts;
}

function unpackFindings(data, programs) {
  const starts = startsOf(unpackRuns(data.count, programs)), count = starts[programs];
  const runs = (name) => unpackRuns(data[name], count);
  return {
    starts,
    rules: data.rules,
    kinds: startsOf(unpackRuns(data.kinds, programs)),
    tally: data.tally,
    severity: runs("severity"), rule: runs("rule"), file: runs("file"), pair: runs("pair"),
    message: runs("message"), cure: runs("cure"), shortfall: runs("shortfall"),
    line: summed(runs("line")), block: summed(runs("block")), text: summed(runs("text")),
  };
}

/** The number of all findings of a program by rule: [{ rule, severity, count }]. */
function talliesOf(findings, i) {
  const tallies = [];
  for (let k = findings.kinds[i]; k < findings.kinds[i + 1]; ++k)
    tallies.push({ rule: findings.tally[3 * k], severity: findings.tally[3 * k + 1], count: findings.tally[3 * k + 2] });
  return tallies;
}

function countsOf(findings, programs, severity) {
  return Int32Array.from({ length: programs }, (_, i) =>
    talliesOf(findings, i).reduce((sum, tally) => sum + (tally.severity === severity ? tally.count : 0), 0));
}

/**
 * Units: um, ms, mm3. `pair` is -1 if no clearance was measured; `margin` is then NaN. All numbers of a program
 * that was not checked are NaN, except its outcome.
 */
function unpackPrograms(data) {
  const count = data.count, findings = unpackFindings(data.findings, count);
  const runs = (name) => unpackRuns(data[name], count);
  const pair = runs("pair"), outcome = runs("outcome");
  const checked = (numbers) => Float64Array.from(numbers, (number, i) => (outcome[i] < outcomes.length - 1 ? number : NaN));
  return {
    ...data,
    findings,
    pair,
    outcome,
    setup: runs("setup"), dialect: runs("dialect"), engine: runs("engine"),
    margin: Float64Array.from(pair, (index, i) => (index < 0 ? NaN : data.lower[i] - data.keep[i])),
    blocks: checked(data.blocks), cycle: checked(data.cycle), seconds: checked(data.seconds),
    errors: checked(countsOf(findings, count, severities.indexOf("error"))),
    warnings: checked(countsOf(findings, count, severities.indexOf("warning"))),
    notes: checked(countsOf(findings, count, severities.indexOf("note"))),
    failure: new Map(data.errors.map(([i, file, line, column, message]) => [i, { file, line, column, message }])),
    assumptions: startsOf(runs("assumptions")),
  };
}

/** Splits a path into folder, relative to the common folder, and name. */
function partsOf(programs, i) {
  const path = programs.path[i].slice(programs.folder.length), at = path.lastIndexOf("/") + 1;
  return { folder: path.slice(0, at), name: path.slice(at) };
}

/** CSS class that colours an outcome. */
function toneOf(outcome) {
  return outcome >= firstLost ? "lost" : ["clear", "undecided"].find((name) => name === outcomes[outcome]) || "";
}
