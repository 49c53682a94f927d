/** The measured delay between this page and the server, and all limits of time that follow from it. Any answer measures; no other
 * file decides how long the network may take. Knows times; never what is asked. */

/** A question and its answer, in ms. */
interface Sample {
  readonly round_ms: number;
  /** Lead of the server's clock, if both directions took equally long. */
  readonly ahead_ms: number;
}

/** Interval of the pings, with or without answers. Clocks of runs go no further than the last answer. */
export const PING_MS = 1_000;
/** Age from which shown data is old, in addition to the delay. */
const OLD_MS = 4_000;
/** Silence after which another connection is tried, in addition to the delay. The silent one stays open. */
const SILENT_MS = 12_000;
/** Timeout of the first answer, because the speed of the network is unknown. */
const UNMEASURED_MS = 30_000;
/** A dial: what a busy server and three lost packets take, and the rounds of TCP, TLS and the upgrade. */
const DIAL_MS = 20_000;
const DIAL_ROUNDS = 3;
/** Number of failed dials after which the timeout of one of them doubles. */
const DIALS_EACH = 4;
const DIAL_MAX_MS = 120_000;
/** A request that is repeated if its answer is lost, and one that is not: the server may work on it. */
const AGAIN_MS = 8_000;
const ONCE_MS = 45_000;
/** TCP, TLS, the request, and one to spare. */
const REQUEST_ROUNDS = 4;
/** Transfer times are those of the slowest supported network: 64 kbit/s, shared. */
const BYTES_PER_MS = 4;
/** Number of answers of which the fastest one compares the clocks. */
const SAMPLES_MAX = 8;
/** Capacity of the open pings. */
const ASKED_MAX = 100;

export class Delay {
  readonly #asked = new Map<number, number>();
  #id = 0;
  /** Smoothed round trip and its variation, as TCP reckons them (RFC 6298). */
  #round_ms: number | null = null;
  #varies_ms = 0;
  /** Only a dial was measured so far. */
  #isGuess = true;
  #samples: readonly Sample[] = [];

  /** A question is sent: its id. */
  ask(now_ms: number): number {
    this.#id += 1;
    this.#asked.set(this.#id, now_ms);
    if (this.#asked.size > ASKED_MAX) this.#asked.delete(this.#id - ASKED_MAX);
    return this.#id;
  }

  /** The server answered a question at its time `server_ms`. Gives how long that took; null if nobody had asked. */
  answer(id: number, server_ms: number, now_ms: number): number | null {
    const asked_ms = this.#asked.get(id);
    if (asked_ms === undefined) return null;
    this.#asked.delete(id);
    const round_ms = Math.max(0, now_ms - asked_ms);
    this.#measure(round_ms);
    this.#isGuess = false;
    const sample = { round_ms, ahead_ms: server_ms + round_ms / 2 - now_ms };
    this.#samples = [...this.#samples, sample].slice(-SAMPLES_MAX);
    return round_ms;
  }

  /** Takes the duration of a dial and the server's time at its end: an estimate until the first answer. */
  dialled(took_ms: number, server_ms: number, now_ms: number): void {
    this.#asked.clear();
    const ahead_ms = this.#ahead() ?? server_ms + took_ms / (2 * DIAL_ROUNDS) - now_ms;
    // Measurements of the last connection count until they are repeated.
    this.#samples = [{ round_ms: Number.POSITIVE_INFINITY, ahead_ms }];
    if (this.#isGuess) this.#measure(took_ms / 2);
  }

  /** Lead of the server's clock over the browser's, in ms. */
  get ahead_ms(): number {
    return this.#ahead() ?? 0;
  }

  /** Time without confirmation after which shown data is old, in ms. */
  get old_ms(): number {
    return OLD_MS + this.#late_ms;
  }

  /** Silence after which another connection is tried, in ms. */
  get silent_ms(): number {
    return this.#round_ms === null ? UNMEASURED_MS : SILENT_MS + 3 * this.#late_ms;
  }

  /** Timeout of a dial after this number of failed ones, in ms. */
  dial_ms(unanswered: number): number {
    const round_ms = DIAL_ROUNDS * this.#late_ms;
    const limit_ms =
      this.#round_ms === null ? UNMEASURED_MS : Math.max(DIAL_MS, DIAL_MS / 2 + round_ms);
    const isLonger = unanswered % DIALS_EACH === DIALS_EACH - 1;
    const each = isLonger ? (unanswered + 1) / DIALS_EACH : 0;
    // While nothing is known, each may take longer than the one before.
    const doubled = this.#isGuess ? unanswered : each;
    return Math.min(limit_ms * 2 ** doubled, Math.max(limit_ms, DIAL_MAX_MS));
  }

  /** Timeout of a request that sends this number of bytes, in ms. */
  request_ms(isRepeated: boolean, bytes: number): number {
    const least_ms = this.#round_ms === null ? UNMEASURED_MS : AGAIN_MS;
    const limit_ms = isRepeated ? least_ms : ONCE_MS;
    return limit_ms + REQUEST_ROUNDS * this.#late_ms + bytes / BYTES_PER_MS;
  }

  /** An answer is hardly ever later than this. */
  get #late_ms(): number {
    return Math.round((this.#round_ms ?? 0) + 4 * this.#varies_ms);
  }

  #ahead(): number | null {
    const [first, ...others] = this.#samples;
    if (!first) return null;
    return others.reduce((best, each) => (each.round_ms <= best.round_ms ? each : best), first)
      .ahead_ms;
  }

  #measure(round_ms: number): void {
    if (this.#round_ms === null || this.#isGuess) {
      [this.#round_ms, this.#varies_ms] = [round_ms, round_ms / 2];
      return;
    }
    const off_ms = Math.abs(this.#round_ms - round_ms);
    this.#varies_ms += (off_ms - this.#varies_ms) / 4;
    this.#round_ms += (round_ms - this.#round_ms) / 8;
  }
}
