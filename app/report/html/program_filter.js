// Filter and order of the table of programs.

/** For each text of the batch, whether it contains the word. */
function textsWith(programs, word) {
  programs.lowered ||= programs.texts.map((text) => text.toLowerCase());
  return programs.lowered.map((text) => text.includes(word));
}

/** Predicate on programs for a word: matches name, verdict, rules and the texts of findings. */
function programQuestion(word, programs) {
  const wanted = word.toLowerCase(), has = (text) => text.toLowerCase().includes(wanted);
  const texts = textsWith(programs, wanted), rules = programs.findings.rules.map(has);
  const { starts, message, pair, text, cure, file } = programs.findings;
  return (i) => {
    if (has(programs.path[i]) || has(outcomes[programs.outcome[i]])) return true;
    if (texts[programs.setup[i]] || texts[programs.dialect[i]] || texts[programs.pair[i]] === true) return true;
    const failure = programs.failure.get(i);
    if (failure && (texts[failure.message] || texts[failure.file])) return true;
    if (talliesOf(programs.findings, i).some((tally) => rules[tally.rule])) return true;
    for (let k = starts[i]; k < starts[i + 1]; ++k)
      if (texts[message[k]] || texts[pair[k]] || texts[text[k]] || texts[cure[k]] || texts[file[k]]) return true;
    return false;
  };
}

/** The programs that match all words; `outcome` is "all", "lost", "bad" or a number; rule "" matches any. */
function passedPrograms(programs, words, outcome, rule) {
  const questions = words.split(/\s+/).filter(Boolean).map((word) => programQuestion(word, programs));
  if (outcome === "lost") questions.push((i) => programs.outcome[i] >= firstLost);
  else if (outcome === "bad") questions.push((i) => programs.errors[i] > 0);
  else if (outcome !== "all") questions.push((i) => programs.outcome[i] === Number(outcome));
  if (rule !== "") {
    const wanted = programs.findings.rules.indexOf(rule);
    questions.push((i) => talliesOf(programs.findings, i).some((tally) => tally.rule === wanted));
  }
  const passed = [];
  for (let i = 0; i < programs.count; ++i) if (questions.every((question) => question(i))) passed.push(i);
  return passed;
}

/** The rank of each program in natural order of names: 9 before 10. */
function nameRanks(programs) {
  const { compare } = new Intl.Collator("en", { numeric: true });
  const ranks = new Int32Array(programs.count);
  Array.from(programs.path.keys()).sort((a, b) => compare(programs.path[a], programs.path[b]))
    .forEach((program, rank) => { ranks[program] = rank; });
  return ranks;
}

/** Columns that sort in ascending order at the first click: names from A, small margins. */
const startsLow = ["program", "margin"];

/** Sorts programs by a column; programs without a value come last. */
function sortedPrograms(programs, passed, column, isDown) {
  programs.ranks ||= nameRanks(programs);
  const keys = column === "program" ? programs.ranks : programs[column], way = isDown ? -1 : 1;
  return Int32Array.from(passed).sort((a, b) => {
    const lost = Number(Number.isNaN(keys[a])) - Number(Number.isNaN(keys[b]));
    return lost || way * (keys[a] - keys[b]) || a - b;
  });
}
