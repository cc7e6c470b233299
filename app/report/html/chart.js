// The chart of clearances: a bar per pixel, for the worst block that the pixel covers.

const chartMargin = { left: 44, right: 8, top: 8, bottom: 24 };

function colorOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
}

/** A step of 1, 2 or 5 times a power of ten that divides `range` into about `count`. */
function niceStep(range, count) {
  const rough = range / count, power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
}

/** For each pixel, the worst block that it covers; -1 if nothing is known of any. */
function worstPerPixel(blocks, placeOf, width) {
  const worst = new Int32Array(width).fill(-1);
  for (let i = 0; i < blocks.count; ++i) {
    if (badnessOf(blocks, i) < 0) continue;
    const [from, to] = placeOf(i);
    if (to < 0 || from > width) continue;
    // Blocks without duration get a pixel, too, even at the end of the range.
    const first = Math.min(Math.floor(from), width - 1);
    for (let x = Math.max(0, first); x < Math.min(width, Math.max(to, first + 1)); ++x)
      if (isWorse(blocks, i, worst[x])) worst[x] = i;
  }
  return worst;
}

/** Square root scale: small clearances get most of the height. */
function heightShare(um, top) {
  return Math.sqrt(Math.min(1, Math.max(0, um) / top));
}

class Chart {
  /** Calls `onChoose(block)` on clicks and `onPoint(block)` for the block under the pointer (-1: none). */
  constructor(canvas, blocks, onChoose, onPoint) {
    Object.assign(this, { canvas, blocks, onChoose, onPoint, axis: "time", range: null, chosen: -1, drag: null, worst: null });
    this.context = canvas.getContext("2d");
    this.top = Math.max(blocks.limit, 1000); // um
    canvas.addEventListener("pointerdown", (event) => { this.drag = { from: this.place(event), to: this.place(event) }; });
    canvas.addEventListener("pointermove", (event) => this.onMove(event));
    canvas.addEventListener("pointerleave", () => { onPoint(-1); });
    addEventListener("pointerup", () => this.onRelease());
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  choose(block) {
    this.chosen = block;
    this.draw();
  }
  along(name) {
    this.axis = name;
    this.look(null);
  }
  /** Shows a range of the axis; null: the whole program. */
  look(range) {
    this.range = range;
    this.worst = null;
    this.draw();
  }

  whole() {
    return this.axis === "time" ? [0, Math.max(this.blocks.end, 1e-3)] : [0, Math.max(this.blocks.count, 1)];
  }
  startOf(i) { return this.axis === "time" ? this.blocks.time[i] : i; }
  endOf(i) { return this.axis === "time" ? this.blocks.time[i] + durationOf(this.blocks, i) : i + 1; }
  width() { return Math.max(10, Math.floor(this.canvas.clientWidth - chartMargin.left - chartMargin.right)); }
  height() { return this.canvas.clientHeight - chartMargin.top - chartMargin.bottom; }
  pixelOf(value) { return ((value - this.range[0]) / (this.range[1] - this.range[0])) * this.width(); }
  valueAt(pixel) { return this.range[0] + (pixel / this.width()) * (this.range[1] - this.range[0]); }
  heightOf(um) { return chartMargin.top + this.height() * (1 - heightShare(um, this.top)); }

  draw() {
    const { canvas, context } = this, scale = devicePixelRatio || 1;
    if (canvas.clientWidth === 0) return;
    canvas.width = Math.round(canvas.clientWidth * scale);
    canvas.height = Math.round(canvas.clientHeight * scale);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    this.range ||= this.whole();
    if (!this.worst || this.worst.length !== this.width())
      this.worst = worstPerPixel(this.blocks, (i) => [this.pixelOf(this.startOf(i)), this.pixelOf(this.endOf(i))], this.width());
    context.fillStyle = colorOf("dim");
    context.strokeStyle = colorOf("line");
    context.font = "11px system-ui, sans-serif";
    this.drawHeights();
    this.drawAxis();
    this.drawBars();
    this.drawMarks();
    this.drawAlarms();
  }

  drawHeights() {
    const { context } = this;
    context.textAlign = "right";
    context.textBaseline = "middle";
    let last = Infinity; // labels must not overlap
    for (const mm of [0, 0.1, 0.5, 1, 2, 5, 10, 20, 50]) {
      const y = this.heightOf(mm * 1000);
      if (mm * 1000 > this.top || last - y < 13) continue;
      last = y;
      context.fillText(String(mm), chartMargin.left - 6, y);
      context.beginPath();
      context.moveTo(chartMargin.left, Math.round(y) + 0.5);
      context.lineTo(chartMargin.left + this.width(), Math.round(y) + 0.5);
      context.stroke();
    }
  }

  drawAxis() {
    const { context, range, axis } = this, least = axis === "time" ? 1e-3 : 1;
    context.textAlign = "center";
    context.textBaseline = "top";
    const step = Math.max(niceStep(range[1] - range[0], this.width() / 90), least);
    const text = (value) => (axis === "block" ? String(Math.round(value)) : step < 1 ? value.toFixed(3) + " s" : secondsText(value));
    for (let value = Math.ceil(range[0] / step) * step; value <= range[1]; value += step) {
      // Keeps the last label inside the right border.
      const label = text(value), most = this.canvas.clientWidth - context.measureText(label).width / 2 - 1;
      context.fillText(label, Math.min(chartMargin.left + this.pixelOf(value), most), chartMargin.top + this.height() + 6);
    }
  }

  drawBars() {
    const { worst, blocks } = this, colors = { near: colorOf("near"), clear: colorOf("clear") };
    for (let x = 0; x < worst.length; ++x)
      if (worst[x] >= 0 && stateOf(blocks, worst[x]) !== "violation") this.drawBar(x, colors[stateOf(blocks, worst[x])]);
  }

  drawBar(x, color) {
    const foot = chartMargin.top + this.height(), tall = Math.max(foot - this.heightOf(this.blocks.lower[this.worst[x]]), 2);
    this.context.fillStyle = color;
    this.context.fillRect(chartMargin.left + x, foot - tall, 1, tall);
  }

  /** Draws blocks that are not clear or have an error on top, with a foot, even if no clearance is known. */
  drawAlarms() {
    const { context, worst, blocks } = this, color = colorOf("violation"), foot = chartMargin.top + this.height();
    for (let x = 0; x < worst.length; ++x) {
      if (worst[x] < 0 || stateOf(blocks, worst[x]) !== "violation") continue;
      this.drawBar(x, color);
      context.fillRect(chartMargin.left + x - 1, foot - 5, 3, 5);
    }
  }

  drawMarks() {
    const { context, chosen, drag } = this, height = this.height();
    const x = chosen < 0 ? -1 : this.pixelOf(this.startOf(chosen));
    context.fillStyle = colorOf("current");
    if (x >= 0 && x <= this.width()) context.fillRect(chartMargin.left + x - 1, chartMargin.top, 2, height);
    if (!drag || drag.from === drag.to) return;
    context.globalAlpha = 0.25;
    context.fillStyle = colorOf("accent");
    context.fillRect(chartMargin.left + Math.min(drag.from, drag.to), chartMargin.top, Math.abs(drag.to - drag.from), height);
    context.globalAlpha = 1;
  }

  place(event) {
    return Math.max(0, Math.min(this.width() - 1, Math.floor(event.offsetX - chartMargin.left)));
  }

  /** The worst block within 3 pixels; -1: none. */
  blockNear(pixel) {
    let worst = -1;
    for (let x = Math.max(0, pixel - 3); x <= Math.min(this.width() - 1, pixel + 3); ++x)
      if (isWorse(this.blocks, this.worst[x], worst)) worst = this.worst[x];
    return worst;
  }

  onMove(event) {
    this.onPoint(this.blockNear(this.place(event)));
    if (!this.drag) return;
    this.drag.to = this.place(event);
    this.draw();
  }

  onRelease() {
    if (!this.drag) return;
    const from = Math.min(this.drag.from, this.drag.to), to = Math.max(this.drag.from, this.drag.to);
    this.drag = null;
    if (to - from > 5) return this.look([this.valueAt(from), this.valueAt(to)]);
    const block = this.blockNear(from);
    if (block >= 0) this.onChoose(block);
    this.draw();
  }

  onKey(event) {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!way || this.blocks.count === 0) return;
    event.preventDefault();
    this.onChoose(Math.max(0, Math.min(this.blocks.count - 1, this.chosen + way)));
  }
}
