// Counts the work of a page, so that a page that has become slow is noticed even on a busy machine.

import assert from "node:assert/strict";
import { openReport } from "./browser.mjs";

/** Runs in the page before its own scripts. */
function countCalls() {
  const calls = (window.countedCalls = { elements: 0, strokes: 0 });
  const count = (object, names, key) => {
    for (const name of names) {
      const inner = object[name];
      object[name] = function (...words) {
        ++calls[key];
        return inner.apply(this, words);
      };
    }
  };
  count(Document.prototype, ["createElement", "createElementNS"], "elements");
  count(Node.prototype, ["cloneNode"], "elements");
  count(CanvasRenderingContext2D.prototype,
    ["moveTo", "lineTo", "arc", "rect", "fillRect", "strokeRect", "fill", "stroke", "fillText"], "strokes");
}

/**
 * A report in a window of its own, as openReport gives it, and `work()`, which says what the page has done since it
 * was asked last:
 *   steps     how often a function or a block of its scripts was run; the same on every machine
 *   elements  how many elements its scripts made
 *   strokes   how many calls drew on a flat canvas
 *   nodes     how many elements the page has now
 */
export async function openCounted(browser, file, options = {}) {
  let client;
  const opened = await openReport(browser, file, { ...options, beforeOpening: async (page) => {
    client = await page.context().newCDPSession(page);
    await client.send("Profiler.enable");
    await client.send("Profiler.startPreciseCoverage", { callCount: true, detailed: true });
    await page.addInitScript(countCalls);
  } });
  await untilDrawn(opened.page, () => {});
  const work = async () => {
    const { result } = await client.send("Profiler.takePreciseCoverage");
    const steps = result.filter((script) => script.url.startsWith("file:")).flatMap((script) => script.functions)
      .flatMap((part) => part.ranges).reduce((sum, range) => sum + range.count, 0);
    const calls = await opened.page.evaluate(() => {
      const made = { ...window.countedCalls, nodes: document.querySelectorAll("*").length };
      Object.assign(window.countedCalls, { elements: 0, strokes: 0 });
      return made;
    });
    return { steps, ...calls };
  };
  return { ...opened, work };
}

/** Fails where work is more than it should be. */
export function assertLittle(work, most, what) {
  for (const [name, limit] of Object.entries(most))
    assert.ok(work[name] <= limit, `${what}: ${work[name]} ${name}, at most ${limit} expected`);
}

/** Does something in a page and waits until it was drawn. */
export const untilDrawn = (page, act, argument) => page.evaluate(`(async () => {
  (${act})(${JSON.stringify(argument)});
  for (let i = 0; i < 3; ++i) await new Promise((done) => requestAnimationFrame(done));
})()`);

/** Scrolls the table to a part of its height, from 0 to 1. */
export const scrollTo = (part) => {
  const grid = document.getElementById("grid");
  grid.scrollTop = part * grid.scrollHeight;
};

/** Types a text into the filter. */
export const find = (text) => {
  const words = document.getElementById("filter-text");
  words.value = text;
  words.dispatchEvent(new Event("input"));
};

/** Sorts by a column of the table of programs. */
export const sort = (name) => document.querySelector(`[data-sort="${name}"]`).click();
