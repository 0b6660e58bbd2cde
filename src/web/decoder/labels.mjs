// Streams of labels, and of columns of integers, at elements.
import { out, place, room, shorts } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { given, predictors } from "./graph.mjs";

/** Return the labels of elements; the offset of an error counts from the begin of the stream. */
export function decodeLabels(core, stream, elements) {
  const labels = new Int32Array(elements.count);
  const memory = [room(core.constant("DM_FOLLOWERS")), place()];
  core.decode(core.model("labels"), stream, (coder) => {
    if (!core.good("dm_code_labels", coder, ...given(elements), out(labels), ...memory)) {
      throw new FormatError("non-canonical label: a candidate was skipped", 0);
    }
  });
  return labels;
}

/** Return rows of three integers that parallelograms predict, as numbers of 64 bits. */
export function decodeThree(core, stream, elements, offset = 0) {
  const values = new BigInt64Array(3 * elements.count);
  const run = (coder) => codeThree(core, coder, elements, values);
  core.decode(core.model("positions"), stream, run, offset);
  return values;
}

/** Read rows of three integers that parallelograms predict. */
export function codeThree(core, coder, elements, values) {
  const mesh = [...given(elements), ...predictors(elements), shorts(elements.within)];
  core.call("dm_code_positions", coder, ...mesh, out(values), room(values.length));
}

/** Return rows of three integers below 2^31, predicted to be zero. */
export function decodeVectors(core, stream, graph, offset = 0) {
  const values = new Int32Array(3 * graph.count);
  const run = (coder) => codeVectors(core, coder, graph, values);
  core.decode(core.model("vectors"), stream, run, offset);
  return values;
}

/** Read rows of three integers that are predicted to be zero. */
export function codeVectors(core, coder, graph, values) {
  core.call("dm_code_deltas", coder, ...given(graph), out(values));
}

/** Return columns of integers, three of which share a stream; the padding has to be zero. */
export function joined(threes, offset, count, width) {
  const columns = new BigInt64Array(count * width);
  threes.forEach((three, k) => {
    for (let i = 0; i < count; i++) {
      for (let a = 0; a < 3; a++) {
        if (3 * k + a < width) columns[i * width + 3 * k + a] = three[3 * i + a];
        else if (three[3 * i + a]) {
          throw new FormatError("nonzero padding column of an attribute", offset);
        }
      }
    }
  });
  return columns;
}
