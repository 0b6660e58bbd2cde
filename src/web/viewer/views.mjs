// Views of a canvas: side by side or, where it is high, one above the other.

/** Return the rectangle of one of so many views, in pixels from the lower left. */
export function placeOf({ width, height }, count, i) {
  const isTall = height > width;
  const share = Math.floor((isTall ? height : width) / count);
  return isTall ? [0, height - (i + 1) * share, width, share] : [i * share, 0, share, height];
}

/** Return the view of a canvas at an event, its rectangle, and the pixel; null for none. */
export function viewAt(canvas, count, event) {
  const box = canvas.getBoundingClientRect();
  const ratio = canvas.width / box.width;
  const x = Math.floor((event.clientX - box.left) * ratio);
  const y = Math.floor((box.bottom - event.clientY) * ratio);
  for (let view = 0; view < count; view++) {
    const place = placeOf(canvas, count, view);
    const [left, low, width, height] = place;
    if (x >= left && x < left + width && y >= low && y < low + height) return { view, place, x, y };
  }
  return null;
}
