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

/** Names with values, kept and changed in place. */
export class Facts {
  readonly element = make("dl", "facts");
  private readonly values = new Map<string, { row: HTMLElement; value: HTMLElement }>();

  /** A value of null hides its row. */
  set(name: string, value: string | null): void {
    let found = this.values.get(name);
    if (found === undefined) {
      found = { row: make("div"), value: make("dd") };
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
