// What a person does with a report. Argument: the folder with the reports; pictures go there.

import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { launch, openReport } from "./browser.mjs";
import { isWide, keepPicture, lightness, runAll, test } from "./harness.mjs";

const folder = process.argv[2];
const report = (name) => `${folder}/${name}.html`;

const eye = (page) => page.locator(".stage").getAttribute("data-view");
/** Waits until the view has another eye than before. */
const moved = (page, before) => page.waitForFunction((old) => document.querySelector(".stage").dataset.view !== old, before);
const countText = (page) => page.locator("#filter-count").textContent();
const rowTexts = (page) => page.locator(".grid-row").allTextContents();

for (const colorScheme of ["light", "dark"])
  for (const width of [1400, 400])
    for (const name of ["findings", "clear", "evil"])
      test(`${name}, ${colorScheme}, ${width} px wide: opens without an error or a request, nothing sticks out`, async (browser) => {
        const { page, wrong } = await openReport(browser, report(name), { width, colorScheme });
        await page.waitForTimeout(300);
        await keepPicture(page, `${folder}/${name}-${colorScheme}-${width}.png`, { fullPage: true });
        assert.equal(await isWide(page), false);
        assert.equal((await lightness(page)) > 384, colorScheme === "light");
        assert.deepEqual(wrong, []);
      });

test("a click on a finding moves the view, and so do buttons, keys, mouse and finger", async (browser) => {
  const { page, wrong } = await openReport(browser, report("findings"), { hasTouch: true });
  const act = async (action) => {
    const before = await eye(page);
    await action();
    await moved(page, before);
  };
  await page.locator(".stage[data-view]").waitFor();
  assert.match(await page.locator(".caption").textContent(), /Block 38 .*strap-1/);
  await act(() => page.locator(".shot").nth(1).click());
  assert.match(await page.locator(".caption").textContent(), /Block 39 .*strap-2/);
  assert.equal(await page.locator(".card.shown").count(), 2);
  assert.equal(await page.locator(".grid-row.chosen").count(), 1);
  for (const button of ["Top", "Front", "Iso", "Pair", "+", "\u2212"])
    await act(() => page.locator(".buttons").getByText(button, { exact: true }).click());
  await page.locator(".stage").focus();
  for (const key of ["ArrowLeft", "ArrowUp", "+"]) await act(() => page.keyboard.press(key));
  const box = await page.locator(".stage").boundingBox(), x = box.x + box.width / 2, y = box.y + box.height / 2;
  await act(async () => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 80, y + 30, { steps: 5 });
    await page.mouse.up();
  });
  await act(async () => {
    const client = await page.context().newCDPSession(page);
    const touch = (type, points) => client.send("Input.dispatchTouchEvent", { type, touchPoints: points });
    await touch("touchStart", [{ x, y }]);
    for (let i = 1; i <= 5; ++i) await touch("touchMove", [{ x: x - 12 * i, y: y + 5 * i }]);
    await touch("touchEnd", []);
  });
  assert.deepEqual(wrong, []);
});

test("the view draws bodies, not an empty stage", async (browser) => {
  const { page } = await openReport(browser, report("findings"));
  await page.locator(".stage[data-view]").waitFor();
  const colors = await page.evaluate(() => {
    const canvas = document.querySelector(".stage canvas"), copy = document.createElement("canvas");
    Object.assign(copy, { width: 120, height: 90 });
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0, 120, 90);
    const data = context.getImageData(0, 0, 120, 90).data, seen = new Set();
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 0) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
    return seen.size;
  });
  assert.ok(colors > 100, `${colors} colours`);
});

test("without WebGL the pictures take the place of the view", async () => {
  const browser = await launch(["--disable-gpu", "--disable-webgl", "--disable-webgl2", "--disable-3d-apis"]);
  const { page, wrong } = await openReport(browser, report("findings"));
  const image = page.locator(".stage img");
  const first = await image.getAttribute("src");
  await page.locator(".shot").nth(1).click();
  assert.notEqual(await image.getAttribute("src"), first);
  assert.equal(await page.locator(".stage canvas").count(), 0);
  assert.deepEqual(wrong.filter((line) => !line.includes("WebGL")), []);
  await browser.close();
});

test("the filter lets through what it says", async (browser) => {
  const { page } = await openReport(browser, report("findings"));
  assert.equal(await countText(page), "46 of 46 blocks");
  await page.locator("#filter-verdict").selectOption("found");
  assert.equal(await countText(page), "4 of 46 blocks");
  await page.locator("#filter-text").fill("strap-2");
  assert.equal(await countText(page), "1 of 46 blocks");
  assert.match((await rowTexts(page))[0], /Y143\..*collision/);
  await page.locator("#filter-verdict").selectOption("all");
  await page.locator("#filter-text").fill("T2 G81");
  const drilled = await rowTexts(page);
  assert.ok(drilled.length > 0 && drilled.every((text) => /G81/.test(text)));
  await page.locator("#filter-text").fill("no such words");
  assert.equal(await countText(page), "0 of 46 blocks");
  await page.locator("#filter-text").fill("");
  await page.locator("#filter-near").fill("1");
  const near = Number((await countText(page)).split(" ")[0]);
  assert.ok(near >= 4 && near < 46);
});

