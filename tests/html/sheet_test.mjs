// Prints set-up sheets and looks at the pages.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { keepPicture, runAll, test } from "./harness.mjs";

const work = process.argv[2];

/** A sheet in a window of its own; `wrong` gets a line for every error and request. */
async function openSheet(browser, name) {
  const context = await browser.newContext({ viewport: { width: 800, height: 1100 } });
  const page = await context.newPage(), wrong = [], url = pathToFileURL(join(work, name)).href;
  page.on("console", (message) => wrong.push("console: " + message.text()));
  page.on("request", (request) => {
    if (request.url() !== url && !request.url().startsWith("data:")) wrong.push("request: " + request.url());
  });
  await page.goto(url);
  return { page, wrong };
}

/** The number of pages of a PDF file by Chromium. */
const pagesOf = (pdf) => pdf.toString("latin1").match(/\/Type\s*\/Page\b(?!s)/g).length;

async function printed(page, name, format) {
  const pdf = await page.pdf({ format, preferCSSPageSize: false, margin: { top: "9mm", bottom: "11mm", left: "10mm", right: "10mm" } });
  writeFileSync(join(work, name.replace("html", format + ".pdf")), pdf);
  return pagesOf(pdf);
}

for (const name of ["clear.html", "tolerances.html", "findings.html", "inch.html", "inferred.html"])
  test(`${name} is one page on A4 and on Letter`, async (browser) => {
    const { page, wrong } = await openSheet(browser, name);
    await page.emulateMedia({ media: "print" });
    await keepPicture(page, join(work, name + ".png"), { fullPage: true });
    for (const format of ["A4", "Letter"]) assert.equal(await printed(page, name, format), 1, format);
    assert.deepEqual(wrong, []);
  });

test("many tools take several pages, and each begins with the verdict", async (browser) => {
  const { page, wrong } = await openSheet(browser, "many.html");
  const pages = await printed(page, "many.html", "A4");
  assert.ok(pages > 1 && pages < 6, `${pages} pages`);
  assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector(".sheet > thead")).display),
    "table-header-group");
  assert.deepEqual(wrong, []);
});

test("pictures are shown, and only a clear verdict is black on white", async (browser) => {
  const colours = async (name) => {
    const { page } = await openSheet(browser, name);
    const pictures = await page.evaluate(() => [...document.images].map((image) => image.naturalWidth));
    assert.deepEqual(pictures, [900, 600], name);
    return page.evaluate(() => getComputedStyle(document.querySelector(".verdict")).backgroundColor);
  };
  assert.equal(await colours("clear.html"), "rgba(0, 0, 0, 0)");
  assert.equal(await colours("findings.html"), "rgb(0, 0, 0)");
  assert.equal(await colours("inferred.html"), "rgb(0, 0, 0)");
});

test("nothing is wider than the page", async (browser) => {
  for (const name of ["clear.html", "findings.html", "inch.html", "inferred.html", "tolerances.html", "many.html"]) {
    const { page } = await openSheet(browser, name);
    await page.setViewportSize({ width: 718, height: 1000 }); // 190 mm
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, name);
  }
});

await runAll();
