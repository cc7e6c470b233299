// Uses the page of a batch as a person does. Argument: the folder with the pages; pictures go there.

import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { openReport } from "./browser.mjs";
import { isWide, keepPicture, lightness, runAll, test } from "./harness.mjs";
import { assertLittle, find, openCounted, scrollTo, sort, untilDrawn } from "./work.mjs";

const folder = process.argv[2];
const report = (name) => `${folder}/${name}.html`;

const countText = (page) => page.locator("#filter-count").textContent();
const rowTexts = (page) => page.locator(".grid-row").allTextContents();
const cells = (page, column) => page.locator(`.grid-row > span:nth-child(${column})`).allTextContents();
const sortBy = (page, name) => page.locator(".grid-head").getByText(name, { exact: true }).click();
const openProgram = (page, name) => page.locator(".grid-row", { hasText: name }).first().click();

for (const colorScheme of ["light", "dark"])
  for (const width of [1400, 400])
    for (const name of ["shop", "good"])
      test(`${name}, ${colorScheme}, ${width} px wide: opens without an error or a request, nothing sticks out`, async (browser) => {
        const { page, wrong } = await openReport(browser, report(name), { width, colorScheme });
        await keepPicture(page, `${folder}/batch-${name}-${colorScheme}-${width}.png`, { fullPage: true });
        assert.equal(await isWide(page), false);
        await page.locator(".grid-row").first().click();
        assert.equal(await page.locator("#program").isVisible(), true);
        assert.equal(await isWide(page), false);
        await keepPicture(page, `${folder}/batch-${name}-${colorScheme}-${width}-open.png`, { fullPage: true });
        assert.equal((await lightness(page)) > 384, colorScheme === "light");
        assert.deepEqual(wrong, []);
      });

test("what is missing is said before all else, and a click shows it", async (browser) => {
  const { page } = await openReport(browser, report("shop"));
  assert.equal(await page.title(), "1 of 6 programs not checked to the end");
  assert.match(await page.locator(".missing").textContent(), /1 of 6 programs could not be run to the end.*G999/s);
  const tops = await page.evaluate(() => [".missing", ".tiles", "#grid"].map((name) => document.querySelector(name).getBoundingClientRect().top));
  assert.deepEqual(tops, [...tops].sort((a, b) => a - b));
  await page.locator(".missing button").click();
  assert.equal(await countText(page), "1 of 6 programs");
});

test("the worst program comes first, columns sort both ways", async (browser) => {
  const { page } = await openReport(browser, report("shop"));
  const names = async () => (await cells(page, 1)).map((text) => text.trim().split(" vise/")[0].split(" air/")[0]);
  assert.deepEqual((await cells(page, 2)).slice(0, 3), ["stopped", "collision", "collision"]);
  await sortBy(page, "Program");
  const up = await names();
  assert.ok(up.indexOf("part 9.nc") < up.indexOf("part 10.nc"), up.join());
  await sortBy(page, "Program");
  assert.deepEqual(await names(), [...up].reverse());
  await sortBy(page, "Errors");
  const errors = (await cells(page, 5)).map(Number);
  assert.deepEqual(errors, [...errors].sort((a, b) => b - a));
  assert.ok(errors[0] > errors[5]);
  await sortBy(page, "Margin mm");
  const margins = (await cells(page, 3)).filter(Boolean).map((text) => Number(text.replace("\u2265 ", "")));
  assert.deepEqual(margins, [...margins].sort((a, b) => a - b));
  assert.ok(margins[0] < 0);
  assert.equal(await page.locator('[aria-sort="ascending"]').textContent(), "Margin mm");
});

