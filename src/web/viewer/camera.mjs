// Camera that turns about a target, and the gestures that move it.
import { cross, dot, less, length, perspective, plus, product, turned, unit, view } from "./matrices.mjs"; // prettier-ignore

const ANGLE = Math.PI / 5;
const CLOSEST = 1e-3;
const FARTHEST = 50;

/** Camera that looks at a target from a distance; meshes are of about one unit around 0. */
export class Camera {
  constructor() {
    this.upwards = "y";
    this.reset();
  }

  /** See all, from a little above. */
  reset() {
    this.target = [0, 0, 0];
    this.distance = 2.1;
    const axis = this.upwards === "y" ? [0, 1, 0] : [0, 0, 1];
    this.back = unit(this.upwards === "y" ? [0.45, 0.35, 1] : [0.45, -1, 0.35]);
    this.up = unit(cross(this.back, cross(axis, this.back)));
  }

  get right() {
    return cross(this.up, this.back);
  }

  get eye() {
    return plus(this.target, this.back, this.distance);
  }

  /** Turn by so many pixels of a view of so many. */
  turn(dx, dy, height) {
    const scale = Math.PI / height;
    const axis = this.right;
    this.back = turned(turned(this.back, this.up, -dx * scale), axis, -dy * scale);
    this.up = turned(this.up, axis, -dy * scale);
    this.back = unit(this.back);
    this.up = unit(plus(this.up, this.back, -dot(this.up, this.back)));
  }

  /** Turn about the line of sight. */
  roll(angle) {
    this.up = turned(this.up, this.back, angle);
  }

  /** Move by so many pixels of a view of so many. */
  pan(dx, dy, height) {
    const scale = (2 * this.distance * Math.tan(ANGLE / 2)) / height;
    this.target = plus(plus(this.target, this.right, -dx * scale), this.up, dy * scale);
  }

  /** Come closer by a factor. */
  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance / factor, CLOSEST), FARTHEST);
  }

  /** Return the matrices of a view of this aspect. */
  matrices(aspect) {
    const seen = view(this.eye, this.right, this.up, this.back);
    // Both sides of a mesh of about one unit are in view at any distance.
    const reach = length(this.target) + 2;
    const near = Math.max(this.distance - reach, this.distance / 500);
    const angle = aspect < 1 ? 2 * Math.atan(Math.tan(ANGLE / 2) / aspect) : ANGLE;
    const projected = perspective(angle, aspect, near, this.distance + reach);
    return { seen, whole: product(projected, seen), angle };
  }

  /** Return the direction in which a place of a view, -1 to 1 in x and y, is seen. */
  direction(x, y, aspect) {
    const { angle } = this.matrices(aspect);
    const size = Math.tan(angle / 2);
    const sideways = plus([0, 0, 0], this.right, x * size * aspect);
    return unit(less(plus(sideways, this.up, y * size), this.back));
  }
}

/**
 * Let pointers, wheel and touch on an element move a camera.
 *
 * `sizeOf(event)` returns the height of the view at an event; `changed` is called after each move.
 */
export function followGestures(element, camera, sizeOf, changed) {
  const pointers = new Map();
  let dragged = false;
  const middle = () => {
    const [a, b] = [...pointers.values()];
    const apart = Math.hypot(a.x - b.x, a.y - b.y);
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart, angle: Math.atan2(b.y - a.y, b.x - a.x) };
  };
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    dragged = false;
  });
  element.addEventListener("pointermove", (event) => {
    const pointer = pointers.get(event.pointerId);
    if (!pointer) return;
    const height = sizeOf(event);
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (pointers.size === 2) {
      const before = middle();
      Object.assign(pointer, { x: event.clientX, y: event.clientY });
      const now = middle();
      camera.pan(now.x - before.x, now.y - before.y, height);
      camera.zoom(now.apart / Math.max(before.apart, 1));
      camera.roll(now.angle - before.angle);
    } else {
      Object.assign(pointer, { x: event.clientX, y: event.clientY });
      if (event.buttons & 6 || event.shiftKey) camera.pan(dx, dy, height);
      else camera.turn(dx, dy, height);
    }
    dragged = dragged || Math.abs(dx) + Math.abs(dy) > 1;
    changed();
  });
  const end = (event) => pointers.delete(event.pointerId);
  element.addEventListener("pointerup", end);
  element.addEventListener("pointercancel", end);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  const onWheel = (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(-event.deltaY / (event.deltaMode ? 20 : 500)));
    changed();
  };
  element.addEventListener("wheel", onWheel, { passive: false });
  return { isDragging: () => pointers.size > 0, wasDragged: () => dragged };
}
