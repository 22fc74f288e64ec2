// One line on top while processes are not well: which, and why. It leads to the list of processes, and makes no sound.
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { button, make, Pace, setAttribute, setText } from "./dom.js";
import type { ProcessWatch } from "./process_watch.js";
import { Shape } from "./shapes.js";

const kEvery_ms = 500;

export class ProcessLine {
  readonly element = make("div");
  private readonly line: HTMLButtonElement;
  private readonly shape = new Shape();
  private readonly text = make("span");
  private readonly spoken = make("div", "for-readers");
  private readonly pace = new Pace(() => { this.draw(); }, () => kEvery_ms);

  constructor(state: State, private readonly watch: ProcessWatch, open: () => void) {
    this.line = button("", open, "banner unwell");
    this.line.append(this.shape.element, this.text);
    this.spoken.setAttribute("role", "status");
    this.element.append(this.line, this.spoken);
    state.on(["picture", "age", "connection", "showing"], () => { this.pace.ask(); });
    this.draw();
  }

  private draw(): void {
    const unwell = this.watch.unwell();
    this.line.hidden = unwell === null;
    setText(this.spoken, unwell?.who ?? "");
    if (unwell === null) return;
    setAttribute(this.line, "data-level", unwell.level);
    setAttribute(this.line, "title", `${unwell.text}\n${texts.panels.health.open}`);
    this.shape.set(unwell.level);
    setText(this.text, unwell.text);
  }
}
