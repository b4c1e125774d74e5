"""How cost.html looks, and how its table is sorted."""

STYLE = """
:root { color-scheme: light dark; --ink: #1d1f21; --soft: #5b6168; --paper: #ffffff; --line: #d9dde2; --tint: #f3f5f7;
  --accent: #0072b2; --chosen: #fdf1d6; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e8ea; --soft: #a4abb3; --paper: #17191b; --line: #3a3f45; --tint: #212529; --accent: #56b4e9;
    --chosen: #4a3a12; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 72rem; margin: 0 auto; padding: 1.5rem 1rem 3rem; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .5rem; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 1.8rem 0 .6rem; }
p { margin: .5rem 0; max-width: 60rem; overflow-wrap: anywhere; }
.quiet, figcaption, dd { color: var(--soft); font-size: .92rem; }
.advice { border: 1px solid var(--line); border-left: .4rem solid var(--accent); background: var(--tint);
  border-radius: .4rem; padding: .2rem 1rem .6rem; margin-top: 1rem; }
.advice.path { border-left-color: #009e73; }
.advice.unknown { border-left-color: var(--soft); }
.advice h2 { margin-top: .6rem; }
ul { padding-left: 1.2rem; }
.pictures { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); }
figure { margin: 0; }
.pictures img { width: 100%; height: auto; display: block; border-radius: .3rem; background: #000; }
.plot { margin: 1rem 0; max-width: 48rem; overflow-x: auto; }
.plot svg { width: 100%; min-width: 28rem; height: auto; color: var(--ink); }
.wide { overflow-x: auto; border: 1px solid var(--line); border-radius: .4rem; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { padding: .35rem .6rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
tbody tr:last-child td { border-bottom: 0; }
td.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
td:first-child { min-width: 11rem; }
td:nth-child(2) { text-align: left; }
td:last-child { font-size: .85em; text-align: left; white-space: normal; }
th { background: var(--tint); }
th button { all: unset; cursor: pointer; font-weight: 600; white-space: nowrap; }
th button:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
th[aria-sort="ascending"] button::after { content: " ↑"; }
th[aria-sort="descending"] button::after { content: " ↓"; }
tr.chosen td { background: var(--chosen); }
dt { font-weight: 600; }
dd { margin: 0 0 .5rem; }
"""

SCRIPT = """
const table = document.getElementById("measurements");
const heads = [...table.tHead.rows[0].cells];
const key = (row, column) => {
  const text = row.cells[column].dataset.key, number = Number(text === "inf" ? "Infinity" : text);
  return Number.isNaN(number) || text === "" ? text : number;
};
const compare = (a, b) => typeof a === "string" || typeof b === "string" ? String(a).localeCompare(String(b), "en",
  { numeric: true }) : a === b ? 0 : a > b ? 1 : -1;
heads.forEach((head, column) => head.firstElementChild.addEventListener("click", () => {
  const direction = head.ariaSort === "ascending" ? -1 : 1;
  const rows = [...table.tBodies[0].rows].sort((a, b) => direction * compare(key(a, column), key(b, column)));
  heads.forEach((other) => other.removeAttribute("aria-sort"));
  head.setAttribute("aria-sort", direction === 1 ? "ascending" : "descending");
  table.tBodies[0].append(...rows);
}));
"""
