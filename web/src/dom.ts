// SPDX-License-Identifier: Apache-2.0
// Creates elements of the page.

type Attributes = Record<string, string | ((event: Event) => void)>;

/** Creates an element with attributes and children. Attributes whose names begin with "on" are listeners. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Attributes = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  apply(made, attributes);
  made.append(...children);
  return made;
}

export function svg(tag: string, attributes: Attributes = {}, ...children: (Node | string)[]): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  apply(made, attributes);
  made.append(...children);
  return made;
}

function apply(made: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value);
  }
}

/** Splits the name of a variable after its dots, so that the browser may break a long name there. */
export function dotted(name: string): (string | HTMLElement)[] {
  return name.split(/(?<=\.)/).flatMap((part, i) => (i > 0 ? [element("wbr", {}), part] : [part]));
}
