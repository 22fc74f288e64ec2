// The colours of the palettes can be read: contrast by WCAG 2.2, of each text on each ground on which it stands.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

type Palette = Map<string, string>;
function palettes(): Map<string, Palette> {
  const found = new Map<string, Palette>();
  for (const [, name, body] of readFileSync("styles/palettes.css", "utf8").matchAll(/\[data-palette="(\w+)"\] \{([^}]*)\}/g)) {
    found.set(name!, new Map([...body!.matchAll(/--([\w-]+): (#[0-9a-f]{6});/g)].map(([, property, colour]) => [property!, colour!])));
  }
  return found;
}
const channels = (colour: string) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
function luminance(colour: string): number {
  const [r, g, b] = channels(colour).map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r! + 0.7152 * g! + 0.0722 * b!;
}
function contrast(a: string, b: string): number {
  const [dark, bright] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (bright! + 0.05) / (dark! + 0.05);
}

const kTexts = ["text", "muted", "accent", "caution", "warning", "ok"], kGrounds = ["bg", "panel"];
const kFills = [["on-accent", "accent"], ["on-caution", "caution-fill"], ["on-warning", "warning-fill"]];
const kDrawn = ["own", "track", "moving", "returns", "warning", "caution"];

test("contrast is computed as WCAG says", () => {
  assert.equal(contrast("#000000", "#ffffff"), 21);
  assert.ok(Math.abs(contrast("#777777", "#ffffff") - 4.48) < 0.01);
});

test("there are four palettes with the same colours", () => {
  const all = palettes();
  assert.deepEqual([...all.keys()], ["day", "dusk", "night", "sun"]);
  for (const [name, palette] of all) assert.deepEqual([...palette.keys()], [...all.get("day")!.keys()], name);
});

for (const [name, least] of [["day", 4.5], ["dusk", 4.5], ["night", 4.5], ["sun", 7]] as const) {
  test(`${name}: text has a contrast of at least ${least}`, () => {
    const palette = palettes().get(name)!;
    const pairs = [...kTexts.flatMap((text) => kGrounds.map((ground) => [text, ground])), ...kFills];
    for (const [text, ground] of pairs) {
      const found = contrast(palette.get(text!)!, palette.get(ground!)!);
      assert.ok(found >= least, `${text} on ${ground}: ${found.toFixed(2)}`);
    }
  });
  test(`${name}: what is drawn on water has a contrast of at least 3`, () => {
    const palette = palettes().get(name)!;
    for (const drawn of kDrawn) {
      const found = contrast(palette.get(drawn)!, palette.get("water")!);
      assert.ok(found >= 3, `${drawn}: ${found.toFixed(2)}`);
    }
  });
}

test("night is red on black", () => {
  for (const [property, colour] of palettes().get("night")!) {
    const [red, green, blue] = channels(colour);
    assert.equal(blue, 0, property);
    assert.ok(green! <= 0.27 * red!, `${property}: ${colour}`);
  }
});
