// Parts of meshes: their names, and the lists in which they are hidden.
import { partColour } from "./colours.mjs";

/** Return the name of a part, as the list of parts has it. */
export const nameOf = (names, part) => (part < 0 ? "(none)" : names[part] || "(no name)");

/** Return what all parts of a kind are called. */
export const titleOfKind = (kind) => (kind === "smoothing" ? "smoothing groups" : `${kind}s`);

/** Fill the lists of the parts of a viewer's meshes anew. */
export function fillParts(viewer) {
  const divisions = new Map();
  for (const { kind, names, ofFace } of viewer.panels.flatMap(({ mesh }) => mesh.parts)) {
    if (!divisions.has(kind)) divisions.set(kind, new Map());
    const colours = divisions.get(kind);
    names.forEach((_, part) => colours.set(nameOf(names, part), partColour(part)));
    if (ofFace.some((part) => part < 0)) colours.set(nameOf(names, -1), partColour(-1));
  }
  const lists = [...divisions].map(([kind, colours]) => listOf(viewer, kind, colours));
  const place = document.querySelector("#parts");
  place.replaceChildren(...lists);
  place.parentElement.hidden = !lists.length;
}

/** Return a list of parts that can be hidden. */
function listOf(viewer, kind, colours) {
  const list = document.createElement("fieldset");
  list.append(Object.assign(document.createElement("legend"), { textContent: titleOfKind(kind) }));
  const hide = () => {
    const boxes = [...list.querySelectorAll("input")];
    const names = boxes.filter((box) => !box.checked).map((box) => box.value);
    viewer.hideParts(kind, new Set(names));
  };
  for (const [name, rgb] of colours) {
    const label = document.createElement("label");
    const box = Object.assign(document.createElement("input"), { type: "checkbox", value: name });
    box.checked = !viewer.hidden.get(kind)?.has(name);
    const swatch = document.createElement("i");
    swatch.style.background = `rgb(${rgb})`;
    label.append(box, swatch, name);
    list.append(label);
  }
  list.addEventListener("change", hide);
  // Alone, or all again.
  list.addEventListener("dblclick", (event) => {
    const own = event.target.closest("label")?.querySelector("input");
    if (!own) return;
    const boxes = [...list.querySelectorAll("input")];
    const isAlone = boxes.every((box) => box.checked === (box === own));
    boxes.forEach((box) => (box.checked = isAlone || box === own));
    hide();
  });
  return list;
}
