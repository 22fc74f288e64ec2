// Which number is to be plotted: all that there are, searched by words.
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { labelOf } from "./chart.js";
import { button, make, placeChildren } from "./dom.js";
import { type Path, pathsOf, unitOf } from "./series.js";

const words = texts.panels.plots;
const kShown = 150;

/** Paths in whose text all words are found; those in which they come early first. */
export function search(paths: readonly Path[], query: string): Path[] {
  const wanted = query.toLowerCase().split(/\s+/).filter((word) => word !== "");
  if (wanted.length === 0) return [...paths];
  const found = paths.map((path) => {
    const text = `${labelOf(path)} ${path}`.toLowerCase();
    return { path, places: wanted.map((word) => text.indexOf(word)) };
  }).filter(({ places }) => places.every((place) => place >= 0));
  return found.map(({ path, places }) => ({ path, place: Math.min(...places) })).sort((a, b) => a.place - b.place).map(({ path }) => path);
}

export class Chooser {
  readonly element = make("dialog", "chooser");
  private readonly input = make("input");
  private readonly list = make("ul");
  private readonly none = make("p", "empty", words.noneFound);
  private paths: Path[] = [];

  constructor(private readonly state: State, private readonly onChoose: (path: Path) => void) {
    this.element.setAttribute("aria-label", words.choose);
    this.input.type = "search";
    this.input.placeholder = words.search;
    this.input.setAttribute("aria-label", words.search);
    this.input.oninput = () => { this.draw(); };
    const bar = make("div", "bar");
    bar.append(this.input, button(words.close, () => { this.element.close(); }));
    this.element.append(bar, this.none, this.list);
    this.element.onclick = (event) => { if (event.target === this.element) this.element.close(); };
  }

  /** @param plotted what stands there already, and is not offered */
  open(plotted: readonly Path[]): void {
    const { picture, chosen } = this.state;
    this.paths = picture === null ? [] : pathsOf(picture, chosen).filter((path) => !plotted.includes(path));
    this.input.value = "";
    this.draw();
    this.element.showModal();
  }

  private draw(): void {
    const found = search(this.paths, this.input.value).slice(0, kShown);
    this.none.hidden = found.length > 0;
    placeChildren(this.list, found.map((path) => {
      const item = make("li");
      const choose = button(labelOf(path), () => {
        this.element.close();
        this.onChoose(path);
      });
      choose.append(make("span", "muted", `${path.split("/")[0]!} ${unitOf(path).unit}`));
      item.append(choose);
      return item;
    }));
  }
}
