// Runs tests one after the other in one browser and prints the result of each.

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
    for (const context of browser.contexts()) await context.close();
  }
  await browser.close();
  console.log(`${tests.length - failed} passed, ${failed} failed`);
  process.exit(failed > 0 ? 1 : 0);
}

export const isWide = (page) => page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
export const lightness = (page) =>
  page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number).reduce((a, b) => a + b));

/** Keeps a picture of a page. A browser on a busy machine now and then has none at the first time. */
export async function keepPicture(page, path, more = {}) {
  for (let left = 2; ; --left) {
    try {
      return await page.screenshot({ path, ...more });
    } catch (error) {
      if (left === 0) throw error;
    }
  }
}
