// Figures of the page in chromium (./dev bench page [SECONDS]): the first picture of a log; then, live, ten scans a second of 30 000 returns and 200 tracks:
// animation frames, time from scan to pixel, heap; then the server with four clients, one of them stopped. Prints; decides nothing.
import { spawn } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { cpus, loadavg, tmpdir } from "node:os";
import { bin, log, socketHeaders, source, startBrowser, startFilm, startProgram, stop, wait } from "./harness.mjs";

const kSeconds = Number(process.argv[2] ?? 60);
const kVisits = 5, kClients = 4, kClients_s = 20, kTicksPerSecond = 100, kPort = 7668;
const kChannels = ["LIDAR_SCAN", "SEGMENTS", "OBSTACLES", "TRACKS", "ALERTS", "POSE", "HEALTH", "LIDAR_CLOCK", "GNSS_FIX"];

const at = (values, share) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))] ?? NaN;
const ticksOf = (pid) => readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\) /, "").split(" ").slice(11, 13).reduce((sum, ticks) => sum + Number(ticks), 0);
const mbOf = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1]) / 1024;
async function shareOf(pid, seconds) {
  const ticks = ticksOf(pid);
  await wait(1000 * seconds);
  return (ticksOf(pid) - ticks) / kTicksPerSecond / seconds;
}

// In the page: when animation frames came, and how old a scan was when the second frame after its last message began (the first has drawn it).
function watch() {
  const kept = { frames_ms: [], scans_ms: [], pictures: 0 };
  window.lookoutFigures = kept;
  const turn = (now) => { kept.frames_ms.push(now); requestAnimationFrame(turn); };
  requestAnimationFrame(turn);
  const Plain = window.WebSocket;
  window.WebSocket = class extends Plain {
    constructor(...words) {
      super(...words);
      let channels = [];
      this.addEventListener("message", ({ data }) => {
        if (typeof data === "string") {
          const told = JSON.parse(data);
          if (told.type === "hello") channels = told.channels;
          return;
        }
        const head = new DataView(data);
        // ALERTS is the last message of a scan, one a scan.
        if (channels[head.getUint16(2, true)] !== "ALERTS") return;
        const came_us = Number(head.getBigInt64(8, true));
        requestAnimationFrame(() => { requestAnimationFrame(() => {
          kept.pictures += 1;
          kept.scans_ms.push(performance.timeOrigin + performance.now() - came_us / 1000);
        }); });
      });
    }
  };
}

async function firstPicture(browser, url) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  let bytes = 0;
  await session.send("Network.enable");
  session.on("Network.loadingFinished", ({ encodedDataLength }) => { bytes += encodedDataLength; });
  const begin = performance.now();
  await page.goto(url, { waitUntil: "commit" });
  // The time line names the moment when its picture is there; the views draw in the frame after.
  await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "", null, { polling: "raf" });
  await page.evaluate(() => new Promise((settle) => { requestAnimationFrame(() => { requestAnimationFrame(settle); }); }));
  const first_ms = performance.now() - begin;
  await wait(500);
  await context.close();
  return { first_ms, bytes };
}

/** A client that takes everything and says so. */
function startClient() {
  const ask = Object.entries(socketHeaders(kPort)).map((entry) => entry.join(": ")).join("\r\n");
  return spawn(process.execPath, ["-e", `
    const socket = require("node:net").connect(${kPort}, "127.0.0.1", () => socket.write(${JSON.stringify(`GET /socket HTTP/1.1\r\n${ask}\r\n\r\n`)}));
    const say = (object) => { const text = JSON.stringify(object), n = text.length; socket.write(Buffer.concat([Buffer.from(n < 126 ? [0x81, 0x80 | n, 0, 0, 0, 0] : [0x81, 0xfe, n >> 8, n & 255, 0, 0, 0, 0]), Buffer.from(text)])); };
    let buffer = Buffer.alloc(0), isOpen = false, frames = 0, told = 0;
    socket.on("data", (bytes) => {
      buffer = Buffer.concat([buffer, bytes]);
      if (!isOpen) {
        const end = buffer.indexOf("\\r\\n\\r\\n");
        if (end < 0) return;
        buffer = buffer.subarray(end + 4);
        isOpen = true;
        say({ op: "watch", channels: ${JSON.stringify(kChannels)} });
      }
      for (;;) {
        if (buffer.length < 2) break;
        const short = buffer[1] & 127, head = short < 126 ? 2 : short === 126 ? 4 : 10;
        if (buffer.length < head) break;
        const length = short < 126 ? short : short === 126 ? buffer.readUInt16BE(2) : Number(buffer.readBigUInt64BE(2));
        if (buffer.length < head + length) break;
        if ((buffer[0] & 15) === 2) ++frames;
        if ((buffer[0] & 15) === 9) { const pong = Buffer.from(buffer.subarray(0, head + length)); socket.write(Buffer.concat([Buffer.from([0x8a, 0x80 | length, 0, 0, 0, 0]), pong.subarray(head)])); }
        buffer = buffer.subarray(head + length);
      }
      if (frames > told) { told = frames; say({ op: "got", frames }); }
    });
    socket.on("error", () => process.exit(1));
    setInterval(() => console.log(frames), 500);
  `], { stdio: ["ignore", "pipe", "inherit"] });
}
function framesOf(client) {
  let frames = 0;
  client.stdout.on("data", (bytes) => { frames = Number(String(bytes).trim().split("\n").at(-1)); });
  return () => frames;
}

