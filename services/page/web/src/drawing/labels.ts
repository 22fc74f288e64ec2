// Labels that do not cover each other: those that matter most are placed first, and what has no room stays away.
import type { Theme } from "./colours.js";

export interface Label {
  x_px: number;
  y_px: number;
  /** Free of the label: radius of what it belongs to. */
  radius_px: number;
  lines: string[];
  /** In place of lines where these have no room, one after the other; the last is drawn wherever it must. */
  shorter?: string[][];
  colour: string;
  /** In a box of its own colour: what must be read. */
  isBoxed: boolean;
}
/** Of the screen, pixels. */
export interface Box { x: number; y: number; width: number; height: number }

const kLine_px = 15;
export const kFont = "600 13px system-ui, sans-serif";

const widths = new Map<string, number>();
function widthOf(context: CanvasRenderingContext2D, text: string): number {
  let sum = 0;
  for (const character of text) {
    let width = widths.get(character);
    if (width === undefined) widths.set(character, width = context.measureText(character).width);
    sum += width;
  }
  return sum;
}

/** What labels are drawn on. `covered`: there something lies over it, so that nothing can be read. */
export interface Sheet { width_px: number; height_px: number; covered: readonly Box[] }

/** Draws labels in their order, at most `most`, but for those that must be drawn (`shorter`). `taken` holds boxes that nothing may cover, and gets those that were drawn. */
export function drawLabels(context: CanvasRenderingContext2D, labels: Label[], theme: Theme, sheet: Sheet, most: number, taken: Box[]): void {
  context.font = kFont;
  context.textBaseline = "middle";
  context.textAlign = "left";
  context.lineJoin = "round";
  const drawn: Box[] = [];
  taken.push(...sheet.covered);
  for (const label of labels) {
    if (drawn.length >= most && label.shorter === undefined) continue;
    const fit = [label.lines, ...(label.shorter ?? [])].map((lines) => {
      const width = Math.max(...lines.map((line) => widthOf(context, line))) + 10, height = kLine_px * lines.length + 4;
      return { lines, width, height, box: placeFor(label, width, height, sheet, taken) };
    });
    const found = fit.find(({ box }) => box !== null) ?? (label.shorter === undefined ? undefined : fit.at(-1));
    if (found === undefined) continue;
    const { lines, width, height } = found, box = found.box ?? within(label, width, height, sheet, drawn);
    taken.push(box);
    drawn.push(box);
    if (label.isBoxed) {
      context.fillStyle = label.colour;
      context.beginPath();
      context.roundRect(box.x, box.y, width, height, 4);
      context.fill();
      context.fillStyle = theme.css.panel;
    } else {
      context.strokeStyle = theme.css.water;
      context.lineWidth = 3.5;
      context.fillStyle = label.colour;
    }
    lines.forEach((line, index) => {
      const x = box.x + 5, y = box.y + 2 + kLine_px * (index + 0.5);
      if (!label.isBoxed) context.strokeText(line, x, y);
      context.fillText(line, x, y);
    });
  }
}

// Beside it, on the screen, over marks if it must be, but over no label and under no button where any place is left: first to the side with more room.
const kShifts_px = [0, -22, 22, -44, 44, -66, 66, -88, 88];
export function within(label: Pick<Label, "x_px" | "y_px" | "radius_px">, width: number, height: number, sheet: Sheet, drawn: readonly Box[]): Box {
  const inside = (at: number, most: number) => Math.max(2, Math.min(at, most - 2));
  const gap = label.radius_px + 6, sides = [label.x_px + gap, label.x_px - gap - width];
  if (label.x_px > sheet.width_px / 2) sides.reverse();
  const boxes = kShifts_px.flatMap((shift) => sides.map((left) => (
    { x: inside(left, sheet.width_px - width), y: inside(label.y_px - height / 2 + shift, sheet.height_px - height), width, height })));
  const isFree = (box: Box, of: readonly Box[]) => of.every((other) => isApart(box, other));
  return boxes.find((box) => isFree(box, drawn) && isFree(box, sheet.covered)) ?? boxes.find((box) => isFree(box, sheet.covered)) ?? boxes[0]!;
}
function isApart(a: Box, b: Box): boolean { return a.x + a.width < b.x || b.x + b.width < a.x || a.y + a.height < b.y || b.y + b.height < a.y; }

/** The first of four places around it (right, left, above, below) that is free and on the screen; null: none. */
export function placeFor(label: Pick<Label, "x_px" | "y_px" | "radius_px">, width: number, height: number, size: { width_px: number; height_px: number }, taken: readonly Box[]): Box | null {
  const { x_px: x, y_px: y } = label, gap = label.radius_px + 6;
  const places = [[x + gap, y - height / 2], [x - gap - width, y - height / 2], [x - width / 2, y - gap - height], [x - width / 2, y + gap]] as const;
  for (const [left, top] of places) {
    if (left < 2 || top < 2 || left + width > size.width_px - 2 || top + height > size.height_px - 2) continue;
    if (taken.every((other) => isApart({ x: left, y: top, width, height }, other))) return { x: left, y: top, width, height };
  }
  return null;
}
