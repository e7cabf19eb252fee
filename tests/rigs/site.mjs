// Opens the site of the documentation in Chromium, from the disk and from a web server, and reads and searches in it.
// Usage: node tests/rigs/site.mjs SITE PICTURES
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join, resolve, sep } from "node:path";
import { pathToFileURL } from "node:url";

const require = createRequire(new URL("../../.rigs/npm/package.json", import.meta.url));
const { chromium } = require("playwright-core");

const [folder, pictures] = process.argv.slice(2);
const site = resolve(folder);
let failed = 0;
function check(name, holds, found = "") {
  console.log(`${holds ? "ok  " : "FAIL"} ${name}${holds ? "" : `\n     found: ${found}`}`);
  if (!holds) failed += 1;
}

// Only what hangs takes as long, on a busy host too.
const LONG_MS = 300_000;
// Pages of every kind: text, pictures, wide tables, code, generated reference, a file of the repository.
const PAGES = {
  "index.html": "Octant",
  "reference/keys.html": "Keys",
  "reference/commands.html": "Commands and options",
  "reference/measures.html": "Measures",
  "reference/faults.html": "Kinds of faults",
  "docs/faults/spike.html": "spike",
  "docs/results.html": "Results",
  "docs/qualification/trace.html": "Trace",
  "harness/devices/wire/index.html": "The wire",
  "fixtures/scenarios/tour.toml.src.html": "tour.toml",
};

// A plain server, in a folder of its host as project pages have it.
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".json": "application/json",
  ".svg": "image/svg+xml", ".png": "image/png" };
const server = createServer(async (request, response) => {
  const path = resolve(site, `.${sep}${decodeURIComponent(new URL(request.url, "http://localhost").pathname)
    .replace(/^\/docs-of-octant\//, "").replace(/(^|\/)$/, "$1index.html")}`);
  try {
    if (!path.startsWith(site + sep)) throw new Error("outside");
    const body = await readFile(path);
    response.writeHead(200, { "content-type": TYPES[extname(path)] ?? "application/octet-stream" }).end(body);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
const served = `http://127.0.0.1:${server.address().port}/docs-of-octant/`;

const browser = await chromium.launch({
  timeout: LONG_MS,
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});

const brightness = (page) => page.evaluate(() => {
  const [r, g, b] = getComputedStyle(document.body).backgroundColor.match(/[\d.]+/g).map(Number);
  return (r + g + b) / 3;
});

// Distinct colours of a screenshot: an empty page has one.
const colours = (page, picture) => page.evaluate(async (data) => {
  const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  return new Set(new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer)).size;
}, picture.toString("base64"));

async function read(name, base, offline, photographed) {
  const context = await browser.newContext({ offline, viewport: { width: 1280, height: 900 } });
  context.setDefaultTimeout(LONG_MS);
  const page = await context.newPage();
  const errors = [];
  const requests = [];
  const answers = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  // Whoever leaves a page ends what it still asks for (its icon, its search): that says nothing of the site.
  page.on("requestfailed", (request) => {
    const why = request.failure()?.errorText ?? "no reason";
    if (why !== "net::ERR_ABORTED") answers.push(`${request.url()}: ${why}`);
  });
  page.on("response", (response) => { if (response.status() >= 400) answers.push(`${response.url()}: ${response.status()}`); });

  const titles = [];
  const wide = [];
  for (const [path, heading] of Object.entries(PAGES)) {
    await page.goto(base + path);
    const found = await page.locator("article h1").first().evaluate((one) => one.firstChild.textContent.trim());
    const text = await page.locator("article").innerText();
    if (!found.includes(heading) || text.length < 300) titles.push(`${path}: ${found}, ${text.length} characters`);
    // Tables and code scroll within themselves; the page never does, on a phone either.
    for (const width of [1280, 390]) {
      await page.setViewportSize({ width, height: 900 });
      const content = await page.evaluate(() => document.documentElement.scrollWidth);
      if (content > width) wide.push(`${path}: ${content} of ${width} pixels`);
    }
    await page.setViewportSize({ width: 1280, height: 900 });
  }
  check(`${name}: ${Object.keys(PAGES).length} pages have their heading and text`, titles.length === 0, titles.join("; "));
  check(`${name}: no page is wider than the screen`, wide.length === 0, wide.join("; "));

  for (const path of photographed) {
    await page.goto(base + path);
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      for (const width of [1280, 390]) {
        await page.setViewportSize({ width, height: 900 });
        const picture = await page.screenshot({
          path: join(pictures, `${name}-${path.replace(/\W/g, "-")}-${colorScheme}-${width}.png`) });
        const found = await colours(page, picture);
        check(`${name}: ${path} is drawn, ${colorScheme}, ${width} pixels`, found > 20, `${found} colours`);
      }
      const light = await brightness(page);
      check(`${name}: ${path} is ${colorScheme}`, colorScheme === "light" ? light > 200 : light < 80, light);
    }
    await page.setViewportSize({ width: 1280, height: 900 });
  }

  // The search, as a reader uses it: words, hits, and the page of the first hit.
  await page.goto(`${base}docs/faults/spike.html`);
  await page.locator("input.md-search__input").click();
  await page.keyboard.type("innovation");
  const hits = page.locator(".md-search-result__item a.md-search-result__link");
  await hits.first().waitFor();
  // An item is a page with the hits in it.
  const texts = await page.locator(".md-search-result__item").allInnerTexts();
  check(`${name}: the search finds "innovation"`, texts.length > 0 && texts.every((text) => /innovation/i.test(text)),
    texts.find((text) => !/innovation/i.test(text)) ?? "no hit");
  await hits.first().click();
  await page.waitForURL((url) => !url.pathname.endsWith("spike.html"));
  const landed = await page.locator("article").innerText();
  check(`${name}: the hit's page has the word`, /innovation/i.test(landed), page.url());
  await page.locator("input.md-search__input").click();
  await page.keyboard.type("qqzzxx");
  await page.waitForFunction(() => /No matching/.test(document.querySelector(".md-search-result__meta").innerText));
  check(`${name}: the search finds nothing where there is nothing`, (await hits.count()) === 0);

  check(`${name}: no error in the console`, errors.length === 0, errors.join("; "));
  check(`${name}: everything that is asked for is there`, answers.length === 0, answers.join(" "));
  const outside = requests.filter((url) => !url.startsWith(base) && !/^(data|blob):/.test(url));
  check(`${name}: nothing is asked of another place`, requests.length > 20 && outside.length === 0, outside.join(" "));
  await context.close();
}

await read("disk", `${pathToFileURL(site).href}/`, true, ["index.html", "reference/keys.html"]);
await read("server", served, false, []);
await browser.close();
server.close();
if (failed > 0) {
  console.error(`${failed} checks failed`);
  process.exit(1);
}
