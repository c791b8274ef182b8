// Small helpers. Text from the wire goes into the page through `textContent` alone.

/** @param {string} id */
export function by(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no ${id}`);
  return element;
}

/** @param {string} id */
export const input = (id) => /** @type {HTMLInputElement} */ (by(id));

/** @param {string} id */
export const select = (id) => /** @type {HTMLSelectElement} */ (by(id));

/**
 * An element with attributes and what it contains.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, string>} attributes
 * @param {...(Node | string)} content
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, attributes = {}, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...content);
  return element;
}

/** Sets a text only where it differs, so that a screen reader speaks it once. @param {Element} element @param {string} text */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** A button that can't be used keeps the focus. @param {Element} button @param {boolean} enabled @param {string} [why] */
export function enable(button, enabled, why = '') {
  button.setAttribute('aria-disabled', String(!enabled));
  if (enabled) button.removeAttribute('title'); else button.setAttribute('title', why);
}

/** @param {Element} button */
export const usable = (button) => button.getAttribute('aria-disabled') !== 'true';

/** Has a select offer these. @param {string} id @param {string[]} values @param {string[]} [words] */
export function options(id, values, words = values) {
  select(id).replaceChildren(...values.map((value, at) => make('option', { value }, words[at])));
}

/** @param {string} name @param {Blob} blob */
export function save(name, blob) {
  const link = make('a', { download: name, href: URL.createObjectURL(blob) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** @param {number | null | undefined} value @param {number} digits */
export const number = (value, digits = 2) => (value == null || !Number.isFinite(value) ? '?' : value.toFixed(digits));
