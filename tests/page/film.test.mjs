// A log as a film in chromium: seeking, pictures in all palettes and widths, who may ask, hostile clients, and coming back.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { dirname } from "node:path";
import { after, before, test } from "node:test";
import pixelmatch from "pixelmatch";
import pngjs from "pngjs";
import { accessibleTexts, ask, log, openPage, socketHeaders, source, startBrowser, startFilm, stop, stopAll, wait } from "./harness.mjs";

const { PNG } = pngjs;
const kPictures = `${source}/tests/page/pictures`;
const kOtherPixels_share = 0.03;   // fonts differ a little from computer to computer
const kMoment = "+15";             // s after the begin of the log

const kPhone = [360, 740], kTablet = [820, 1180], kWide = [1440, 900];
const folder = dirname(log);

let film, browser;
before(async () => { film = await startFilm(); browser = await startBrowser(); });
after(async () => { await browser?.close(); await stopAll(); });

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

test("a log opens, steps by scans, jumps to a time and plays", async () => {
  const page = await opened();
  const opening = await clockOf(page), first = seconds(opening);
  const since = async () => Number(/\+([\d.]+) s$/.exec(await clockOf(page))[1]);
  await page.keyboard.press(".");
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, opening);
  const second = seconds(await clockOf(page));
  assert.ok(second - first > 0.05 && second - first < 0.25, `a step of ${second - first} s`);
  const began = Date.now();
  await seek(page, "+12");
  assert.ok(Date.now() - began < 2000, `seeking took ${Date.now() - began} ms`);
  assert.equal(await since(), 12);
  await page.selectOption(".film_rate", "5");
  const started = Date.now();
  await page.keyboard.press(" ");
  await wait(2000);
  await page.keyboard.press(" ");
  const took_s = (Date.now() - started) / 1000, played = await since() - 12;
  assert.ok(played > 5 && played < 5 * took_s + 3, `played ${played} s of the log in ${took_s} s at 5 times`);
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
  assert.deepEqual(page.errors, [], "a chart that is not there is no error");
  await page.context().close();
});

test("screen readers find a heading of level one, and one notation of time stands everywhere", async () => {
  const page = await opened();
  await seek(page, kMoment);
  assert.deepEqual(await page.$$eval("h1", (found) => found.map((element) => element.textContent)), ["Lookout"]);
  const notation = /\d\d:\d\d:\d\d\.\d UTC \+15\.0 s/;
  assert.match(await clockOf(page), notation);
  assert.match(await page.textContent(".head .clock"), notation);
  assert.match(await page.getAttribute(".film_strip", "aria-valuetext"), notation);
  await page.click("#list-tab-alerts");
  await page.waitForFunction(() => /^\d\d:\d\d:\d\d\.\d UTC \+[\d.]+ s$/.test(document.querySelector(".history time")?.textContent ?? ""));
  await page.context().close();
});

// On a phone neither the own heading nor a field for a time was to be seen.
test("a phone shows heading, speed and a field for a time, live and of a log", async () => {
  const page = await opened({ width: 360, height: 740 });
  await seek(page, kMoment);
  const shown = await page.$$eval(".head .own dt, .head .own dd:not(.note)", (found) => found.filter((element) => element.checkVisibility()).map((element) => element.textContent));
  assert.equal(shown.length, 4, shown.join());
  assert.match(shown.join(" "), /^HDG \d{3}° SOG [\d.]+ kn$/);
  await page.fill(".film_time", "+5");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => / \+5\.0 s$/.test(document.querySelector(".film_clock").textContent));
  const boxes = await page.$$eval(".head > *, .film_controls > *", (found) => found.filter((element) => element.checkVisibility() && element.offsetWidth > 1).map((element) => element.getBoundingClientRect().right));
  assert.ok(Math.max(...boxes) <= 360, `${Math.max(...boxes)} px`);
  await page.context().close();
});

