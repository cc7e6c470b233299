// Prints set-up sheets and looks at the pages.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";
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

/** The text of each page of a PDF file by Chromium, without line ends. */
function pagesOf(pdf) {
  const text = pdf.toString("latin1"), objects = new Map();
  for (const [, number, body] of text.matchAll(/\n(\d+) 0 obj\n(.*?)\nendobj/gs)) objects.set(number, body);
  const streamOf = (number) => {
    const bytes = objects.get(number).match(/stream\n(.*)\nendstream/s)[1];
    return inflateSync(Buffer.from(bytes, "latin1")).toString("latin1");
  };
  const fonts = new Map();
  for (const [number, body] of objects) {
    const names = body.match(/\/ToUnicode (\d+) 0 R/);
    if (names) fonts.set(number, lettersOf(streamOf(names[1])));
  }
  return [...objects.values()].filter((body) => /\/Type \/Page\n/.test(body)).map((body) => {
    let letters = new Map(), words = "";
    const pieces = streamOf(body.match(/\/Contents (\d+) 0 R/)[1]).matchAll(/\/F(\d+) [\d.]+ Tf|<([0-9A-F]+)> Tj/g);
    for (const [, font, glyphs] of pieces)
      if (font) letters = fonts.get(font) ?? new Map();
      else words += glyphs.match(/.{1,4}/g).map((glyph) => letters.get(parseInt(glyph, 16)) ?? "?").join("");
    return words;
  });
}

/** The letter of each glyph by the ToUnicode table of a font. */
function lettersOf(table) {
  const letters = new Map();
  for (const [, chars] of table.matchAll(/beginbfchar\n(.*?)endbfchar/gs))
    for (const [, glyph, code] of chars.matchAll(/<(\w+)> <(\w{4})/g))
      letters.set(parseInt(glyph, 16), String.fromCharCode(parseInt(code, 16)));
  for (const [, ranges] of table.matchAll(/beginbfrange\n(.*?)endbfrange/gs))
    for (const [, first, last, code] of ranges.matchAll(/<(\w+)> <(\w+)> <(\w+)>/g))
      for (let i = parseInt(first, 16); i <= parseInt(last, 16); ++i)
        letters.set(i, String.fromCharCode(parseInt(code, 16) + i - parseInt(first, 16)));
  return letters;
}

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
    for (const format of ["A4", "Letter"]) assert.equal((await printed(page, name, format)).length, 1, format);
    assert.deepEqual(wrong, []);
  });

test("many tools take several pages, and each begins with the heading", async (browser) => {
  const { page, wrong } = await openSheet(browser, "many.html");
  for (const format of ["A4", "Letter"]) {
    const pages = await printed(page, "many.html", format);
    assert.ok(pages.length > 1 && pages.length < 6, `${pages.length} pages`);
    pages.forEach((text, i) => {
      assert.match(text, new RegExp(`page ${i + 1} of ${pages.length}`));
      assert.match(text, /Set-up sheet · fanuc.*many\.nc.*NO ERROR IN THE PROGRAM ITSELF/);
      assert.match(text, /Stick-out.*Speed, rev\/min/);
    });
    for (let tool = 1; tool <= 60; ++tool)
      assert.equal(pages.filter((text) => text.includes(`H${tool}: measure it`)).length, 1, `tool ${tool}`);
  }
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
