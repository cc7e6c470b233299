// The page of one program: connects findings, view, chart and table. A block selected in one is
// shown in all.

/** `pair`: the bodies that the view shows; their clearance is known only if they decide the block. */
function captionOf(blocks, i, pair = ["", ""]) {
  const words = ["Block " + i, "line " + lineText(blocks, i), blocks.texts[blocks.text[i]]];
  const names = pair[0] ? pair[0] + " / " + pair[1] : pairText(blocks, i);
  const clearance = names === pairText(blocks, i) ? clearanceWithPair(blocks, i) : names;
  if (clearance) words.push(clearance);
  const rules = rulesText(blocks, i);
  if (rules) words.push(rules);
  return words.join(" \u00b7 ");
}

/** The picture of a view, if a card has one. */
function pictureOf(view) {
  const image = document.querySelector('.shot[data-view="' + view + '"] img');
  return image ? image.src : "";
}

/** The 3D view, or the pictures without WebGL; null if there is neither. */
function makeView(panel, data) {
  const stage = panel.querySelector(".stage"), buttons = panel.querySelector(".buttons");
  const scenes = data.views.map((view) => view.scene);
  const solid = window.FeelerView && scenes.some(Boolean)
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
    has: (index) => index >= 0 && (solid ? Boolean(scenes[index]) : pictureOf(index) !== ""),
    show(index, caption) {
      if (solid) solid.show(scenes[index]); else image.src = pictureOf(index);
      panel.querySelector(".caption").textContent = caption;
      panel.dataset.block = String(data.views[index].block);
      panel.dataset.view = String(index);
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

  /** Shows a block; `index`: the view to show, because a block has one for each pair with a finding. */
  function choose(block, index = views.views.findIndex((entry) => entry.block === block)) {
    chart.choose(block);
    table.choose(block);
    by("chart-read").textContent = captionOf(blocks, block);
    const isShown = view && view.has(index);
    if (isShown) view.show(index, captionOf(blocks, block, views.views[index].pair));
    for (const card of document.querySelectorAll(".card"))
      card.classList.toggle("shown", isShown && card.querySelector('[data-view="' + index + '"]') !== null);
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
    } else if (choose(Number(button.dataset.block), button.dataset.view === undefined ? -1 : Number(button.dataset.view))) {
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
  const first = views.views.findIndex((entry, index) => view && view.has(index));
  if (first >= 0) choose(views.views[first].block, first);
  document.documentElement.dataset.ready = "true";
}

startPage();