test("details of a track are whole, on a wide screen and on a phone", async () => {
  for (const [width, height] of [kWide, kPhone]) {
    const page = await opened({ width, height });
    await seek(page, kMoment);
    if (width < 900) await page.click("[data-view=lists]");
    await page.click(".track-table tbody tr");
    const { inside, hidden, last } = await page.$eval(".detail", (detail) => {
      const pane = detail.parentElement.getBoundingClientRect(), box = detail.getBoundingClientRect();
      detail.scrollTop = 1e6;
      const facts = [...detail.querySelectorAll(".facts > div")].filter((fact) => fact.checkVisibility());
      return { inside: box.top >= pane.top - 1 && box.bottom <= pane.bottom + 1, hidden: detail.scrollHeight - detail.clientHeight, last: pane.bottom - facts.at(-1).getBoundingClientRect().bottom };
    });
    assert.ok(inside && last >= 0, `${width} px: ${last} px below the last fact`);
    if (width >= 900) assert.equal(hidden, 0, "nothing is to be scrolled for");
    await page.context().close();
  }
});

test("while a distance is measured no words about a return lie over it", async () => {
  const page = await opened();
  await seek(page, kMoment);
  const box = await (await page.$(".drawing.around")).boundingBox(), tip = () => page.$eval(".drawing.around .drawing-tip", (element) => !element.hidden);
  // Somewhere there is a return: each place of a grid is pointed at until words come.
  let at = null;
  for (let y = 0.2; y < 0.9 && at === null; y += 0.01) {
    for (let x = 0.3; x < 0.7 && at === null; x += 0.02) {
      await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
      await wait(25);
      if (await tip()) at = [box.x + x * box.width, box.y + y * box.height];
    }
  }
  assert.notEqual(at, null, "no return was found");
  await page.click(".drawing.around button[aria-pressed=false]");
  await page.mouse.move(at[0] + 60, at[1] + 60);
  await page.mouse.click(at[0] + 60, at[1] + 60);
  await page.mouse.move(...at);
  await wait(200);
  assert.equal(await tip(), false);
  await page.context().close();
});

test("a heading that is only the course over ground is not shown as a compass", async () => {
  const other = await startFilm([`${folder}/course.lcmlog`]);
  const page = await openPage(browser, other.url);
  await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "");
  await seek(page, "+6");
  await page.waitForFunction(() => /COURSE\s*\d{3}°\s*no compass/.test(document.querySelector(".head .own").innerText));
  await page.click("#list-tab-sensors");
  await page.waitForFunction(() => /No compass: the heading is only the course over ground/.test(document.querySelector(".sensors").innerText));
  await page.context().close();
  await stop(other);
});

test("of a log nobody asks whether the tracker runs: no position at this time", async () => {
  for (const files of [[`${folder}/nowhere.lcmlog`], [log]]) {
    const other = await startFilm(files);
    const page = await openPage(browser, other.url);
    await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "");
    await wait(500);
    assert.doesNotMatch(await page.evaluate(() => document.body.innerText), /running\?/);
    if (files[0] !== log) assert.match(await page.innerText(".tracks"), /No position at this time|holds no/);
    await page.context().close();
    await stop(other);
  }
});

// A log opened on its first scan, which has neither POSE nor tracks.
test("a log opens where its server says that there is something to see", async () => {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  await page.routeWebSocket(/\/socket$/, (socket) => {
    const server = socket.connectToServer();
    server.onMessage((message) => {
      if (typeof message !== "string" || !/"sources":/.test(message)) { socket.send(message); return; }
      const told = JSON.parse(message);
      for (const source of told.sources) source.opens_utime_us = source.begin_utime_us + 4_000_000;
      socket.send(JSON.stringify(told));
    });
  });
  await page.goto(film.url);
  await page.waitForFunction(() => / \+4\.0 s$/.test(document.querySelector(".film_clock")?.textContent ?? ""), null, { timeout: 10_000 });
  await page.waitForFunction(() => /HDG\s*\d{3}°/.test(document.querySelector(".head .own").innerText));
  await context.close();
});

