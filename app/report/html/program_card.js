// The card of one program.

const mostPlaces = 300; // listed per finding

/** An element with a class and content. */
function make(tag, name, ...inside) {
  const made = document.createElement(tag);
  if (name) made.className = name;
  made.append(...inside);
  return made;
}

/** "4, 7\u20139 and more": the sorted numbers as ranges, at most twelve. */
function rangesText(numbers) {
  const ranges = [], sorted = [...new Set(numbers)].sort((a, b) => a - b);
  for (const number of sorted) {
    const last = ranges[ranges.length - 1];
    if (last && number === last[1] + 1) last[1] = number; else ranges.push([number, number]);
  }
  const shown = ranges.slice(0, 12).map(([from, to]) => (from === to ? String(from) : from + "\u2013" + to));
  return shown.join(", ") + (ranges.length > shown.length ? " and more" : "");
}

/** Groups findings of a program that are equal except for their block: lists of indices. */
function findingGroups(findings, i) {
  const { severity, rule, message, cure, pair, file } = findings, groups = new Map();
  for (let k = findings.starts[i]; k < findings.starts[i + 1]; ++k) {
    const key = [severity[k], rule[k], message[k], cure[k], pair[k], file[k]].join();
    if (groups.has(key)) groups.get(key).push(k); else groups.set(key, [k]);
  }
  return [...groups.values()];
}

function placesOf(programs, group) {
  const { line, block, text } = programs.findings, first = group[0];
  if (block[first] < 0) return [];
  if (group.length === 1)
    return [make("p", "where", "line " + line[first] + ", block " + block[first] + " ", make("code", "", programs.texts[text[first]]))];
  const list = make("ol", "", ...group.slice(0, mostPlaces).map((k) =>
    make("li", "", make("span", "", "line " + line[k]), make("code", "", programs.texts[text[k]]))));
  const summary = make("summary", "where", group.length + " blocks, lines " + rangesText(group.map((k) => line[k])));
  const rest = group.length > mostPlaces ? [make("p", "where", "and " + (group.length - mostPlaces) + " more")] : [];
  return [make("details", "", summary, list, ...rest)];
}

function findingCard(programs, group) {
  const { severity, rule, message, cure, pair, file, rules } = programs.findings, first = group[0];
  const name = severities[severity[first]], texts = programs.texts;
  const header = make("header", "", make("span", "badge " + name, name), make("h3", "", rules[rule[first]]));
  if (texts[pair[first]]) header.append(make("span", "pair", texts[pair[first]]));
  const card = make("article", "card " + name, header, make("p", "", texts[message[first]]));
  if (texts[cure[first]]) card.append(make("p", "cure", make("b", "", "Cure: "), texts[cure[first]]));
  if (texts[file[first]]) card.append(make("p", "where", "in " + texts[file[first]]));
  card.append(...placesOf(programs, group));
  return card;
}

function findingsPart(programs, i) {
  const { findings } = programs, groups = findingGroups(findings, i);
  const all = programs.errors[i] + programs.warnings[i] + programs.notes[i], kept = findings.starts[i + 1] - findings.starts[i];
  const part = make("div", "", make("h4", "", "Findings"),
    make("div", "cards", ...groups.map((group) => findingCard(programs, group))));
  if (all === 0) part.append(make("p", "notice", programs.outcome[i] < firstLost ? "None." : "None up to that point."));
  if (all > kept) part.append(make("p", "notice", "and " + (all - kept) + " more; check this program alone to list them"));
  return part;
}

function stoppedPart(programs, i) {
  const failure = programs.failure.get(i);
  if (!failure) return [];
  const file = programs.texts[failure.file], isOwn = file === "" || file === programs.path[i];
  const place = [isOwn ? "" : file, failure.line > 0 ? "line " + failure.line : "", failure.column > 0 ? "column " + failure.column : ""];
  const text = place.filter(Boolean).join(", ");
  return [make("div", "stopped", make("b", "", programs.blocks[i] > 0 ? "Stopped: " : "Not run: "),
    (text ? text + ": " : "") + programs.texts[failure.message])];
}

function clearanceSentence(programs, i) {
  if (programs.pair[i] < 0) return "no pair of bodies within the search limit";
  const at = programs.texts[programs.pair[i]] + " in block " + programs.block[i] + ", line " + programs.line[i];
  const isClear = ["clear", "no error", "errors"].includes(outcomes[programs.outcome[i]]);
  if (isClear && programs.lower[i] === 0 && programs.keep[i] === 0) return "permitted contact only: " + at;
  const lower = millimetres(programs.lower[i]), width = programs.width[i];
  const range = width < 0 ? "at least " + lower + " mm" : width <= 1 ? lower + " mm" : lower + " to " + millimetres(programs.lower[i] + width) + " mm";
  return range + " (minimum " + millimetres(programs.keep[i]) + " mm): " + at;
}

function factsPart(programs, i) {
  const texts = programs.texts, rows = [
    ["clearance", clearanceSentence(programs, i)],
    ["blocks", String(programs.blocks[i])],
    ["cycle time", secondsText(programs.cycle[i] / 1000)],
    ["removed", programs.removed[i] + " mm\u00b3"],
    ["set-up", texts[programs.setup[i]] || "none: inferred from the program"],
    ["dialect", texts[programs.dialect[i]] || "not known"],
    ["engine", texts[programs.engine[i]]],
    ["checked in", (programs.seconds[i] / 1000).toFixed(2) + " s"],
    ["SHA-256", programs.sha256[i]]];
  const body = make("tbody", "", ...rows.filter(([, text]) => text).map(([name, text]) =>
    make("tr", "", make("th", "", name), make("td", "", text))));
  return make("table", "facts", body);
}

function assumptionsPart(programs, i) {
  const items = programs.assumed.slice(programs.assumptions[i], programs.assumptions[i + 1]);
  if (items.length === 0) return [];
  return [make("details", "assumed", make("summary", "", items.length + " assumptions"),
    make("ul", "", ...items.map((text) => make("li", "", programs.texts[text]))))];
}

function cardHeader(programs, i) {
  const outcome = programs.outcome[i], { name } = partsOf(programs, i);
  const close = make("button", "", "\u2715");
  close.type = "button";
  close.dataset.close = "true";
  close.setAttribute("aria-label", "Close the program");
  return make("header", "", make("div", "",
    make("span", "outcome " + toneOf(outcome), outcomes[outcome]), make("h3", "", name), make("p", "folder", programs.path[i])), close);
}

function programCard(programs, i) {
  const card = make("article", "program", cardHeader(programs, i));
  if (programs.outcome[i] === outcomes.length - 1) {
    card.append(make("p", "notice", "This program was not checked: the batch was stopped before it."), commandPart(programs, i));
    return card;
  }
  card.append(...stoppedPart(programs, i), findingsPart(programs, i), factsPart(programs, i),
    ...assumptionsPart(programs, i), commandPart(programs, i));
  return card;
}
