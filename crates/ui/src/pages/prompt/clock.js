// @ts-check
// The server's clock on this page: seconds, and how far they may be off.

/** How often the server is asked for the time at once, and how long an answer holds, milliseconds. */
const TRIES = 6;
const HOLDS_MS = 30000;

/** @type {{offset_s: number, uncertainty_s: number, at_ms: number} | null} */
let best = null;

/** Asks the server for its time; the fastest answer of the last half minute counts. */
export async function synchronize() {
  for (let k = 0; k < TRIES; k += 1) {
    const sent_ms = performance.now();
    const answer = await fetch("api/prompt/clock", { method: "POST" });
    const back_ms = performance.now();
    if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
    const { time_s } = await answer.json();
    const uncertainty_s = (back_ms - sent_ms) / 2000;
    if (!best || uncertainty_s <= best.uncertainty_s || back_ms - best.at_ms > HOLDS_MS) {
      best = { offset_s: time_s - (sent_ms + back_ms) / 2000, uncertainty_s, at_ms: back_ms };
    }
  }
}

/** The server's time at a time of this page, seconds. @param {number} page_ms */
export const server_s = (page_ms) => page_ms / 1000 + (best ? best.offset_s : 0);
/** How far that may be off, seconds. */
export const uncertainty_s = () => (best ? best.uncertainty_s : 1);
export const isSet = () => best !== null;

/** As it is shown and filmed: mm:ss.t. @param {number} time_s */
export function shown(time_s) {
  const tenths = Math.max(0, Math.floor(time_s * 10 + 1e-6));
  const two = (/** @type {number} */ n) => String(n).padStart(2, "0");
  return `${two(Math.floor(tenths / 600) % 60)}:${two(Math.floor(tenths / 10) % 60)}.${tenths % 10}`;
}
