// Tables sort by the column whose heading is pressed: numbers by value, texts by their words and the numbers in them; what is missing comes
// last. Of a long table the first rows are laid out, and all of them on demand.
document.querySelectorAll("table.sorts").forEach((table) => {
  const shown = 100;
  const body = table.tBodies[0];
  let all = body.rows.length <= 2 * shown;
  const order = (rows) => {
    rows.forEach((row, k) => { row.hidden = !all && k >= shown; });
    body.replaceChildren(...rows);
  };
  if (!all) {
    const more = document.createElement("button");
    more.type = "button";
    more.className = "more";
    more.textContent = `Show all ${body.rows.length.toLocaleString("en")} rows`;
    more.addEventListener("click", () => {
      all = true;
      more.remove();
      order(Array.from(body.rows));
    });
    table.parentElement.after(more);
    order(Array.from(body.rows));
  }
  const words = new Intl.Collator("en", { numeric: true });
  const value = (text, numeric) => {
    if (text === "" || text === "-") return null;
    if (!numeric) return text;
    const levels = text.split(" then ").map((part) => parseFloat(part.replace(/,/g, "")));
    return levels.some(Number.isNaN) ? null : levels;
  };
  const compare = (a, b) => {
    if (typeof a === "string") return words.compare(a, b);
    const k = a.findIndex((one, level) => one !== b[level]);
    return k < 0 ? 0 : a[k] < b[k] ? -1 : 1;
  };
  table.querySelectorAll("thead th").forEach((head) => {
    head.querySelector("button")?.addEventListener("click", () => {
      const upwards = head.getAttribute("aria-sort") !== "ascending";
      const numeric = head.classList.contains("n");
      table.querySelectorAll("th[aria-sort]").forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", upwards ? "ascending" : "descending");
      const rows = Array.from(body.rows, (row) => [value(row.cells[head.cellIndex].textContent.trim(), numeric), row]);
      rows.sort(([a], [b]) => (a === null || b === null ? (a === null) - (b === null) : upwards ? compare(a, b) : compare(b, a)));
      order(rows.map(([, row]) => row));
    });
  });
});
