// The page of one program: connects findings, view, chart and table. A block selected in one is
// shown in all.

function captionOf(blocks, i) {
  const words = ["Block " + i, "line " + lineText(blocks, i), blocks.texts[blocks.text[i]]];
  const clearance = clearanceText(blocks, i);
  if (clearance) words.push(clearance + " mm " + pairText(blocks, i));
  const rules = rulesText(blocks, i);
  if (rules) words.push(rules);
  return words.join(" \u00b7 ");
}

/** The picture of a block, if a card has one. */
function pictureOf(block) {
  const image = document.querySelector('.shot[data-block="' + block + '"] img');
  return image ? image.src : "";
}

/** The 3D view, or the pictures without WebGL; null if there is neither. */
function makeView(panel, data) {
  const stage = panel.querySelector(".stage"), buttons = panel.querySelector(".buttons");
  const known = new Map(data.views.map((view) => [view.block, view.scene]));
  const solid = window.FeelerView && [...known.values()].some(Boolean)
    ? window.FeelerView.make(stage, buttons, data.meshes, colorOf) : null;
  if (!solid && !window.FeelerView) return null;
  if (!solid && !document.querySelector(".shot")) return null;
  const image = document.createElement("img");
  if (!solid) {
    image.alt = "";
    stage.append(image);
    stage.removeAttribute("role");
    stage.setAttribute("aria-label", "Picture");
  }
  panel.hidden = false;
  panel.parentElement.classList.add("with-view");
  return {
    isSolid: Boolean(solid),
    has: (block) => (solid ? Boolean(known.get(block)) : pictureOf(block) !== ""),
    show(block, caption) {
      if (solid) solid.show(known.get(block)); else image.src = pictureOf(block);
      panel.querySelector(".caption").textContent = caption;
      panel.dataset.block = String(block);
    },
    recolor() { if (solid) solid.recolor(); },
  };
}

function startPage() {
  const blocks = unpackBlocks(dataIn("block-data")), views = dataIn("view-data");
  const by = (id) => document.getElementById(id);
  const view = makeView(by("view"), views);
  const chart = new Chart(by("clearance-chart"), blocks, (block) => choose(block), (block) => {
    by("chart-read").textContent = block < 0 ? "" : captionOf(blocks, block);
  });
  const table = new Table(by("grid"), (block) => blockRow(blocks, block), (block) => choose(block));

  function choose(block) {
    chart.choose(block);
    table.choose(block);
    by("chart-read").textContent = captionOf(blocks, block);
    const isShown = view && view.has(block);
    if (isShown) view.show(block, captionOf(blocks, block));
    for (const card of document.querySelectorAll(".card"))
      card.classList.toggle("shown", isShown && card.querySelector('[data-block="' + block + '"]') !== null);
    return isShown;
  }

  function filter() {
    const passed = passedBlocks(blocks, by("filter-text").value, by("filter-verdict").value, Number(by("filter-near").value));
    table.show(passed);
    by("filter-count").textContent = passed.length + " of " + blocks.count + " blocks";
  }

  document.querySelector(".cards").addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    if (button.dataset.rule !== undefined) {
      by("filter-text").value = button.dataset.rule;
      filter();
    } else if (choose(Number(button.dataset.block))) {
      return;
    }
    by("blocks").scrollIntoView();
  });
  for (const id of ["filter-text", "filter-verdict", "filter-near"]) by(id).addEventListener("input", filter);
  by("chart-axis").addEventListener("input", (event) => chart.along(event.target.value));
  by("chart-all").addEventListener("click", () => chart.look(null));
  const repaint = () => {
    chart.draw();
    if (view) view.recolor();
  };
  followTheme(by("theme"), repaint);
  addToolTimes(document.querySelector("#tool-times tbody"), blocks);
  filter();
  const first = views.views.find((entry) => view && view.has(entry.block));
  if (first) choose(first.block);
  document.documentElement.dataset.ready = "true";
}

startPage();