test("a hundred thousand blocks scroll without waiting, to the last one", async (browser) => {
  const begin = Date.now();
  const { page, wrong } = await openReport(browser, report("long"));
  const opened = Date.now() - begin;
  assert.ok(opened < 5000, `opened in ${opened} ms`);
  assert.match(await countText(page), /^1000\d\d of/);
  assert.ok((await rowTexts(page)).length < 60);
  const slowest = await page.evaluate(async () => {
    const grid = document.getElementById("grid");
    let slowest = 0;
    for (let i = 0; i <= 60; ++i) {
      const begin = performance.now();
      grid.scrollTop = (i / 60) * grid.scrollHeight;
      await new Promise((done) => requestAnimationFrame(done));
      slowest = Math.max(slowest, performance.now() - begin);
    }
    await new Promise((done) => setTimeout(done, 100));
    return slowest;
  });
  assert.ok(slowest < 250, `a frame took ${slowest} ms`);
  assert.match((await rowTexts(page)).join(), /M30/);
  await page.locator("#grid").focus();
  await page.keyboard.press("Home");
  assert.match(await page.locator(".grid-row.chosen").textContent(), /^0/);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("PageDown");
  await page.keyboard.press("End");
  assert.match(await page.locator(".grid-row.chosen").textContent(), /^1000\d\d/);
  await page.locator("#filter-text").fill("L54321");
  assert.match((await rowTexts(page)).join(), /54321/);
  assert.equal(await countText(page).then((text) => text.split(" ")[0]), "1");
  console.log(`    opened in ${opened} ms, the slowest frame took ${slowest.toFixed(0)} ms`);
  assert.deepEqual(wrong, []);
});

test("a click in the chart goes to the block, a drag looks closer", async (browser) => {
  const { page } = await openReport(browser, report("findings"));
  const chart = page.locator("#clearance-chart");
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox(), at = (share) => [box.x + share * box.width, box.y + 120];
  const before = await chart.screenshot();
  await page.mouse.click(...at(0.5));
  assert.match(await page.locator("#chart-read").textContent(), /^Block \d+/);
  await page.mouse.move(...at(0.7));
  await page.mouse.down();
  await page.mouse.move(...at(0.95), { steps: 4 });
  await page.mouse.up();
  await page.mouse.move(0, 0);
  assert.notDeepEqual(await chart.screenshot(), before);
  await page.locator("#chart-axis").selectOption("block");
  await page.locator("#chart-all").click();
});

test("the keyboard alone reaches the findings and shows them", async (browser) => {
  const { page } = await openReport(browser, report("findings"));
  for (let i = 0; i < 6; ++i) await page.keyboard.press("Tab");
  const focused = await page.evaluate(() => document.activeElement.closest(".card") !== null);
  assert.equal(focused, true);
  const block = await page.evaluate(() => document.activeElement.dataset.block);
  await page.keyboard.press("Enter");
  assert.equal(await page.locator("#view").getAttribute("data-block"), block);
});

test("light and dark can be changed by hand", async (browser) => {
  const { page } = await openReport(browser, report("findings"));
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const before = await background();
  await page.locator("#theme").click();
  assert.notEqual(await background(), before);
  await keepPicture(page, `${folder}/turned-dark.png`);
  await page.locator("#theme").click();
  assert.equal(await background(), before);
});

test("what a program says is text and nothing else", async (browser) => {
  const { page, wrong } = await openReport(browser, report("evil"));
  assert.match(await page.title(), /^collision: /);
  await page.locator("#filter-text").fill("onerror");
  assert.match((await rowTexts(page)).join(), /<\/script><script>document\.title="broken".*\u00e4/);
  assert.deepEqual(wrong, []);
});

test("it prints on white paper with its findings", async (browser) => {
  const { page } = await openReport(browser, report("findings"), { colorScheme: "dark" });
  await page.pdf({ path: `${folder}/findings.pdf`, format: "A4", printBackground: false });
  assert.ok(statSync(`${folder}/findings.pdf`).size > 50_000);
  await page.emulateMedia({ media: "print" });
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
  assert.equal(await page.locator("#view").isVisible(), false);
  assert.equal(await page.locator(".shot img").first().isVisible(), true);
});

test("reports are as small as they should be", async () => {
  for (const [name, most] of [["findings", 3e6], ["clear", 3e6], ["long", 20e6]]) {
    const bytes = statSync(report(name)).size;
    assert.ok(bytes < most, `${name} has ${bytes} bytes`);
    console.log(`    ${name}: ${(bytes / 1e6).toFixed(2)} MB`);
  }
});

await runAll();
