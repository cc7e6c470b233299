// Uses a report as a person does. Argument: the folder with the reports; pictures go there.

import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { launch, openReport } from "./browser.mjs";
import { isWide, keepPicture, lightness, runAll, test } from "./harness.mjs";
import { assertLittle, find, openCounted, scrollTo, untilDrawn } from "./work.mjs";

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
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
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

test("a hundred thousand blocks open, scroll and filter with little work", async (browser) => {
  const { page, wrong, work } = await openCounted(browser, report("long"));
  assert.match(await countText(page), /^1000\d\d of/);
  assertLittle(await work(), { steps: 120 * 100_000, elements: 1500, strokes: 5000, nodes: 1000 }, "opening");
  for (let i = 0; i <= 40; ++i) {
    await untilDrawn(page, scrollTo, i / 40);
    assert.ok((await rowTexts(page)).length < 60);
    assertLittle(await work(), { steps: 3000, elements: 500, strokes: 0, nodes: 1000 }, "scrolling");
  }
  assert.match((await rowTexts(page)).join(), /M30/);
  for (const text of ["x", "L5432", ""]) {
    await untilDrawn(page, find, text);
    assertLittle(await work(), { steps: 30 * 100_000, elements: 1500, strokes: 5000, nodes: 1000 }, `filter by '${text}'`);
  }
  assert.deepEqual(wrong, []);
});

test("a hundred thousand blocks are reached by keys, to the last one", async (browser) => {
  const { page, wrong } = await openReport(browser, report("long"));
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

/** How many pixels of the chart have the colour of a state, in each column that has any. */
const pixelsLike = (page, state) => page.evaluate((name) => {
  const canvas = document.getElementById("clearance-chart"), context = canvas.getContext("2d");
  const color = getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const wanted = parseInt(color.slice(1), 16), found = new Map();
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  for (let i = 0; i < data.length; i += 4)
    if ((data[i] << 16 | data[i + 1] << 8 | data[i + 2]) === wanted && data[i + 3] === 255) {
      const x = (i / 4) % canvas.width;
      found.set(x, (found.get(x) || 0) + 1);
    }
  return [...found].sort((a, b) => a[0] - b[0]);
}, state);

for (const width of [1400, 400])
  test(`one violation among thousands of blocks in contact is seen in the chart, ${width} px wide`, async (browser) => {
    const { page } = await openReport(browser, report("one_of_many"), { width });
    assert.ok(Number((await countText(page)).split(" ")[0]) > 9000);
    await page.locator("#filter-verdict").selectOption("open");
    assert.equal(await countText(page).then((text) => text.split(" ")[0]), "1");
    for (const axis of ["time", "block"]) {
      await page.locator("#chart-axis").selectOption(axis);
      const red = await pixelsLike(page, "violation");
      assert.ok(red.length >= 3, `${red.length} columns along ${axis}`);
      assert.ok(red.some(([, pixels]) => pixels > 5), "a bar as tall as the clearance, not its foot alone");
      assert.deepEqual(await pixelsLike(page, "near"), [], "contact that is allowed is clear");
      const chart = page.locator("#clearance-chart");
      await chart.scrollIntoViewIfNeeded();
      await keepPicture(page, `${folder}/one-of-many-${axis}-${width}.png`);
      const box = await chart.boundingBox();
      await page.mouse.click(box.x + red[Math.floor(red.length / 2)][0], box.y + 100);
      assert.match(await page.locator("#chart-read").textContent(), /G1 X90\. F9000\. .*near-miss/);
    }
  });

test("of the blocks of a pixel the chart shows the worst: verdict, then margin, errors without a clearance too", async (browser) => {
  const { page } = await openReport(browser, report("clear"));
  // The functions of the page are private: they are defined once more here, without its start.
  await page.evaluate(() => {
    const script = [...document.scripts].pop().textContent, inner = script.slice(script.indexOf("{") + 1, script.lastIndexOf("startPage();"));
    Object.assign(window, new Function(inner + "; return { unpackBlocks, worstPerPixel, stateOf };")());
  });
  /** The worst of blocks as [lower, keep, verdict, severity of what was found], all on one pixel and in either order. */
  const worst = async (...blocks) => {
    const both = await page.evaluate((list) => [list, [...list].reverse()].map((rows) => {
      const runs = (numbers) => numbers.flatMap((number) => [number, 1]);
      const zeros = [0, rows.length];
      const made = unpackBlocks({ count: rows.length, time: rows.map(() => 0), end: 0, limit: 20000, line: zeros, text: zeros,
        texts: [""], file: zeros, files: [""], motion: zeros, tool: zeros, removed: [], rules: ["r"],
        verdict: runs(rows.map((row) => row[2])), pair: runs(rows.map((row, i) => (row[0] < 0 ? -1 : i))),
        pairs: rows.map((row) => ["a", "b", row[1]]), lower: rows.map((row) => row[0]), width: rows.map(() => 0),
        found: rows.flatMap((row, i) => (row[3] ? [[i, row[3], 0]] : [])) });
      const [block] = worstPerPixel(made, () => [0, 0], 1), atEnd = worstPerPixel(made, () => [4, 4], 4);
      if (atEnd[3] !== block) return "lost at the end of the range";
      return block < 0 ? "none" : JSON.stringify(rows[block]) + " " + stateOf(made, block);
    }), blocks);
    assert.equal(both[0], both[1]);
    return both[0];
  };
  const touching = [0, 0, 0, 0], far = [20000, 0, 0, 0], unknown = [-1, 0, 0, 0];
  assert.equal(await worst(touching, [1500, 2000, 2, 0], far), "[1500,2000,2,0] violation");
  assert.equal(await worst([1500, 2000, 2, 0], [3000, 5000, 2, 0]), "[3000,5000,2,0] violation");
  assert.equal(await worst([0, 2000, 1, 0], [1500, 2000, 2, 0]), "[1500,2000,2,0] violation");
  assert.equal(await worst([1000, 2000, 2, 0], [1500, 2000, 3, 0]), "[1500,2000,3,0] violation");
  assert.equal(await worst(touching, [-1, 0, 0, 3], far), "[-1,0,0,3] violation");
  assert.equal(await worst([1500, 2000, 2, 0], [-1, 0, 0, 3]), "[1500,2000,2,0] violation");
  assert.equal(await worst([0, 2000, 1, 0], [9000, 2000, 0, 3]), "[9000,2000,0,3] violation");
  assert.equal(await worst(touching, [3000, 2000, 0, 2]), "[3000,2000,0,2] near");
  assert.equal(await worst(touching, [4000, 2000, 0, 0]), "[0,0,0,0] clear");
  assert.equal(await worst(unknown, unknown), "none");
});

test("no number under the chart is cut off", async (browser) => {
  const { page } = await openReport(browser, report("one_of_many"));
  const spare = await page.evaluate(() => {
    const canvas = document.getElementById("clearance-chart"), axis = document.getElementById("chart-axis"), spare = [];
    const write = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
      if (this.textAlign === "center") spare.push(canvas.clientWidth - x - this.measureText(text).width / 2);
      write.call(this, text, x, y);
    };
    for (let width = 400; width <= 1300; width += 15) {
      canvas.style.width = width + "px";
      for (const name of ["block", "time"]) {
        axis.value = name;
        axis.dispatchEvent(new Event("input"));
      }
    }
    return spare;
  });
  assert.ok(spare.length > 200);
  assert.ok(Math.min(...spare) >= 0, `${-Math.min(...spare)} px are missing`);
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