const say = (what, value) => { console.log(`${what.padEnd(58)} ${value}`); };
const folder = mkdtempSync(`${tmpdir()}/page_figures.`), config = `${folder}/config`;
cpSync(`${source}/config/demo`, config, { recursive: true });
writeFileSync(`${config}/page.txtpb`, `port: ${kPort}\ntoken_file: "../token"\nlook_back_folder: "../look-back"\n`, { flag: "a" });
say("cores, load of the minute before", `${cpus().length}, ${loadavg()[0].toFixed(2)}`);
const browser = await startBrowser();
const started = [];
try {
  const film = await startFilm();
  started.push(film);
  const visits = [];
  for (let i = 0; i < kVisits; ++i) visits.push(await firstPicture(browser, film.url));
  await stop(film);
  say("first picture of a log: median, most", `${at(visits.map((visit) => visit.first_ms), 0.5).toFixed(0)} ms, ${at(visits.map((visit) => visit.first_ms), 1).toFixed(0)} ms`);
  say("bytes of the page over HTTP", `${(visits[0].bytes / 1000).toFixed(0)} kB`);

  const server = await startProgram(`${bin}/lookout-page`, ["--config", config], /: starts, version /, { cwd: folder });
  started.push(server);
  const load = await startProgram(process.env.LOOKOUT_LOAD, ["--log", process.env.LOOKOUT_DUAL_LOG, "--seconds", String(kSeconds + 2 * kClients_s + 60)], /^sends: (.*)$/m);
  started.push(load);
  say("load: ten a second of", load.found[1]);
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  await context.addInitScript(watch);
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  await session.send("Performance.enable");
  const heap = async () => {
    await session.send("HeapProfiler.collectGarbage");
    return (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "JSHeapUsedSize").value / 1e6;
  };
  await page.goto(`http://127.0.0.1:${kPort}/`);
  const settle_s = Math.min(60, Math.max(5, kSeconds / 10));
  await wait(1000 * settle_s);
  const heapBefore_mb = await heap();
  await page.evaluate(() => { Object.assign(window.lookoutFigures, { frames_ms: [], scans_ms: [], pictures: 0 }); });
  const begin = performance.now(), ticks = ticksOf(server.child.pid);
  await wait(1000 * (kSeconds - settle_s));
  const { frames_ms, scans_ms, pictures } = await page.evaluate(() => window.lookoutFigures);
  const seconds = (performance.now() - begin) / 1000;
  const intervals_ms = frames_ms.slice(1).map((time, index) => time - frames_ms[index]);
  say("watched", `${seconds.toFixed(0)} s, load ${loadavg()[0].toFixed(2)} with chromium's own`);
  say("animation frames: median, 99 %, most", `${(1000 / at(intervals_ms, 0.5)).toFixed(1)} frames/s, ${at(intervals_ms, 0.99).toFixed(0)} ms, ${at(intervals_ms, 1).toFixed(0)} ms`);
  say("animation frames below 100 ms", `${(100 * intervals_ms.filter((ms) => ms < 100).length / intervals_ms.length).toFixed(2)} %`);
  say("pictures a second; scan to pixel: median, 95 %, most", `${(pictures / seconds).toFixed(1)}; ${at(scans_ms, 0.5).toFixed(0)} ms, ${at(scans_ms, 0.95).toFixed(0)} ms, ${at(scans_ms, 1).toFixed(0)} ms`);
  await page.evaluate(() => { Object.assign(window.lookoutFigures, { frames_ms: [], scans_ms: [], pictures: 0 }); });
  const heapAfter_mb = await heap();
  say("heap after the begin, at the end, growth", `${heapBefore_mb.toFixed(1)} MB, ${heapAfter_mb.toFixed(1)} MB, ${(100 * (heapAfter_mb / heapBefore_mb - 1)).toFixed(1)} %`);
  say("server with one window: core, memory", `${(100 * (ticksOf(server.child.pid) - ticks) / kTicksPerSecond / seconds).toFixed(1)} %, ${mbOf(server.child.pid).toFixed(1)} MB`);
  await context.close();

  const clients = Array.from({ length: kClients }, startClient);
  for (const client of clients) started.push({ child: client });
  const counts = clients.map(framesOf);
  await wait(2000);
  const before = counts.map((count) => count());
  const share = await shareOf(server.child.pid, kClients_s);
  const all = counts.map((count, index) => (count() - before[index]) / kClients_s);
  say("server with four clients of all channels: core, memory", `${(100 * share).toFixed(1)} %, ${mbOf(server.child.pid).toFixed(1)} MB`);
  clients[0].kill("SIGSTOP");
  await wait(2000);
  const then = counts.map((count) => count());
  await wait(1000 * kClients_s);
  const others = counts.map((count, index) => (count() - then[index]) / kClients_s).slice(1);
  say("messages a second of each client; one stopped: of the others", `${all.map((rate) => rate.toFixed(0)).join(" ")}; ${others.map((rate) => rate.toFixed(0)).join(" ")}`);
  clients[0].kill("SIGKILL");
} finally {
  await browser.close();
  for (const program of started.reverse()) await stop(program);
  rmSync(folder, { recursive: true });
}
