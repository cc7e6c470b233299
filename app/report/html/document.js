// Functions used by every page.

function dataIn(id) {
  return JSON.parse(document.getElementById(id).textContent);
}

/** Lets a button switch between light and dark; `repaint` is called after the colours change. */
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
