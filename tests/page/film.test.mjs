// A log as a film in chromium: seeking, pictures in all palettes and widths, who may ask, hostile clients, and coming back.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { after, before, test } from "node:test";
import pixelmatch from "pixelmatch";
import pngjs from "pngjs";
import { accessibleTexts, ask, openPage, socketHeaders, source, startBrowser, startFilm, stop, wait } from "./harness.mjs";

const { PNG } = pngjs;
const kPictures = `${source}/tests/page/pictures`;
const kOtherPixels_share = 0.03;   // fonts differ a little from computer to computer
const kMoment = "+15";             // s after the begin of the log

let film, browser;
before(async () => { film = await startFilm(); browser = await startBrowser(); });
after(async () => { await browser?.close(); if (film) await stop(film); });

const clockOf = (page) => page.textContent(".film_clock");
async function seek(page, text) {
  const before = await clockOf(page);
  await page.evaluate((typed) => {
    const field = document.querySelector(".film_time");
    field.value = typed;
    field.dispatchEvent(new Event("change"));
  }, text);
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, before, { timeout: 5000 });
}
async function opened(options) {
  const page = await openPage(browser, film.url, options);
  await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "", null, { timeout: 10_000 });
  return page;
}
const seconds = (clock) => { const [, h, m, s] = /(\d+):(\d+):([\d.]+) UTC/.exec(clock); return 3600 * h + 60 * m + Number(s); };

test("a log opens at its first moment, steps by scans, jumps to a time and plays", async () => {
  const page = await opened();
  const opening = await clockOf(page), first = seconds(opening);
  await page.keyboard.press(".");
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, opening);
  const second = seconds(await clockOf(page));
  assert.ok(second - first > 0.05 && second - first < 0.25, `a step of ${second - first} s`);
  const began = Date.now();
  await seek(page, "+12");
  assert.ok(Date.now() - began < 2000, `seeking took ${Date.now() - began} ms`);
  assert.ok(Math.abs(seconds(await clockOf(page)) - first - 12) < 0.4, await clockOf(page));
  await page.selectOption(".film_rate", "5");
  await page.keyboard.press(" ");
  await wait(2000);
  await page.keyboard.press(" ");
  const played = seconds(await clockOf(page)) - first - 12;
  assert.ok(played > 5 && played < 13, `played ${played} s of the log in 2 s at 5 times`);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test("alerts are jumped to, and screen readers are told of them", async () => {
  const page = await opened();
  const before = await clockOf(page);
  await wait(1000);  // until the time line knows the events
  await page.keyboard.press("]");
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, before);
  await wait(500);
  const texts = await accessibleTexts(page);
  assert.ok(texts.some(({ role, name }) => role === "slider" && name === "Time of the recording"));
  assert.ok(texts.some(({ name }) => /closest approach|guard zone/i.test(name)), "no alert in the accessibility tree");
  await page.context().close();
});

test("plots show the numbers of the log", async () => {
  const page = await opened();
  await page.click("[data-view=plots]");
  await page.waitForFunction(() => /POSE: heading\s*\d/.test(document.querySelector(".pane.side").innerText), null, { timeout: 10_000 });
  await page.context().close();
});

test("nothing is asked of another computer", async () => {
  const page = await opened();
  for (const tab of await page.$$(".tabs button:visible")) { await tab.click(); await wait(200); }
  const foreign = page.asked.filter((url) => !/^(http|ws):\/\/127\.0\.0\.1:/.test(url) && !/^(data|blob):/.test(url));
  assert.deepEqual(foreign, []);
  assert.deepEqual(page.errors.filter((error) => !/tiles\.json|404/.test(error)), []);
  await page.context().close();
});

