// Makes the pictures of services/page/README.md out of a simulated log.
import { mkdirSync } from "node:fs";
import { openPage, source, startBrowser, startFilm, stop, wait } from "./harness.mjs";

const kFolder = `${source}/services/page/pictures`;
const kPictures = [
  { name: "day", width: 1280, height: 800, palette: "day", at: "+12" },
  { name: "night", width: 1280, height: 800, palette: "night", at: "+12" },
  { name: "phone", width: 360, height: 740, palette: "dusk", at: "+12" },
  { name: "log", width: 1280, height: 800, palette: "day", at: "+20", tabs: ["cloud", "plots"] },
];

mkdirSync(kFolder, { recursive: true });
const film = await startFilm();
const browser = await startBrowser();
try {
  for (const { name, width, height, palette, at, tabs = [] } of kPictures) {
    const page = await openPage(browser, film.url, { width, height, palette });
    await page.waitForFunction(() => (document.querySelector(".film_clock")?.textContent ?? "") !== "");
    for (const tab of tabs) await page.click(`[data-view=${tab}]`);
    await page.evaluate((typed) => {
      const field = document.querySelector(".film_time");
      field.value = typed;
      field.dispatchEvent(new Event("change"));
    }, at);
    await wait(2500);
    await page.screenshot({ path: `${kFolder}/${name}.png` });
    await page.context().close();
  }
} finally {
  await browser.close();
  await stop(film);
}
