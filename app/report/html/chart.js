// The chart of clearances: a bar from zero for each pixel, the least of all blocks that it covers.

const chartMargin = { left: 44, right: 8, top: 8, bottom: 24 };

function colorOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
}

/** Steps of 1, 2 or 5 times a power of ten, some `count` of them to a range. */
function niceStep(range, count) {
  const rough = range / count, power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
}

/** The least clearance, and the block that has it, for each pixel of a range of blocks. */
function leastPerPixel(blocks, placeOf, width) {
  const least = new Float64Array(width).fill(Infinity), block = new Int32Array(width).fill(-1);
  for (let i = 0; i < blocks.count; ++i) {
    if (blocks.lower[i] < 0) continue;
    const [from, to] = placeOf(i);
    if (to < 0 || from >= width) continue;
    for (let x = Math.max(0, Math.floor(from)); x < Math.min(width, Math.max(to, Math.floor(from) + 1)); ++x) {
      // Of blocks alike near, one that is not clear is the one to see.
      const worse = block[x] >= 0 && blocks.verdict[i] > blocks.verdict[block[x]];
      if (blocks.lower[i] > least[x] || (blocks.lower[i] === least[x] && !worse)) continue;
      least[x] = blocks.lower[i];
      block[x] = i;
    }
  }
  return { least, block };
}

/** Small clearances get most of the height: it goes with the root. */
function heightShare(um, top) {
  return Math.sqrt(Math.min(1, Math.max(0, um) / top));
}

/** `onChoose(block)` is told of clicks, `onPoint(block)` of the block under the pointer, -1: none. */
function makeChart(canvas, blocks, onChoose, onPoint) {
  const context = canvas.getContext("2d");
  let axis = "time", range = null, chosen = -1, drag = null, columns = null;

  const whole = () => (axis === "time" ? [0, Math.max(blocks.end, 1e-3)] : [0, Math.max(blocks.count, 1)]);
  const startOf = (i) => (axis === "time" ? blocks.time[i] : i);
  const endOf = (i) => (axis === "time" ? blocks.time[i] + durationOf(blocks, i) : i + 1);
  const inner = () => Math.max(10, Math.floor(canvas.clientWidth - chartMargin.left - chartMargin.right));
  const pixelOf = (value) => ((value - range[0]) / (range[1] - range[0])) * inner();
  const valueAt = (pixel) => range[0] + (pixel / inner()) * (range[1] - range[0]);

  const top = Math.max(blocks.limit, 1000);

  function drawAxes(height) {
    context.fillStyle = colorOf("dim");
    context.strokeStyle = colorOf("line");
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    let last = Infinity; // no label upon another
    for (const mm of [0, 0.1, 0.5, 1, 2, 5, 10, 20, 50]) {
      if (mm * 1000 > top) break;
      const y = chartMargin.top + height * (1 - heightShare(mm * 1000, top));
      if (last - y < 13) continue;
      last = y;
      context.fillText(String(mm), chartMargin.left - 6, y);
      context.beginPath();
      context.moveTo(chartMargin.left, Math.round(y) + 0.5);
      context.lineTo(chartMargin.left + inner(), Math.round(y) + 0.5);
      context.stroke();
    }
    context.textAlign = "center";
    context.textBaseline = "top";
    const step = Math.max(niceStep(range[1] - range[0], inner() / 90), axis === "time" ? 1e-3 : 1);
    for (let value = Math.ceil(range[0] / step) * step; value <= range[1]; value += step) {
      const text = axis === "time" ? (step < 1 ? value.toFixed(3) + " s" : secondsText(value)) : String(Math.round(value));
      context.fillText(text, chartMargin.left + pixelOf(value), chartMargin.top + height + 6);
    }
  }

  function drawBars(height) {
    const colors = { violation: colorOf("violation"), near: colorOf("near"), clear: colorOf("clear") };
    for (let x = 0; x < columns.block.length; ++x) {
      const i = columns.block[x];
      if (i < 0) continue;
      const tall = Math.max(height * heightShare(columns.least[x], top), 2);
      context.fillStyle = colors[stateOf(blocks, i)] || colors.clear;
      context.fillRect(chartMargin.left + x, chartMargin.top + height - tall, 1, tall);
      // A finding of which the clearance says nothing still has to be seen.
      if (stateOf(blocks, i) === "violation")
        context.fillRect(chartMargin.left + x - 1, chartMargin.top + height - 5, 3, 5);
    }
  }

  function drawMarks(height) {
    if (chosen >= 0) {
      context.fillStyle = colorOf("current");
      const x = pixelOf(startOf(chosen));
      if (x >= 0 && x <= inner()) context.fillRect(chartMargin.left + x - 1, chartMargin.top, 2, height);
    }
    if (!drag || drag.from === drag.to) return;
    context.globalAlpha = 0.25;
    context.fillStyle = colorOf("accent");
    context.fillRect(chartMargin.left + Math.min(drag.from, drag.to), chartMargin.top, Math.abs(drag.to - drag.from), height);
    context.globalAlpha = 1;
  }

  function draw() {
    const scale = devicePixelRatio || 1, height = canvas.clientHeight - chartMargin.top - chartMargin.bottom;
    if (canvas.clientWidth === 0) return;
    canvas.width = Math.round(canvas.clientWidth * scale);
    canvas.height = Math.round(canvas.clientHeight * scale);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    if (!range) range = whole();
    if (!columns || columns.block.length !== inner())
      columns = leastPerPixel(blocks, (i) => [pixelOf(startOf(i)), pixelOf(endOf(i))], inner());
    drawAxes(height);
    drawBars(height);
    drawMarks(height);
  }

  function look(fresh) {
    range = fresh;
    columns = null;
    draw();
  }

  const place = (event) => Math.max(0, Math.min(inner() - 1, Math.floor(event.offsetX - chartMargin.left)));
  // The worst within reach of a finger or a mouse.
  function blockNear(pixel) {
    let best = -1;
    for (let x = Math.max(0, pixel - 3); x <= Math.min(inner() - 1, pixel + 3); ++x)
      if (columns.block[x] >= 0 && (best < 0 || columns.least[x] < columns.least[best])) best = x;
    return best < 0 ? -1 : columns.block[best];
  }
  canvas.addEventListener("pointerdown", (event) => { drag = { from: place(event), to: place(event) }; });
  canvas.addEventListener("pointermove", (event) => {
    onPoint(blockNear(place(event)));
    if (!drag) return;
    drag.to = place(event);
    draw();
  });
  canvas.addEventListener("pointerleave", () => { onPoint(-1); });
  addEventListener("pointerup", () => {
    if (!drag) return;
    const [from, to] = [Math.min(drag.from, drag.to), Math.max(drag.from, drag.to)];
    drag = null;
    if (to - from > 5) return look([valueAt(from), valueAt(to)]);
    const block = blockNear(from);
    if (block >= 0) onChoose(block);
    draw();
  });
  canvas.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!way || blocks.count === 0) return;
    event.preventDefault();
    onChoose(Math.max(0, Math.min(blocks.count - 1, chosen + way)));
  });
  new ResizeObserver(draw).observe(canvas);
  return {
    draw,
    choose(block) { chosen = block; draw(); },
    along(name) { axis = name; look(null); },
    whole() { look(null); },
  };
}
