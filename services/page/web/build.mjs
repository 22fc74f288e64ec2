// Builds the page into the folder that is named: node build.mjs FOLDER. Run where node_modules is; LCM_TYPES names the folder of the wire types.
import { copyFileSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { build } from "esbuild";

const folder = process.argv[2];
execFileSync(process.execPath, ["generate_messages.mjs"], { stdio: "inherit" });

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const options = { bundle: true, minify: true, charset: "utf8", legalComments: "none", target: "es2022", metafile: true, logLevel: "warning" };
const script = await build({ ...options, entryPoints: ["src/main.ts"], format: "iife", outfile: join(folder, "page.js"), sourcemap: "linked", sourcesContent: true });
const style = await build({ ...options, entryPoints: ["page.css"], outfile: join(folder, "page.css") });
for (const file of ["index.html", "icon.svg"]) copyFileSync(file, join(folder, file));

// Licences of the packages of which anything is in the page.
const inputs = [script, style].flatMap(({ metafile }) => Object.values(metafile.outputs).flatMap((output) => Object.entries(output.inputs)))
  .filter(([, { bytesInOutput }]) => bytesInOutput > 0).map(([path]) => path);
const packages = new Set(inputs.map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1]).filter(Boolean));
const texts = [...packages].sort().map((name) => {
  const place = join("node_modules", name);
  const licence = readdirSync(place).find((entry) => /^licen[cs]e/i.test(entry));
  const { version } = JSON.parse(readFileSync(join(place, "package.json"), "utf8"));
  return `${name} ${version}\n\n${readFileSync(join(place, licence), "utf8").trim()}\n`;
});
writeFileSync(join(folder, "licences.txt"), texts.join("\n\n"));