const kPhone = [360, 740], kTablet = [820, 1180], kWide = [1440, 900];
// Each palette and each width twice or more; all of them would be 12 pictures in the repository.
for (const [palette, sizes] of [["day", [kPhone, kTablet, kWide]], ["dusk", [kPhone]], ["night", [kPhone, kTablet, kWide]], ["sun", [kTablet]]]) {
  for (const [width, height] of sizes) {
    test(`picture: ${palette}, ${width} px wide`, async () => {
      const page = await opened({ width, height, palette });
      await seek(page, kMoment);
      await wait(1500);
      const shot = await page.screenshot();
      await page.context().close();
      const file = `${kPictures}/${palette}_${width}.png`;
      if (process.env.LOOKOUT_NEW_PICTURES) { mkdirSync(kPictures, { recursive: true }); writeFileSync(file, shot); return; }
      assert.ok(existsSync(file), `${file} is missing: make it by LOOKOUT_NEW_PICTURES=1 ./dev test slow slow_page_film`);
      const stored = PNG.sync.read(readFileSync(file)), now = PNG.sync.read(shot);
      assert.deepEqual([now.width, now.height], [stored.width, stored.height]);
      const marked = new PNG({ width: now.width, height: now.height });
      const share = pixelmatch(stored.data, now.data, marked.data, now.width, now.height, { threshold: 0.2 }) / (now.width * now.height);
      if (share > kOtherPixels_share) {
        writeFileSync(`${palette}_${width}.now.png`, shot);
        writeFileSync(`${palette}_${width}.difference.png`, PNG.sync.write(marked));
      }
      assert.ok(share <= kOtherPixels_share, `${(100 * share).toFixed(1)} % of the pixels are others than in ${file}; see ${process.cwd()}/${palette}_${width}.*.png`);
    });
    test(`nothing is wider than the screen: ${palette}, ${width} px`, async () => {
      const page = await opened({ width, height, palette });
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      await page.context().close();
    });
  }
}

test("who may ask", async () => {
  const { port } = film, own = { Host: `127.0.0.1:${port}` };
  assert.equal((await ask(port, { headers: own })).status, 200);
  assert.equal((await ask(port, { headers: { Host: "evil.example" } })).status, 421);
  assert.equal((await ask(port, { headers: { ...own, Origin: "http://evil.example" } })).status, 403);
  assert.equal((await ask(port, { path: "/socket", headers: socketHeaders(port, { Origin: "http://evil.example" }) })).status, 403);
  const policy = (await ask(port, { headers: own })).headers["content-security-policy"];
  assert.match(policy, /default-src 'none'/);
  assert.doesNotMatch(policy, /unsafe/);
});

test("hostile clients cost those who look nothing", async () => {
  const page = await opened();
  const sockets = [];
  const open = (text) => {
    const socket = connect(film.port, "127.0.0.1", () => { socket.write(text); });
    socket.on("error", () => undefined);
    sockets.push(socket);
    return socket;
  };
  for (let i = 0; i < 1000; ++i) open(i % 3 === 0 ? "GET / HTTP/1.1\r\nHost: 127" : i % 3 === 1 ? Buffer.from([0, 255, 3, 7, 13, 10]) : "");
  const upgraded = open(`GET /socket HTTP/1.1\r\n${Object.entries(socketHeaders(film.port)).map((entry) => entry.join(": ")).join("\r\n")}\r\n\r\n`);
  await wait(300);
  // The head of a frame of 100 MB, and garbage behind it.
  upgraded.write(Buffer.from([0x81, 0xff, 0, 0, 0, 0, 0x06, 0x40, 0, 0, 1, 2, 3, 4]));
  upgraded.write(Buffer.alloc(65536, 0x5a));
  const before = await clockOf(page);
  await page.keyboard.press(".");
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, before, { timeout: 3000 });
  for (const socket of sockets) socket.destroy();
  assert.equal(film.child.exitCode, null);
  await wait(500);
  assert.equal((await ask(film.port, { headers: { Host: `127.0.0.1:${film.port}` } })).status, 200);
  await page.context().close();
});

test("the page says that its server is gone, and comes back by itself", async () => {
  const page = await opened();
  await seek(page, "+10.05");
  const shown = await clockOf(page);
  const { port } = film;
  await stop(film);
  await page.waitForFunction(() => /no connection/i.test(document.body.innerText), null, { timeout: 10_000 });
  film = await startFilm(undefined, port);
  await page.waitForFunction(() => !/no connection/i.test(document.body.innerText), null, { timeout: 15_000 });
  // The moment that was shown is shown again, and the next can be.
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent === old, shown, { timeout: 5000 });
  await wait(1500);
  await page.keyboard.press(".");
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, shown, { timeout: 5000 });
  await page.reload();
  await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "", null, { timeout: 10_000 });
  await page.context().close();
});
