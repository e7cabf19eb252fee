// Opens the reports of a run and of a campaign and a comparison in Chromium and checks what a reader sees.
// Usage: node tests/rigs/browser.mjs REPORT SUMMARY COMPARISON CAMPAIGN PICTURES
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(new URL("../../.rigs/npm/package.json", import.meta.url));
const { chromium } = require("playwright-core");

const [report, summaryPath, comparison, campaign, pictures] = process.argv.slice(2);
let failed = 0;
function check(name, holds, found = "") {
  console.log(`${holds ? "ok  " : "FAIL"} ${name}${holds ? "" : `\n     found: ${found}`}`);
  if (!holds) failed += 1;
}

// Only what hangs takes as long, on a busy host too.
const LONG_MS = 300_000;

const browser = await chromium.launch({
  timeout: LONG_MS,
  executablePath: "/usr/bin/chromium",
  args: [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
  ],
});

// Waits until what follows a change of size or style is drawn.
const settled = (page) => page.evaluate(() => new Promise((done) =>
  requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)))));

// What every page has to keep, whatever is on it. `use` gets the open page.
async function visit(name, path, use) {
  const context = await browser.newContext({ offline: true, viewport: { width: 1280, height: 900 } });
  context.setDefaultTimeout(LONG_MS);
  const page = await context.newPage();
  const errors = [];
  const requests = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(path).href);

  check(`${name}: has a title`, (await page.title()) !== "", await page.title());
  const empty = await page.$$eval("svg", (charts) =>
    charts.filter((chart) => {
      const box = chart.getBoundingClientRect();
      const drawn = chart.querySelectorAll("path[d], circle, line, rect, text").length;
      // Only what is shown: legends' marks and folded parts have no box.
      return box.width > 0 && (drawn === 0 || box.height === 0);
    }).length);
  check(`${name}: no chart is empty`, empty === 0, empty);
  const broken = await page.$$eval("svg [d], svg circle, svg line", (marks) =>
    marks.filter((mark) => /NaN|inf|undefined/.test(mark.outerHTML)).length);
  check(`${name}: no mark has a place that is no number`, broken === 0, broken);
  await use(page);

  // Nothing is beyond the edge of the screen, on a phone either.
  for (const scheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme: scheme });
    for (const width of [360, 390, 1280, 2560]) {
      await page.setViewportSize({ width, height: 900 });
      await settled(page);
      const beyond = await page.evaluate(() => {
        const all = Array.from(document.querySelectorAll("main *:not(svg *)"));
        const far = all.filter((one) => one.getBoundingClientRect().right > innerWidth + 1);
        return document.documentElement.scrollWidth > innerWidth || far.length > 0
          ? [document.documentElement.scrollWidth, ...far.slice(0, 4).map((one) => `${one.tagName}.${one.className}`)].join(" ") : "";
      });
      check(`${name}: ${width} pixels are wide enough, ${scheme}`, beyond === "", beyond);
      if (width !== 360) await page.screenshot({ path: `${pictures}/${name}-${width}-${scheme}.png` });
    }
  }
  await page.setViewportSize({ width: 1280, height: 900 });

  const background = () => page.evaluate(() => {
    const of = (element) => getComputedStyle(element).backgroundColor;
    const body = of(document.body);
    const [r, g, b, a = 1] = (body.match(/[\d.]+/g) ?? []).map(Number);
    if (a > 0) return (r + g + b) / 3;
    const root = (of(document.documentElement).match(/[\d.]+/g) ?? []).map(Number);
    return root[3] === 0 ? 255 : (root[0] + root[1] + root[2]) / 3;
  });
  await page.emulateMedia({ colorScheme: "light" });
  const light = await background();
  await page.screenshot({ path: `${pictures}/${name}-light.png`, fullPage: true });
  await page.emulateMedia({ colorScheme: "dark" });
  const dark = await background();
  await page.screenshot({ path: `${pictures}/${name}-dark.png`, fullPage: true });
  check(`${name}: dark where the reader wants it dark`, light > 200 && dark < 80, `${light}, ${dark}`);
  await page.emulateMedia({ colorScheme: "dark", media: "print" });
  const print = await background();
  check(`${name}: printed on white`, print > 240, print);
  const pdf = await page.pdf({ path: `${pictures}/${name}.pdf`, format: "A4" });
  check(`${name}: makes a PDF`, pdf.subarray(0, 5).toString() === "%PDF-" && pdf.length > 10_000);

  check(`${name}: no error in the console`, errors.length === 0, errors.join("; "));
  const outside = requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:"));
  check(`${name}: nothing is asked of the network`, outside.length === 0, outside.join(" "));
  check(`${name}: one file is all of it`, new Set(requests).size === 1, requests.join(" "));
  await context.close();
}

const visible = (page) => page.evaluate(() => document.body.innerText);
const charts = (page) =>
  page.$$eval("svg", (all) => all.filter((svg) => svg.querySelector("path.line[d]")).length);

