// @ts-check
// What every page does: shows the token, says how it stands. What comes from files is only ever set as text.

/** @param {string} id */
export const at = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} tag @param {string} text @param {string} [kind] */
export function made(tag, text, kind) {
  const one = document.createElement(tag);
  one.textContent = text;
  if (kind) one.className = kind;
  return one;
}

/** @param {string} text */
export function say(text) {
  at("state").textContent = text;
}

/** The token of the address for a cookie; it leaves the address then. */
export async function enter() {
  const token = location.hash.slice(1);
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  const answer = await fetch("api/session", { method: "POST", body: token });
  if (!answer.ok) throw new Error("the address is not this server's; copy the one that it printed");
}

/** @param {() => Promise<void>} work */
export async function tell(work) {
  try {
    await work();
  } catch (why) {
    say(`Not loaded: ${why instanceof Error ? why.message : why}.`);
  }
}
