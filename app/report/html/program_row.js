// A row of the table of programs.

function nameCell(programs, i) {
  const { folder, name } = partsOf(programs, i), made = cell("", "name"), dim = document.createElement("span");
  made.textContent = name + " ";
  made.title = programs.path[i];
  dim.className = "folder";
  dim.textContent = folder;
  made.append(dim);
  return made;
}

function marginText(programs, i) {
  return Number.isNaN(programs.margin[i]) ? "" : (programs.width[i] < 0 ? "\u2265 " : "") + millimetres(programs.margin[i]);
}

function nearestText(programs, i) {
  return programs.pair[i] < 0 ? "" : programs.texts[programs.pair[i]] + ", " + programs.line[i];
}

/** A count that should be zero; `alarm` is the class if it is not. */
function countCell(count, isKnown, alarm) {
  return cell(isKnown ? String(count) : "", "right " + (count > 0 ? alarm : "zero"));
}

function programRow(programs, i) {
  const outcome = programs.outcome[i], isKnown = outcome < outcomes.length - 1;
  return row("", [nameCell(programs, i), cell(outcomes[outcome], "outcome " + toneOf(outcome)),
    cell(marginText(programs, i), "right" + (programs.margin[i] < 0 ? " alarm" : "")), cell(nearestText(programs, i)),
    countCell(programs.errors[i], isKnown, "alarm"), countCell(programs.warnings[i], isKnown, "doubt"),
    cell(isKnown ? String(programs.blocks[i]) : "", "right"), cell(isKnown ? secondsText(programs.cycle[i] / 1000) : "", "right"),
    cell(isKnown ? (programs.seconds[i] / 1000).toFixed(2) : "", "right")]);
}
