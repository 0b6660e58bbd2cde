// Section STEP: the exponents of the steps of vertices, and what follows from them (SPEC.md 5.19).
import { take } from "./bytes.mjs";
import { FormatError, located } from "./errors.mjs";
import { decodeLabels } from "./labels.mjs";
import { withoutParallelograms } from "./graph.mjs";
import { largest } from "./integers.mjs";
import { MAX_EXPONENT, MAX_GRID_BITS, PER_OCTAVE, QUARTERS } from "./layout.mjs";

/** Return the ratio of an exponent: what a step is over the coarsest. */
export function ratio(exponent) {
  return QUARTERS[exponent % PER_OCTAVE] * 2 ** -Math.floor(exponent / PER_OCTAVE);
}

/** Return the ratio of each of so many vertices, 1 where there are no exponents. */
export function ratiosOf(exponents, count) {
  const ratios = new Float64Array(count).fill(1);
  for (let v = 0; v < exponents.length; v++) ratios[v] = ratio(exponents[v]);
  return ratios;
}

/** Return how many bits more a grid coordinate takes, at most, in the step of an exponent. */
export const extraBits = (exponent) => Math.ceil(exponent / PER_OCTAVE);

/** Return the exponents of the vertices of the faces; none where all steps are alike. */
export function decodeSteps(core, { sections, parameters }, { graph }) {
  if (!sections.has("STEP")) return new Int32Array(0);
  return sections.get("STEP").read((payload) => {
    if (!parameters.step) throw new FormatError("steps by vertex in a file of 0 bits", 0);
    const [count] = take(payload, 0, 1);
    if (count < 2) throw new FormatError(`${count} different steps`, 0);
    const distinct = [...take(payload, 1, count)];
    const most = Math.max(...distinct);
    if (most > MAX_EXPONENT) {
      throw new FormatError(`an exponent of ${most}`, 1 + distinct.indexOf(most));
    }
    if (new Set(distinct).size < count) {
      throw new FormatError("an exponent that comes twice", 1);
    }
    if (Math.min(...distinct) > 0) throw new FormatError("no vertex of the coarsest step", 1);
    const at = 1 + count;
    const elements = withoutParallelograms(graph);
    const labels = located(at, "", () => decodeLabels(core, payload.subarray(at), elements));
    const found = largest(labels) + 1;
    if (found !== count) throw new FormatError(`${found} labels of ${count} steps`, at);
    return labels.map((label) => distinct[label]);
  });
}

/** Return the bits of each coordinate of a grid point, at the begin of a payload. */
export function readGridBits(payload) {
  const bits = Int32Array.from(take(payload, 0, 3));
  const most = bits.indexOf(Math.max(...bits));
  if (bits[most] > MAX_GRID_BITS) {
    throw new FormatError(`a grid of more than ${MAX_GRID_BITS} bits`, most);
  }
  return bits;
}
