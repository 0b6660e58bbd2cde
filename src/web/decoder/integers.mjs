// Integers of 64 bits as pairs of words, without a BigInt for each.

/** Return numbers of 32 bits as numbers of 64 bits. */
export function widened(numbers) {
  const wide = new BigInt64Array(numbers.length);
  const words = new Int32Array(wide.buffer);
  for (let i = 0; i < numbers.length; i++) {
    words[2 * i] = numbers[i];
    words[2 * i + 1] = numbers[i] >> 31;
  }
  return wide;
}

/** Return numbers of 64 bits as doubles, each rounded once. */
export function doubled(wide) {
  const words = wordsOf(wide);
  const numbers = new Float64Array(wide.length);
  for (let i = 0; i < numbers.length; i++) {
    numbers[i] = words[2 * i + 1] * 4294967296 + (words[2 * i] >>> 0);
  }
  return numbers;
}

/** Return the words of numbers of 64 bits, the low one of each first. */
export function wordsOf(wide) {
  return new Int32Array(wide.buffer, wide.byteOffset, 2 * wide.length);
}

/** Return 0, 1, ... as many as asked for. */
export function counted(count) {
  const numbers = new Int32Array(count);
  for (let i = 0; i < count; i++) numbers[i] = i;
  return numbers;
}

/** Return where each number is among those of a permutation. */
export function inverse(order) {
  const rank = new Int32Array(order.length);
  for (let i = 0; i < order.length; i++) rank[order[i]] = i;
  return rank;
}

/** Return the largest number, or the least one that it may be. */
export function largest(numbers, least = -1) {
  let most = least;
  for (let i = 0; i < numbers.length; i++) if (numbers[i] > most) most = numbers[i];
  return most;
}

/**
 * Return the order of elements by keys, stable: equal ones keep their order.
 *
 * The keys are [numbers, bound] from the most significant on, numbers from 0 to below the bound.
 */
export function sorted(count, ...keys) {
  let order = counted(count);
  for (const [numbers, bound] of keys.reverse()) {
    const begins = new Int32Array(bound + 1);
    for (let i = 0; i < count; i++) begins[numbers[i] + 1]++;
    for (let k = 0; k < bound; k++) begins[k + 1] += begins[k];
    const next = new Int32Array(count);
    for (let i = 0; i < count; i++) next[begins[numbers[order[i]]]++] = order[i];
    order = next;
  }
  return order;
}
