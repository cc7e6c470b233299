// The table of blocks. Only the rows in sight exist, so that its length does not count.

const rowHeight = 26;
const headHeight = 30;
const tallest = 8e6; // px: browsers do not lay out much more
const mostPrinted = 400;

function cell(text, name) {
  const span = document.createElement("span");
  span.textContent = text;
  span.title = text;
  span.setAttribute("role", "cell");
  if (name) span.className = name;
  return span;
}

function rowOf(blocks, i, isChosen) {
  const row = document.createElement("div");
  row.className = "grid-row " + stateOf(blocks, i) + (isChosen ? " chosen" : "");
  row.setAttribute("role", "row");
  row.setAttribute("aria-selected", String(isChosen));
  row.dataset.row = String(i);
  const pair = blocks.pairs[blocks.pair[i]];
  const judged = [blocks.motion[i] ? verdicts[blocks.verdict[i]] : "", rulesText(blocks, i)];
  row.append(cell(String(i)), cell(lineText(blocks, i)), cell(blocks.texts[blocks.text[i]]),
    cell(blocks.motion[i] ? motions[blocks.motion[i]] : ""),
    cell(blocks.tool[i] < 0 ? "" : "T" + blocks.tool[i]), cell(blocks.time[i].toFixed(2), "right"),
    cell(clearanceText(blocks, i), "amount right"), cell(pair ? millimetres(pair[2]) : "", "right"),
    cell(pairText(blocks, i)), cell(judged.filter(Boolean).join(": "), "judged"));
  return row;
}

/** `onChoose(block)` is told of clicks and keys. */
function makeTable(grid, blocks, onChoose) {
  const body = grid.querySelector(".grid-body");
  const rows = grid.querySelector(".grid-rows");
  let shown = new Int32Array(0); // blocks
  let chosen = -1; // block

  const room = () => Math.max(1, Math.floor((grid.clientHeight - headHeight) / rowHeight));
  const height = () => Math.min(shown.length * rowHeight, tallest);
  // Beyond `tallest` a pixel of scrolling is more than a pixel of rows.
  const ratio = () => {
    const way = height() - room() * rowHeight;
    return way > 0 ? (shown.length - room()) / way : 0;
  };

  function draw() {
    const first = Math.max(0, Math.min(Math.floor(grid.scrollTop * ratio()), shown.length - room()));
    const last = Math.min(shown.length, first + room() + 2);
    const fresh = [];
    for (let k = first; k < last; ++k) fresh.push(rowOf(blocks, shown[k], shown[k] === chosen));
    rows.replaceChildren(...fresh);
    const top = grid.scrollTop - (ratio() > 0 ? (grid.scrollTop * ratio() - first) * rowHeight : grid.scrollTop);
    rows.style.top = Math.max(0, Math.min(top, height() - fresh.length * rowHeight)) + "px";
    grid.setAttribute("aria-rowcount", String(shown.length));
  }

  function show(passed) {
    shown = passed;
    body.style.height = height() + "px";
    grid.scrollTop = 0;
    draw();
  }

  function placeOf(block) {
    let low = 0, high = shown.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (shown[middle] < block) low = middle + 1; else high = middle;
    }
    return low;
  }

  /** Marks a block and brings it into sight, if the filter lets it through. */
  function choose(block) {
    chosen = block;
    const at = placeOf(block);
    if (shown[at] === block && ratio() > 0) {
      const first = grid.scrollTop * ratio();
      if (at < first) grid.scrollTop = at / ratio();
      if (at > first + room() - 1) grid.scrollTop = (at - room() + 1) / ratio();
    }
    draw();
  }

  const steps = { ArrowDown: () => 1, ArrowUp: () => -1, PageDown: room, PageUp: () => -room(),
    Home: () => -blocks.count, End: () => blocks.count };
  grid.addEventListener("keydown", (event) => {
    const step = steps[event.key];
    if (!step || shown.length === 0) return;
    event.preventDefault();
    const at = Math.max(0, Math.min(shown.length - 1, placeOf(Math.max(chosen, 0)) + (chosen < 0 ? 0 : step())));
    onChoose(shown[at]);
  });
  grid.addEventListener("click", (event) => {
    const row = event.target.closest(".grid-row");
    if (row) onChoose(Number(row.dataset.row));
  });
  grid.addEventListener("scroll", draw, { passive: true });
  new ResizeObserver(draw).observe(grid);
  // On paper there is nothing to scroll: the first rows stand there, and how many are missing.
  addEventListener("beforeprint", () => {
    rows.replaceChildren(...Array.from(shown.slice(0, mostPrinted), (i) => rowOf(blocks, i, false)));
    if (shown.length > mostPrinted)
      rows.append(cell("and " + (shown.length - mostPrinted) + " more in the file"));
    body.style.height = "auto";
  });
  addEventListener("afterprint", () => {
    body.style.height = height() + "px";
    draw();
  });
  return { show, choose };
}
