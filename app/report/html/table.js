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

class Table {
  /** `onChoose(block)` is told of clicks and keys. */
  constructor(grid, blocks, onChoose) {
    const shown = new Int32Array(0); // blocks
    Object.assign(this, { grid, blocks, onChoose, shown, chosen: -1 });
    this.body = grid.querySelector(".grid-body");
    this.rows = grid.querySelector(".grid-rows");
    grid.addEventListener("keydown", (event) => this.onKey(event));
    grid.addEventListener("click", (event) => {
      const row = event.target.closest(".grid-row");
      if (row) onChoose(Number(row.dataset.row));
    });
    grid.addEventListener("scroll", () => this.draw(), { passive: true });
    new ResizeObserver(() => this.draw()).observe(grid);
    addEventListener("beforeprint", () => this.toPaper());
    addEventListener("afterprint", () => this.fromPaper());
  }

  /** Rows that fit into sight. */
  room() { return Math.max(1, Math.floor((this.grid.clientHeight - headHeight) / rowHeight)); }
  height() { return Math.min(this.shown.length * rowHeight, tallest); }
  /** Rows to a pixel of scrolling: beyond `tallest` a pixel is more than a pixel of rows. */
  ratio() {
    const way = this.height() - this.room() * rowHeight;
    return way > 0 ? (this.shown.length - this.room()) / way : 0;
  }

  draw() {
    const { grid, shown } = this, ratio = this.ratio(), place = grid.scrollTop * ratio;
    const first = Math.max(0, Math.min(Math.floor(place), shown.length - this.room()));
    const last = Math.min(shown.length, first + this.room() + 2);
    const fresh = [];
    for (let k = first; k < last; ++k) fresh.push(rowOf(this.blocks, shown[k], shown[k] === this.chosen));
    this.rows.replaceChildren(...fresh);
    const top = ratio > 0 ? grid.scrollTop - (place - first) * rowHeight : 0;
    this.rows.style.top = Math.max(0, Math.min(top, this.height() - fresh.length * rowHeight)) + "px";
    grid.setAttribute("aria-rowcount", String(shown.length));
  }

  show(passed) {
    this.shown = passed;
    this.body.style.height = this.height() + "px";
    this.grid.scrollTop = 0;
    this.draw();
  }

  /** Where a block is among those shown, or would be. */
  placeOf(block) {
    let low = 0, high = this.shown.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.shown[middle] < block) low = middle + 1; else high = middle;
    }
    return low;
  }

  /** Marks a block and brings it into sight, if the filter lets it through. */
  choose(block) {
    this.chosen = block;
    const at = this.placeOf(block), ratio = this.ratio();
    if (this.shown[at] === block && ratio > 0) {
      const first = this.grid.scrollTop * ratio;
      if (at < first) this.grid.scrollTop = at / ratio;
      if (at > first + this.room() - 1) this.grid.scrollTop = (at - this.room() + 1) / ratio;
    }
    this.draw();
  }

  onKey(event) {
    const { shown, chosen } = this, room = this.room();
    const steps = { ArrowDown: 1, ArrowUp: -1, PageDown: room, PageUp: -room, Home: -shown.length, End: shown.length };
    const step = steps[event.key];
    if (step === undefined || shown.length === 0) return;
    event.preventDefault();
    const from = this.placeOf(Math.max(chosen, 0)) + (chosen < 0 ? 0 : step);
    this.onChoose(shown[Math.max(0, Math.min(shown.length - 1, from))]);
  }

  /** On paper there is nothing to scroll: the first rows stand there, and how many are missing. */
  toPaper() {
    const { rows, shown } = this;
    rows.replaceChildren(...Array.from(shown.slice(0, mostPrinted), (i) => rowOf(this.blocks, i, false)));
    if (shown.length > mostPrinted) rows.append(cell("and " + (shown.length - mostPrinted) + " more in the file"));
    this.body.style.height = "auto";
  }

  fromPaper() {
    this.body.style.height = this.height() + "px";
    this.draw();
  }
}
