// A row of the table of blocks.

function blockRow(blocks, i) {
  const pair = blocks.pairs[blocks.pair[i]];
  const judged = [blocks.motion[i] ? verdicts[blocks.verdict[i]] : "", rulesText(blocks, i)];
  return row(stateOf(blocks, i), [cell(String(i)), cell(lineText(blocks, i)), cell(blocks.texts[blocks.text[i]]),
    cell(blocks.motion[i] ? motions[blocks.motion[i]] : ""),
    cell(blocks.tool[i] < 0 ? "" : "T" + blocks.tool[i]), cell(blocks.time[i].toFixed(2), "right"),
    cell(clearanceText(blocks, i), "amount right"), cell(pair ? millimetres(pair[2]) : "", "right"),
    cell(pairText(blocks, i)), cell(judged.filter(Boolean).join(": "), "judged")]);
}
