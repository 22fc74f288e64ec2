// Builds the page in the folder that holds it and node_modules: template, style and script in one file, with the licences of the packages in the script.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const read = (path) => readFileSync(path, "utf8");

const options = { bundle: true, minify: true, write: false, charset: "ascii", legalComments: "none" };
const script = await build({ ...options, entryPoints: ["page.mjs"], format: "iife", target: "es2022", metafile: true });
const style = await build({ ...options, entryPoints: ["page.css"] });

// What has bytes in the bundle, and no more. Texts that differ in the year or holder alone stand once, below all who share them.
const inputs = Object.entries(Object.values(script.metafile.outputs)[0].inputs).filter(([, { bytesInOutput }]) => bytesInOutput > 0);
const packages = new Set(inputs.map(([path]) => /^node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1]).filter(Boolean));
const holders = new Map();
for (const name of [...packages].sort()) {
  const folder = `node_modules/${name}/`;
  const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  const paragraphs = read(folder + file).split(/\n\s*\n/).map((text) => text.trim().replace(/\s+/g, " ").replaceAll("--", "- -"));
  const isOfHolder = (text) => /^Copyright /.test(text);
  const body = paragraphs.filter((text) => !isOfHolder(text)).join("\n");
  const { version } = JSON.parse(read(folder + "package.json"));
  holders.set(body, [...(holders.get(body) ?? []), `${name} ${version}: ${paragraphs.filter(isOfHolder).join(" ")}`.trim()]);
}
const licences = [...holders].map(([body, names]) => [...names, body].join("\n")).join("\n\n");

// Text of the script must not end its element.
const code = script.outputFiles[0].text.trim().replaceAll("</script", "<\\/script");
const parts = {
  hash: `sha256-${createHash("sha256").update(code).digest("base64")}`,
  style: style.outputFiles[0].text.trim(),
  script: code,
  licences,
};
const page = read("page.html").replace(/\{\{(\w+)\}\}/g, (place, name) => parts[name] ?? place);
writeFileSync(process.argv[2], page);
