"use strict";
// Sort a table by the column whose head is clicked: numbers by value, the rest by text, missing last.
for (const head of document.querySelectorAll("th")) {
  const sort = () => {
    const body = head.closest("table").tBodies[0], column = head.cellIndex;
    const up = head.getAttribute("aria-sort") !== "ascending";
    for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
    const key = (row) => {
      const cell = row.cells[column];
      return cell.dataset.v !== undefined ? Number(cell.dataset.v) : cell.textContent;
    };
    const order = (a, b) => {
      const [x, y] = [key(a), key(b)];
      if (x === "" || y === "") return (x === "") - (y === "");
      const less = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y), "en", { numeric: true });
      return up ? less : -less;
    };
    body.append(...[...body.rows].sort(order));
  };
  head.addEventListener("click", sort);
  head.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); sort(); } });
}
// Tell the point nearest to the pointer, or the hint of a cell.
const tip = document.getElementById("tip");
const tell = (text, event) => {
  tip.textContent = text;
  tip.hidden = false;
  const right = event.pageX + 16 + tip.offsetWidth > document.documentElement.clientWidth;
  tip.style.left = event.pageX + (right ? -12 - tip.offsetWidth : 14) + "px";
  tip.style.top = event.pageY + 12 + "px";
};
const hush = () => { tip.hidden = true; };
const read = (value) => String(Number(value.toPrecision(4))).replace("-", "\u2212");
let told = 0;
for (const figure of document.querySelectorAll("figure")) {
  const json = figure.querySelector('script[type="application/json"]'), svg = figure.querySelector("svg");
  if (!json || !svg) continue;
  const { plot: [left, top, width, height], x, y, series } = JSON.parse(json.textContent);
  told += series.length;
  const px = (value) => left + (value - x.range[0]) / (x.range[1] - x.range[0]) * width;
  const py = (value) => top + (y.range[1] - value) / (y.range[1] - y.range[0]) * height;
  svg.addEventListener("mousemove", (event) => {
    const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
    const [mx, my] = [(event.clientX - box.left) / scale, (event.clientY - box.top) / scale];
    let best = null, nearest = 18 * 18;
    for (const { name, points } of series) for (const [u, v] of points) {
      const apart = (px(u) - mx) ** 2 + (py(v) - my) ** 2;
      if (apart < nearest) [nearest, best] = [apart, [name, u, v]];
    }
    if (!best) return hush();
    tell(`${best[0]}\n${x.caption}: ${read(best[1])}\n${y.caption}: ${read(best[2])}`.trim(), event);
  });
  svg.addEventListener("mouseleave", hush);
}
for (const cell of document.querySelectorAll("td[data-hint]")) {
  cell.addEventListener("mousemove", (event) => tell(cell.dataset.hint, event));
  cell.addEventListener("mouseleave", hush);
}
// For tests: how many tables sort and how many series answer.
document.documentElement.dataset.ready = `${document.querySelectorAll("table").length} tables, ${told} series`;