test("words, verdict and rule filter, and a click on a rule or a number does", async (browser) => {
  const { page, wrong } = await openReport(browser, report("shop"));
  assert.equal(await countText(page), "6 of 6 programs");
  for (const [words, count] of [["part 10", 1], ["geh\u00e4use", 1], ["strap-2", 2], ["G999", 1], ["collision strap-1", 2], ["no such words", 0], ["", 6]]) {
    await page.locator("#filter-text").fill(words);
    assert.equal(await countText(page), `${count} of 6 programs`, words);
  }
  await page.locator("#filter-outcome").selectOption("bad");
  assert.equal(await countText(page), "2 of 6 programs");
  await page.locator("#filter-none").click();
  await page.locator('[data-rule="rapid-near-clamp"], [data-rule="collision"]').first().click();
  const rule = await page.locator("#filter-rule").inputValue();
  assert.ok(["rapid-near-clamp", "collision"].includes(rule));
  assert.equal(await countText(page), "2 of 6 programs");
  await page.locator(`[data-rule="${rule}"]`).first().click();
  assert.equal(await countText(page), "6 of 6 programs");
  const tile = page.locator(".tile", { hasText: "collision" });
  await tile.click();
  assert.equal(await countText(page), "2 of 6 programs");
  assert.equal(await tile.getAttribute("aria-pressed"), "true");
  assert.deepEqual(wrong, []);
});

test("the name of a subprogram's file finds the programs in which it went wrong", async (browser) => {
  const { page } = await openReport(browser, report("sub"));
  for (const [word, program] of [["o2000.nc", "main.nc"], ["O3000", "broken.nc"]]) {
    await page.locator("#filter-text").fill(word);
    assert.equal(await countText(page), "1 of 2 programs", word);
    assert.ok((await cells(page, 1))[0].includes(program), word);
  }
});

test("an unchecked program comes last when sorted by any number, both ways", async (browser) => {
  const { page } = await openReport(browser, report("large"));
  const grid = page.locator("#grid");
  for (const name of ["Margin mm", "Errors", "Warnings", "Blocks", "Cycle time", "Check s"])
    for (let way = 0; way < 2; ++way) {
      await sortBy(page, name);
      assert.doesNotMatch((await rowTexts(page))[0], /never\.nc/, name);
      await grid.evaluate((node) => { node.scrollTop = node.scrollHeight; });
      await page.waitForFunction(() => [...document.querySelectorAll(".grid-row")].pop().textContent.includes("never.nc"));
    }
});

test("a program opens to its findings, facts, assumptions and the command for its own page", async (browser) => {
  const { page, wrong } = await openReport(browser, report("shop"), { permissions: ["clipboard-read", "clipboard-write"] });
  await openProgram(page, "it's");
  const program = page.locator("#program");
  assert.match(await program.locator("h3").first().textContent(), /^it's "50%" & \$HOME\.nc$/);
  const text = await program.textContent();
  for (const part of ["strap-1", "line ", "Cure: ", "clamped_plate.toml", "assumptions", "(minimum "])
    assert.ok(text.includes(part), part);
  assert.ok((await program.locator(".card.error").count()) >= 1);
  assert.match(await program.locator(".card code").first().textContent(), /[GXYZ]/);
  const command = await program.locator(".command code").textContent();
  assert.match(command, /^feeler check 'shop\/vise\/Geh\u00e4use <i>\/it'\\''s "50%" & \$HOME\.nc' --setup \S+clamped_plate\.toml .*--format html -o /);
  await program.locator(".command button").click();
  await program.getByText("Copied").waitFor();
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), command);
  await page.keyboard.press("Escape");
  assert.equal(await program.isVisible(), false);
  await openProgram(page, "alert");
  assert.match(await program.textContent(), /line 4, column 1: G999/);
  assert.equal(await page.locator(".grid-row.chosen").count(), 1);
  assert.deepEqual(wrong, []);
});

test("the keyboard alone opens programs one after the other", async (browser) => {
  const { page } = await openReport(browser, report("shop"));
  await page.locator("#grid").focus();
  await page.keyboard.press("ArrowDown");
  const first = await page.locator("#program h3").first().textContent();
  await page.keyboard.press("ArrowDown");
  assert.notEqual(await page.locator("#program h3").first().textContent(), first);
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#program").isVisible(), false);
  await page.locator('[data-sort="blocks"]').focus();
  await page.keyboard.press("Enter");
  assert.equal(await page.locator('[aria-sort="descending"]').textContent(), "Blocks");
});

