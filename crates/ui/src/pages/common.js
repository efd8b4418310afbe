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

/** The token of the address for a cookie; it leaves the address then. Links to the server's other pages, if there are any. */
export async function enter() {
  const token = location.hash.slice(1);
  if (token) {
    history.replaceState(null, "", location.pathname);
    const answer = await fetch("api/session", { method: "POST", body: token });
    if (!answer.ok) throw new Error("the address is not this server's; copy the one that it printed");
  }
  const answer = await fetch("api/pages");
  if (answer.ok) link(await answer.json());
}

/** @param {{name: string, title: string}[]} pages */
function link(pages) {
  if (pages.length < 2) return;
  const all = made("nav", "");
  all.setAttribute("aria-label", "Pages");
  pages.forEach(({ name, title }, k) => {
    const one = /** @type {HTMLAnchorElement} */ (made("a", title));
    one.href = name;
    if (location.pathname === `/${name}` || (location.pathname === "/" && k === 0)) one.setAttribute("aria-current", "page");
    all.append(one);
  });
  /** @type {HTMLElement} */ (document.querySelector("header")).append(all);
}

/** @param {() => Promise<void>} work */
export async function tell(work) {
  try {
    await work();
  } catch (why) {
    say(`Not loaded: ${why instanceof Error ? why.message : why}.`);
  }
}
