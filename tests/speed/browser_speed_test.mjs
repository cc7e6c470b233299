// How long a person waits for large pages. Argument: the folder with the pages.

import assert from "node:assert/strict";
import { openReport } from "./browser.mjs";
import { runAll, test } from "./harness.mjs";
import { find, scrollTo, sort } from "./work.mjs";

const folder = process.argv[2];

async function frameTime(act, argument) {
  const begin = performance.now();
  act(argument);
  await new Promise((done) => requestAnimationFrame(done));
  return performance.now() - begin;
}

/** How many ms pass in a page from `act(argument)` to the next frame. */
const timeToFrame = (page, act, argument) => page.evaluate(`(${frameTime})(${act}, ${JSON.stringify(argument)})`);

/**
 * The most ms to a frame on the way of a table from its first row to its last. It goes there three times,
 * and of each place the quickest counts: what else a busy machine does in between is no work of the page.
 */
async function timeToScroll(page, places = 40) {
  const times = new Array(places + 1).fill(Infinity);
  for (let round = 0; round < 3; ++round)
    for (let i = 0; i <= places; ++i) times[i] = Math.min(times[i], await timeToFrame(page, scrollTo, i / places));
  return Math.max(...times);
}

async function openTimed(browser, name) {
  const begin = Date.now();
  const { page } = await openReport(browser, `${folder}/${name}.html`);
  const opened = Date.now() - begin;
  console.log(`    opened in ${opened} ms`);
  assert.ok(opened < 5000, `opened in ${opened} ms`);
  const slowest = await timeToScroll(page);
  console.log(`    the slowest frame took ${slowest.toFixed(0)} ms`);
  assert.ok(slowest < 250, `a frame took ${slowest} ms`);
  return page;
}

test("a hundred thousand blocks open and scroll without waiting", (browser) => openTimed(browser, "long"));

test("ten thousand programs open, scroll, sort and filter without waiting", async (browser) => {
  const page = await openTimed(browser, "large"), took = [];
  for (const name of ["program", "margin", "errors"]) took.push(await timeToFrame(page, sort, name));
  for (const text of ["h", "holder comes", "clamp-3 part 77"]) took.push(await timeToFrame(page, find, text));
  const slowest = Math.max(...took);
  console.log(`    the slowest sort or filter took ${slowest.toFixed(0)} ms`);
  assert.ok(slowest < 1500, `a sort or filter took ${slowest} ms`);
});

await runAll();
