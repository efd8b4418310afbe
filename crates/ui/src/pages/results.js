// @ts-check
// The list of results, and one of them: what it is, what it warns of, its report and its pictures. Names come from
// folders and files, so they are only ever set as text.

/** @typedef {{id: number, name: string}} Picture */
/** @typedef {{id: number, name: string, job: string, version: string, made_unix_s: number, wall_s: number | null,
 *   warnings: string[], failed: string[], left_out: string[], report: number | null, pictures: Picture[]}} Run */

import { at, enter, made, say, tell } from "./common.js";

const filter = /** @type {HTMLInputElement} */ (at("filter"));
/** @type {Run[]} */
let runs = [];
/** @type {string | null} */
let shown = null;

/** @param {Run} run */
function summary(run) {
  const parts = [run.job, new Date(1000 * run.made_unix_s).toLocaleString()];
  const small = made("small", parts.join(", "));
  if (run.failed.length) small.append(" ", made("span", `${run.failed.length} failed`, "bad"));
  const warned = run.warnings.length;
  if (warned) small.append(" ", made("span", warned === 1 ? "1 warning" : `${warned} warnings`, "doubt"));
  return small;
}

function list() {
  const words = filter.value.toLowerCase();
  const some = runs.filter((run) => `${run.name} ${run.job}`.toLowerCase().includes(words));
  at("runs").replaceChildren(...some.map((run) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(run.name, summary(run));
    if (run.name === shown) button.setAttribute("aria-current", "true");
    button.addEventListener("click", () => {
      show(run);
      at("run-title").focus();
    });
    const item = document.createElement("li");
    item.append(button);
    return item;
  }));
  say(`${runs.length} results` + (some.length < runs.length ? `, ${some.length} of them listed` : ""));
}

/** @param {string} title @param {string[]} lines @param {string} kind */
function section(title, lines, kind) {
  if (!lines.length) return [];
  const all = document.createElement("ul");
  all.append(...lines.map((line) => made("li", line)));
  return [made("h3", title, kind), all];
}

/** @param {Run} run */
function show(run) {
  shown = run.name;
  list();
  at("run").hidden = false;
  at("run-title").textContent = run.name;
  const facts = [["job", run.job], ["version", run.version], ["made", new Date(1000 * run.made_unix_s).toLocaleString()]];
  if (run.wall_s !== null) facts.push(["took", `${run.wall_s.toPrecision(3)} s`]);
  at("facts").replaceChildren(...facts.flatMap(([name, value]) => [made("dt", name), made("dd", value)]));
  at("lists").replaceChildren(
    ...section("Failed", run.failed, "bad"),
    ...section("Warnings", run.warnings, "doubt"),
    ...section("Left out", run.left_out, ""),
  );
  const report = /** @type {HTMLIFrameElement} */ (at("report"));
  report.hidden = at("report-title").hidden = run.report === null;
  if (run.report !== null) report.src = `api/file/${run.report}`;
  at("pictures").replaceChildren(...run.pictures.map((picture) => {
    const figure = document.createElement("figure");
    const image = document.createElement("img");
    image.loading = "lazy";
    image.src = `api/file/${picture.id}`;
    image.alt = picture.name;
    figure.append(image, made("figcaption", picture.name));
    return figure;
  }));
}

async function load() {
  const answer = await fetch("api/results");
  if (answer.status === 403) throw new Error("this browser is not known; open the address that the program printed");
  if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  const results = await answer.json();
  runs = results.runs;
  const known = runs.find((run) => run.name === shown) ?? runs[0];
  if (known) show(known);
  else list();
  if (results.left_out) say(`${runs.length} results; ${results.left_out}`);
}

filter.addEventListener("input", list);
at("reload").addEventListener("click", () => tell(load));
tell(async () => {
  await enter();
  await load();
});
