// What every page does.

function dataIn(id) {
  return JSON.parse(document.getElementById(id).textContent);
}

/** A button turns light to dark and back; `repaint` is called when the colours have changed. */
function followTheme(button, repaint) {
  const prefersDark = matchMedia("(prefers-color-scheme: dark)");
  button.addEventListener("click", () => {
    const root = document.documentElement;
    const isDark = root.dataset.theme ? root.dataset.theme === "dark" : prefersDark.matches;
    root.dataset.theme = isDark ? "light" : "dark";
    root.style.colorScheme = root.dataset.theme;
    repaint();
  });
  prefersDark.addEventListener("change", repaint);
}