// An alert of the tracker, put into ALERTS on their way to the browser: lcmtypes/alert_t.lcm.
function withAlert(bytes, text) {
  const kHead = 16, kBefore = kHead + 8 + 6 * 8 + 1, told = Buffer.from(`${text}\0`);
  const alert = Buffer.alloc(8 + 4 + 2 + 2 * 4 + 8 + (4 + 1) + 2 * 8 + 6 * 4 + 2 * 8 + 4 + 8 + 4 + 4);
  let at = alert.writeInt32BE(3, alert.writeBigInt64BE(77n, 0));  // watch
  at += 2;                                                        // neither in the zone nor near
  for (const number of [1, 1]) at = alert.writeInt32BE(number, at);  // caution, active
  at = alert.writeBigInt64BE(0n, at);
  at = alert.writeInt32BE(1, at) + 1;                             // no name
  for (const number of [1n, 1n]) at = alert.writeBigInt64BE(number, at);
  for (let i = 0; i < 6; ++i) at = alert.writeFloatBE(NaN, at);
  for (let i = 0; i < 2; ++i) at = alert.writeDoubleBE(NaN, at);
  at = alert.writeInt32BE(1, at);
  at = alert.writeBigInt64BE(0n, at);
  at = alert.writeInt32BE(0, at);
  alert.writeInt32BE(told.length, at);
  const whole = Buffer.concat([bytes.subarray(0, kBefore + 4), alert, told, bytes.subarray(kBefore + 4)]);
  whole.writeInt32BE(bytes.readInt32BE(kBefore) + 1, kBefore);
  return whole;
}
test("where nobody looks is told in words, and hatched in the guard zone", async () => {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, deviceScaleFactor: 1 });
  const page = await context.newPage();
  page.setDefaultTimeout(8000);
  const text = "no look-out in part of the guard zone: 300 to 60 deg, from 5.0 m on (beyond max_range_m of the segmenter)";
  let isBlind = false, channels = [];
  await page.routeWebSocket(/\/socket$/, (socket) => {
    const server = socket.connectToServer();
    server.onMessage((message) => {
      if (typeof message === "string") { if (/"hello"/.test(message)) ({ channels } = JSON.parse(message)); socket.send(message); }
      else socket.send(isBlind && channels[message.readUInt16LE(2)] === "ALERTS" ? withAlert(message, text) : message);
    });
  });
  await page.goto(film.url);
  await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "");
  const cautions = () => page.evaluate(() => {
    const canvas = document.querySelector(".drawing.around > canvas:last-of-type"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i] === 0x8f && data[i + 1] === 0x47 && data[i + 2] === 0 && data[i + 3] === 255) ++count;
    return count;
  });
  // The same moment without it and with it: what else is in alert is in both.
  await seek(page, "+12.5");
  await wait(500);
  const before = await cautions();
  isBlind = true;
  await seek(page, "+12");
  await seek(page, "+12.5");
  await page.waitForFunction((wanted) => document.querySelector(".alerts").innerText.includes(wanted), text);
  await wait(500);
  const after = await cautions();
  assert.ok(after > before + 100, `${before} pixels of caution, then ${after}`);
  await context.close();
});

// "Next that differs" stopped at each scan, and the two pictures were a fifth of the screen each.
test("two logs: the next difference that matters is found, and one that lasts is met once", async () => {
  const two = await startFilm([log], 0, ["--beside", `${folder}/other.lcmlog`]);
  const page = await openPage(browser, two.url);
  await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "");
  await seek(page, "+2");
  await page.click("[data-view=compare]");
  for (const side of await page.$$(".compare_side .drawing")) {
    const { width, height } = await side.boundingBox();
    assert.ok(width > 480 && height > 480, `${width} x ${height} px`);
  }
  const time = async () => Number(/\+([\d.]+) s$/.exec(await clockOf(page))[1]);
  const stops = [await time()];
  for (let i = 0; i < 3; ++i) {
    const old = await clockOf(page);
    await page.click(".compare_next");
    // The first may be where the film stands.
    const isMet = ([was, mayStay]) => (mayStay || document.querySelector(".film_clock").textContent !== was) &&
      document.querySelector(".compare_table .begins, .compare_summary.begins") !== null;
    await page.waitForFunction(isMet, [old, i === 0], { timeout: 30_000 });
    stops.push(await time());
  }
  assert.ok(stops.at(-1) - stops[0] > 1, `three stops within ${stops.join(", ")} s: each scan is one`);
  // What never matters is never stopped at: less is found.
  await page.selectOption(".compare_limits select >> nth=0", "0");
  await page.selectOption(".compare_limits select >> nth=1", "0");
  assert.deepEqual(page.errors, []);
  await page.context().close();
  await stop(two);
});

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
  await seek(page, "+10.04");  // and the next scan is another tenth of a second
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
