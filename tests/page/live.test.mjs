// The live look-out in chromium: a crossing on the simulated boat, its alerts, who may acknowledge, and what the page says when something fails.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { connect } from "node:net";
import { cpSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { after, before, test } from "node:test";
import { accessibleTexts, ask, bin, openPage, socketHeaders, source, startBrowser, startProgram, stop, wait } from "./harness.mjs";

const kServices = execFileSync(`${bin}/lookout-up`, ["--list"], { encoding: "utf8" }).trim().split("\n");
const kPort = 7668;  // of a network namespace of its own
const kUrl = `http://127.0.0.1:${kPort}/`;

const folder = mkdtempSync(`${tmpdir()}/page_live.`), config = `${folder}/config`;
const services = new Map();
let sim = null, browser, token;

const start = async (name) => {
  services.set(name, await startProgram(`${bin}/lookout-${name}`, ["--config", config], /: starts, version /, { cwd: folder }));
};
const sail = async (seconds) => {
  sim = await startProgram(`${bin}/lookout-sim`, ["--config", config, "--scene", "crossing", "--seed", "1", "--seconds", String(seconds), "--udp", "127.0.0.1"], null);
};

before(async () => {
  cpSync(`${source}/config/demo`, config, { recursive: true });
  writeFileSync(`${config}/page.txtpb`, `port: ${kPort}\ntoken_file: "../token"\nlook_back_folder: "../look-back"\n`, { flag: "a" });
  for (const name of kServices) await start(name);
  token = readFileSync(`${folder}/token`, "utf8").trim();
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  if (sim !== null) await stop(sim);
  for (const name of [...kServices].reverse()) if (services.has(name)) await stop(services.get(name));
  rmSync(folder, { recursive: true });
});

const open = async (options = {}, hash = "") => openPage(browser, kUrl + hash, options);
const mode = (page) => page.getAttribute(".mode", "data-mode");
const isMode = (page, wanted, timeout = 15_000) => page.waitForFunction((is) => document.querySelector(".mode")?.getAttribute("data-mode") === is, wanted, { timeout });
async function until(what, timeout_ms, isTrue) {
  for (const end = Date.now() + timeout_ms; !await isTrue(); await wait(500)) assert.ok(Date.now() < end, what);
}
/** Messages that come to a page in so many ms. */
async function framesIn(page, ms) {
  const before = page.numFrames();
  await wait(ms);
  return page.numFrames() - before;
}

test("before anything came the page says so, and that nobody keeps a look-out is no secret", async () => {
  const page = await open();
  await page.waitForFunction(() => /Nothing came yet|No look-out/.test(document.body.innerText), null, { timeout: 15_000 });
  assert.notEqual(await mode(page), "live");
  await page.context().close();
});

test("an alert is raised, seen and heard of by screen readers, refused without the token, acknowledged with it, and cleared", async () => {
  await sail(150);
  const stranger = await open();
  await isMode(stranger, "live");
  await stranger.waitForSelector(".alerts li.alert[data-gravity=warning]", { timeout: 40_000 });
  const texts = await accessibleTexts(stranger);
  assert.ok(texts.some(({ role, name }) => role === "button" && /^Acknowledge: .*(closest approach|guard zone)/.test(name)), "no button of the alert in the accessibility tree");
  assert.ok(texts.some(({ name }) => /^(WARNING|CAUTION): /.test(name)), "screen readers are not told");
  // Without the token the page says why nothing happens, and the server refuses whoever asks it past the page.
  await wait(600);
  await stranger.click(".alerts li.alert[data-gravity=warning] button.acknowledge");
  await stranger.waitForFunction(() => /Not allowed: open this page by the link/.test(document.querySelector(".alerts").innerText));
  const own = { Host: `127.0.0.1:${kPort}`, Origin: `http://127.0.0.1:${kPort}`, "Content-Type": "application/json" };
  const body = JSON.stringify({ alert_id: 1, raised_utime_us: 1 });
  assert.equal((await ask(kPort, { method: "POST", path: "/acknowledge", headers: own, body })).status, 401);
  assert.equal((await ask(kPort, { method: "POST", path: "/acknowledge", headers: { ...own, Authorization: `Bearer ${"0".repeat(token.length)}` }, body })).status, 401);

  const helmsman = await open({}, `#token=${token}`);
  assert.equal(new URL(helmsman.url()).hash, "", "the token stays in the address");
  // One that is not over: what is over is cleared at once when it is acknowledged.
  const active = '.alerts li.alert[data-gravity=warning]:has(.level:text-is("WARNING")) .name';
  await helmsman.waitForSelector(active, { timeout: 60_000 });
  // Silence is no acknowledgement: the alert stands as before.
  await helmsman.click(".alerts button.silence");
  await helmsman.waitForFunction(() => /^Silent for \d+ s$/.test(document.querySelector(".alerts button.silence").textContent));
  const name = await helmsman.textContent(active);
  const rowsOf = (page) => page.$$eval(".alerts li.alert", (rows) => rows.map((row) => ({ gravity: row.dataset.gravity, text: row.querySelector(".name").textContent })));
  const isLoud = async (page) => (await rowsOf(page)).some((row) => row.gravity !== "quiet" && row.text === name);
  // Pressed again where the row has just moved: a touch that was meant for another counts for nothing.
  await until(`${name} is not acknowledged`, 10_000, async () => {
    if (!await isLoud(helmsman)) return true;
    const row = await helmsman.$(`.alerts li.alert:has(.name:text-is("${name}")) button.acknowledge:visible`);
    await row?.click({ timeout: 1000 }).catch(() => undefined);
    return false;
  });
  await until("another window does not know of it", 5000, async () => !await isLoud(stranger));
  // And when it has passed, it is gone. Acknowledged ones stand last.
  await until(`${name} is not cleared`, 90_000, async () => {
    const more = await helmsman.$(".alerts .more[aria-expanded=false]:visible");
    await more?.click({ timeout: 1000 }).catch(() => undefined);
    return !(await rowsOf(helmsman)).some((row) => row.text === name);
  });
  for (const page of [stranger, helmsman]) {
    assert.deepEqual(page.errors.filter((error) => !/401|404/.test(error)), []);
    await page.context().close();
  }
});

// HEALTH has as many publishers as there are processes: their names in one line pushed the rates out of the pane.
test("the rate of each channel is in sight, however many publish it", async () => {
  for (const [width, height] of [[1440, 900], [920, 800], [360, 740]]) {
    const page = await open({ width, height });
    await isMode(page, "live");
    await page.click("[data-view=lists]");
    await page.click("#list-tab-channels");
    await page.waitForFunction(() => /HEALTH[\s\S]*tracker[\s\S]*Hz/.test(document.querySelector(".channels").innerText));
    const { most, right } = await page.$eval(".channels", (list) => ({
      right: list.getBoundingClientRect().right,
      most: Math.max(...[...list.querySelectorAll("td, th")].filter((cell) => cell.checkVisibility()).map((cell) => cell.getBoundingClientRect().right)),
    }));
    assert.ok(most <= right + 0.5, `${width} px: ${most} px in a pane that ends at ${right} px`);
    await page.context().close();
  }
});

test("one window that stands still costs the others nothing", async () => {
  const page = await open();
  await isMode(page, "live");
  await wait(1000);
  const alone = await framesIn(page, 4000);
  // A client that asks for everything, and is then stopped.
  const client = spawn(process.execPath, ["-e", `
    const socket = require("node:net").connect(${kPort}, "127.0.0.1", () => socket.write(${JSON.stringify(`GET /socket HTTP/1.1\r\n${Object.entries(socketHeaders(kPort)).map((entry) => entry.join(": ")).join("\r\n")}\r\n\r\n`)}));
    const text = JSON.stringify({ op: "watch", channels: ["LIDAR_SCAN", "SEGMENTS", "OBSTACLES", "TRACKS", "ALERTS", "POSE", "HEALTH"] });
    socket.once("data", () => { socket.write(Buffer.concat([Buffer.from([0x81, 0x80 | text.length, 0, 0, 0, 0]), Buffer.from(text)])); console.log("watches"); });
    socket.on("data", () => undefined);
  `], { stdio: ["ignore", "pipe", "inherit"] });
  await new Promise((settle) => { client.stdout.once("data", settle); });
  await wait(1000);
  client.kill("SIGSTOP");
  const beside = await framesIn(page, 4000);
  client.kill("SIGKILL");
  assert.ok(alone >= 40, `${alone} messages in 4 s`);
  assert.ok(beside > 0.8 * alone, `${beside} messages in 4 s beside a stopped client, ${alone} without`);
  await page.context().close();
});

// It was told in the list of processes alone, which nobody had open.
test("a process that dies stands on top, which leads to the list of processes, and no more when it is back", async () => {
  for (const [width, height] of [[1440, 900], [360, 740]]) {
    const page = await open({ width, height });
    await isMode(page, "live");
    await page.waitForFunction(() => { const line = document.querySelector(".unwell"); return line.hidden || !/plotter/.test(line.textContent); });
    await wait(2000);  // until each process was heard
    services.get("plotter").child.kill("SIGKILL");
    await page.waitForSelector('.unwell[data-level=warning]:has-text("plotter (silent)"):visible', { timeout: 15_000 });
    const { wide, left, right } = await page.$eval(".unwell", (line) => ({ wide: document.documentElement.clientWidth, left: line.getBoundingClientRect().left, right: line.getBoundingClientRect().right }));
    assert.ok(left >= 0 && right <= wide + 0.5, `from ${left} to ${right} px of ${wide}`);
    await page.click(".unwell");
    await page.waitForFunction(() => document.querySelector(".processes").checkVisibility() && /plotter\s*SILENT/.test(document.querySelector(".processes").innerText));
    await start("plotter");
    await page.waitForFunction(() => !/plotter/.test(document.querySelector(".unwell:not([hidden])")?.textContent ?? ""), null, { timeout: 15_000 });
    assert.deepEqual(page.errors, []);
    await page.context().close();
  }
});

test("the last minutes are looked back at, and left again", async () => {
  const page = await open();
  await isMode(page, "live");
  await page.waitForFunction(() => !document.querySelector(".film").hidden, null, { timeout: 15_000 });
  await page.keyboard.press(",");
  await isMode(page, "recorded");
  await page.waitForFunction(() => /not at now/.test(document.body.innerText));
  const clock = await page.textContent(".film_clock");
  await page.keyboard.press(",");
  await page.waitForFunction((old) => document.querySelector(".film_clock").textContent !== old, clock);
  await page.keyboard.press("l");
  await isMode(page, "live");
  await page.context().close();
});

test("the page process is killed and started again: the window says so, and comes back by itself", async () => {
  const page = await open();
  await isMode(page, "live");
  services.get("page").child.kill("SIGKILL");
  await isMode(page, "lost");
  await page.waitForFunction(() => /No connection to the boat/.test(document.body.innerText), null, { timeout: 10_000 });
  await start("page");
  await isMode(page, "live", 20_000);
  await page.reload();
  await isMode(page, "live", 20_000);
  assert.ok(await framesIn(page, 2000) > 10);
  await page.context().close();
});

test("more windows than may be are told so", async () => {
  await wait(3000);  // until the windows of before are gone
  const sockets = [];
  const upgraded = () => new Promise((settle) => {
    const socket = connect(kPort, "127.0.0.1", () => { socket.write(`GET /socket HTTP/1.1\r\n${Object.entries(socketHeaders(kPort)).map((entry) => entry.join(": ")).join("\r\n")}\r\n\r\n`); });
    socket.once("data", (bytes) => { settle(/HTTP\/1.1 (\d+)/.exec(bytes.toString("latin1"))?.[1]); });
    socket.on("error", () => { settle("error"); });
    sockets.push(socket);
  });
  const answers = [];
  for (let i = 0; i < 18; ++i) answers.push(await upgraded());
  for (const socket of sockets) socket.destroy();
  assert.deepEqual(answers, [...Array(16).fill("101"), "503", "503"]);
});

test("the lidar is stopped: the page says how old its picture is, and never shows it as live", async () => {
  const page = await open();
  await isMode(page, "live", 30_000);
  await stop(sim);
  await isMode(page, "old", 4000);
  await page.waitForFunction(() => /The picture is .* old/.test(document.body.innerText), null, { timeout: 4000 });
  const before = await page.textContent(".banner");
  await wait(2500);
  assert.notEqual(await page.textContent(".banner"), before, "its age stands still");
  assert.equal(await mode(page), "old");
  await page.context().close();
});

test("what was acknowledged stands in the recorder's log", async () => {
  for (const name of [...kServices].reverse()) {
    await stop(services.get(name));
    services.delete(name);
  }
  const [log] = readdirSync(`${folder}/logs`).filter((name) => name.endsWith(".lcmlog"));
  const table = execFileSync(`${bin}/lookout-export`, ["--in", `${folder}/logs/${log}`, "--table", "alerts"], { encoding: "utf8", maxBuffer: 1e9 }).split("\n").map((line) => line.split(","));
  const state = table[0].indexOf("state");
  const states = new Set(table.slice(1).map((row) => row[state]));
  // Nothing is cleared that nobody acknowledged.
  for (const wanted of ["active", "cleared"]) assert.ok(states.has(wanted), `no alert is ${wanted}: ${[...states]}`);
  assert.match(execFileSync(`${bin}/lookout-log`, ["info", `${folder}/logs/${log}`], { encoding: "utf8" }), /^ALERT_ACK /m);
});
