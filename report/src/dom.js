/** An element with properties and children; names with a dash become attributes. */
export function element(kind, properties = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-")) made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children);
  return made;
}

export function styleColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
