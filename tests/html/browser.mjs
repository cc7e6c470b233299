// Opens a report in Chromium and records all its errors.

import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** How many ms anything may take before a test gives up: enough for a machine that is busy with other work. */
const patience = 180_000;

export function launch(more = []) {
  // clock: gives up after 3 min
  return chromium.launch({ executablePath: "/usr/bin/chromium", args: [...flags, ...more], timeout: patience });
}

/**
 * A report in a window of its own; `wrong` gets a line for every error and every request. `beforeOpening` is called with
 * the empty page.
 */
export async function openReport(browser, file, { width = 1400, height = 1000, colorScheme = "light", beforeOpening = async () => {}, ...more } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, ...more });
  const page = await context.newPage(), wrong = [], url = pathToFileURL(file).href;
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) wrong.push("console: " + message.text()); });
  page.on("pageerror", (error) => wrong.push("error: " + error.message));
  page.on("request", (request) => {
    if (request.url() !== url && !/^(data|blob):/.test(request.url())) wrong.push("request: " + request.url());
  });
  page.on("dialog", (dialog) => { wrong.push("dialog: " + dialog.message()); dialog.dismiss(); });
  page.setDefaultTimeout(patience); // clock: gives up after 3 min
  await beforeOpening(page);
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
  return { page, wrong };
}
