// A table for any number of rows: only visible rows exist.

const rowHeight = 26;
const headHeight = 30;
const tallest = 8e6; // px: browsers lay out little more
const mostPrinted = 400;

function cell(text, name) {
  const span = document.createElement("span");
  span.textContent = text;
  span.title = text;
  span.setAttribute("role", "cell");
  if (name) span.className = name;
  return span;
}

function row(state, cells) {
  const made = document.createElement("div");
  made.className = "grid-row " + state;
  made.setAttribute("role", "row");
  made.append(...cells);
  return made;
}

class Table {
  /** `rowOf(i)` makes the row of an entry; `onChoose(i, isClick)` is called on clicks and keys. */
  constructor(grid, rowOf, onChoose) {
    const shown = new Int32Array(0); // entries, in the order of their rows
    Object.assign(this, { grid, rowOf, onChoose, shown, chosen: -1 });
    this.body = grid.querySelector(".grid-body");
    this.rows = grid.querySelector(".grid-rows");
    grid.addEventListener("keydown", (event) => this.onKey(event));
    grid.addEventListener("click", (event) => {
      const row = event.target.closest(".grid-row");
      if (row) onChoose(Number(row.dataset.row), true);
    });
    grid.addEventListener("scroll", () => this.draw(), { passive: true });
    new ResizeObserver(() => this.draw()).observe(grid);
    addEventListener("beforeprint", () => this.toPaper());
    addEventListener("afterprint", () => this.fromPaper());
  }

  /** Number of visible rows. */
  room() { return Math.max(1, Math.floor((this.grid.clientHeight - headHeight) / rowHeight)); }
  height() { return Math.min(this.shown.length * rowHeight, tallest); }
  /** Rows per pixel of scrolling; larger than 1 / rowHeight if the table is higher than `tallest`. */
  ratio() {
    const way = this.height() - this.room() * rowHeight;
    return way > 0 ? (this.shown.length - this.room()) / way : 0;
  }

  rowAt(k) {
    const entry = this.shown[k], made = this.rowOf(entry), isChosen = entry === this.chosen;
    made.classList.toggle("chosen", isChosen);
    made.setAttribute("aria-selected", String(isChosen));
    made.dataset.row = String(entry);
    return made;
  }

  draw() {
    const { grid, shown } = this, ratio = this.ratio(), place = grid.scrollTop * ratio;
    const first = Math.max(0, Math.min(Math.floor(place), shown.length - this.room()));
    const last = Math.min(shown.length, first + this.room() + 2);
    const fresh = [];
    for (let k = first; k < last; ++k) fresh.push(this.rowAt(k));
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

  /** Marks an entry and scrolls to its row, if it is shown. */
  choose(entry) {
    this.chosen = entry;
    const at = this.shown.indexOf(entry), ratio = this.ratio();
    if (at >= 0 && ratio > 0) {
      const first = this.grid.scrollTop * ratio;
      if (at < first) this.grid.scrollTop = at / ratio;
      if (at > first + this.room() - 1) this.grid.scrollTop = (at - this.room() + 1) / ratio;
    }
    this.draw();
  }

  onKey(event) {
    const { shown } = this, room = this.room(), at = shown.indexOf(this.chosen);
    const steps = { ArrowDown: 1, ArrowUp: -1, PageDown: room, PageUp: -room, Home: -shown.length, End: shown.length };
    const step = steps[event.key];
    if (step === undefined || shown.length === 0) return;
    event.preventDefault();
    const next = at < 0 ? 0 : at + step; // the first, if none is chosen
    this.onChoose(shown[Math.max(0, Math.min(shown.length - 1, next))]);
  }

  /** Paper does not scroll: prints the first rows and the number of the others. */
  toPaper() {
    const { rows, shown } = this;
    rows.replaceChildren(...Array.from(shown.slice(0, mostPrinted), this.rowOf));
    if (shown.length > mostPrinted) rows.append(cell("and " + (shown.length - mostPrinted) + " more in the file"));
    this.body.style.height = "auto";
  }

  fromPaper() {
    this.body.style.height = this.height() + "px";
    this.draw();
  }
}
