// Runs tests one after the other in one browser, and says what became of each.

import { launch } from "./browser.mjs";

const tests = [];

export function test(name, run) {
  tests.push({ name, run });
}

/** Runs them all and ends the process: with 1 if one failed. */
export async function runAll() {
  const browser = await launch();
  let failed = 0;
  for (const { name, run } of tests) {
    try {
      await run(browser);
      console.log("ok      " + name);
    } catch (error) {
      ++failed;
      console.log("FAILED  " + name + "\n" + error.message);
    }
  }
  await browser.close();
  console.log(`${tests.length - failed} passed, ${failed} failed`);
  process.exit(failed > 0 ? 1 : 0);
}

export const isWide = (page) => page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
export const lightness = (page) =>
  page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number).reduce((a, b) => a + b));
