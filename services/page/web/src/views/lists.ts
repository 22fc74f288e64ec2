// All lists in one view, one at a time, with tabs of its own.
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { AlertHistory } from "./alert_history.js";
import { Channels } from "./channels.js";
import { button, make, setAttribute } from "./dom.js";
import { Processes } from "./health.js";
import type { ProcessWatch } from "./process_watch.js";
import { Sensors } from "./sensors.js";
import { Tracks } from "./tracks.js";

type Name = keyof typeof texts.panels.lists;

export class Lists implements View {
  readonly element = make("div", "view lists");
  private readonly pages: Map<Name, View>;
  private readonly tabs = new Map<Name, HTMLButtonElement>();
  private shown: Name = "tracks";
  private isVisible = false;

  constructor(state: State, watch: ProcessWatch) {
    this.pages = new Map<Name, View>([
      ["tracks", new Tracks(state)], ["alerts", new AlertHistory(state)], ["health", new Processes(state, watch)], ["channels", new Channels(state)],
      ["sensors", new Sensors(state)],
    ]);
    const bar = make("div", "subtabs");
    bar.setAttribute("role", "tablist");
    bar.setAttribute("aria-label", texts.views.lists);
    for (const [name, page] of this.pages) {
      const tab = button(texts.panels.lists[name], () => { this.show(name); });
      tab.id = `list-tab-${name}`;
      tab.setAttribute("role", "tab");
      page.element.setAttribute("role", "tabpanel");
      page.element.setAttribute("aria-labelledby", tab.id);
      this.tabs.set(name, tab);
      bar.append(tab);
    }
    bar.onkeydown = (event) => {
      const names = [...this.tabs.keys()], step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      if (step === 0) return;
      const next = names[(names.indexOf(this.shown) + step + names.length) % names.length]!;
      this.show(next);
      this.tabs.get(next)?.focus();
    };
    this.element.append(bar, ...[...this.pages.values()].map((page) => page.element));
    // What is chosen elsewhere is shown here in full.
    let chosen: number | null = null;
    state.on(["marked"], () => {
      if (state.chosen !== chosen && state.chosen !== null && this.isVisible) this.show("tracks");
      chosen = state.chosen;
    });
    this.show(this.shown);
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.show(this.shown);
  }

  show(name: Name): void {
    this.shown = name;
    for (const [each, page] of this.pages) {
      const isShown = each === name, tab = this.tabs.get(each)!;
      page.element.hidden = !isShown;
      page.setVisible(isShown && this.isVisible);
      setAttribute(tab, "aria-selected", String(isShown));
      tab.tabIndex = isShown ? 0 : -1;
    }
  }
}
