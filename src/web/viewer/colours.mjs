// Colours: scales for numbers, parts, and the colours of attributes.

const RISING = ["#1d2a6b", "#275fa3", "#2f9a9a", "#7fc46a", "#f2d64b", "#f28c28", "#c6261f"];
const AROUND = ["#1f4f9e", "#6fa3d8", "#f1f1ec", "#e58a6b", "#a8202a"];
const STEPS = 256;

const bytesOf = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

function scaleOf(stops) {
  const colours = stops.map(bytesOf);
  const scale = new Uint8Array(4 * STEPS);
  for (let i = 0; i < STEPS; i++) {
    const place = (i / (STEPS - 1)) * (colours.length - 1);
    const k = Math.min(Math.floor(place), colours.length - 2);
    const mixed = colours[k].map((x, a) => x + (place - k) * (colours[k + 1][a] - x));
    scale.set([...mixed, 255], 4 * i);
  }
  return scale;
}

/** Scales of 256 colours, four bytes each. */
export const SCALES = { rising: scaleOf(RISING), around: scaleOf(AROUND) };

/** Return a scale as a gradient of CSS. */
export const gradientOf = (signed) => `linear-gradient(to right, ${(signed ? AROUND : RISING).join(", ")})`;

/** Return the colour of a part, by its number, three bytes. */
export function partColour(part) {
  if (part < 0) return [176, 176, 176];
  // Hues far from those before: the golden angle.
  const hue = (part * 137.508 + 205) % 360;
  const chroma = part % 2 ? 0.5 : 0.62;
  const channel = (n) => {
    const k = (n + hue / 30) % 12;
    return Math.round(255 * (0.64 - chroma * 0.36 * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}

/** Return values of a colour attribute at corners as four bytes each. */
export function colourBytes(values, width, attribute) {
  const isWhole = attribute.type.startsWith("uint");
  const most = isWhole ? 2 ** Number(attribute.type.slice(4)) - 1 : 1;
  const count = values.length / width;
  const bytes = new Uint8Array(4 * count).fill(255);
  for (let c = 0; c < count; c++) {
    for (let a = 0; a < 3; a++) {
      const value = values[c * width + Math.min(a, width - 1)] / most;
      bytes[4 * c + a] = Math.round(255 * Math.min(1, Math.max(0, value)));
    }
  }
  return bytes;
}
