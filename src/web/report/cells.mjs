// Cells of a report as text.
import { short } from "../viewer/facts.mjs";

/** Return what a cell says: nothing for null. */
export function cellText(value, kind) {
  if (value === null) return "";
  if (typeof value === "string") return value;
  if (kind === "share") return value < 1 ? `${short(100 * value)} %` : `${short(value)} times`;
  return short(value);
}
