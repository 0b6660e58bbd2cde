// Exceptions in one tree, with the names and the messages of the Python library.

/** Base of everything that the decoder throws on purpose. */
export class DeltameshError extends Error {
  constructor(message) {
    super(message);
    this.name = new.target.name;
  }
}

/** The bytes are not a valid `.dmesh` file; `offset` says where, in bytes from its start. */
export class FormatError extends DeltameshError {
  constructor(reason, offset = null) {
    super(offset === null ? reason : `${reason} (at byte ${offset})`);
    this.reason = reason;
    this.offset = offset;
  }
}

/** Decoding would need more than the caller allows; nothing has been allocated. */
export class LimitError extends DeltameshError {}

/** The least-squares system could not be factored or solved. */
export class SolveError extends DeltameshError {}

/** Return a number as messages spell it. */
export function spelled(number) {
  if (Number.isNaN(number)) return "nan";
  if (!Number.isFinite(number)) return number < 0 ? "-inf" : "inf";
  return Number.isInteger(number) && Math.abs(number) < 1e16 ? `${number}.0` : `${number}`;
}

/** Return what `run` returns; offsets of its FormatErrors then count from before byte `start`. */
export function located(start, prefix, run) {
  try {
    return run();
  } catch (error) {
    if (!(error instanceof FormatError)) throw error;
    throw new FormatError(prefix + error.reason, start + (error.offset ?? 0));
  }
}
