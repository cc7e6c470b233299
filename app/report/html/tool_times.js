// Time of each tool by kind of motion.

function addToolTimes(body, blocks) {
  const tools = new Map();
  for (let i = 0; i < blocks.count; ++i) {
    const tool = blocks.tool[i];
    if (!tools.has(tool)) tools.set(tool, { feed: 0, rapid: 0, still: 0, removed: 0 });
    const entry = tools.get(tool), motion = motions[blocks.motion[i]];
    entry[motion === "none" ? "still" : motion === "rapid" ? "rapid" : "feed"] += durationOf(blocks, i);
    entry.removed += blocks.removed[i];
  }
  const total = (entry) => entry.feed + entry.rapid + entry.still;
  const most = Math.max(1e-9, ...Array.from(tools.values(), total));
  for (const [tool, entry] of tools) {
    if (total(entry) === 0 && entry.removed === 0) continue;
    const row = body.insertRow(), bar = document.createElement("div");
    row.insertCell().textContent = tool < 0 ? "none" : "T" + tool;
    row.insertCell().textContent = secondsText(total(entry));
    bar.className = "bar";
    for (const kind of ["feed", "rapid", "still"]) {
      const part = document.createElement("i");
      part.className = "mark " + kind;
      part.style.margin = "0";
      part.style.width = (100 * entry[kind]) / most + "%";
      part.title = kind + ": " + secondsText(entry[kind]);
      bar.append(part);
    }
    row.insertCell().append(bar);
    row.insertCell().textContent = entry.removed.toFixed(1) + " mm\u00b3";
  }
}
