// Where views stand: one at a time on a phone, two beside each other where there is room; alerts above, the time line below.
import { lineOf } from "./film.js";
import type { State, View } from "./state.js";
import { texts } from "./texts/index.js";

export type ViewName = keyof typeof texts.views;

export class Layout {
  private main: ViewName = "around";
  private side: ViewName = "lists";
  private isSideOpen = true;
  private readonly buttons = new Map<ViewName, HTMLButtonElement>();
  private readonly toggle: HTMLButtonElement;
  private readonly panes: { main: HTMLElement; side: HTMLElement };
  private readonly wide = matchMedia("(min-width: 900px)");

  constructor(private readonly state: State, private readonly views: Map<ViewName, View>, top: HTMLElement[], bottom: HTMLElement[]) {
    const make = (tag: string, name: string) => {
      const element = document.createElement(tag);
      element.className = name;
      return element;
    };
    this.panes = { main: make("section", "pane main"), side: make("section", "pane side") };
    const tabs = make("nav", "tabs");
    tabs.setAttribute("aria-label", texts.title);
    for (const name of views.keys()) {
      const button = document.createElement("button");
      button.textContent = texts.views[name];
      button.dataset["view"] = name;
      button.onclick = () => { this.show(name); };
      this.buttons.set(name, button);
      tabs.append(button);
    }
    this.toggle = document.createElement("button");
    this.toggle.type = "button";
    this.toggle.className = "side-toggle";
    this.toggle.onclick = () => { this.state.settings.set("shows_side", !this.state.settings.get("shows_side")); };
    tabs.append(this.toggle);
    const panes = make("main", "panes");
    panes.append(this.panes.main, this.panes.side);
    document.body.append(...top, tabs, panes, ...bottom);
    this.wide.onchange = () => { this.place(); };
    const palette = () => { document.documentElement.dataset["palette"] = this.state.settings.get("palette"); };
    this.state.on(["settings"], () => {
      palette();
      if (this.state.settings.get("shows_side") !== this.isSideOpen) this.place();
    });
    palette();
    this.state.on(["sources"], () => { this.offerComparing(); });
    this.offerComparing();
    this.place();
  }

  show(name: ViewName): void {
    if (this.buttons.get(name)?.hidden === true) return;
    if (this.wide.matches && (name === "lists" || name === "plots")) {
      this.side = name;
      if (this.main === "compare") this.main = "around";
      this.state.settings.set("shows_side", true);
    } else this.main = name;
    this.place();
  }

  // Where there is no second recording beside the first, there is nothing to compare.
  private offerComparing(): void {
    const { sources } = this.state;
    const isOffered = lineOf(sources).length < sources.length;
    this.buttons.get("compare")!.hidden = !isOffered;
    if (!isOffered && this.main === "compare") this.show("around");
  }

  private place(): void {
    // Two logs beside each other need the whole width.
    this.isSideOpen = this.state.settings.get("shows_side");
    const hasRoom = this.wide.matches && this.main !== "compare", hasSide = hasRoom && this.isSideOpen, shown = hasSide ? [this.main, this.side] : [this.main];
    // Before views are told that they are seen: they measure their place then.
    this.panes.side.hidden = !hasSide;
    this.toggle.hidden = !hasRoom;
    this.toggle.textContent = this.isSideOpen ? texts.side.close : texts.side.open;
    this.toggle.setAttribute("aria-expanded", String(this.isSideOpen));
    for (const [name, view] of this.views) {
      const pane = name === this.main ? this.panes.main : hasSide && name === this.side ? this.panes.side : null;
      if (pane !== null && view.element.parentElement !== pane) pane.append(view.element);
      view.element.hidden = pane === null;
      view.setVisible(pane !== null);
      this.buttons.get(name)?.setAttribute("aria-pressed", String(shown.includes(name)));
    }
    this.panes.main.setAttribute("aria-label", texts.views[this.main]);
    this.panes.side.setAttribute("aria-label", texts.views[this.side]);
  }
}