test("a page of no program says so, and nothing breaks", async (browser) => {
  const { page, wrong } = await openReport(browser, report("empty"));
  assert.equal(await countText(page), "0 of 0 programs");
  assert.equal(await page.title(), "no program was checked");
  await sortBy(page, "Blocks");
  await page.locator("#grid").press("ArrowDown");
  await page.locator("#filter-text").fill("part");
  assert.equal(await page.locator("#program").isVisible(), false);
  assert.deepEqual(wrong, []);
});

test("between phone and desk nothing sticks out either", async (browser) => {
  for (const width of [560, 720, 1000, 1149, 1150, 1900]) {
    const { page } = await openReport(browser, report("shop"), { width });
    await page.locator(".grid-row").nth(1).click();
    assert.equal(await isWide(page), false, `${width} px`);
    await keepPicture(page, `${folder}/batch-shop-${width}.png`, { fullPage: true });
    await page.close();
  }
});

test("the program with the least margin is a click away, and the theme is", async (browser) => {
  const { page } = await openReport(browser, report("shop"));
  await page.locator("#summary .link").click();
  assert.match(await page.locator("#program").textContent(), /collision/);
  const before = await lightness(page);
  await page.locator("#theme").click();
  assert.ok((await lightness(page)) < before - 300);
});

test("it prints on white paper, with the table whole and what is wrong with each program", async (browser) => {
  const { page } = await openReport(browser, report("shop"), { colorScheme: "dark" });
  await page.pdf({ path: `${folder}/shop.pdf`, format: "A4" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  await page.emulateMedia({ media: "print" });
  assert.equal(await lightness(page), 3 * 255);
  assert.equal(await page.locator("#printed .program").count(), 3);
  const grid = await page.locator("#grid").boundingBox(), printed = await page.locator("#printed").boundingBox();
  const last = await page.locator(".grid-row").last().boundingBox();
  assert.ok(last.y + last.height <= grid.y + grid.height + 1 && grid.y + grid.height <= printed.y + 1);
});

test("ten thousand programs open, scroll, sort and filter with little work", async (browser) => {
  const { page, wrong, work } = await openCounted(browser, report("large"));
  assert.ok(statSync(report("large")).size < 20e6);
  assert.equal(await countText(page), "10001 of 10001 programs");
  assert.match((await rowTexts(page))[0], /never\.nc.*not checked/);
  assertLittle(await work(), { steps: 300 * 10_000, elements: 1500, strokes: 0, nodes: 1000 }, "opening");
  for (let i = 0; i <= 40; ++i) {
    await untilDrawn(page, scrollTo, i / 40);
    assert.ok((await rowTexts(page)).length < 60);
    assertLittle(await work(), { steps: 3000, elements: 700, strokes: 0, nodes: 1000 }, "scrolling");
  }
  for (const [act, argument] of [[sort, "program"], [sort, "margin"], [sort, "errors"],
    [find, "h"], [find, "holder comes"], [find, "clamp-3 part 77"]]) {
    await untilDrawn(page, act, argument);
    assertLittle(await work(), { steps: 300 * 10_000, elements: 1500, strokes: 0, nodes: 1000 }, argument);
  }
  await page.locator("#filter-text").fill("part-no-9999");
  assert.equal(await countText(page), "0 of 10001 programs");
  await page.locator("#filter-text").fill("9999.nc");
  assert.equal(await countText(page), "1 of 10001 programs");
  await page.locator(".grid-row").first().click();
  assert.equal(await page.locator("#program h3").first().textContent(), "part 9999.nc");
  await keepPicture(page, `${folder}/batch-large.png`);
  assert.deepEqual(wrong, []);
});

await runAll();
