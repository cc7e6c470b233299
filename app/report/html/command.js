// The command that makes the page of one program, for copying.

/** A word quoted for a shell. */
function shellWord(text) {
  return /^[\w@%+=:,./-]+$/.test(text) ? text : "'" + text.replaceAll("'", "'\\''") + "'";
}

/** A path that no command mistakes for an option. */
function pathWord(path) {
  return shellWord(path.startsWith("-") ? "./" + path : path);
}

function commandText(programs, i) {
  const setup = programs.texts[programs.setup[i]], dialect = programs.texts[programs.dialect[i]];
  const name = partsOf(programs, i).name.replace(/\.[^.]*$/, "");
  return ["feeler check", pathWord(programs.path[i]), ...(setup ? ["--setup " + pathWord(setup)] : []),
    ...(dialect ? ["--dialect " + shellWord(dialect)] : []), "--format html -o " + pathWord(name + ".html")].join(" ");
}

/** Copies a text; if the browser refuses, selects it for copying by hand. */
async function copyText(text, element, button) {
  const say = (word) => {
    button.textContent = word;
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  };
  try {
    await navigator.clipboard.writeText(text);
    say("Copied");
  } catch {
    getSelection().selectAllChildren(element);
    say(document.execCommand("copy") ? "Copied" : "Selected");
  }
}

function commandPart(programs, i) {
  const text = commandText(programs, i), code = make("code", "", text), button = make("button", "", "Copy");
  button.type = "button";
  button.addEventListener("click", () => copyText(text, code, button));
  return make("div", "command-part", make("h4", "", "Pictures, charts, all blocks"),
    make("p", "notice", "The page of a single program shows them. Run this in the folder of the batch, with its other options:"),
    make("div", "command", code, button));
}
