// What the trials share: lookout-page as a process, and a browser that looks at it.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { request } from "node:http";
import { chromium } from "playwright-core";

export const bin = process.env.LOOKOUT_BIN, log = process.env.LOOKOUT_LOG, source = process.env.LOOKOUT_SOURCE;
const kStart_ms = 20_000, kKept_chars = 100_000;
const started = [];

/** Starts a program, and waits until it prints what is expected (null: nothing). */
export async function startProgram(program, words, expected, options = {}) {
  const child = spawn(program, words, { stdio: ["ignore", "pipe", "pipe"], ...options });
  started.push(child);
  let printed = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (bytes) => { printed = (printed + bytes).slice(-kKept_chars); });
  const until = Date.now() + kStart_ms;
  for (;;) {
    const found = expected?.exec(printed);
    if (found || expected === null) return { child, found, printed: () => printed };
    if (child.exitCode !== null || Date.now() > until) throw new Error(`${program} did not start: ${printed}`);
    await wait(50);
  }
}
/** Starts lookout-page with a log; the port is any that is free, unless it is given. */
export async function startFilm(files = [log], port = 0, more = []) {
  const { child, found } = await startProgram(`${bin}/lookout-page`, ["--log", ...files, ...(port > 0 ? ["--port", String(port)] : []), ...more], /http:\/\/[\w.]+:(\d+)/);
  return { child, port: Number(found[1]), url: `http://127.0.0.1:${found[1]}/` };
}
export async function stop({ child }) {
  if (child.exitCode !== null || child.signalCode !== null) return;
  child.kill("SIGTERM");
  await Promise.race([once(child, "exit"), wait(5000).then(() => { child.kill("SIGKILL"); })]);
}
/** What a trial that failed has left: the run of trials ends only without it. */
export async function stopAll() { for (const child of started.splice(0)) await stop({ child }); }
export const wait = (ms) => new Promise((settle) => { setTimeout(settle, ms); });

export function startBrowser() {
  return chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update",
      "--disable-sync", "--font-render-hinting=none", "--force-color-profile=srgb"],
  });
}
/** A page that keeps what it asked for and what went wrong in it. */
export async function openPage(browser, url, { width = 1440, height = 900, palette = "day", settings = {} } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, deviceScaleFactor: 1, reducedMotion: "reduce", locale: "en-GB", timezoneId: "UTC" });
  await context.addInitScript((kept) => { localStorage.setItem("lookout.settings", kept); }, JSON.stringify({ palette, ...settings }));
  const page = await context.newPage();
  page.setDefaultTimeout(8000);
  page.asked = [];
  page.errors = [];
  page.on("request", (asked) => { page.asked.push(asked.url()); });
  let numFrames = 0;
  page.numFrames = () => numFrames;
  page.on("websocket", (socket) => {
    page.asked.push(socket.url());
    socket.on("framereceived", ({ payload }) => { if (typeof payload !== "string") ++numFrames; });
  });
  page.on("pageerror", (error) => { page.errors.push(String(error)); });
  page.on("console", (message) => { if (message.type() === "error") page.errors.push(message.text()); });
  await page.goto(url);
  return page;
}
/** All names and descriptions of the accessibility tree, with their roles. */
export async function accessibleTexts(page) {
  const session = await page.context().newCDPSession(page);
  const { nodes } = await session.send("Accessibility.getFullAXTree");
  await session.detach();
  return nodes.filter((node) => !node.ignored).map((node) => ({ role: node.role?.value ?? "", name: node.name?.value ?? "" }));
}
/** The status of one request with headers of its own. */
export function ask(port, { method = "GET", path = "/", headers = {}, body = "" } = {}) {
  return new Promise((settle, fail) => {
    const sent = request({ host: "127.0.0.1", port, method, path, headers, setHost: !("Host" in headers), timeout: 10_000 }, (response) => {
      response.resume();
      response.on("end", () => { settle({ status: response.statusCode, headers: response.headers }); });
    });
    sent.on("error", fail);
    sent.on("timeout", () => { sent.destroy(new Error("no answer within 10 s")); });
    sent.end(body);
  });
}
export const socketHeaders = (port, more = {}) => ({
  Host: `127.0.0.1:${port}`, Origin: `http://127.0.0.1:${port}`, Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": "13",
  "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Protocol": "lookout.page.v1", ...more,
});
