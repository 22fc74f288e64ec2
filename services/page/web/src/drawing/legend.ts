// What the colours of a ramp mean: a bar with numbers below it.
import { texts } from "../texts/index.js";
import { type ColourBy, rampColour, rampOf, type Theme } from "./colours.js";
import { kFont } from "./labels.js";

const kBar_px = 8, kStep_px = 2;

/** From the foot of what stands above it to the foot of its numbers, pixels. */
export const kLegendHeight_px = 50;
/** Of that, the room for its name, which stands above its bar. */
export const kLegendName_px = 22;

/** Paints the legend of a ramp with its bar at `y_px`; of what is coloured otherwise nothing. */
export function paintLegend(context: CanvasRenderingContext2D, theme: Theme, colour_by: ColourBy, at: { x_px: number; y_px: number; width_px: number; ground: string }): void {
  const ramp = rampOf(colour_by);
  if (ramp === undefined) return;
  const { x_px, y_px, width_px } = at, first = ramp.share(ramp.ticks[0]!), last = ramp.share(ramp.ticks.at(-1)!);
  const toX = (value: number) => x_px + (ramp.share(value) - first) / (last - first) * width_px;
  for (let x = 0; x < width_px; x += kStep_px) {
    context.fillStyle = `rgb(${rampColour(first + x / width_px * (last - first), theme.isNight, theme.isDark).join(" ")})`;
    context.fillRect(x_px + x, y_px, kStep_px, kBar_px);
  }
  context.font = kFont;
  context.lineJoin = "round";
  context.strokeStyle = at.ground;
  context.lineWidth = 4;
  context.fillStyle = theme.css.text;
  const write = (text: string, x: number, y: number) => { context.strokeText(text, x, y); context.fillText(text, x, y); };
  context.textAlign = "left";
  context.textBaseline = "bottom";
  write(texts.drawing.legends[colour_by] ?? "", x_px, y_px - 3);
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const tick of ramp.ticks) write(String(tick), toX(tick), y_px + kBar_px + 3);
}
