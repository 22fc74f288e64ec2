// Small help with elements. Texts become text nodes, and a node is touched only where something has changed.

type Tag = keyof HTMLElementTagNameMap;

export function make<T extends Tag>(tag: T, className = "", text = ""): HTMLElementTagNameMap[T] {
  const element = document.createElement(tag);
  if (className !== "") element.className = className;
  if (text !== "") element.textContent = text;
  return element;
}

export function button(text: string, onClick: () => void, className = ""): HTMLButtonElement {
  const element = make("button", className, text);
  element.type = "button";
  element.onclick = onClick;
  return element;
}

export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
/** Sets or, by null, removes an attribute. */
export function setAttribute(element: Element, name: string, value: string | null): void {
  if (element.getAttribute(name) === value) return;
  if (value === null) element.removeAttribute(name);
  else element.setAttribute(name, value);
}

/** Draws at most so often; what was asked for meanwhile is drawn when the time has come, so that the last is always seen. */
export class Pace {
  private drawn_ms = -Infinity;
  private timer: number | undefined;

  constructor(private readonly draw: () => void, private readonly every_ms: () => number) {}

  ask(): void {
    const wait_ms = this.drawn_ms + this.every_ms() - performance.now();
    if (wait_ms <= 0) this.now();
    else this.timer ??= setTimeout(() => { this.now(); }, wait_ms);
  }
  now(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.drawn_ms = performance.now();
    this.draw();
  }
}

/** Names with values, kept and changed in place. */
export class Facts {
  readonly element = make("dl", "facts");
  private readonly values = new Map<string, { row: HTMLElement; value: HTMLElement }>();

  /** A value of null hides its row; a long one has the room of two. */
  set(name: string, value: string | null, isLong = false): void {
    let found = this.values.get(name);
    if (found === undefined) {
      found = { row: make("div", isLong ? "long" : ""), value: make("dd") };
      found.row.append(make("dt", "", name), found.value);
      this.values.set(name, found);
      this.element.append(found.row);
    }
    found.row.hidden = value === null;
    if (value !== null) setText(found.value, value);
  }
}

/** Makes the children of a parent those that are given, in their order, moving as few as may be. */
export function placeChildren(parent: Element, children: Element[]): void {
  let at = parent.firstElementChild;
  for (const child of children) {
    if (at === child) at = at.nextElementSibling;
    else parent.insertBefore(child, at);
  }
  while (at !== null) {
    const next = at.nextElementSibling;
    at.remove();
    at = next;
  }
}
