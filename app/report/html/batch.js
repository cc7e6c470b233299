// The page of many programs: connects counts, rules, filter, table and the open program.

const mostCardsPrinted = 40;

function startBatch() {
  const programs = unpackPrograms(dataIn("batch-data")), by = (id) => document.getElementById(id);
  const table = new Table(by("grid"), (i) => programRow(programs, i), open);
  const sort = { column: "outcome", isDown: true };
  let shown = [];

  function open(i, isClick) {
    by("program").replaceChildren(programCard(programs, i));
    by("program").hidden = false;
    by("program").scrollTop = 0;
    by("program").dataset.program = String(i);
    document.querySelector(".list-and-program").classList.add("open");
    table.choose(i);
    if (isClick && !matchMedia("(min-width: 1150px)").matches) by("program").scrollIntoView();
  }

  function close() {
    by("program").hidden = true;
    document.querySelector(".list-and-program").classList.remove("open");
    table.choose(-1);
    by("grid").focus({ preventScroll: true });
    by("grid").scrollIntoView({ block: "nearest" });
  }

  function filter() {
    const outcome = by("filter-outcome").value, rule = by("filter-rule").value;
    const passed = passedPrograms(programs, by("filter-text").value, outcome, rule);
    shown = sortedPrograms(programs, passed, sort.column, sort.isDown);
    table.show(shown);
    by("filter-count").textContent = shown.length + " of " + programs.count + " programs";
    for (const tile of document.querySelectorAll(".tile")) tile.setAttribute("aria-pressed", String(tile.dataset.outcome === outcome));
    for (const button of document.querySelectorAll("[data-rule]")) button.setAttribute("aria-pressed", String(button.dataset.rule === rule));
  }

  function sortBy(column) {
    sort.isDown = sort.column === column ? !sort.isDown : !startsLow.includes(column);
    sort.column = column;
    showOrder();
    filter();
  }

  function showOrder() {
    for (const button of document.querySelectorAll("[data-sort]"))
      button.parentElement.setAttribute("aria-sort",
        button.dataset.sort !== sort.column ? "none" : sort.isDown ? "descending" : "ascending");
  }

  /** Sets one field of the filter, or resets it if it has that value, and shows the table. */
  function toggle(id, value, none) {
    by(id).value = by(id).value === value ? none : value;
    filter();
    by("programs").scrollIntoView();
  }

  function addChoices() {
    for (const outcome of [...new Set(programs.outcome)].sort((a, b) => b - a))
      by("filter-outcome").append(new Option(outcomes[outcome], String(outcome)));
    for (const rule of [...programs.findings.rules].sort()) by("filter-rule").append(new Option(rule, rule));
  }

  /** When printing, cards of the programs with errors follow the table. */
  function print() {
    const bad = Array.from(shown).filter((i) => programs.errors[i] > 0 || programs.failure.has(i));
    by("printed").replaceChildren(...bad.slice(0, mostCardsPrinted).map((i) => programCard(programs, i)));
    if (bad.length > mostCardsPrinted)
      by("printed").append(make("p", "notice", "and " + (bad.length - mostCardsPrinted) + " more programs with errors in the file"));
  }

  document.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    const { outcome, rule, program, sort: column } = button.dataset;
    if (button.dataset.lost) toggle("filter-outcome", "lost", "lost");
    if (button.dataset.close) close();
    if (outcome !== undefined) toggle("filter-outcome", outcome, "all");
    if (rule !== undefined) toggle("filter-rule", rule, "");
    if (column !== undefined) sortBy(column);
    if (program === undefined) return;
    by("programs").scrollIntoView();
    open(Number(program), true);
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !by("program").hidden) close();
  });
  by("filter-none").addEventListener("click", () => {
    [by("filter-text").value, by("filter-outcome").value, by("filter-rule").value] = ["", "all", ""];
    filter();
  });
  for (const id of ["filter-text", "filter-outcome", "filter-rule"]) by(id).addEventListener("input", filter);
  addEventListener("beforeprint", print);
  addEventListener("afterprint", () => by("printed").replaceChildren());
  followTheme(by("theme"), () => {});
  addChoices();
  by("hint").textContent = "Click opens a program, Esc closes it." + (programs.folder ? " Folders are relative to " + programs.folder : "");
  showOrder();
  filter();
  document.documentElement.dataset.ready = "true";
}

startBatch();