await visit("report", report, async (page) => {
  const summary = JSON.parse(await readFile(summaryPath, "utf8"));
  check("report: title is the scenario's", (await page.title()).includes(summary.scenario),
    await page.title());
  check("report: the verdict is seen", await page.locator(`.badge.${summary.verdict}`).first().isVisible());
  // What is folded is unfolded first, as a reader does.
  await page.$$eval("details", (all) => all.forEach((one) => { one.open = true; }));
  const text = await visible(page);
  const names = Object.keys(summary.calibration.parameters);
  const missing = names.filter((name) => !text.includes(name));
  check(`report: all ${names.length} parameters are seen`, names.length === 30 && missing.length === 0,
    missing.join(" "));
  for (const heading of ["Calibrated parameters", "Navigation", "Gimbals", "Provenance"]) {
    check(`report: has ${heading}`, text.includes(heading));
  }
  check("report: seed and stream hash are told",
    text.includes(summary.stream_hash.slice(0, 8)), summary.stream_hash);
  const drawn = await charts(page);
  check("report: charts have lines", drawn >= 4, drawn);
  await plots(page);
  await requirementsInSight(page);
});

// Zoom, cursor, markers and keys of the plots.
async function plots(page) {
  const size = (await readFile(report)).length;
  console.log(`     report: ${(size / 1e6).toFixed(2)} MB`);
  check("report: under 3 MB", size < 3_000_000, size);
  // The best of a few, since the host does other things as well.
  const paints = [];
  for (let k = 0; k < 3; k += 1) {
    await page.reload();
    await settled(page);
    paints.push(await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity));
  }
  console.log(`     report: first paint after ${Math.min(...paints).toFixed(0)} ms`);
  check("report: first paint within 1 s", Math.min(...paints) < 1000, paints.join(" "));

  const first = page.locator(".chart > svg[tabindex]").first();
  await first.scrollIntoViewIfNeeded();
  await settled(page);
  const box = await first.boundingBox();
  const ticks = () => first.locator(".tick.x").allTextContents();
  const before = (await ticks()).join(" ");
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 60);
  const shown = await page.locator(".chart .shown").count();
  check("report: the cursor is in every plot in sight", shown >= 2, shown);
  const readouts = (await page.locator(".readout").allTextContents()).filter((text) => /^−?\d/.test(text));
  check("report: values at the cursor are told", readouts.length >= 2, readouts.join(" "));
  await page.mouse.down();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 60, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const zoomed = await page.locator(".chart.zoomed").count();
  check("report: a drag zooms all plots in sight", zoomed >= 2, zoomed);
  check("report: the axis follows", (await ticks()).join(" ") !== before, before);
  const draws = [];
  await first.focus();
  for (const key of ["+", "+", "-", "ArrowRight", "+", "-", "-"]) {
    await page.keyboard.press(key);
    await settled(page);
    draws.push(await page.evaluate(() => Number(document.documentElement.dataset.drawMs)));
  }
  draws.sort((a, b) => a - b);
  console.log(`     report: zoom drawn in ${draws[3].toFixed(1)} ms (median), ${draws.at(-1).toFixed(1)} ms (largest)`);
  check("report: a zoom is drawn within 50 ms", draws[3] < 50, draws.join(" "));
  await page.keyboard.press("0");
  await settled(page);
  check("report: 0 shows everything again", (await ticks()).join(" ") === before, (await ticks()).join(" "));

  const boxes = await page.locator(".switch input").count();
  check("report: markers have switches", boxes >= 2, boxes);
  await page.keyboard.press("m");
  check("report: m switches the markers off", (await page.locator(".switch input:checked").count()) === 0);
  await page.keyboard.press("m");
  check("report: and on", (await page.locator(".switch input:checked").count()) === boxes);
  await page.evaluate(() => { document.activeElement.blur(); scrollTo(0, 0); });
  await page.keyboard.press("j");
  await page.waitForURL((url) => url.hash !== "");
  await page.keyboard.press("?");
  check("report: ? lists the keys", await page.locator("dialog.help").isVisible());
  await page.keyboard.press("Escape");

  // Without a script nothing is missing but what moves.
  const context = await browser.newContext({ javaScriptEnabled: false, offline: true, viewport: { width: 1280, height: 900 } });
  const still = await context.newPage();
  await still.goto(pathToFileURL(report).href);
  const drawings = await still.locator("svg[role=img]").count();
  const lines = await still.locator("svg[role=img]:has(path.line[d], rect.diagonal)").count();
  check("report: every drawing is there without a script", drawings >= 30 && lines === drawings, `${lines} of ${drawings}`);
  await context.close();
}

// Verdict, value, limit, margin, unit and text of a requirement are in sight on a phone.
async function requirementsInSight(page) {
  await page.setViewportSize({ width: 360, height: 900 });
  await settled(page);
  const cells = await page.$$eval(".requirements tbody tr:first-child td", (all) =>
    all.map((cell) => ({ box: cell.getBoundingClientRect(), text: cell.innerText.trim() })));
  const seen = cells.filter(({ box, text }) => box.width > 0 && box.left >= 0 && box.right <= 360 && text !== "");
  check("report: all of a requirement is in sight at 360 pixels", cells.length === 6 && seen.length === 6, seen.length);
  await page.setViewportSize({ width: 1280, height: 900 });
}

