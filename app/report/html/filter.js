// Filter of the table of blocks.

/** Predicate on blocks for a word: T3 is a tool, L44 a line, anything else text, body or rule. */
function questionOf(word, blocks) {
  const tool = /^t(\d+)$/i.exec(word);
  if (tool) return (i) => blocks.tool[i] === Number(tool[1]);
  const line = /^l(\d+)$/i.exec(word);
  if (line) return (i) => blocks.line[i] === Number(line[1]);
  const wanted = word.toLowerCase();
  const has = (text) => text.toLowerCase().includes(wanted);
  const texts = blocks.texts.map(has);
  const pairs = blocks.pairs.map((pair) => has(pair[0]) || has(pair[1]));
  const rules = blocks.rules.map(has);
  return (i) => {
    const found = blocks.found.get(i);
    return texts[blocks.text[i]] || pairs[blocks.pair[i]] === true
      || has(verdicts[blocks.verdict[i]]) || (found !== undefined && found.rules.some((rule) => rules[rule]));
  };
}

/** The blocks that match all words and the verdict and are nearer than so many mm (0: any). */
function passedBlocks(blocks, words, verdict, nearer) {
  const questions = words.split(/\s+/).filter(Boolean).map((word) => questionOf(word, blocks));
  if (verdict === "open") questions.push((i) => blocks.verdict[i] > 0);
  if (verdict === "found") questions.push((i) => blocks.found.has(i));
  if (verdict === "moves") questions.push((i) => blocks.motion[i] > 0);
  if (nearer > 0)
    questions.push((i) => blocks.lower[i] >= 0 && blocks.lower[i] < nearer * 1000);
  const passed = new Int32Array(blocks.count);
  let count = 0;
  for (let i = 0; i < blocks.count; ++i)
    if (questions.every((question) => question(i))) passed[count++] = i;
  return passed.slice(0, count);
}
