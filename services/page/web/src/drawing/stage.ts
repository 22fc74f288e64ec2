// What every drawn view stands on: canvases of the right size, buttons for the thumb, the word that the picture is old, and one drawing a frame of the screen.
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { duration } from "../units.js";
import { listen, type Gestures } from "./gestures.js";
import type { Box } from "./labels.js";

const kOld_s = 1;
const kMostPixelsPerPixel = 2;  // finer screens cost more than the eye has of it

/** Whether what is shown is too old to be looked at as now, or as the time of the log that is shown. */
export function isOld(state: State): boolean { return state.picture !== null && state.age_s > kOld_s; }

// Strokes on 24 by 24.
const kIcons = {
  nearer: "M12 5v14M5 12h14",
  further: "M5 12h14",
  centre: "M12 3v5M12 16v5M3 12h5M16 12h5M12 7a5 5 0 1 0 .01 0M12 11.9v.2",
  measure: "M4 16.5 16.5 4 20 7.5 7.5 20zM8 12.5l2 2M11 9.5l2.5 2.5M14 6.5l2 2",
  colours: "M12 4a8 8 0 1 0 .01 0M12 4v16M12 8h5.8M12 12h8M12 16h5.8", head: "M12 3 18.5 20 12 16 5.5 20z", north: "M7 19V5l10 14V5",
} as const;
export type Icon = keyof typeof kIcons;
const kSvg = "http://www.w3.org/2000/svg";
/** A sign of a button; its words stand in the label of the button. */
export function icon(name: Icon): SVGSVGElement {
  const svg = document.createElementNS(kSvg, "svg"), path = document.createElementNS(kSvg, "path");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("drawing-icon");
  path.setAttribute("d", kIcons[name]);
  svg.append(path);
  return svg;
}

/** An element of the page with a class and, where it is given, a text. */
export function make<Tag extends keyof HTMLElementTagNameMap>(tag: Tag, name: string, text = ""): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  element.className = name;
  if (text !== "") element.textContent = text;
  return element;
}

export class Stage {
  readonly element: HTMLElement;
  readonly plan = document.createElement("canvas");
  readonly context: CanvasRenderingContext2D;
  /** In pixels of the style sheet. */
  width_px = 1;
  height_px = 1;
  scale = 1;
  /** Where buttons lie over the canvases: on a low screen in more than one column. */
  covered: readonly Box[] = [];
  private readonly tools = make("div", "drawing-tools");
  private readonly old = make("p", "drawing-old");
  private readonly note = make("p", "drawing-note");
  private readonly tip = make("p", "drawing-tip");
  private isVisible = false;
  private isAsked = false;
  private said = "";

  /** @param below canvases under that of the plan, the lowest first */
  constructor(private readonly state: State, name: string, private readonly below: HTMLCanvasElement[], private readonly paint: () => void, gestures: Gestures) {
    this.element = make("div", `drawing ${name}`);
    this.context = this.plan.getContext("2d")!;
    this.plan.tabIndex = 0;
    this.plan.setAttribute("role", "img");
    for (const hidden of [this.old, this.tip]) hidden.setAttribute("aria-hidden", "true");
    for (const element of [this.old, this.note, this.tip]) element.hidden = true;
    this.element.append(...below, this.plan, this.note, this.old, this.tip, this.tools);
    const sizes = new ResizeObserver(() => { this.fit(); });
    for (const element of [this.element, this.tools]) sizes.observe(element);
    listen(this.plan, gestures);
    state.on(["picture", "marked", "settings", "showing", "connection", "sources"], () => { this.ask(); });
    state.on(["age", "picture", "showing"], () => { this.tellAge(); });
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    if (isVisible) { this.fit(); this.tellAge(); this.ask(); }
  }
  /** Draws with the next frame of the screen, however often it is asked for. */
  ask(): void {
    if (this.isAsked || !this.isVisible) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      if (!this.isVisible || this.width_px < 2 || this.height_px < 2) return;
      this.context.setTransform(this.scale, 0, 0, this.scale, 0, 0);
      this.paint();
    });
  }

  button(label: string, sign: Icon, onClick: () => void): HTMLButtonElement {
    const button = make("button", "drawing-button");
    button.append(icon(sign));
    button.type = "button";
    button.title = label;
    button.setAttribute("aria-label", label);
    button.onclick = () => { onClick(); this.ask(); };
    this.tools.append(button);
    return button;
  }
  /** Keys of the canvas; what is known is kept from the browser. */
  keys(known: Record<string, () => void>): void {
    this.plan.addEventListener("keydown", (event) => {
      const action = event.ctrlKey || event.altKey || event.metaKey ? undefined : known[event.key];
      if (action === undefined) return;
      event.preventDefault();
      action();
      this.ask();
    });
  }
  /** What the picture shows, for those who do not see it. */
  describe(text: string): void {
    if (text !== this.said) this.plan.setAttribute("aria-label", this.said = text);
  }
  /** A word about the picture as a whole; empty: none. */
  setNote(text: string): void { setText(this.note, text); }
  /** A word beside the pointer; empty: none. */
  setTip(text: string, x_px = 0, y_px = 0): void {
    setText(this.tip, text);
    if (text === "") return;
    const isRight = x_px > this.width_px / 2, isLow = y_px > this.height_px / 2;
    this.tip.style.left = isRight ? "auto" : `${x_px + 16}px`;
    this.tip.style.right = isRight ? `${this.width_px - x_px + 16}px` : "auto";
    this.tip.style.top = isLow ? "auto" : `${y_px + 16}px`;
    this.tip.style.bottom = isLow ? `${this.height_px - y_px + 16}px` : "auto";
  }

  private tellAge(): void {
    if (!this.isVisible) return;
    const old = isOld(this.state);
    this.element.classList.toggle("old", old);
    setText(this.old, !old ? "" : (this.state.showing.kind === "live" ? texts.stale : texts.gap)(duration(Math.floor(this.state.age_s)).replace(".0 ", " ")));
  }
  private fit(): void {
    const { clientWidth, clientHeight } = this.element;
    const scale = Math.min(kMostPixelsPerPixel, devicePixelRatio || 1);
    if (clientWidth < 2 || clientHeight < 2) return;
    this.width_px = clientWidth;
    this.height_px = clientHeight;
    this.scale = scale;
    for (const canvas of [...this.below, this.plan]) {
      const width = Math.round(clientWidth * scale), height = Math.round(clientHeight * scale);
      if (canvas.width !== width) canvas.width = width;
      if (canvas.height !== height) canvas.height = height;
    }
    const all = this.element.getBoundingClientRect();
    this.covered = [...this.tools.children].map((child) => child.getBoundingClientRect())
      .map(({ x, y, width, height }) => ({ x: x - all.x, y: y - all.y, width, height }));
    this.ask();
  }
}

function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
  if (element.hidden !== (text === "")) element.hidden = text === "";
}