await visit("compare", comparison, async (page) => {
  const text = await visible(page);
  for (const words of ["eight positions with G states", "six positions without G states", "24 h"]) {
    check(`compare: tells of ${words}`, text.includes(words));
  }
  const marks = await page.locator("svg circle, svg path").count();
  check("compare: pairs and intervals are drawn", marks > 4, marks);
});

// What the keyboard is at.
const focused = (page) => page.evaluate(() => {
  const at = document.activeElement;
  const style = getComputedStyle(at);
  return {
    tag: at.tagName.toLowerCase(),
    href: at.getAttribute("href"),
    index: Array.from(document.querySelectorAll("*")).indexOf(at),
    marked: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0,
    seen: at.getBoundingClientRect().width > 0,
  };
});

await visit("campaign", `${campaign}/report.html`, async (page) => {
  const statistics = JSON.parse(await readFile(`${campaign}/statistics.json`, "utf8"));
  check("campaign: title is the campaign's", (await page.title()).includes(statistics.title),
    await page.title());
  check("campaign: the verdict is seen",
    await page.locator(`header .badge.${statistics.verdict}`).isVisible());
  const pictured = await charts(page);
  const wanted = 2 * statistics.combinations.length;
  check("campaign: latitude and longitude of every combination are drawn", pictured >= wanted && wanted === 24,
    `${pictured} of ${wanted}`);
  const bands = await page.$$eval("svg path.band[d]", (all) =>
    all.filter((band) => band.getBBox().width > 50 && band.getBBox().height > 1).length);
  check("campaign: envelopes have an area", bands >= 2 * wanted, bands);
  const text = await visible(page);
  for (const { id } of statistics.requirements) check(`campaign: has ${id}`, text.includes(id));
  for (const { id } of statistics.discrepancies) check(`campaign: has ${id}`, text.includes(id));
  check("campaign: the plan is told", text.includes(statistics.plan));

  // Everything that does something is reached with the Tab key, in the order of the page, and is marked.
  const count = await page.$$eval("a[href], summary, [tabindex]", (all) =>
    // What is folded isn't there for the keyboard.
    all.filter((one) => one.checkVisibility()).length);
  await page.evaluate(() => window.scrollTo(0, 0));
  // Where the next press of the key leads; on a busy host the focus follows the key late, and can be at nothing on
  // its way: it has to be at the same place twice.
  const next = async (from) => {
    await page.keyboard.press("Tab");
    let before = from;
    for (let wait = 0; wait < 400; wait += 1) {
      const at = await focused(page);
      if (at.index !== from && at.index === before) return at;
      before = at.index;
      await page.waitForTimeout(25);
    }
    return { index: from };
  };
  let last = (await focused(page)).index, backwards = [], unmarked = 0, reached = 0;
  while (reached < count) {
    const at = await next(last);
    if (at.tag === "body" || at.index === last) break;
    if (at.index < last) backwards.push(`${last} to ${at.index}, ${at.tag} ${at.href}`);
    if (!at.marked || !at.seen) unmarked += 1;
    last = at.index;
    reached += 1;
  }
  check("campaign: the Tab key gets everywhere", reached >= count, `${reached} of ${count}`);
  check("campaign: from the top to the bottom", backwards.length === 0, backwards.join("; "));
  check("campaign: and it is seen where it is", unmarked === 0, unmarked);
  // A section by its link, and what is folded by the space bar.
  await page.locator('nav.contents a[href="#trace"]').focus();
  await page.keyboard.press("Enter");
  await page.waitForURL((url) => url.hash === "#trace");
  const place = await page.evaluate(() => document.querySelector("#trace").getBoundingClientRect().top);
  check("campaign: Enter goes to a section", page.url().endsWith("#trace") && place < 900, place);
  const folded = page.locator("#trace ~ details").first();
  await folded.locator("summary").focus();
  await page.keyboard.press("Space");
  check("campaign: the space bar unfolds", await folded.evaluate((one) => one.open));
  await page.keyboard.press("Space");
  // The list of cases is filtered by words.
  await page.$$eval("details", (all) => all.forEach((one) => { one.open = true; }));
  const rows = page.locator("table.filtered tbody tr:visible");
  const total = await rows.count();
  await page.locator("input.filter").first().fill("no such case");
  check("campaign: a filter hides the other cases", total > 1 && (await rows.count()) === 0, total);
  await page.locator("input.filter").first().fill("");
  check("campaign: and shows them again", (await rows.count()) === total, await rows.count());
  await page.$$eval("details", (all) => all.forEach((one) => { one.open = false; }));
  await page.evaluate(() => window.scrollTo(0, 0));
});

await browser.close();
if (failed > 0) {
  console.error(`${failed} checks failed`);
  process.exit(1);
}
